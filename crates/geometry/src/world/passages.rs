// SPDX-License-Identifier: MIT OR Apache-2.0
//! All passages of a ray through surfaces, in order: what shadows through glass need.

use std::cell::Cell;

use super::{Hit, Object, World};
use crate::bvh::NoCount;
use crate::ray::{Departure, HitId, Leaving, LocalRay, Ray};
use crate::shape::Crossing;

/// A shape's surface that is crossed more often than this by one ray is cut off there.
const MAX_CROSSINGS: usize = 10_000;

thread_local! {
    /// Memory of [`World::hits`].
    static CROSSINGS: Cell<Vec<Crossing>> = const { Cell::new(Vec::new()) };
}

impl World {
    /// Fills `out` with every passage through a surface with `0 <= t <= t_max`, sorted by `t`, then id;
    /// a ray that goes through a solid gives one hit where it enters and one where it leaves.
    pub fn hits(&self, ray: &Ray, t_max: f64, departure: Option<&Departure>, out: &mut Vec<Hit>) {
        out.clear();
        // Used again: asking for memory would take as long as the query.
        let mut crossings = CROSSINGS.take();
        self.visit(ray, t_max, departure, &mut NoCount, |instance, object, local| {
            crossings.clear();
            if object.shape.is_solid() {
                solid_hits(object, local, &mut crossings);
            } else {
                surface_hits(object, local, &mut crossings);
            }
            out.extend(
                crossings.iter().map(|c| Hit {
                    t: c.t,
                    id: HitId { instance, object: object.id, part: c.part },
                }),
            );
            Some(local.t_max)
        });
        CROSSINGS.set(crossings);
        out.sort_by(|a, b| a.t.total_cmp(&b.t).then(a.id.cmp(&b.id)));
    }
}

/// The crossings of a solid that lie ahead, as [`LocalRay::accept`] judges them.
fn solid_hits(object: &Object, ray: &LocalRay, out: &mut Vec<Crossing>) {
    object.shape.crossings(ray, out);
    if let Some(leaving) = ray.leaving {
        // The crossing that is left: the nearest one of its part and sense.
        let left = out
            .iter()
            .enumerate()
            .filter(|(_, c)| c.part == leaving.part && c.enters != leaving.outward)
            .min_by(|(_, a), (_, b)| a.t.abs().total_cmp(&b.t.abs()))
            .map(|(i, _)| i);
        if let Some(i) = left {
            out.remove(i);
        }
    }
    out.retain_mut(|c| {
        if c.t > 0.0 {
            return c.t <= ray.t_max;
        }
        if ray.leaving.is_some() {
            return false;
        }
        let surface = object.shape.surface_point(ray.at(c.t), c.part);
        let speed = ray.direction.dot(surface.normal).abs();
        // A line that slides along the surface far behind has no speed.
        let own = object.shape.surface_point(ray.origin, c.part);
        match ray.accept(c.t, speed, surface.error) {
            Some(t) if ray.starts_at(own.point, own.error) => {
                c.t = t;
                true
            }
            _ => false,
        }
    });
}

/// The hits of a surface that is not closed: each next one as of a ray that leaves the last.
fn surface_hits(object: &Object, ray: &LocalRay, out: &mut Vec<Crossing>) {
    let mut next = *ray;
    let mut travelled = 0.0;
    while out.len() < MAX_CROSSINGS {
        let Some(root) = object.shape.intersect(&next) else { return };
        let t = travelled + root.t;
        if !(t <= ray.t_max) {
            return;
        }
        let surface = object.shape.surface_point(next.at(root.t), root.part);
        let outward = ray.direction.dot(surface.normal) > 0.0;
        out.push(Crossing { t, part: root.part, enters: !outward });
        travelled = t;
        next.origin = surface.point;
        next.error = surface.error;
        next.t_max = ray.t_max - t;
        next.leaving = Some(Leaving { part: root.part, outward });
    }
}
