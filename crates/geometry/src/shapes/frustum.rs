// SPDX-License-Identifier: MIT OR Apache-2.0
//! The solid between two parallel circles on one axis: what cylinders, cones and cut cones share.

mod args;
#[cfg(test)]
mod tests;

pub(crate) use args::{ends, no_length};

use std::f64::consts::PI;

use dioptric_math::bounds::gamma;
use dioptric_math::{DVec2, DVec3, normalize};

use super::convex::{Chord, root};
use super::disc::circle_bounds;
use super::frame::{around, longitude};
use crate::bounds::Bounds;
use crate::ray::LocalRay;
use crate::shape::{Crossing, LocalSurface, Root, SurfacePoint};

/// Part of the curved side.
pub(crate) const SIDE: u32 = 0;
/// Part of the disc at the base; it faces against the axis.
pub(crate) const BASE: u32 = 1;
/// Part of the disc at the top; it faces along the axis.
pub(crate) const TOP: u32 = 2;

/// Text for the manual: how the surfaces of cylinders and cones are coordinated.
macro_rules! uv_doc {
    () => {
        "`uv` of the side: u is the longitude like a sphere's, from 0 at -z over 0.25 at -x and 0.5 at +z to 1; v runs \
         from 0 at the base to 1 at the top. `uv` of the caps: the square around the disc, 0 to 1, with 0.5 at the \
         centre; u runs along +x, v along -z on the top and along +z on the base. Along another axis than +y all \
         directions are turned by the smallest rotation from +y."
    };
}
pub(crate) use uv_doc;

/// The solid, or with `open` its side alone.
///
/// In the half plane through the axis, with distance `rho` from it and height `y` over the base, the
/// side is the line `cos rho + sin y = cos radius`, and `(cos, sin)` is its unit normal. So
/// `f = (cos rho)^2 - s(y)^2` with `s(y) = cos radius - sin y` is a quadric whose coefficients stay
/// in proportion for any slope, cylinder (`sin = 0`) and almost flat cone alike; `s > 0` tells the
/// solid from its mirror image beyond the apex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Frustum {
    base: DVec3,
    axis: DVec3,
    height: f64,
    radius: f64,
    top_radius: f64,
    cos: f64,
    sin: f64,
    /// The square of the larger radius.
    widest2: f64,
    /// Bounds the rounding of all heights and of points on the surface.
    error: f64,
    open: bool,
}

/// A ray in the terms of the frustum.
struct Line {
    /// Height of the origin over the base.
    y: f64,
    /// The line within the slab between the two circles.
    slab: Chord,
    /// The line within the side's quadric.
    side: Chord,
}

impl Frustum {
    /// Of its side: base, axis and radius there; radius at the top, height, cosine and sine of the slope; a bound on the
    /// errors of points.
    pub const fn numbers(&self) -> (DVec3, DVec3, f64, [f64; 4], f64) {
        let Self { base, axis, height, radius, top_radius, cos, sin, error, .. } = *self;
        (base, axis, radius, [top_radius, height, cos, sin], error)
    }

    /// A frustum from `base` to `base + length`; `None` where that is the same point or numbers are
    /// not finite. One of the radii may be 0.
    pub fn new(
        base: DVec3,
        length: DVec3,
        radius: f64,
        top_radius: f64,
        open: bool,
    ) -> Option<Self> {
        let axis = normalize(length)?;
        let height = length.dot(axis);
        let slant = normalize(DVec3::new(height, radius - top_radius, 0.0))?;
        let widest = radius.max(top_radius);
        let error = gamma(16) * (base.abs().max_element() + height + widest);
        error.is_finite().then_some(Self {
            base,
            axis,
            height,
            radius,
            top_radius,
            cos: slant.x,
            sin: slant.y,
            widest2: widest * widest,
            error,
            open,
        })
    }

    pub fn is_open(&self) -> bool {
        self.open
    }

    pub fn bounds(&self) -> Bounds {
        let top = self.base + self.axis * self.height;
        circle_bounds(self.base, self.axis, self.radius).union(circle_bounds(
            top,
            self.axis,
            self.top_radius,
        ))
    }

    /// `s` at a height: `cos` times the side's radius there.
    fn s(&self, y: f64) -> f64 {
        self.cos * self.radius - self.sin * y
    }

