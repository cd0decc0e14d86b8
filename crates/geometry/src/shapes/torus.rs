// SPDX-License-Identifier: MIT OR Apache-2.0
//! The torus: a ring with a round tube.

use std::f64::consts::PI;

use dioptric_math::bounds::gamma;
use dioptric_math::{DVec2, DVec3, atan2, normalize};
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::convex::root;
use super::disc::circle_bounds;
use super::frame::{around, longitude};
use super::roots::{Pieces, cubic_turns, find, quartic_turns};
use crate::bounds::Bounds;
use crate::ray::LocalRay;
use crate::shape::{Crossing, Described, LocalSurface, Root, Shape};

/// All points at distance `minor` from a circle of radius `major`.
///
/// In units of `major + minor`, with distance `rho` from the axis and height `y` over the middle
/// plane, `g = (rho - R)^2 + y^2 - r^2` is below 0 inside. Times a factor that is never negative it is
/// the quartic `(|p|^2 + R^2 - r^2)^2 - 4 R^2 rho^2`. The quartic's turning points cut a line into
/// pieces with at most one root each; the signs at the cuts and the roots themselves come from `g`,
/// which keeps its digits on tubes however thin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Torus {
    center: DVec3,
    axis: DVec3,
    major: f64,
    minor: f64,
    error: f64,
}

static SCHEMA: Schema = Schema {
    kind: "torus",
    category: Category::Shape,
    summary: "a ring with a round tube",
    doc: "All points at distance `minor_radius` from a circle of radius `major_radius` around `axis`. `minor_radius` must \
          be the smaller one: the ring has a hole.\n\n\
          `uv`: u is the longitude like a sphere's, from 0 at -z over 0.25 at -x and 0.5 at +z to 1; v goes around the \
          tube, from 0 at the side of the hole over 0.25 at the bottom, 0.5 at the outermost circle and 0.75 at the top to \
          1. Along another axis than +y all directions are turned by the smallest rotation from +y.\n\n\
          The quartic is that of Hanrahan in Glassner (ed.), \"An Introduction to Ray Tracing\", 1989, chapter 3; its \
          roots are isolated by its derivative's and refined on the distance to the tube's middle. A ray that leaves the \
          torus meets the cubic that remains when its own root is divided out.",
    params: &[
        Param::new("center", Type::Vec3, Default::Vec3([0.0; 3]), "The middle of the hole."),
        Param::new(
            "axis",
            Type::Direction,
            Default::Vec3([0.0, 1.0, 0.0]),
            "The direction of the hole; of any length.",
        ),
        Param::new(
            "major_radius",
            Type::Positive,
            Default::Number(1.0),
            "From the centre to the middle of the tube.",
        ),
        Param::new(
            "minor_radius",
            Type::Positive,
            Default::Number(0.25),
            "Radius of the tube; below `major_radius`.",
        ),
    ],
    example: "torus(center = (0, 0.4, 0), major_radius = 1, minor_radius = 0.4, material = matte(\"tomato\"))",
};

/// How well roots are found, in the torus's units: the rounding of points that far from the centre.
const DIGITS: f64 = 2.0 * f64::EPSILON;

/// A line in the torus's units: the length of `direction` is 1, and `t = (s + start) / speed`.
struct Line {
    point: DVec3,
    direction: DVec3,
    start: f64,
    speed: f64,
    /// The line within the box of the torus: nothing of it lies beyond.
    range: (f64, f64),
}

impl Torus {
    /// A torus; `None` where the axis is no direction or the tube is not thinner than the ring.
    #[must_use]
    pub fn new(center: DVec3, axis: DVec3, major: f64, minor: f64) -> Option<Self> {
        let axis = normalize(axis)?;
        let error = gamma(32) * (center.abs().max_element() + major + minor);
        (minor > 0.0 && minor < major && error.is_finite()).then_some(Self {
            center,
            axis,
            major,
            minor,
            error,
        })
    }

    /// One over the unit of length in which roots are sought, and the two radii in it.
    fn scaled(&self) -> (f64, f64, f64) {
        let scale = 1.0 / (self.major + self.minor);
        (scale, self.major * scale, self.minor * scale)
    }

    /// A point's distance from the axis and height over the middle plane.
    fn meridian(&self, offset: DVec3) -> (f64, f64) {
        let y = offset.dot(self.axis);
        ((offset - self.axis * y).length(), y)
    }

