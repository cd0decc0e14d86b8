// SPDX-License-Identifier: MIT OR Apache-2.0
//! A disc by the solid angle that it fills, and a ring, a disc with a hole, by its area.

use std::f64::consts::{PI, TAU};

use dioptric_math::bounds::gamma;
use dioptric_math::{DVec3, atan2, normalize, orthonormal_basis, sin_cos};

use super::patch::{Found, Met};
use crate::sampling::warp::concentric_disc;

/// All points of a plane between two circles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ring {
    pub center: DVec3,
    pub normal: DVec3,
    /// The radius of the hole, and of the rim.
    pub radii: [f64; 2],
}

impl Ring {
    pub fn area(&self) -> f64 {
        let [hole, rim] = self.radii;
        PI * (rim - hole) * (rim + hole)
    }

    /// A point, uniform over the area.
    pub fn point(&self, u: [f64; 2]) -> DVec3 {
        let [mut a, mut b] = concentric_disc(u);
        let [hole, rim] = self.radii;
        let r2 = a * a + b * b;
        if hole > 0.0 {
            let length = r2.sqrt();
            (a, b) = if length > 0.0 { (a / length, b / length) } else { (1.0, 0.0) };
            let r = (hole * hole + r2 * (rim - hole) * (rim + hole)).sqrt() / rim;
            (a, b) = (a * r, b * r);
        }
        let (x, y) = orthonormal_basis(self.normal);
        self.center + (x * a + y * b) * rim
    }

    /// The way to its plane along the normal; `None` from points in it, within rounding.
    fn height(&self, point: DVec3) -> Option<f64> {
        let height = (self.center - point).dot(self.normal);
        let rounding = gamma(32) * (self.center.abs().max_element() + point.abs().max_element());
        (height.abs() > rounding).then_some(height)
    }

    pub fn sample(&self, point: DVec3, u: [f64; 2]) -> Option<Found> {
        let (height, normal) = (self.height(point)?, self.normal);
        if self.radii[0] > 0.0 {
            let way = self.point(u) - point;
            let (direction, distance) = (normalize(way)?, way.length());
            let density = Met { direction, distance, normal }.per_solid_angle(1.0 / self.area());
            return Some(Found { direction, distance, normal, density, part: 0 });
        }
        let (direction, density) = self.cone(point, height)?.sample(u)?;
        let distance = height / direction.dot(normal);
        Some(Found { direction, distance, normal, density, part: 0 })
    }

    /// The density with which [`Self::sample`] finds what a ray from a point met.
    pub fn density(&self, point: DVec3, met: &Met) -> f64 {
        let Some(height) = self.height(point) else { return 0.0 };
        if self.radii[0] > 0.0 {
            return met.per_solid_angle(1.0 / self.area());
        }
        self.cone(point, height).map_or(0.0, |cone| cone.density(met.direction))
    }

    /// The cone of directions from a point to a disc.
    fn cone(&self, point: DVec3, height: f64) -> Option<Cone> {
        let (up, r) = (if height < 0.0 { -self.normal } else { self.normal }, self.radii[1]);
        let (h, way) = (height.abs(), self.center - point);
        let aside = way - self.normal * way.dot(self.normal);
        // In the plane through the point, the middle and the normal: the disc reaches from y0 to y1.
        let side = normalize(aside).unwrap_or_else(|| orthonormal_basis(up).0);
        let y = aside.dot(side);
        let length = |y: f64| (h * h + y * y).sqrt();
        let (y0, y1) = (y - r, y + r);
        let (l0, l1) = (length(y0), length(y1));
        // The cone's axis halves the angle between both. Of the sum and the difference of the two unit vectors the
        // longer one is exact.
        let narrow = h * h + y0 * y1;
        let (c, s) = if narrow > 0.0 {
            (h / l0 + h / l1, y0 / l0 + y1 / l1)
        } else {
            (y1 / l1 - y0 / l0, h / l0 - h / l1)
        };
        let axis = normalize(up * c + side * s)?;
        let (sine, _) = sin_cos(0.5 * atan2(2.0 * r * h, narrow));
        // The half chord across, where the axis meets the disc, and the way to there.
        let chord = 2.0 * r * (l0 * l1).sqrt() / (l0 + l1);
        let far = length((y0 * l1 + y1 * l0) / (l0 + l1));
        let across = chord / (chord * chord + far * far).sqrt();
        let x = normalize(side * c - up * s)?;
        Some(Cone { axis, sides: [x, axis.cross(x)], sines: [sine, across] })
    }
}

/// An elliptic cone: seen along the axis, directions are the points of an ellipse in the unit disc.
///
/// A direction has its azimuth from an angle t of that ellipse, `(a cos t, b sin t)`, and one minus the cosine of its
/// way from the axis uniform up to the ellipse's. With t uniform the density is `(1 + c) / (2 pi a b)`, where c is the
/// cosine of the way from the axis to the ellipse: within a factor of two the same everywhere. With the density of t
/// in proportion to `1 + k cos 2t`, `k` chosen for both ends of the axes, nothing worth mentioning is left of that
/// factor.
struct Cone {
    axis: DVec3,
    sides: [DVec3; 2],
    /// The half axes of the ellipse.
    sines: [f64; 2],
}

impl Cone {
    fn k(&self) -> f64 {
        let [c, d] = self.sines.map(|s| (1.0 - s * s).max(0.0).sqrt());
        (d - c) / (2.0 + c + d)
    }

    /// The density where the angle's squared cosine is `cos2`, and one minus the cosine of the ellipse there.
    fn density_at(&self, cos2: f64) -> (f64, f64, f64) {
        let [a, b] = self.sines;
        let sine2 = (a * a * cos2 + b * b * (1.0 - cos2)).min(1.0);
        let cos = (1.0 - sine2).sqrt();
        let density = (1.0 + self.k() * (2.0 * cos2 - 1.0)) * (1.0 + cos) / (TAU * a * b);
        (density, sine2, sine2 / (1.0 + cos))
    }

    fn sample(&self, u: [f64; 2]) -> Option<(DVec3, f64)> {
        let [x, y] = concentric_disc(u);
        let uniform = atan2(y, x);
        // t + k/2 sin 2t = uniform, by Newton's method; |k| < 1/3.
        let (k, mut t) = (self.k(), uniform);
        for _ in 0..4 {
            let (s, c) = sin_cos(2.0 * t);
            t -= (t + 0.5 * k * s - uniform) / (1.0 + k * c);
        }
        let (s, c) = sin_cos(t);
        let (density, sine2, most) = self.density_at(c * c);
        let up = (x * x + y * y).min(1.0) * most;
        let out = (up * (2.0 - up) / sine2).sqrt();
        let [a, b] = self.sines;
        let [i, j] = self.sides;
        let direction = self.axis * (1.0 - up) + (i * (a * c) + j * (b * s)) * out;
        Some((normalize(direction)?, density))
    }

    fn density(&self, direction: DVec3) -> f64 {
        let [x, y] = [0, 1].map(|k| direction.dot(self.sides[k]) / self.sines[k]);
        let length2 = x * x + y * y;
        let cos2 = if length2 > 0.0 { x * x / length2 } else { 1.0 };
        let (density, ..) = self.density_at(cos2);
        if density.is_finite() { density } else { 0.0 }
    }
}
