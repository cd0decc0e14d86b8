// SPDX-License-Identifier: MIT OR Apache-2.0
//! Convex solids as intersections of simpler ones: a line passes through each in one interval, and
//! the interval of the solid is what remains. A line that goes in therefore always comes out: solids
//! made this way cannot leak at their edges.

use crate::ray::LocalRay;
use crate::shape::{Crossing, Root};

/// The part of a line inside a convex solid.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Chord {
    /// Where the line goes in, and through which part.
    pub near: (f64, u32),
    /// Where it comes out.
    pub far: (f64, u32),
}

impl Chord {
    /// The whole line; the parts mean nothing yet.
    pub const LINE: Self = Self { near: (f64::NEG_INFINITY, 0), far: (f64::INFINITY, 0) };

    /// Keeps what is below a plane. `height` is how far the origin lies above it and `rate` how fast
    /// the line rises.
    pub fn clip(&mut self, height: f64, rate: f64, part: u32) {
        if rate > 0.0 {
            let t = -height / rate;
            if t < self.far.0 {
                self.far = (t, part);
            }
        } else if rate < 0.0 {
            let t = -height / rate;
            if t > self.near.0 {
                self.near = (t, part);
            }
        } else if height > 0.0 {
            // Parallel and outside: nothing remains.
            self.near.0 = f64::INFINITY;
        }
    }

    /// Whether anything remains (NaN counts as nothing).
    pub fn is_some(&self) -> bool {
        self.near.0 <= self.far.0
    }

    /// The first hit of a ray that does not leave this solid.
    ///
    /// `heights(part)` says how far the origin lies above the surface of a part, and above the highest
    /// of all parts: a passage behind the origin counts, at 0, where the origin itself is on the part
    /// within `ray.error + surface_error`.
    pub fn first(
        &self,
        ray: &LocalRay,
        surface_error: f64,
        heights: impl Fn(u32) -> (f64, f64),
    ) -> Option<Root> {
        let tolerance = ray.error + surface_error;
        for (t, part) in [self.near, self.far] {
            if t > 0.0 {
                return root(ray, t, part);
            }
            let (own, highest) = heights(part);
            if own.abs() <= tolerance && highest <= tolerance {
                return root(ray, 0.0, part);
            }
        }
        None
    }

    /// Appends both passages.
    pub fn push_crossings(&self, ray: &LocalRay, out: &mut Vec<Crossing>) {
        let ((near, far), finite) = ((self.near, self.far), |t| ray.at(t).is_finite());
        if near.0 <= far.0 && finite(near.0) && finite(far.0) {
            out.push(Crossing { t: near.0, part: near.1, enters: true });
            out.push(Crossing { t: far.0, part: far.1, enters: false });
        }
    }
}

/// The root at `t`, or at 0 where rounding made it negative; nothing beyond `t_max` or for rays that
/// are not finite.
pub(crate) fn root(ray: &LocalRay, t: f64, part: u32) -> Option<Root> {
    let t = if t < 0.0 { 0.0 } else { t };
    (t <= ray.t_max && ray.direction != dioptric_math::DVec3::ZERO && ray.at(t).is_finite())
        .then_some(Root { t, part })
}

/// The root of a plane for a ray that does not leave it, judged as by [`LocalRay::accept`]: `height`
/// is how far the origin lies above the plane, `rate` how fast the ray rises.
pub(crate) fn plane_root(
    ray: &LocalRay,
    height: f64,
    rate: f64,
    surface_error: f64,
) -> Option<f64> {
    if rate == 0.0 {
        return None;
    }
    let t = -height / rate;
    if t > 0.0 {
        (t <= ray.t_max).then_some(t)
    } else {
        (height.abs() <= ray.error + surface_error).then_some(0.0)
    }
}
