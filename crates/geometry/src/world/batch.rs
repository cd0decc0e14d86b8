// SPDX-License-Identifier: MIT OR Apache-2.0
//! Many rays at once: the same answers as one by one, sooner where neighbours go the same way.
//!
//! Sixteen rays at a time walk the tree of the objects outside of groups together; instances are visited by each
//! ray alone. Lanes only reject: whatever they let through is asked the same as by a single ray.

#![allow(unsafe_code)]

use std::ops::Range;

use super::filter::Left;
use super::query::{block, into, leaving, meet};
use super::rays::{Bundle, Found, Query, Rays};
use super::{Hit, Level, Object, World};
use crate::bvh::Lanes;
use crate::bvh::packet::rows::{self, LANES, Mask, Rows};
use crate::bvh::packet::{Packet, PacketLeaves};
use crate::ray::{HitId, LocalRay, Ray};

/// Where more than this many of sixteen rays are wanted, they walk as they stand; fewer are gathered first.
const DENSE: u32 = 11;

impl World {
    /// [`Self::closest_past`] for each query; `hits` is cleared first.
    pub fn closest_each(&self, queries: &[Query], hits: &mut Vec<Option<Hit>>) {
        hits.clear();
        let (mut bundle, mut found) = (Bundle::EMPTY, Found::NOTHING);
        for queries in queries.chunks(LANES) {
            self.walk_queries::<false>(queries, &mut bundle, &mut found);
            hits.extend((0..queries.len()).map(|lane| found.best(lane)));
        }
    }

    /// [`Self::blocker_past`] for each query, though perhaps not the same one; `blockers` is cleared first.
    pub fn blocker_each(&self, queries: &[Query], blockers: &mut Vec<Option<HitId>>) {
        blockers.clear();
        let (mut bundle, mut found) = (Bundle::EMPTY, Found::NOTHING);
        for queries in queries.chunks(LANES) {
            self.walk_queries::<true>(queries, &mut bundle, &mut found);
            blockers.extend((0..queries.len()).map(|lane| found.best(lane).map(|hit| hit.id)));
        }
    }

    fn walk_queries<const ANY: bool>(
        &self,
        queries: &[Query],
        bundle: &mut Bundle,
        found: &mut Found,
    ) {
        for (lane, query) in queries.iter().enumerate() {
            bundle.set(lane, query);
        }
        self.walk_any_lanes::<ANY>(bundle, first(queries.len()), found);
    }

    /// [`Self::closest_past`] for each of the rays: sixteen answers for each bundle.
    pub fn closest_of_rays(&self, rays: &Rays, found: &mut Vec<Found>) {
        found.clear();
        found.resize(rays.bundles().len(), Found::NOTHING);
        let mut left = rays.len();
        for (bundle, found) in rays.bundles().iter().zip(found) {
            self.walk_any_lanes::<false>(bundle, first(left), found);
            left = left.saturating_sub(LANES);
        }
    }

    /// [`Self::blocker_past`] for the rays whose bits are set, though perhaps not the same one: sixteen answers for each
    /// bundle.
    pub fn blockers_of_rays(&self, bundles: &[Bundle], wanted: &[Mask], found: &mut Vec<Found>) {
        found.clear();
        found.resize(bundles.len(), Found::NOTHING);
        let mut few = Few::NONE;
        for (at, (bundle, &rays)) in bundles.iter().zip(wanted).enumerate() {
            if rays.count_ones() > DENSE {
                self.walk_any_lanes::<true>(bundle, rays, &mut found[at]);
                continue;
            }
            let mut rays = rays;
            while rays != 0 {
                let lane = rays.trailing_zeros() as usize % LANES;
                rays &= rays - 1;
                few.bundle.take(few.count, bundle, lane);
                few.of[few.count] = (at as u32, lane as u8);
                few.count += 1;
                if few.count == LANES {
                    self.walk_few(&mut few, found);
                }
            }
        }
        self.walk_few(&mut few, found);
    }

    /// The same for one bundle.
    pub fn blockers_of(&self, bundle: &Bundle, wanted: Mask, found: &mut Found) {
        self.walk_any_lanes::<true>(bundle, wanted, found);
    }

    /// Walks with rays that were gathered, and hands out what they found.
    fn walk_few(&self, few: &mut Few, found: &mut [Found]) {
        if few.count == 0 {
            return;
        }
        self.walk_any_lanes::<true>(&few.bundle, first(few.count), &mut few.found);
        let mut hit = few.found.hit;
        while hit != 0 {
            let from = hit.trailing_zeros() as usize % LANES;
            hit &= hit - 1;
            let (at, lane) = few.of[from];
            if let Some(best) = few.found.best(from) {
                found[at as usize].keep(usize::from(lane), best);
            }
        }
        few.count = 0;
    }

