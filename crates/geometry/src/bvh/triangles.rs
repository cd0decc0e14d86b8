// SPDX-License-Identifier: MIT OR Apache-2.0
//! Eight triangles side by side, and the line that filters them.
//!
//! The filter is the sheared edge test of Woop, Benthin and Wald, "Watertight Ray/Triangle Intersection",
//! JCGT 2(1), 2013, in single precision with a margin. It rejects only what the exact test rejects:
//!
//! Let u = 2^-24, R bound the coordinates of corners and origin together, b the distance from the exact origin
//! within which the caller wants all triangles, and E the shears of a triangle's edges. Corners are exact.
//! A corner's offset from the rounded origin is off by 2uR, the slope (at most 1, a product of rounded numbers) by
//! 4u, so that a sheared coordinate is off by at most 2uR + 2uR + 4uR + uR + 2uR, and the line itself by 2b:
//! e = 12uR + 2b. The coordinates of a triangle that is passed are at most E + e =: M; each of an edge function's
//! two products is off by 2Me + e^2, and their roundings add 6uM^2 where uM <= e. Together that is less
//! than 12eM.
//!
//! What is left then gets a second look, with bounds from its own numbers. Let O bound the origin, and X and Z be the
//! largest coordinates that were worked out across and along the line. The rounded origin is off by uO, an offset
//! A by uA more, so that a sheared coordinate is off by at most 2uO + u(2X + 7Z) and by 2b: e. An edge
//! function is off by 4Xe + 2e^2 + 6uX^2 < 8e(X + e), a depth by less than e, and the three products of both together
//! by 3 times the one by Z, and the sum of the edge functions by e.
//!
//! Nearly all that is left then is certain: where all edge functions are at least twice what they may be off by, the
//! exact ones are at least that, which is more than f64 can be off by, and so the exact test finds a passage. With
//! their sum S, margins m and the range D of the corners' depths, a depth that is the mean of those weighted by edge
//! functions is off by 3mD / (S - 3m) for these, where S is at least 6m, and by e for those: 6mD / S + e, and the
//! roundings of the mean, less than 6uZ <= e. What the exact test is off by is far less: of needles and of triangles
//! that the line sees from their edges less than a tenth of the first term, of others of the second.

use dioptric_math::DVec3;

use super::ray::Start;

/// Triangles of a packet.
pub(crate) const SIDE_BY_SIDE: usize = 8;

/// Eight triangles or fewer; the corners of those that are missing are NaN.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct Packet {
    /// Corner, axis, triangle.
    pub corners: [[[f32; SIDE_BY_SIDE]; 3]; 3],
    /// The triangles' numbers; `u32::MAX` where missing.
    pub parts: [u32; SIDE_BY_SIDE],
}

impl Packet {
    /// No triangle.
    pub const EMPTY: Self =
        Self { corners: [[[f32::NAN; SIDE_BY_SIDE]; 3]; 3], parts: [u32::MAX; SIDE_BY_SIDE] };

    /// Puts a triangle into a lane.
    pub fn set(&mut self, lane: usize, corners: &[[f32; 3]; 3], part: u32) {
        for (corner, from) in self.corners.iter_mut().zip(corners) {
            for (axis, x) in corner.iter_mut().zip(from) {
                axis[lane] = *x;
            }
        }
        self.parts[lane] = part;
    }

    /// The corners of a lane's triangle, their coordinates in some order.
    #[inline(always)]
    pub fn get(&self, lane: usize, [x, y, z]: [usize; 3]) -> [[f32; 3]; 3] {
        // Written out: `map` on arrays is a call.
        let [a, b, c] = &self.corners;
        [
            [a[x][lane], a[y][lane], a[z][lane]],
            [b[x][lane], b[y][lane], b[z][lane]],
            [c[x][lane], c[y][lane], c[z][lane]],
        ]
    }

    /// A bit for each triangle.
    pub fn all(&self) -> u32 {
        (0..SIDE_BY_SIDE).fold(0, |all, i| all | u32::from(self.parts[i] != u32::MAX) << i)
    }
}