    /// How far a point lies above the surface.
    fn height(&self, point: DVec3) -> f64 {
        let (rho, y) = self.meridian(point - self.center);
        let x = rho - self.major;
        (x * x + y * y).sqrt() - self.minor
    }

    fn line(&self, ray: &LocalRay) -> Option<Line> {
        let (scale, _, minor) = self.scaled();
        let length = ray.direction.length();
        let direction = ray.direction / length;
        let offset = (ray.origin - self.center) * scale;
        // Start anew from the point nearest to the centre: origins far away lose no digits.
        let start = -offset.dot(direction);
        let point = offset + direction * start;
        let m = point.length_squared();
        // Written so that NaN is a miss. A little room: at both ends the line must be outside.
        if !(m <= 1.0 + 1e-9) {
            return None;
        }
        let half = (1.0 + 1e-9 - m).sqrt();
        let (y, dy) = (point.dot(self.axis), direction.dot(self.axis));
        let (low, high) = (-minor * (1.0 + 1e-9), minor * (1.0 + 1e-9));
        let mut range = (-half, half);
        if dy != 0.0 {
            let (s, t) = ((low - y) / dy, (high - y) / dy);
            range = (range.0.max(s.min(t)), range.1.min(s.max(t)));
        } else if !(y >= low && y <= high) {
            return None;
        }
        let line = Line { point, direction, start, speed: length * scale, range };
        (range.0 <= range.1).then_some(line)
    }

    /// `g` at a point of a line, and its derivative.
    fn value(&self, line: &Line, s: f64) -> (f64, f64) {
        let (_, major, minor) = self.scaled();
        let p = line.point + line.direction * s;
        let (y, dy) = (p.dot(self.axis), line.direction.dot(self.axis));
        let q = p - self.axis * y;
        let rho = q.length();
        // The derivative of rho times rho.
        let turn = q.dot(line.direction);
        let x = rho - major;
        let slope = if rho > 0.0 { x * turn / rho } else { 0.0 };
        // r^2 as a factor of a difference of squares loses nothing where the tube is thin.
        let hypot = (x * x + y * y).sqrt();
        ((hypot - minor) * (hypot + minor), 2.0 * (slope + y * dy))
    }

    /// The pieces of the line, each with at most one root.
    fn pieces(&self, line: &Line) -> Pieces<3> {
        let (_, major, minor) = self.scaled();
        let (y, dy) = (line.point.dot(self.axis), line.direction.dot(self.axis));
        let q = line.point - self.axis * y;
        let across2 = (line.direction - self.axis * dy).length_squared();
        let k = line.point.length_squared() + (major - minor) * (major + minor);
        let r4 = 4.0 * major * major;
        // s^4 + 2 k s^2 + k^2 - 4 R^2 (across2 s^2 + 2 (q . direction) s + |q|^2)
        let turns = quartic_turns(2.0 * k - r4 * across2, -2.0 * r4 * q.dot(line.direction));
        Pieces::new(line.range, turns, |s| self.value(line, s).0 < 0.0, false)
    }

    /// The next hit of a ray that leaves the surface: the roots of the cubic that remains when the
    /// quartic, its constant term at the exact value 0, is divided by `t`.
    fn departing(&self, ray: &LocalRay, outward: bool) -> Option<Root> {
        let (scale, major, _) = self.scaled();
        let length = ray.direction.length();
        let d = ray.direction / length;
        let p = (ray.origin - self.center) * scale;
        let (y, dy) = (p.dot(self.axis), d.dot(self.axis));
        let q = p - self.axis * y;
        let rho = q.length();
        let across = d - self.axis * dy;
        let radial = if rho > 0.0 { q.dot(d) / rho } else { 0.0 };
        // The slope of the quartic at its exact root, as a product: its sign is known.
        let slope = (8.0 * major * rho * ((rho - major) * radial + y * dy)).abs();
        let c1 = if outward { slope } else { -slope };
        let b = p.dot(d);
        let c2 = 4.0 * (b * b + major * (rho - major * across.length_squared()));
        let c3 = 4.0 * b;
        let cubic = |s: f64| (((s + c3) * s + c2) * s + c1, (3.0 * s + 2.0 * c3) * s + c2);
        // Everything lies within the unit ball.
        let end = -b + (b * b + (1.0 + 1e-9 - p.length_squared()).max(0.0)).sqrt();
        let pieces = Pieces::new((0.0, end), cubic_turns(c3, c2), |s| cubic(s).0 < 0.0, !outward);
        // Where the surface curves towards an outward ray, its root within the error is the one it left.
        let least = if outward { 2.0 * ray.error * scale } else { 0.0 };
        let s = pieces.changes().map(|piece| find(&cubic, piece, 0.0)).find(|&s| s >= least)?;
        root(ray, s / (length * scale), 0)
    }
}

