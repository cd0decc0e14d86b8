// SPDX-License-Identifier: MIT OR Apache-2.0
//! Whether triangles enclose a volume, in one pass over them.
//!
//! Every edge must be walked as often in one direction as in the other. Each directed edge gets a random
//! number that is the negative of its reverse's (a hash of the corners' positions, so that corners that
//! a file repeats are one); the sum over all is 0 for closed meshes, and for open ones once in 2^64.

use super::line::Corners;

/// What is summed up over all triangles; sums of parts may be added in any order.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Boundary {
    sum: u64,
}

impl Boundary {
    /// Adds the three edges of a triangle.
    #[inline]
    pub fn add(&mut self, corners: &Corners) {
        let [a, b, c] = corners.map(hash);
        self.sum =
            self.sum.wrapping_add(edge(a, b)).wrapping_add(edge(b, c)).wrapping_add(edge(c, a));
    }

    /// No triangle.
    pub const NONE: Self = Self { sum: 0 };

    /// The sum over both parts.
    pub const fn and(self, other: Self) -> Self {
        Self { sum: self.sum.wrapping_add(other.sum) }
    }

    /// Whether nothing is left open.
    pub const fn is_closed(self) -> bool {
        self.sum == 0
    }
}

/// 0 for an edge from a corner to itself.
#[inline]
fn edge(a: u64, b: u64) -> u64 {
    let way = |a: u64, b: u64| mix(a.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(b));
    way(a, b).wrapping_sub(way(b, a))
}

/// A number for a position; -0 is 0.
#[inline]
fn hash(corner: [f32; 3]) -> u64 {
    let [x, y, z] = corner.map(|x| u64::from((x + 0.0).to_bits()));
    mix(mix(x | y << 32).wrapping_add(z))
}

/// The finaliser of SplitMix64 (Steele, Lea and Flood, "Fast Splittable Pseudorandom Number Generators",
/// OOPSLA 2014).
#[inline]
const fn mix(mut z: u64) -> u64 {
    z = z.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}