    fn slab(&self, y: f64, dy: f64) -> Chord {
        let mut slab = Chord::LINE;
        slab.clip(-y, -dy, BASE);
        slab.clip(y - self.height, dy, TOP);
        slab
    }

    /// Whether a line through `offset` from the base clearly passes further away from the axis than the solid
    /// reaches; most do, and this takes no division.
    ///
    /// The distance is `|(offset x d) . axis| / |e|`, with the part `e` of `d` across the axis. As computed, the
    /// numerator is wrong by at most `gamma(8) |offset| |d|`, and the point next to the axis that [`Self::line`]
    /// finds by `gamma(16) |offset| |d| / |e|` (where it is clamped to the slab, this and less than the growth of
    /// its distance, as long as `|e| > 1e-6 |d|`). The sum `x` of both may be added to the widest radius `w`:
    /// `(w |e| + x)^2 <= (1 + 2^-20) w^2 |e|^2 + (1 + 2^20) x^2`, of which the last is below
    /// `1e-21 |offset|^2 |d|^2`. And the difference `|d|^2 - dy^2` is `|e|^2` within `1e-15 |d|^2`, so not wrong by
    /// more than a thousandth of what is added here. NaN is not clear; 1e-290 is where f64 loses digits.
    fn passes_clearly(&self, offset: DVec3, d: DVec3, dy: f64) -> bool {
        let across = offset.cross(d).dot(self.axis);
        let d2 = d.length_squared();
        let e2 = d2 - dy * dy;
        let reach =
            self.widest2 * (e2 * (1.0 + 1e-6) + d2 * 1e-12) + offset.length_squared() * d2 * 1e-20;
        across * across > reach + 1e-290 && e2 > d2 * 1e-11 + 1e-290
    }

    /// `None` where the line misses the slab or the side's quadric.
    fn line(&self, ray: &LocalRay) -> Option<Line> {
        let offset = ray.origin - self.base;
        let (y, dy) = (offset.dot(self.axis), ray.direction.dot(self.axis));
        if self.passes_clearly(offset, ray.direction, dy) {
            return None;
        }
        self.line_along(ray, offset, y, dy)
    }

    fn line_along(&self, ray: &LocalRay, offset: DVec3, y: f64, dy: f64) -> Option<Line> {
        let slab = self.slab(y, dy);
        if !slab.is_some() {
            return None;
        }
        let (p, e) = (offset - self.axis * y, ray.direction - self.axis * dy);
        // Start anew from the line's point nearest to the axis within the slab: all that follows is of
        // the size of the solid there, so origins far away and long thin solids lose no digits.
        let e2 = e.length_squared();
        let nearest = -p.dot(e) / e2;
        let start = nearest.max(slab.near.0).min(slab.far.0);
        let q = p + e * start;
        let q2 = q.length_squared();
        // Written so that NaN is a miss.
        if !(q2 <= self.widest2) {
            return None;
        }
        let (s, ds) = (self.s(y + dy * start), -self.sin * dy);
        let cos2 = self.cos * self.cos;
        let a = cos2 * e2 - ds * ds;
        let b = cos2 * q.dot(e) - s * ds;
        let c = cos2 * q2 - s * s;
        let (near, far) = inside_quadric(a, b, c, ds)?;
        let side = Chord { near: (start + near, SIDE), far: (start + far, SIDE) };
        Some(Line { y, slab, side })
    }

    fn chord(line: &Line) -> Chord {
        Chord {
            near: if line.side.near.0 > line.slab.near.0 { line.side.near } else { line.slab.near },
            far: if line.side.far.0 < line.slab.far.0 { line.side.far } else { line.slab.far },
        }
    }

    /// How far a point lies above the side, and how high over the base.
    fn side_height(&self, point: DVec3) -> (f64, f64) {
        let offset = point - self.base;
        let y = offset.dot(self.axis);
        let rho = (offset - self.axis * y).length();
        (self.cos * rho - self.s(y), y)
    }

