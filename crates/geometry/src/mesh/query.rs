// SPDX-License-Identifier: MIT OR Apache-2.0
//! Casting rays at a mesh.

use dioptric_math::DVec3;

use super::Mesh;
use super::line::{Corners, Line, nearest};
use crate::bvh::{BoxRay, NoCount};
use crate::ray::{Leaving, LocalRay};
use crate::shape::{Crossing, Root};

/// Beyond this many times the error of a ray's origin nothing touches it.
const CONTACT_REACH: f64 = 1e6;

impl Mesh {
    /// What hits may lie outside of the boxes, and rays beside what they mean.
    fn pad(&self, ray: &LocalRay) -> f64 {
        let largest = ray.origin.abs().max_element();
        ray.error + 4.0 * self.error + dioptric_math::bounds::gamma(64) * largest
    }

    /// The nearest hit; of several at the same `t` that of the lowest triangle.
    pub(super) fn closest(&self, ray: &LocalRay) -> Option<Root> {
        let mut best: Option<Root> = None;
        let line = Line::new(ray.origin, ray.direction);
        let box_ray = BoxRay::new(ray.origin, ray.direction, &self.bvh, self.pad(ray));
        self.bvh.visit(&box_ray, ray.t_max, &mut NoCount, |range, mut t_max, _| {
            for &part in self.order.get(range).unwrap_or_default() {
                let Some(corners) = self.corners(part) else { continue };
                let Some(t) = self.meet(ray, &line, part, &corners) else { continue };
                if t < t_max || (t == t_max && best.is_none_or(|b| part < b.part || t < b.t)) {
                    best = Some(Root { t, part });
                    t_max = t;
                }
            }
            Some(t_max)
        });
        best
    }

    /// Where the ray hits one triangle, if it does, as [`crate::Shape`] has the rules; `t_max` is not looked at.
    #[inline]
    fn meet(&self, ray: &LocalRay, line: &Line, part: u32, corners: &Corners) -> Option<f64> {
        let passage = line.pass(corners);
        let Some(leaving) = ray.leaving else {
            return match passage {
                Some(passage) if passage.t > 0.0 => Some(passage.t),
                _ => self.starts_on(ray, part, corners).then_some(0.0),
            };
        };
        if part == leaving.part {
            return None;
        }
        if let Some(passage) = passage {
            // The common case: well ahead.
            let rate = passage.normal.dot(ray.direction).abs();
            if passage.t * rate > (ray.error + self.error) * passage.normal.length() {
                return Some(passage.t);
            }
        }
        self.meet_near(ray, leaving, part, corners, passage.map(|p| p.t))
    }

    /// A triangle that is met about where the ray leaves another one of this mesh: a neighbour that
    /// rises from the left one's side blocks the way at once, or edges would leak; one that falls away
    /// from it cannot be met there, whatever rounding says.
    fn meet_near(
        &self,
        ray: &LocalRay,
        leaving: Leaving,
        part: u32,
        corners: &Corners,
        t: Option<f64>,
    ) -> Option<f64> {
        // Generously: next to an edge the way through the inside is as short as the error is.
        let bound = 8.0 * (ray.error + self.error);
        let way = t.map(|t| t * ray.direction.abs().max_element());
        if way.is_some_and(|way| way > CONTACT_REACH * bound) {
            return t;
        }
        if !is_near(ray.origin, corners, bound) {
            return t.filter(|&t| t > 0.0);
        }
        let same = self.corners(leaving.part)?.iter().all(|c| corners.contains(c));
        let unit = self.outward(part, corners);
        let rising = ray.direction.dot(unit) > 0.0;
        let here = t.is_some() || (nearest(ray.origin, corners) - ray.origin).length() <= bound;
        (here && !same && rising != leaving.outward).then(|| t.map_or(0.0, |t| t.max(0.0)))
    }

    /// Whether a ray starts on a triangle, on it or behind it within the errors.
    fn starts_on(&self, ray: &LocalRay, part: u32, corners: &Corners) -> bool {
        let bound = ray.error + self.error;
        // Cheap and nearly always so: it is elsewhere.
        if !is_near(ray.origin, corners, bound) || !ray.direction.is_finite() {
            return false;
        }
        let unit = self.outward(part, corners);
        let height = (ray.origin - DVec3::from(corners[0].map(f64::from))).dot(unit);
        let rate = ray.direction.dot(unit);
        let behind = rate != 0.0 && !(-height / rate > 0.0);
        behind && height.abs() <= bound && ray.starts_at(nearest(ray.origin, corners), self.error)
    }

    /// All passages of the line, alternately in and out.
    pub(super) fn all_crossings(&self, ray: &LocalRay, out: &mut Vec<Crossing>) {
        let (origin, direction) = (ray.origin, ray.direction);
        if !(origin.is_finite() && direction.is_finite() && direction != DVec3::ZERO) {
            return;
        }
        let line = Line::new(origin, direction);
        let start = out.len();
        // The two halves of the line; where they meet the sort below tells which hits are the same.
        for way in [direction, -direction] {
            let box_ray = BoxRay::new(origin, way, &self.bvh, self.pad(ray));
            self.bvh.visit(&box_ray, f64::INFINITY, &mut NoCount, |range, t_max, _| {
                for &part in self.order.get(range).unwrap_or_default() {
                    let Some(corners) = self.corners(part) else { continue };
                    let Some(passage) = line.pass_once(&corners) else { continue };
                    let falls = passage.normal.dot(direction) < 0.0;
                    out.push(Crossing { t: passage.t, part, enters: falls != self.inverted });
                }
                Some(t_max)
            });
        }
        let Some(found) = out.get_mut(start..) else { return };
        found.sort_by(|a, b| {
            a.t.total_cmp(&b.t).then(b.enters.cmp(&a.enters)).then(a.part.cmp(&b.part))
        });
        // Rounding may turn two at the same place around, and a triangle at the origin is in both halves.
        let mut kept = start;
        let mut inside = false;
        for i in start..out.len() {
            if out[i].enters != inside {
                inside = out[i].enters;
                out[kept] = out[i];
                kept += 1;
            }
        }
        out.truncate(if inside { kept - 1 } else { kept });
    }
}

/// Whether a point is in the box around a triangle, or as near to it as `bound`.
#[inline]
fn is_near(point: DVec3, corners: &Corners, bound: f64) -> bool {
    let [a, b, c] = corners.map(|corner| DVec3::from(corner.map(f64::from)) - point);
    let (low, high) = (a.min(b).min(c), a.max(b).max(c));
    low.max_element() <= bound && high.min_element() >= -bound
}
