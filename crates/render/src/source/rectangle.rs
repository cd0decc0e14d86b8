// SPDX-License-Identifier: MIT OR Apache-2.0
//! A rectangle, found uniformly over the solid angle that it fills: without branches, so that many points look for it
//! side by side.

use dioptric_math::bounds::gamma;
use dioptric_math::{DVec3, half_turn_angle, turn_sin_cos};

/// Below this solid angle the digits of a direction in it are lost.
const LEAST: f64 = 1e-3;

/// A rectangle that some light comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rectangle {
    pub corner: DVec3,
    /// Unit vectors along the edges, and how long these are.
    pub axes: [DVec3; 2],
    pub lengths: [f64; 2],
    pub normal: DVec3,
    pub area: f64,
}

/// A rectangle from a point: its plane is `height` away along the normal, and in it the first corner lies at `low`,
/// the opposite one at `high`.
#[derive(Clone, Copy)]
pub(super) struct View {
    low: [f64; 2],
    high: [f64; 2],
    pub height: f64,
    /// How far the first corner is, and the one along the second edge.
    ways: [f64; 2],
    pub solid_angle: f64,
    /// Whether the point lies in its plane, within rounding.
    pub within: bool,
    /// Whether the solid angle is unknown: numbers got too small or too large.
    pub odd: bool,
}

/// A direction in which a rectangle is seen.
#[derive(Clone, Copy)]
pub(super) struct Look {
    pub direction: DVec3,
    pub distance: f64,
    /// Whether there is one.
    pub fits: bool,
}

/// A place on a rectangle, as a point sees it.
#[derive(Clone, Copy)]
pub(super) struct Spot {
    pub direction: DVec3,
    pub distance: f64,
    /// The density over solid angles with which it is found.
    pub density: f64,
    /// Whether the point lies in the rectangle's plane, within rounding.
    pub within: bool,
}

/// From farther away than so many times half of its diagonal, a rectangle looks about the same everywhere: places on it
/// are picked evenly over its area, which takes a fifth of the time: the density over directions then varies by a fifth at most.
/// (docs/performance.md.)
const FAR: f64 = 3.0;

impl Rectangle {
    /// Whether it is looked for by its area from a point, and not by its solid angle.
    #[inline(always)]
    pub fn is_far(&self, point: DVec3) -> bool {
        let [u, v] = self.lengths;
        let way = (self.corner - point) + (self.axes[0] * (0.5 * u) + self.axes[1] * (0.5 * v));
        way.length_squared() > (0.25 * FAR * FAR) * (u * u + v * v)
    }

    /// A place, uniform over the area.
    #[inline(always)]
    pub fn spot(&self, point: DVec3, u: [f64; 2]) -> Spot {
        let corner = self.corner - point;
        let [x, y] = [u[0] * self.lengths[0], u[1] * self.lengths[1]];
        let way = corner + (self.axes[0] * x + self.axes[1] * y);
        let height = corner.dot(self.normal).abs();
        let length2 = way.length_squared();
        let distance = length2.sqrt();
        Spot {
            direction: way * (1.0 / distance),
            distance,
            density: length2 * distance / (height * self.area),
            within: !(height > rounding(self.corner, point)),
        }
    }