    pub fn intersect(&self, ray: &LocalRay) -> Option<Root> {
        if let Some(leaving) = ray.leaving {
            return if leaving.outward { None } else { self.far_side(ray, leaving.part) };
        }
        let line = self.line(ray)?;
        if !self.open {
            let chord = Self::chord(&line);
            if !chord.is_some() || chord.near.0 > ray.t_max {
                return None;
            }
            return chord.first(ray, self.error, |part| {
                let (side, y) = self.side_height(ray.origin);
                let (base, top) = (-y, y - self.height);
                (if part == SIDE { side } else { base.max(top) }, side.max(base).max(top))
            });
        }
        let within = line.slab.near.0..=line.slab.far.0;
        for (t, _) in [line.side.near, line.side.far] {
            if t > 0.0 {
                if within.contains(&t) {
                    return root(ray, t, SIDE);
                }
            } else {
                let (side, tolerance) = (self.side_height(ray.origin).0, ray.error + self.error);
                let (y, high) = (line.y, self.height + tolerance);
                if side.abs() <= tolerance && y >= -tolerance && y <= high {
                    return root(ray, 0.0, SIDE);
                }
            }
        }
        None
    }

    /// The exit of a ray that goes inwards from a part.
    fn far_side(&self, ray: &LocalRay, part: u32) -> Option<Root> {
        let offset = ray.origin - self.base;
        let (y, dy) = (offset.dot(self.axis), ray.direction.dot(self.axis));
        let mut exit = self.slab(y, dy).far;
        if exit.1 == part {
            exit.0 = f64::INFINITY;
        }
        let side = if part == SIDE {
            // With the constant term at its exact value 0 the other root is -2 b / a. Where a <= 0 that
            // root is behind, or on the mirror image: the ray stays inside until it meets a cap. Both
            // are written with the slope against the normal, so that a ray along the side finds the
            // apex: then they are small, but their quotient is not.
            let (p, e) = (offset - self.axis * y, ray.direction - self.axis * dy);
            let rho = p.length();
            let radial = normalize(p).unwrap_or_default();
            let outward = e.dot(radial);
            let across2 = (e - radial * outward).length_squared();
            let ds = -self.sin * dy;
            let slope = self.cos * outward - ds;
            let a = self.cos * self.cos * across2 + slope * (self.cos * outward + ds);
            let b = self.cos * rho * slope;
            if a > 0.0 { -2.0 * b / a } else { f64::INFINITY }
        } else {
            // No line at all means that it starts on the rim and leads away from the solid.
            self.line(ray).map_or(0.0, |line| line.side.far.0)
        };
        if side < exit.0 {
            exit = (side, SIDE);
        }
        (exit.1 == SIDE || !self.open).then(|| root(ray, exit.0, exit.1))?
    }

    pub fn crossings(&self, ray: &LocalRay, out: &mut Vec<Crossing>) {
        if !self.open
            && let Some(line) = self.line(ray)
        {
            Self::chord(&line).push_crossings(ray, out);
        }
    }

    pub fn surface(&self, point: DVec3, part: u32) -> LocalSurface {
        let (x, z) = around(self.axis);
        let offset = point - self.base;
        let y = offset.dot(self.axis);
        let p = offset - self.axis * y;
        match part {
            BASE => self.cap(p, x, z, -self.axis),
            TOP => self.cap(p, x, -z, self.axis),
            _ => self.side(p, y, x, z),
        }
    }

    /// The middles of both ends, the radii there, and whether it has no discs.
    pub fn ends(&self) -> ([DVec3; 2], [f64; 2], bool) {
        let top = self.base + self.axis * self.height;
        ([self.base, top], [self.radius, self.top_radius], self.open)
    }

    /// Where the axis begins, its direction and length, and the radius of the tube around it that holds everything.
    pub fn tube(&self) -> (DVec3, DVec3, f64, f64) {
        (self.base, self.axis, self.height, self.radius.max(self.top_radius))
    }

    /// See [`crate::Shape::surface_point`].
    pub fn surface_point(&self, point: DVec3, part: u32) -> SurfacePoint {
        let offset = point - self.base;
        let y = offset.dot(self.axis);
        let p = offset - self.axis * y;
        match part {
            BASE => self.cap_point(p, -self.axis).1,
            TOP => self.cap_point(p, self.axis).1,
            _ => self.side_point(p, y, || around(self.axis).1).2,
        }
    }

    /// `p` is the offset from the axis; also returns it within the cap.
    fn cap_point(&self, p: DVec3, normal: DVec3) -> (DVec3, SurfacePoint) {
        let at_top = normal == self.axis;
        let radius = if at_top { self.top_radius } else { self.radius };
        let center = if at_top { self.base + self.axis * self.height } else { self.base };
        let rho = p.length();
        let p = if rho > radius { p * (radius / rho) } else { p };
        let point = center + p;
        (p, SurfacePoint { point, error: self.error, normal, shading_normal: normal })
    }

