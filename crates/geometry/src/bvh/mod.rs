// SPDX-License-Identifier: MIT OR Apache-2.0
//! A bounding volume hierarchy: a tree of boxes over anything that has a box.
//!
//! It knows boxes and leaf ranges only (invariant 5). Whoever builds one puts its own things into the
//! order that the build returns, and tests them itself when [`Bvh::visit`] hands it a range of them.
//!
//! A box test never loses a hit: boxes are rounded outward to f32 about an f64 centre, and a
//! [`BoxRay`] widens them by a pad that bounds every error of the test and of what lies in the leaves.
//! Boxes are tested eight at a time, with the best instructions that the processor has ([`Lanes`]).

pub(crate) mod balls;
#[allow(unsafe_code)]
mod bins;
pub(crate) mod build;
mod collapse;
pub(crate) mod item;
#[allow(unsafe_code)]
pub(crate) mod lanes;
pub(crate) mod packet;
pub(crate) mod ray;
#[allow(unsafe_code)]
pub(crate) mod traverse;
pub(crate) mod triangles;

use std::ops::Range;

use dioptric_math::DVec3;
use rayon::prelude::*;

use crate::bounds::Bounds;
use crate::memory;

pub(crate) use build::Costs;
pub use lanes::Lanes;
pub use ray::BoxRay;
pub use traverse::{Count, Counter, NoCount};

/// No way from the root has more splits: the build falls back to halving in time.
const MAX_DEPTH: usize = 64;
/// Children of a node.
const WIDTH: usize = 8;

/// Up to eight child boxes and where the children are: four cache lines. A child that is missing has
/// an inverted box, which no ray enters.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(256))]
pub(crate) struct Node {
    /// `planes[2 * axis + side]`, a lane for each child; side 0 is the smaller one.
    planes: [[f32; WIDTH]; 6],
    children: [Child; WIDTH],
}

/// An inner node, by its index; or with the highest bit a leaf: three bits for the number of its items
/// less one, then the index of the first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Child(u32);

impl Child {
    const LEAF: u32 = 1 << 31;
    const COUNT_SHIFT: u32 = 28;
    /// Leaves hold no more items.
    const MAX_COUNT: usize = 8;
    /// Indices are below.
    const MAX_INDEX: usize = 1 << Self::COUNT_SHIFT;

    const fn inner(index: usize) -> Self {
        Self(index as u32)
    }

    const fn leaf(first: usize, count: usize) -> Self {
        Self(Self::LEAF | ((count - 1) as u32) << Self::COUNT_SHIFT | first as u32)
    }

    /// The index of the node, if it is one.
    #[inline(always)]
    const fn node(self) -> Option<usize> {
        if self.0 & Self::LEAF == 0 { Some(self.0 as usize) } else { None }
    }

    /// The items of a leaf.
    #[inline(always)]
    const fn items(self) -> Range<usize> {
        let first = self.0 as usize & (Self::MAX_INDEX - 1);
        let count = 1 + (self.0 >> Self::COUNT_SHIFT & 7) as usize;
        first..first + count
    }
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
    /// How the queries are run; never more than the processor has.
    lanes: Lanes,
}

impl Bvh {
    /// A tree holds no more boxes.
    pub const MAX_ITEMS: usize = Child::MAX_INDEX;

    /// Builds the tree over `boxes` (finite, not empty: see [`Bvh::can_hold`]) and returns it with the
    /// order in which leaf ranges count: range `a..b` means `boxes[order[a]] .. boxes[order[b - 1]]`.
    /// Boxes beyond [`Bvh::MAX_ITEMS`] are left out.
    ///
    /// Uses the pool of threads that it is called in, if it is called in one; the result is the same
    /// for any number of threads.
    #[must_use]
    pub fn build(boxes: impl ExactSizeIterator<Item = Bounds>, center: DVec3) -> (Self, Vec<u32>) {
        build::build(boxes, center, Costs::SINGLE)
    }

    /// Whether a box is finite and not empty, also in single precision about `center`.
    #[must_use]
    pub fn can_hold(bounds: &Bounds, center: DVec3) -> bool {
        !bounds.is_empty() && item::Box32::around(bounds, center).is_finite()
    }

    /// Where the boxes have their origin.
    #[must_use]
    pub const fn center(&self) -> DVec3 {
        self.center
    }

    /// Puts packets of up to `block` items in the leaves: `fill` makes the one of a range of items, and says whether the
    /// index of the leaf's first packet is to be marked with the bits of `mark`. Returns the packets.
    pub(crate) fn pack_leaves<P: Send>(
        &mut self,
        block: usize,
        mark: usize,
        fill: impl Fn(Range<usize>) -> (P, bool) + Sync,
    ) -> Vec<P> {
        let mut runs: Vec<(u32, u32)> = Vec::with_capacity(WIDTH * self.nodes.len());
        for child in self.leaves() {
            let (range, first) = (child.items(), runs.len());
            for start in range.clone().step_by(block) {
                runs.push((start as u32, range.end.min(start + block) as u32));
            }
            *child = Child::leaf(first, runs.len() - first);
        }
        let fill = |&(start, end): &(u32, u32)| fill(start as usize..end as usize);
        let (mut packets, mut marked) = (memory::with_capacity(runs.len()), Vec::new());
        if rayon::current_thread_index().is_some() {
            runs.par_iter().with_min_len(256).map(fill).unzip_into_vecs(&mut packets, &mut marked);
        } else {
            (packets, marked) = runs.iter().map(fill).unzip();
        }
        if marked.iter().any(|m| *m) {
            for child in self.leaves() {
                let packets = child.items();
                if marked.get(packets.clone()).unwrap_or_default().iter().any(|m| *m) {
                    *child = Child::leaf(packets.start | mark, packets.len());
                }
            }
        }
        packets
    }

    fn leaves(&mut self) -> impl Iterator<Item = &mut Child> {
        let children = self.nodes.iter_mut().flat_map(|node| {
            let missing = node.planes[0].map(|low| low == f32::INFINITY);
            node.children.iter_mut().zip(missing).filter_map(|(c, m)| (!m).then_some(c))
        });
        children.filter(|child| child.node().is_none())
    }

    /// The largest coordinate of the boxes, about the centre.
    pub(crate) const fn extent(&self) -> f64 {
        self.extent
    }

    /// Bytes on the heap.
    #[must_use]
    pub fn memory_bytes(&self) -> usize {
        self.nodes.capacity() * size_of::<Node>()
    }

    /// What the queries are run on.
    #[must_use]
    pub const fn lanes(&self) -> Lanes {
        self.lanes
    }

    /// Runs the queries on these instructions, or the best below them that there are: for tests.
    #[doc(hidden)]
    pub fn use_lanes(&mut self, lanes: Lanes) {
        self.lanes = lanes.or_less();
    }
}