    /// Finds the nearest hit of each ray, or any within its limit.
    fn walk_any_lanes<const ANY: bool>(&self, bundle: &Bundle, rays: Mask, found: &mut Found) {
        found.hit = 0;
        let locals = std::array::from_fn(|lane| {
            let Ray { origin, direction, error, .. } = bundle.ray(lane);
            LocalRay { origin, direction, error, t_max: 0.0, leaving: None }
        });
        let mut walk = Walk { bundle, locals, found };
        match self.levels.first().map_or(Lanes::Plain, |level| level.bvh.lanes()) {
            // SAFETY: a tree's lanes are never more than the processor has.
            #[cfg(target_arch = "x86_64")]
            Lanes::Avx2 => unsafe { self.walk_avx2::<ANY>(&mut walk, rays) },
            #[cfg(target_arch = "x86_64")]
            Lanes::Avx512 => unsafe { self.walk_avx512::<ANY>(&mut walk, rays) },
            // SAFETY: that is what everything was compiled for.
            _ => unsafe { self.walk::<rows::Base, ANY>(&mut walk, rays) },
        }
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,fma")]
    fn walk_avx2<const ANY: bool>(&self, walk: &mut Walk, rays: Mask) {
        // SAFETY: the features of this function.
        unsafe { self.walk::<rows::x86::Avx2, ANY>(walk, rays) }
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,fma,avx512f,avx512vl,avx512dq")]
    fn walk_avx512<const ANY: bool>(&self, walk: &mut Walk, rays: Mask) {
        // SAFETY: the features of this function.
        unsafe { self.walk::<rows::x86::Avx512, ANY>(walk, rays) }
    }

    /// # Safety
    /// The processor has the instruction set of `R`.
    #[inline(always)]
    unsafe fn walk<R: Rows, const ANY: bool>(&self, walk: &mut Walk, rays: Mask) {
        let bundle = walk.bundle;
        walk.found.t = bundle.t_max;
        let Some(level) = self.levels.first() else { return };
        let Some(objects) = self.objects.get(level.first..) else { return };
        let (mut packet, fit) = level.packet::<R>(bundle);
        let mut together = rays & fit;
        let mut alone = rays & !together;
        while alone != 0 {
            // What is too large or too small for single precision.
            let lane = alone.trailing_zeros() as usize % LANES;
            alone &= alone - 1;
            self.alone::<ANY>(walk, lane);
        }
        let unbounded = objects.get(level.bounded..level.bounded + level.unbounded);
        for object in unbounded.unwrap_or_default() {
            let kept = self.test::<ANY>(walk, object, together);
            if ANY {
                together &= !kept;
            } else {
                walk.shorten(&mut packet, kept);
            }
        }
        let left = Left::of(bundle.left());
        let mut leaves = Objects::<ANY> { world: self, level, objects, walk, left };
        // SAFETY: the caller answers for the instruction set.
        unsafe { level.bvh.visit_packet::<R, _>(&mut packet, together, &mut leaves) };
        if !self.instances.is_empty() {
            self.visit_instances_alone::<ANY>(walk, together);
        }
    }

    /// Answers a query by a single ray's walk.
    #[cold]
    fn alone<const ANY: bool>(&self, walk: &mut Walk, lane: usize) {
        let query = walk.bundle.query(lane);
        let (departure, contacts) = (query.departure(), query.contacts());
        let (departure, Query { ray, t_max, .. }) = (departure.as_ref(), &query);
        let best = if ANY {
            self.blocker_past(ray, *t_max, departure, contacts).map(|id| Hit { t: 0.0, id })
        } else {
            self.closest_past(ray, *t_max, departure, contacts)
        };
        if let Some(hit) = best {
            walk.found.keep(lane, hit);
        }
    }

    /// Tests an object for some of the rays; returns those for which it is what they ask for, so far.
    #[inline(never)]
    fn test<const ANY: bool>(&self, walk: &mut Walk, object: &Object, mut rays: Mask) -> Mask {
        let mut kept = 0;
        while rays != 0 {
            let lane = rays.trailing_zeros() as usize % LANES;
            rays &= rays - 1;
            kept |= Mask::from(self.test_one::<ANY>(walk, object, lane)) << lane;
        }
        kept
    }

    /// Tests an object for one of the rays; whether it is what that asks for, so far.
    #[inline]
    fn test_one<const ANY: bool>(&self, walk: &mut Walk, object: &Object, lane: usize) -> bool {
        let lane = lane % LANES;
        let Walk { bundle, locals, found } = walk;
        let leave = &bundle.leaves[lane];
        let id = HitId { instance: HitId::NO_INSTANCE, object: object.id, part: 0 };
        let local = &mut locals[lane];
        local.t_max = found.t[lane];
        let departure = leave.departure_from(&id);
        local.leaving = departure.as_ref().map(leaving);
        let ask = if ANY { block } else { meet };
        let root = match self.transform(object.transform) {
            None => ask(id.instance, object, local, leave.contacts()),
            transform => ask(id.instance, object, &into(transform, local), leave.contacts()),
        };
        let Some(root) = root else { return false };
        let hit = Hit { t: root.t, id: HitId { part: root.part, ..id } };
        let t_max = bundle.t_max[lane];
        let keep = if ANY {
            hit.t < t_max
        } else {
            hit.t <= t_max && hit.comes_before(walk.found.best(lane))
        };
        if keep {
            walk.found.keep(lane, hit);
        }
        keep
    }

    /// Lets each ray alone visit the instances.
    #[inline(never)]
    fn visit_instances_alone<const ANY: bool>(&self, walk: &mut Walk, mut rays: Mask) {
        if ANY {
            rays &= !walk.found.hit;
        }
        while rays != 0 {
            let lane = rays.trailing_zeros() as usize % LANES;
            rays &= rays - 1;
            let query = walk.bundle.query(lane);
            let departure = query.departure();
            let departure = departure.as_ref();
            let best = walk.found.best(lane);
            let found = if ANY {
                self.any_instance(&query.ray, query.t_max, departure, query.contacts())
            } else {
                self.nearest_instance(&query.ray, walk.found.t[lane], departure, query.contacts())
            };
            if let Some(hit) = found.filter(|hit| hit.comes_before(best)) {
                walk.found.keep(lane, hit);
            }
        }
    }
}

impl Level {
    /// The rays of a bundle in single precision, and which of them may walk so: others are too large or too small.
    #[inline(always)]
    pub(super) fn packet<R: Rows>(&self, bundle: &Bundle) -> (Packet, Mask) {
        let mut packet = Packet::empty();
        let Bundle { origin, direction, t_max, error, .. } = bundle;
        packet.fill::<R>(origin, direction, t_max, error, &self.bvh);
        let mut fit = Mask::MAX;
        for lane in 0..LANES {
            fit &= !(Mask::from(!(error[lane] >= 0.0 && t_max[lane] >= 0.0)) << lane);
        }
        let reach = (self.reach.amplify, self.reach.extent);
        fit &= packet.finish::<R>(&self.bvh, reach);
        (packet, fit)
    }
}

/// Sixteen rays, and what they have hit so far.
struct Walk<'a> {
    bundle: &'a Bundle,
    /// The rays as objects want them. Written long before they are read: numbers that were just written one by one and
    /// are read two by two make the processor wait.
    locals: [LocalRay; LANES],
    found: &'a mut Found,
}

impl Walk<'_> {
    /// Takes over how far rays still go.
    #[inline(always)]
    fn shorten(&self, packet: &mut Packet, mut rays: Mask) {
        while rays != 0 {
            let lane = rays.trailing_zeros() as usize % LANES;
            rays &= rays - 1;
            packet.shorten(lane, self.found.t[lane]);
        }
    }
}

