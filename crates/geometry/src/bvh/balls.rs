// SPDX-License-Identifier: MIT OR Apache-2.0
//! Eight balls side by side, and the ray that filters them.
//!
//! In single precision, about the tree's centre: the ball's centre less its part along the ray must be no longer
//! than the radius. Let u = 2^-24 and R bound the coordinates of origin and balls together. An offset is off by
//! 2uR, the direction by u and the inverse of its square by 4u, so that the part along the ray is off by less than
//! 25uR, and what is left by less than 32uR along each axis: together less than 56uR.
//!
//! Half the chord is then at most the root of (r + s)^2 - q^2, with this error s, the radius r and what was worked
//! out for the distance q; the roundings of these squares are less than 4u of the first. And where q is no more than
//! r - s the ball is hit for certain, and half the chord at least the root of (r - s)^2 - q^2, for that is
//! no more than r^2 - (q + s)^2.

use super::ray::Start;

/// Balls of a packet.
pub(crate) const BALLS: usize = 8;

/// Eight balls or fewer; the radii of those that are missing are NaN.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(crate) struct Balls {
    /// Axis, ball.
    pub centers: [[f32; BALLS]; 3],
    /// Rounded up.
    pub radii: [f32; BALLS],
    /// The first of their places, which follow each other.
    pub first: u32,
}

impl Balls {
    /// No ball.
    pub const fn empty(first: u32) -> Self {
        Self { centers: [[0.0; BALLS]; 3], radii: [f32::NAN; BALLS], first }
    }
}

/// A ray among balls in single precision, its direction scaled so that the largest component is about 1.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BallRay {
    /// About the tree's centre.
    pub origin: [f32; 3],
    /// Where it goes.
    pub direction: [f32; 3],
    /// 1 over the direction's squared length.
    pub inverse: f32,
    /// What distances may be off by.
    pub slack: f32,
    /// Whether single precision is any use; else all balls must be asked.
    pub usable: bool,
}

impl BallRay {
    /// By how much of the square of radius and error together the square of half the chord is off, and more.
    pub const SQUARES: f32 = 5e-7;
    /// Covers the roundings of half the chord.
    pub const CHORD: f32 = 1e-6;
    /// Covers the rounding of radii.
    pub const RADII: f32 = 1.0 - 3e-7;

    /// For balls with coordinates up to `extent` about the tree's centre; `pad` is what hits may be off by otherwise.
    #[inline(always)]
    pub fn new(start: &Start, extent: f32, pad: f32) -> Self {
        let [x, y, z, _] = start.direction.to_array();
        let reach = extent + start.away;
        Self {
            origin: start.origin.truncate().to_array(),
            direction: [x, y, z],
            inverse: 1.0 / (x * x + y * y + z * z),
            slack: reach * (81.0 / (1u32 << 24) as f32) + pad + f32::MIN_POSITIVE,
            usable: start.usable && reach + pad < 1e18,
        }
    }
}