/// What single precision tells of a packet's triangles.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sight {
    /// A bit for each that the line may pass.
    pub kept: u32,
    /// And for each of these that it passes for certain, the exact test's rounding included, ahead:
    pub sure: u32,
    /// not before these depths
    pub from: [f32; SIDE_BY_SIDE],
    /// and not after these.
    pub to: [f32; SIDE_BY_SIDE],
}

impl Sight {
    /// Nothing is told of these triangles.
    pub const fn unknown(kept: u32) -> Self {
        Self { kept, sure: 0, from: [0.0; SIDE_BY_SIDE], to: [0.0; SIDE_BY_SIDE] }
    }
}

/// A line among triangles in single precision.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Aim {
    /// The origin, in the order of `axes`.
    pub origin: [f32; 3],
    /// The axes in cyclic order; the direction is longest along the last one.
    pub axes: [usize; 3],
    /// How far the line moves along the first two axes for each step along the last.
    pub slope: [f32; 2],
    /// Whether the direction is positive along the last axis.
    pub forward: bool,
    /// What an edge function may be off by, for triangles that are not large.
    pub margin: f32,
    /// What a depth may be off by.
    pub slack: f32,
    /// What a sheared coordinate may be off by for the origin's sake.
    pub error: f32,
    /// Passages up to this depth are not certain.
    pub certain: f32,
    /// Whether single precision is any use; else all triangles must be asked.
    pub usable: bool,
}

impl Aim {
    /// For how much of X, and of Z, a sheared coordinate may be off besides: 2u and 7u, and a little more.
    pub const ACROSS: f32 = 1.3e-7;
    /// See [`Self::ACROSS`].
    pub const ALONG: f32 = 4.5e-7;
    /// The 8 of the edge functions, and a little more.
    pub const EDGES: f32 = 8.5;
    /// The 3 of the depths, and a little more.
    pub const DEPTHS: f32 = 3.2;
    /// For a passage that is certain: the 6 margins for each unit of the triangle's own depth, and a little more.
    pub const RANGES: f32 = 7.0;
    /// And the errors of a sheared coordinate that its depth may be off by.
    pub const ERRORS: f32 = 3.5;

    /// The line of a ray that starts at `origin`. Lengths are rounded up: `away` bounds the origin's coordinates,
    /// `largest` those of all corners and `edge` those of all edges of triangles that are not large; `near` is as b
    /// above.
    #[inline(always)]
    pub fn new(
        start: &Start,
        origin: DVec3,
        away: f32,
        (largest, edge, near): (f32, f32, f32),
        certain: f32,
    ) -> Self {
        const AXES: [[usize; 3]; 3] = [[1, 2, 0], [2, 0, 1], [0, 1, 2]];
        let axes = AXES[start.axis];
        let [x, y, z] = axes;
        let origin = [origin.x as f32, origin.y as f32, origin.z as f32];
        let (direction, inverse) = (start.direction.to_array(), start.inverse.to_array());
        let reach = largest + away;
        let error = 12.0 / (1u32 << 24) as f32 * reach + 2.0 * near;
        let margin = 12.0 * error * (2.0 * edge + error) + f32::MIN_POSITIVE;
        Self {
            origin: [origin[x], origin[y], origin[z]],
            axes,
            slope: [direction[x] * inverse[z], direction[y] * inverse[z]],
            forward: inverse[z] > 0.0,
            // With room for the roundings.
            margin: margin * (1.0 + 1e-6),
            slack: (error + f32::MIN_POSITIVE) * (1.0 + 1e-6),
            // Twice what it must be, for the second look's own roundings.
            error: 4.0 / (1u32 << 24) as f32 * away + 4.0 * near,
            certain,
            usable: start.usable && reach + error < 1e18,
        }
    }

    /// The depths between which triangles lie that matter, as `low <= depths[0]` and `high >= depths[1]`; `limit`
    /// is the largest distance along the last axis.
    #[inline(always)]
    pub fn depths(&self, limit: f32) -> [f32; 2] {
        // More than the roundings of the limit and of this.
        let end = limit + (self.slack + limit * 1e-6);
        if self.forward { [end, -self.slack] } else { [self.slack, -end] }
    }
}