/// Rays that are gathered from bundles with few of them.
struct Few {
    bundle: Bundle,
    count: usize,
    /// Where each comes from: the bundle's number, and the lane.
    of: [(u32, u8); LANES],
    found: Found,
}

impl Few {
    const NONE: Self =
        Self { bundle: Bundle::EMPTY, count: 0, of: [(0, 0); LANES], found: Found::NOTHING };
}

/// The first lanes.
fn first(count: usize) -> Mask {
    if count < LANES { (1 << count) - 1 } else { Mask::MAX }
}

/// The objects in the leaves of a level.
struct Objects<'a, 'w, 'q, const ANY: bool> {
    world: &'a World,
    level: &'a Level,
    objects: &'a [Object],
    walk: &'w mut Walk<'q>,
    left: Left,
}

impl<R: Rows, const ANY: bool> PacketLeaves<R> for Objects<'_, '_, '_, ANY> {
    const ANY: bool = ANY;

    #[inline(always)]
    fn leaf_alone(&mut self, items: Range<usize>, lane: usize, packet: &Packet) -> Option<f64> {
        let filters = self.level.filters.get(items.clone()).unwrap_or_default();
        for (filter, object) in filters.iter().zip(self.objects.get(items).unwrap_or_default()) {
            // For all sixteen, which takes less than most exact tests. (The packet's limits may be old.)
            if (filter.test::<R>(packet) & !self.left.gone::<R>(filter, object.id)) & 1 << lane != 0
                && self.world.test_one::<ANY>(self.walk, object, lane)
                && ANY
            {
                return None;
            }
        }
        Some(self.walk.found.t[lane])
    }

    #[inline(always)]
    fn t_max(&self, lane: usize) -> f64 {
        self.walk.found.t[lane]
    }

    #[inline(always)]
    fn leaf(&mut self, items: Range<usize>, rays: Mask, packet: &mut Packet) -> Mask {
        let mut done = 0;
        let filters = self.level.filters.get(items.clone()).unwrap_or_default();
        for (filter, object) in filters.iter().zip(self.objects.get(items).unwrap_or_default()) {
            let mut rays = filter.test::<R>(packet) & rays & !done;
            if rays != 0 {
                rays &= !self.left.gone::<R>(filter, object.id);
            }
            if rays != 0 {
                let kept = self.world.test::<ANY>(self.walk, object, rays);
                if ANY {
                    done |= kept;
                } else {
                    self.walk.shorten(packet, kept);
                }
            }
        }
        done
    }
}
