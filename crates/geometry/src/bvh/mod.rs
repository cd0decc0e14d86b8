// SPDX-License-Identifier: MIT OR Apache-2.0
//! A bounding volume hierarchy: a tree of boxes over anything that has a box.
//!
//! It knows boxes and leaf ranges only (invariant 5). Whoever builds one puts its own things into the
//! order that the build returns, and tests them itself when [`Bvh::visit`] hands it a range of them.
//!
//! A box test never loses a hit: boxes are rounded outward to f32 about an f64 centre, and a
//! [`BoxRay`] widens them by a pad that bounds every error of the test and of what lies in the leaves.

mod build;
mod traverse;

use dioptric_math::{DVec3, Vec4};

use crate::bounds::Bounds;

pub use traverse::{BoxRay, Count, Counter, NoCount};

/// No way from the root has more splits: the build falls back to halving in time.
const MAX_DEPTH: usize = 64;

/// Up to four child boxes and where the children are: two cache lines. A child that is missing has
/// an inverted box, which no ray enters.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
struct Node {
    /// `planes[2 * axis + side]`, a lane for each child; side 0 is the smaller one.
    planes: [Vec4; 6],
    children: [Child; 4],
}

/// A leaf, `first .. first + count` of the items; or the node `first` where `count` is 0.
#[derive(Clone, Copy, Debug, Default)]
struct Child {
    first: u32,
    count: u32,
}

/// A tree of boxes.
#[derive(Clone, Debug)]
pub struct Bvh {
    nodes: Vec<Node>,
    /// Where the nodes' boxes have their origin.
    center: DVec3,
    /// The largest coordinate of the nodes' boxes.
    extent: f64,
    /// The nodes on the longest way from the root.
    depth: usize,
}

impl Bvh {
    /// Builds the tree over `boxes` (finite, not empty: see [`Bvh::can_hold`]) and returns it with the
    /// order in which leaf ranges count: range `a..b` means `boxes[order[a]] .. boxes[order[b - 1]]`.
    ///
    /// Uses the pool of threads that it is called in, if it is called in one; the result is the same
    /// for any number of threads.
    #[must_use]
    pub fn build(boxes: impl ExactSizeIterator<Item = Bounds>, center: DVec3) -> (Self, Vec<u32>) {
        build::build(boxes, center)
    }

    /// Whether a box is finite and not empty, also in single precision about `center`.
    #[must_use]
    pub fn can_hold(bounds: &Bounds, center: DVec3) -> bool {
        !bounds.is_empty() && build::Box32::around(bounds, center).is_finite()
    }

    /// Bytes on the heap.
    #[must_use]
    pub fn memory_bytes(&self) -> usize {
        self.nodes.capacity() * size_of::<Node>()
    }
}
