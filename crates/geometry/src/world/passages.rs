// SPDX-License-Identifier: MIT OR Apache-2.0
//! All passages of a ray through surfaces, in order: what shadows through glass need.

#![allow(unsafe_code)]

use std::cell::Cell;
use std::ops::Range;

use super::filter::Left;
use super::query::{into, leaving};
use super::rays::Bundle;
use super::{Hit, Level, Object, World};
use crate::bvh::packet::rows::{self, LANES, Mask, Rows};
use crate::bvh::packet::{Packet, PacketLeaves};
use crate::bvh::{Lanes, NoCount};
use crate::ray::{Departure, HitId, Leaving, LocalRay, Ray};
use crate::shape::Crossing;

/// A shape's surface that is crossed more often than this by one ray is cut off there.
const MAX_CROSSINGS: usize = 10_000;

thread_local! {
    /// Memory of [`World::hits`]: asking for it would take as long as the query.
    static CROSSINGS: Cell<Vec<Crossing>> = const { Cell::new(Vec::new()) };
}

/// All passages of the rays of a bundle.
#[derive(Clone, Debug, Default)]
pub struct Passages {
    /// As they were found: lane by lane they are sorted into `sorted`.
    found: Vec<(u32, Hit)>,
    sorted: Vec<Hit>,
    /// Where in `sorted` those of each lane end.
    ends: [usize; LANES],
}

impl Passages {
    /// Those of one ray, as [`World::hits`] has them.
    #[must_use]
    pub fn of(&self, lane: usize) -> &[Hit] {
        let lane = lane % LANES;
        let first = if lane == 0 { 0 } else { self.ends[lane - 1] };
        self.sorted.get(first..self.ends[lane]).unwrap_or_default()
    }

    fn sort(&mut self) {
        let mut next = [0; LANES];
        for (lane, _) in &self.found {
            next[*lane as usize % LANES] += 1;
        }
        let mut end = 0;
        for (next, place) in next.iter_mut().zip(&mut self.ends) {
            let count = *next;
            *next = end;
            end += count;
            *place = end;
        }
        let nothing = HitId { instance: 0, object: 0, part: 0 };
        self.sorted.clear();
        self.sorted.resize(end, Hit { t: 0.0, id: nothing });
        for (lane, hit) in &self.found {
            let place = &mut next[*lane as usize % LANES];
            self.sorted[*place] = *hit;
            *place += 1;
        }
        let mut first = 0;
        for end in self.ends {
            sort(&mut self.sorted[first..end]);
            first = end;
        }
    }
}

/// Sorts hits by `t`, then id.
fn sort(hits: &mut [Hit]) {
    hits.sort_unstable_by(|a, b| a.t.total_cmp(&b.t).then(a.id.cmp(&b.id)));
}

impl World {
    /// Fills `out` with every passage through a surface with `0 <= t <= t_max`, sorted by `t`, then id;
    /// a ray that goes through a solid gives one hit where it enters and one where it leaves.
    pub fn hits(&self, ray: &Ray, t_max: f64, departure: Option<&Departure>, out: &mut Vec<Hit>) {
        out.clear();
        self.each_hit(ray, t_max, departure, |hit| out.push(hit));
        sort(out);
    }

    fn each_hit(
        &self,
        ray: &Ray,
        t_max: f64,
        departure: Option<&Departure>,
        mut found: impl FnMut(Hit),
    ) {
        let mut crossings = CROSSINGS.take();
        self.visit(ray, t_max, departure, &mut NoCount, |instance, object, local| {
            object_hits(instance, object, local, &mut crossings, &mut found);
            Some(local.t_max)
        });
        CROSSINGS.set(crossings);
    }