    /// The rectangle as a point sees it. The half angles of its two halves are those of two complex numbers (van
    /// Oosterom and Strackee, "The Solid Angle of a Plane Triangle", IEEE Trans. Biomed. Eng. 30(2), 1983), and of
    /// their product together.
    #[inline(always)]
    pub fn view(&self, point: DVec3) -> View {
        let a = self.corner - point;
        let (x0, y0, z) = (a.dot(self.axes[0]), a.dot(self.axes[1]), a.dot(self.normal));
        let (x1, y1) = (x0 + self.lengths[0], y0 + self.lengths[1]);
        let (xx, yy, zz) = ([x0 * x0, x1 * x1], [y0 * y0, y1 * y1], z * z);
        let i = (xx[0] + yy[0] + zz).sqrt();
        let j = (xx[1] + yy[0] + zz).sqrt();
        let k = (xx[0] + yy[1] + zz).sqrt();
        let l = (xx[1] + yy[1] + zz).sqrt();
        let (along, up) = (x0 * x1 + zz, y0 * y1 + zz);
        let diagonal = i * l + (x0 * x1 + up);
        let first = diagonal * j + (along + yy[0]) * l + (xx[1] + up) * i;
        let second = diagonal * k + (xx[0] + up) * l + (along + yy[1]) * i;
        let det = z.abs() * self.area;
        let (re, im) = (first * second - det * det, det * (first + second));
        View {
            low: [x0, y0],
            high: [x1, y1],
            height: z,
            ways: [i, k],
            solid_angle: 2.0 * half_turn_angle(re, im),
            within: !(z.abs() > rounding(self.corner, point)),
            odd: !(re.abs() < f64::INFINITY && im > f64::MIN_POSITIVE && im < f64::INFINITY),
        }
    }

    /// A direction, uniform over those in which it is seen (Ureña, Fajardo and King, "An Area-Preserving
    /// Parametrization for Spherical Rectangles", EGSR 2013, section 4). It fits where the solid angle is not small.
    #[inline(always)]
    pub fn look(&self, view: &View, u: [f64; 2]) -> Look {
        let ([x0, y0], [x1, y1], z) = (view.low, view.high, view.height);
        let zz = z * z;
        let (inv0, inv1) = (1.0 / (y0 * y0 + zz).sqrt(), 1.0 / (y1 * y1 + zz).sqrt());
        // Heights of the unit normals of the planes through the sides of y0 and y1, seen along -z.
        let (b0, b1, flat) = (-y0 * inv0, y1 * inv1, z * inv0);
        // k is a whole turn less the angles at the corners (x0, y1) and (x0, y0) between the planes: those of two
        // complex numbers, so that their product has its cosine and its sine.
        let [i, k] = view.ways;
        let unit = (inv0 * inv1) / (x0 * x0 + zz);
        let cos_k = -(x0 * x0 * y0 * y1 + zz * i * k) * unit;
        let sin_k = -z.abs() * x0 * (y1 * i - y0 * k) * unit;
        let (s, c) = turn_sin_cos(u[0] * view.solid_angle);
        let (sine, cosine) = (s * cos_k + c * sin_k, c * cos_k - s * sin_k);
        // (1 - b0^2 would cancel.)
        let (up, down) = (cosine * b0 - b1, flat * sine);
        let root = (up * up - down * down).max(0.0).sqrt();
        let x = ((z * sine).abs() / root).copysign(up * sine).max(x0).min(x1);
        let d2 = x * x + zz;
        let (h0, h1) = (y0 / (d2 + y0 * y0).sqrt(), y1 / (d2 + y1 * y1).sqrt());
        let h = h0 + u[1] * (h1 - h0);
        let y = (h * (d2 / (1.0 - h * h).max(f64::MIN_POSITIVE)).sqrt()).max(y0).min(y1);
        let length2 = d2 + y * y;
        let distance = length2.sqrt();
        let inverse = 1.0 / distance;
        let way = self.axes[0] * x + self.axes[1] * y + self.normal * z;
        Look {
            direction: way * inverse,
            distance,
            fits: view.solid_angle > LEAST && length2 > 1e-200 && length2 < 1e200,
        }
    }
}

/// What rounding does to the height of a point over a plane.
#[inline(always)]
fn rounding(corner: DVec3, point: DVec3) -> f64 {
    gamma(32) * (largest(corner) + largest(point))
}

/// The largest of the components' sizes.
#[inline(always)]
fn largest(v: DVec3) -> f64 {
    v.x.abs().max(v.y.abs()).max(v.z.abs())
}
