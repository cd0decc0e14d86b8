// SPDX-License-Identifier: MIT OR Apache-2.0
//! A sphere, found uniformly over the solid angle that it fills.

use dioptric_math::bounds::gamma;
use dioptric_math::{DVec3, normalize};

use super::patch::Found;
use crate::light::shared::{density_in_cone, direction_in_cone, spread_of_sin2, way_in_cone};

/// A sphere that glows on both sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ball {
    pub center: DVec3,
    pub radius: f64,
    pub part: u32,
}

impl Ball {
    /// A point, uniform over the area, its normal and part.
    pub fn point(&self, u: [f64; 2]) -> (DVec3, DVec3, u32) {
        let normal = direction_in_cone(DVec3::Z, 2.0, u);
        (self.center + normal * self.radius, normal, self.part)
    }

    /// `1 - cos` of the half angle under which a point sees it; 2, all round, from inside and from the sphere
    /// itself within rounding.
    fn spread(&self, point: DVec3) -> f64 {
        let d = (self.center - point).length();
        let size = self.center.abs().max_element() + point.abs().max_element() + self.radius;
        if d <= self.radius + gamma(64) * size {
            return 2.0;
        }
        spread_of_sin2((self.radius / d) * (self.radius / d))
    }

    /// [`Self::sample`] from outside, without branches, for loops over many points; whether it fits.
    #[inline(always)]
    pub fn look(&self, point: DVec3, u: [f64; 2]) -> (Found, bool) {
        let (way, r) = (self.center - point, self.radius);
        let d2 = way.length_squared();
        let d = d2.sqrt();
        let size = self.center.abs().max_element() + point.abs().max_element() + r;
        let outside = d > r + gamma(64) * size;
        let spread = spread_of_sin2((r / d) * (r / d));
        let direction = way_in_cone(way / d, spread, u);
        let direction = direction / direction.length();
        let off = way.cross(direction).length();
        let half = ((r - off) * (r + off)).max(0.0).sqrt();
        let distance = way.dot(direction) - half;
        let normal = direction * distance - way;
        let length = normal.length();
        let density = density_in_cone(spread);
        let sound = (density > 0.0) & (density < f64::INFINITY) & (distance > 0.0);
        let range = (1e-200..=1e200).contains(&d2) & (1e-100..=1e100).contains(&length);
        let normal = normal / length;
        (Found { direction, distance, normal, density, part: self.part }, outside & sound & range)
    }

    /// Uniform over the cone of directions in which it is seen (Shirley, Wang and Zimmerman, "Monte Carlo
    /// Techniques for Direct Lighting Calculations", ACM TOG 15(1), 1996, section 3.2.1). A point on the sphere
    /// itself sees it inwards only.
    pub fn sample(&self, point: DVec3, u: [f64; 2]) -> Option<Found> {
        let (found, fits) = self.look(point, u);
        if fits {
            return Some(found);
        }
        let (way, r) = (self.center - point, self.radius);
        let d = way.length();
        let axis = normalize(way).unwrap_or(DVec3::Z);
        let spread = self.spread(point);
        let direction = direction_in_cone(axis, spread, u);
        let along = way.dot(direction);
        let off = way.cross(direction).length();
        let half = ((r - off) * (r + off)).max(0.0).sqrt();
        let distance = if spread < 2.0 {
            along - half
        } else if d < r * (1.0 - 1e-9) {
            along + half
        } else if along > 0.0 {
            // On the sphere, or next to it: the way to the other side.
            along + half
        } else {
            return None;
        };
        let normal = normalize(direction * distance - way)?;
        Some(Found {
            direction,
            distance,
            normal,
            density: density_in_cone(spread),
            part: self.part,
        })
    }

    pub fn density(&self, point: DVec3) -> f64 {
        density_in_cone(self.spread(point))
    }
}
