// SPDX-License-Identifier: MIT OR Apache-2.0
//! Cylinders and cones, found uniformly over their area, in their own space.

use std::f64::consts::{PI, TAU};

use dioptric_math::bounds::gamma;
use dioptric_math::{DVec3, normalize, orthonormal_basis, sin_cos};

use super::patch::{Found, Met};

/// The side of a cylinder or a cone, cut off or not, and its discs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Tube {
    base: DVec3,
    /// Unit vector to the other end, how far that is, and the radius at both.
    axis: DVec3,
    height: f64,
    radii: [f64; 2],
    /// The areas of the side and of the discs: parts 0, 1 and 2.
    areas: [f64; 3],
}

impl Tube {
    pub fn new([base, top]: [DVec3; 2], radii: [f64; 2], open: bool) -> Option<Self> {
        let (axis, height) = (normalize(top - base)?, (top - base).length());
        let [a, b] = radii;
        let slant = (height * height + (a - b) * (a - b)).sqrt();
        let disc = |r: f64| if open { 0.0 } else { PI * r * r };
        let areas = [PI * (a + b) * slant, disc(a), disc(b)];
        let sum: f64 = areas.iter().sum();
        (sum > 0.0 && sum.is_finite()).then_some(Self { base, axis, height, radii, areas })
    }

    pub fn area(&self) -> f64 {
        self.areas.iter().sum()
    }

    /// A ball around it.
    pub fn ball(&self) -> (DVec3, f64) {
        let half = 0.5 * self.height;
        let widest = self.radii[0].max(self.radii[1]);
        (self.base + self.axis * half, (half * half + widest * widest).sqrt() * (1.0 + 1e-9))
    }

    /// A point, uniform over the area, its normal and part.
    pub fn point(&self, u: [f64; 2]) -> (DVec3, DVec3, u32) {
        let (mut part, mut rest) = (0, u[0] * self.area());
        while part < 2 && rest >= self.areas[part] {
            rest -= self.areas[part];
            part += 1;
        }
        // The last disc may have no area at all.
        if self.areas[part] == 0.0 {
            (part, rest) = (0, self.areas[0]);
        }
        let share = (rest / self.areas[part]).clamp(0.0, 1.0);
        let (x, y) = orthonormal_basis(self.axis);
        let (s, c) = sin_cos(TAU * u[1]);
        let out = x * c + y * s;
        let [a, b] = self.radii;
        match part {
            1 => (self.base + out * (a * share.sqrt()), -self.axis, 1),
            2 => {
                let top = self.base + self.axis * self.height;
                (top + out * (b * share.sqrt()), self.axis, 2)
            }
            _ => {
                // Where the area below is this share: a t + (b - a) t^2 / 2 = share (a + b) / 2.
                let root = (a * a + share * (b - a) * (b + a)).max(0.0).sqrt();
                let t = if a + root > 0.0 { share * (a + b) / (a + root) } else { share.sqrt() };
                let point = self.base + self.axis * (self.height * t) + out * (a + (b - a) * t);
                let normal = normalize(out * self.height + self.axis * (a - b)).unwrap_or(out);
                (point, normal, 0)
            }
        }
    }

    pub fn sample(&self, point: DVec3, u: [f64; 2]) -> Option<Found> {
        let (there, normal, part) = self.point(u);
        let way = there - point;
        let rounding = gamma(32) * (there.abs().max_element() + point.abs().max_element());
        if !(way.dot(normal).abs() > rounding) {
            return None; // along the surface
        }
        let (direction, distance) = (normalize(way)?, way.length());
        let met = Met { direction, distance, normal };
        let density = met.per_solid_angle(1.0 / self.area());
        Some(Found { direction, distance, normal, density, part })
    }
}