impl Described for Torus {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args) -> Result<Self, Diagnostic> {
        let (major, minor) = (args.number("major_radius")?, args.number("minor_radius")?);
        if !(minor < major) {
            return Err(args
                .error(
                    "minor_radius",
                    "no-hole",
                    format!(
                        "minor_radius of the torus is {minor}, not below its major_radius {major}"
                    ),
                )
                .help("make the tube thinner, or use a sphere"));
        }
        Self::new(args.vec3("center")?.into(), args.vec3("axis")?.into(), major, minor).ok_or_else(
            || {
                args.error("axis", "wrong-value", "axis of torus: too large to be a direction")
                    .help("write a vector of ordinary length, such as (0, 1, 0)")
            },
        )
    }
}

impl Shape for Torus {
    fn bounds(&self) -> Bounds {
        let ring = circle_bounds(self.center, self.axis, self.major);
        let reach = self.minor + self.error;
        Bounds { min: ring.min - reach, max: ring.max + reach }
    }

    fn is_solid(&self) -> bool {
        true
    }

    fn is_convex(&self) -> bool {
        false
    }

    fn intersect(&self, ray: &LocalRay) -> Option<Root> {
        if let Some(leaving) = ray.leaving {
            return self.departing(ray, leaving.outward);
        }
        let line = self.line(ray)?;
        if line.start + line.range.0 > ray.t_max * line.speed {
            return None;
        }
        let starts_on = || self.height(ray.origin).abs() <= ray.error + self.error;
        for piece in self.pieces(&line).changes() {
            let behind = line.start + piece.end.0 <= 0.0;
            let t = if behind {
                -1.0
            } else {
                (line.start + find(&|s| self.value(&line, s), piece, DIGITS)) / line.speed
            };
            if t > 0.0 {
                return root(ray, t, 0);
            }
            if starts_on() {
                return root(ray, 0.0, 0);
            }
        }
        None
    }

    fn crossings(&self, ray: &LocalRay, out: &mut Vec<Crossing>) {
        let Some(line) = self.line(ray) else { return };
        for piece in self.pieces(&line).changes() {
            let s = find(&|s| self.value(&line, s), piece, DIGITS);
            let t = (line.start + s) / line.speed;
            out.push(Crossing { t, part: 0, enters: !piece.inside_at_start });
        }
    }

    fn surface(&self, point: DVec3, _part: u32) -> LocalSurface {
        let (x, z) = around(self.axis);
        let offset = point - self.center;
        let y = offset.dot(self.axis);
        let outward = normalize(offset - self.axis * y);
        let outward = outward.map(|o| o - self.axis * o.dot(self.axis)).and_then(normalize);
        let outward = outward.unwrap_or(z);
        let from_ring = DVec2::new(offset.dot(outward) - self.major, y);
        let length = from_ring.length();
        let around_tube = if length > 0.0 { from_ring / length } else { DVec2::X };
        let normal = outward * around_tube.x + self.axis * around_tube.y;
        let (sin_a, cos_a) = (outward.dot(x), outward.dot(z));
        let rho = self.major + self.minor * around_tube.x;
        LocalSurface {
            point: self.center + (outward * rho + self.axis * (self.minor * around_tube.y)),
            error: self.error,
            normal,
            shading_normal: normal,
            uv: DVec2::new(
                longitude(sin_a, cos_a),
                atan2(around_tube.y, around_tube.x) / (2.0 * PI) + 0.5,
            ),
            dpdu: (x * cos_a - z * sin_a) * (2.0 * PI * rho),
            dpdv: (self.axis * around_tube.x - outward * around_tube.y) * (2.0 * PI * self.minor),
        }
    }
}
