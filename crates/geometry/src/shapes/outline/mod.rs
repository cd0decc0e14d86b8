// SPDX-License-Identifier: MIT OR Apache-2.0
//! What is inside a closed outline in a plane, decided twice: by a cheap filter that knows what is clearly
//! inside or outside, and between, near the edges, by the exact test, which alone keeps neighbours watertight.
//!
//! # Why the filters never contradict the exact test
//!
//! Write `u` for the unit roundoff and `g(n)` for [`gamma`]. Let the plane go through `c` with the stored normal
//! `n`, `|n| <= 1 + 4u`, let the ray be `o + d t`, and let the computed numbers be `f = o - c`, `h = f . n`,
//! `r = d . n`, `t = -h / r > 0` and `q = f + d t`. All corners `p` have `|p - c| <= size`, and lie at most `off`
//! away from the plane.
//!
//! 1. `h` is wrong by at most `g(5) |f|` and `r` by `g(4) |d|`, so the point at the computed `t` of the exact line
//!    lies at most `eta = g(8) (|f| + |d| t)` away from the plane; `q` is that point, `l`, within
//!    `g(2) (|f| + |d| t)`.
//! 2. The exact test ([`Shear`]) moves each corner by at most `g(6) R` along either axis of the shear, where
//!    `R <= |f| + 3 size` bounds the offsets of all corners from the origin (the filters' own corners included):
//!    it judges corners that are moved by `rho <= g(9) R`. For these it is right (the sign of a difference of
//!    two rounded products is never wrong, only 0) unless the line passes an edge, measured in the shear, within
//!    `2 u R`.
//! 3. Carry the moved corners along `d` into the plane through `l`. With `k = |d| / |r| >= 1` each arrives within
//!    `B = rho + (off + eta + rho) k` of where it was, and `2 u R` become at most `2 u R k`, since a vector of the
//!    plane is seen along `d` shortened by `1 / k` at most.
//! 4. So where `l` keeps more than `B + 2 u R k` from all edges of the undisturbed outline, its edges can be moved
//!    to where the exact test sees them without one sweeping over `l`, and the exact test's answer is that of
//!    exact arithmetic for the undisturbed outline. With the error of `q` all of that is at most
//!    `k (off + g(64) (|f| + |d| t + size))`.
//!
//! The filters are right with a distance of `slack` or more from the edges, so they may be asked where that is at
//! most `slack`: [`Room`].

mod cells;
mod facet;
mod halves;
#[cfg(test)]
pub(crate) mod testing;

pub(crate) use cells::Cells;
pub(crate) use facet::{Facet, Room, Spread};
pub(crate) use halves::Halves;

#[cfg(doc)]
use dioptric_math::bounds::gamma;
use dioptric_math::{DVec2, DVec3};

use super::sheared::{Shear, area};

/// The outline and its holes: rings of corners one after another.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Outline {
    corners: Box<[DVec3]>,
    /// Where each ring but the first begins.
    holes: Box<[u32]>,
}

impl Outline {
    pub fn new(rings: &[Vec<DVec3>]) -> Self {
        let mut end = 0;
        let ends = rings.iter().map(|ring| {
            end += ring.len() as u32;
            end
        });
        let mut holes: Vec<u32> = ends.collect();
        holes.pop();
        Self { corners: rings.iter().flatten().copied().collect(), holes: holes.into_boxed_slice() }
    }

    pub fn corners(&self) -> &[DVec3] {
        &self.corners
    }

    pub fn memory_bytes(&self) -> usize {
        size_of_val(&*self.corners) + size_of_val(&*self.holes)
    }

    /// Whether there are no holes.
    pub fn is_simple(&self) -> bool {
        self.holes.is_empty()
    }

    /// Where a ring begins and ends.
    fn ring(&self, i: usize) -> (usize, usize) {
        let start = if i == 0 { 0 } else { self.holes.get(i - 1).map_or(0, |&s| s as usize) };
        (start, self.holes.get(i).map_or(self.corners.len(), |&s| s as usize))
    }

    /// The ring that a corner belongs to.
    fn ring_of(&self, corner: usize) -> (usize, usize) {
        self.ring(self.holes.partition_point(|&s| s as usize <= corner))
    }

    /// The rings as ranges of corners.
    fn rings(&self) -> impl Iterator<Item = (usize, usize)> {
        (0..=self.holes.len()).map(|i| self.ring(i))
    }

    /// The corners of the outline, and of each hole.
    pub fn loops(&self) -> impl Iterator<Item = &[DVec3]> {
        self.rings().map(|(start, end)| self.corners.get(start..end).unwrap_or_default())
    }

    /// Whether the line through `origin` along `direction` passes through it, by the parity of the
    /// edges to one side.
    pub fn is_passed(&self, origin: DVec3, direction: DVec3) -> bool {
        let shear = Shear::new(origin, direction);
        let ring = |(start, end)| self.corners.get(start..end).unwrap_or_default();
        self.rings().fold(false, |inside, at| inside ^ encloses(ring(at), &shear))
    }
}

/// Whether a ring goes around the ray of a shear an odd number of times.
fn encloses(ring: &[DVec3], shear: &Shear) -> bool {
    let Some(&last) = ring.last() else { return false };
    let mut a = shear.project(last);
    ring.iter().fold(false, |inside, &corner| {
        let b = shear.project(corner);
        let counted = counts(a, b);
        a = b;
        inside ^ counted
    })
}

/// Whether an edge runs across the half line from the origin to one side. An edge that goes through the origin
/// counts, whichever way it runs, so exactly one of two neighbours has it.
#[inline]
fn counts(a: DVec2, b: DVec2) -> bool {
    (a.y > 0.0) != (b.y > 0.0) && if a.y < b.y { area(a, b) >= 0.0 } else { area(b, a) >= 0.0 }
}