    /// [`Self::hits`] of those rays of a bundle whose bits are set.
    pub fn hits_of_rays(&self, bundle: &Bundle, rays: Mask, out: &mut Passages) {
        out.found.clear();
        let mut crossings = CROSSINGS.take();
        let mut rest = rays;
        if let Some(level) = self.levels.first()
            && let Some(objects) = self.objects.get(level.first..)
        {
            let found = (&mut out.found, &mut crossings);
            let gather = Gather { world: self, bundle, level, objects, found, left: Left::NOTHING };
            rest = match level.bvh.lanes() {
                // SAFETY: a tree's lanes are never more than the processor has.
                #[cfg(target_arch = "x86_64")]
                Lanes::Avx2 => unsafe { gather_avx2(gather, rays) },
                #[cfg(target_arch = "x86_64")]
                Lanes::Avx512 => unsafe { gather_avx512(gather, rays) },
                // SAFETY: that is what everything was compiled for.
                _ => unsafe { gather.walk::<rows::Base>(rays) },
            };
        }
        CROSSINGS.set(crossings);
        while rest != 0 {
            let lane = rest.trailing_zeros() as usize % LANES;
            rest &= rest - 1;
            let query = bundle.query(lane);
            self.each_hit(&query.ray, query.t_max, query.departure().as_ref(), |hit| {
                out.found.push((lane as u32, hit));
            });
        }
        out.sort();
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn gather_avx2(gather: Gather, rays: Mask) -> Mask {
    // SAFETY: the features of this function.
    unsafe { gather.walk::<rows::x86::Avx2>(rays) }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,avx512f,avx512vl,avx512dq")]
fn gather_avx512(gather: Gather, rays: Mask) -> Mask {
    // SAFETY: the features of this function.
    unsafe { gather.walk::<rows::x86::Avx512>(rays) }
}

/// Passages of rays that walk together, as they are found.
struct Gather<'a> {
    world: &'a World,
    bundle: &'a Bundle,
    level: &'a Level,
    objects: &'a [Object],
    found: (&'a mut Vec<(u32, Hit)>, &'a mut Vec<Crossing>),
    left: Left,
}

impl Gather<'_> {
    /// Walks with those rays that are fit for it; returns the others. Where there are instances, none is.
    ///
    /// # Safety
    /// The processor has the instruction set of `R`.
    #[inline(always)]
    unsafe fn walk<R: Rows>(mut self, rays: Mask) -> Mask {
        if !self.world.instances.is_empty() {
            return rays;
        }
        let (mut packet, fit) = self.level.packet::<R>(self.bundle);
        let rest = rays & !fit;
        self.left = Left::of(self.bundle.left());
        let unbounded = self.level.bounded..self.level.bounded + self.level.unbounded;
        for object in self.objects.get(unbounded).unwrap_or_default() {
            self.ask(object, rays & fit);
        }
        let bvh = &self.level.bvh;
        // SAFETY: the caller answers for the instruction set.
        unsafe { bvh.visit_packet::<R, _>(&mut packet, rays & fit, &mut self) };
        rest
    }

    /// Adds the passages of some rays through an object.
    #[inline(never)]
    fn ask(&mut self, object: &Object, mut rays: Mask) {
        let Self { world, bundle, found: (all, crossings), .. } = self;
        while rays != 0 {
            let lane = rays.trailing_zeros() as usize % LANES;
            rays &= rays - 1;
            let Ray { origin, direction, error, .. } = bundle.ray(lane);
            let id = HitId { instance: HitId::NO_INSTANCE, object: object.id, part: 0 };
            let leaving = bundle.leaves[lane].departure_from(&id).as_ref().map(leaving);
            let ray = LocalRay { origin, direction, error, t_max: bundle.t_max[lane], leaving };
            let local = match world.transform(object.transform) {
                None => ray,
                transform => into(transform, &ray),
            };
            let found = |hit| all.push((lane as u32, hit));
            object_hits(id.instance, object, &local, crossings, found);
        }
    }
}

impl<R: Rows> PacketLeaves<R> for Gather<'_> {
    // No ray becomes shorter.
    const ANY: bool = true;

    #[inline(always)]
    fn leaf(&mut self, items: Range<usize>, rays: Mask, packet: &mut Packet) -> Mask {
        let (level, objects) = (self.level, self.objects);
        let filters = level.filters.get(items.clone()).unwrap_or_default();
        for (filter, object) in filters.iter().zip(objects.get(items).unwrap_or_default()) {
            let mut rays = filter.test::<R>(packet) & rays;
            if rays != 0 && object.shape.is_flat() {
                rays &= !self.left.gone::<R>(filter, object.id);
            }
            if rays != 0 {
                self.ask(object, rays);
            }
        }
        0
    }

    #[inline(always)]
    fn leaf_alone(&mut self, items: Range<usize>, lane: usize, packet: &Packet) -> Option<f64> {
        let (level, objects) = (self.level, self.objects);
        let filters = level.filters.get(items.clone()).unwrap_or_default();
        for (filter, object) in filters.iter().zip(objects.get(items).unwrap_or_default()) {
            if filter.test::<R>(packet) & 1 << lane != 0 {
                self.ask(object, 1 << lane);
            }
        }
        Some(self.bundle.t_max[lane])
    }

    #[inline(always)]
    fn t_max(&self, lane: usize) -> f64 {
        self.bundle.t_max[lane]
    }
}

/// Hands out the passages of a ray through an object, `ray` in its space.
#[inline]
fn object_hits(
    instance: u32,
    object: &Object,
    ray: &LocalRay,
    crossings: &mut Vec<Crossing>,
    mut found: impl FnMut(Hit),
) {
    let mut found = |t: f64, part: u32| {
        found(Hit { t, id: HitId { instance, object: object.id, part } });
    };
    if object.shape.is_flat() {
        // Whoever leaves it does not come back.
        if let Some(root) = object.shape.intersect(ray).filter(|root| root.t <= ray.t_max) {
            found(root.t, root.part);
        }
        return;
    }
    crossings.clear();
    if object.shape.is_solid() {
        solid_hits(object, ray, crossings);
    } else {
        surface_hits(object, ray, crossings);
    }
    crossings.iter().for_each(|c| found(c.t, c.part));
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