    /// `p` is the offset from the axis, `u` and `v` the directions of the coordinates.
    fn cap(&self, p: DVec3, u: DVec3, v: DVec3, normal: DVec3) -> LocalSurface {
        let radius = if normal == self.axis { self.top_radius } else { self.radius };
        let (p, SurfacePoint { point, error, normal, shading_normal }) = self.cap_point(p, normal);
        let diameter = 2.0 * radius;
        let uv = if diameter > 0.0 {
            DVec2::new(0.5 + p.dot(u) / diameter, 0.5 + p.dot(v) / diameter)
        } else {
            DVec2::splat(0.5)
        };
        LocalSurface {
            point,
            error,
            normal,
            shading_normal,
            uv: uv.clamp(DVec2::ZERO, DVec2::ONE),
            dpdu: u * diameter,
            dpdv: v * diameter,
        }
    }

    /// `p` is the offset from the axis, `y` the height, `fallback` a direction for points on the axis; also
    /// returns the direction away from the axis and the share of the height.
    fn side_point(
        &self,
        p: DVec3,
        y: f64,
        fallback: impl FnOnce() -> DVec3,
    ) -> (DVec3, f64, SurfacePoint) {
        // Next to the axis `p` is mostly rounding and need not be at right angles to it.
        let outward = normalize(p).map(|o| o - self.axis * o.dot(self.axis));
        let outward = outward.and_then(normalize).unwrap_or_else(fallback);
        // To the nearest point of the side's line, and not beyond its ends.
        let above = self.cos * p.length() - self.s(y);
        let y = (y - self.sin * above).clamp(0.0, self.height);
        let v = y / self.height;
        let rho = self.radius * (1.0 - v) + self.top_radius * v;
        let normal = outward * self.cos + self.axis * self.sin;
        let point = self.base + (self.axis * y + outward * rho);
        (outward, v, SurfacePoint { point, error: self.error, normal, shading_normal: normal })
    }

    fn side(&self, p: DVec3, y: f64, x: DVec3, z: DVec3) -> LocalSurface {
        let (outward, v, at) = self.side_point(p, y, || z);
        let SurfacePoint { point, error, normal, shading_normal } = at;
        let rho = self.radius * (1.0 - v) + self.top_radius * v;
        let (sin_a, cos_a) = (outward.dot(x), outward.dot(z));
        LocalSurface {
            point,
            error,
            normal,
            shading_normal,
            uv: DVec2::new(longitude(sin_a, cos_a), v),
            dpdu: (x * cos_a - z * sin_a) * (2.0 * PI * rho),
            dpdv: self.axis * self.height + outward * (self.top_radius - self.radius),
        }
    }
}

/// Where `a t^2 + 2 b t + c <= 0` on the solid's side of the apex, which is the one where `s` grows
/// if `ds > 0`: an interval, possibly without end.
fn inside_quadric(a: f64, b: f64, c: f64, ds: f64) -> Option<(f64, f64)> {
    let discriminant = b * b - a * c;
    if a >= 0.0 {
        // Written so that NaN is a miss.
        if !(discriminant >= 0.0) {
            return None;
        }
        let q = -(b + discriminant.sqrt().copysign(b));
        if q == 0.0 {
            // A touch; or, with a = 0, a line at constant distance.
            return match a > 0.0 {
                true => Some((0.0, 0.0)),
                false => (c <= 0.0).then_some((f64::NEG_INFINITY, f64::INFINITY)),
            };
        }
        let (t0, t1) = (q / a, c / q);
        Some((t0.min(t1), t0.max(t1)))
    } else if a < 0.0 {
        // Steeper than the side: always two roots, one on each nappe, and inside beyond them. A negative
        // discriminant is rounding at the apex.
        let q = -(b + discriminant.max(0.0).sqrt().copysign(b));
        let (t0, t1) = if q == 0.0 { (0.0, 0.0) } else { (q / a, c / q) };
        Some(if ds > 0.0 { (t0.max(t1), f64::INFINITY) } else { (f64::NEG_INFINITY, t0.min(t1)) })
    } else {
        None
    }
}
