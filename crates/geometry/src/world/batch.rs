// SPDX-License-Identifier: MIT OR Apache-2.0
//! Many rays at once: the same answers as one by one, sooner where neighbours go the same way.
//!
//! Sixteen rays at a time walk the tree of the objects outside of groups together; instances are visited by each
//! ray alone. Lanes only reject: whatever they let through is asked the same as by a single ray.

#![allow(unsafe_code)]

use std::ops::Range;

use super::query::{block, into, leaving, meet};
use super::{Hit, Level, Object, World};
use crate::bvh::Lanes;
use crate::bvh::packet::rows::{self, LANES, Mask, Rows};
use crate::bvh::packet::{Packet, PacketLeaves};
use crate::ray::{Contacts, Departure, HitId, LocalRay, Ray};

/// One ray of a batch, with what [`World::closest_past`] takes.
///
/// Kept flat: batches are written and copied all the time, and options with odd sizes made that slow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Query {
    /// The ray.
    pub ray: Ray,
    /// How far it goes, in units of its direction.
    pub t_max: f64,
    from: HitId,
    except: HitId,
    flags: u32,
}

const LEAVES: u32 = 1;
const OUTWARD: u32 = 2;
const CROSSES: u32 = 4;
const EXCEPTS: u32 = 8;

impl Query {
    /// A question to [`World::closest_each`] or [`World::blocker_each`].
    #[inline]
    #[must_use]
    pub fn new(ray: Ray, t_max: f64, departure: Option<Departure>, contacts: Contacts) -> Self {
        let nobody = HitId { instance: 0, object: 0, part: 0 };
        let flag = |set: bool, flag: u32| if set { flag } else { 0 };
        Self {
            ray,
            t_max,
            from: departure.map_or(nobody, |d| d.from),
            except: contacts.except.unwrap_or(nobody),
            flags: flag(departure.is_some(), LEAVES)
                | flag(departure.is_some_and(|d| d.outward), OUTWARD)
                | flag(contacts.crossed, CROSSES)
                | flag(contacts.except.is_some(), EXCEPTS),
        }
    }

    /// The point that the ray leaves.
    #[inline]
    #[must_use]
    pub fn departure(&self) -> Option<Departure> {
        let outward = self.flags & OUTWARD != 0;
        (self.flags & LEAVES != 0).then_some(Departure { from: self.from, outward })
    }

    /// What becomes of other surfaces at that point.
    #[inline]
    #[must_use]
    pub fn contacts(&self) -> Contacts {
        let except = (self.flags & EXCEPTS != 0).then_some(self.except);
        Contacts { crossed: self.flags & CROSSES != 0, except }
    }
}

/// Up to sixteen rays and what they have hit so far.
struct Walk<'a> {
    queries: &'a [Query],
    /// Rays that hit something.
    hit: Mask,
    /// The best hit, where there is one.
    ids: [HitId; LANES],
    /// Its distance; where there is none, how far the ray goes.
    t: [f64; LANES],
}

impl World {
    /// [`Self::closest_past`] for each query; `hits` is cleared first.
    pub fn closest_each(&self, queries: &[Query], hits: &mut Vec<Option<Hit>>) {
        hits.clear();
        for queries in queries.chunks(LANES) {
            let walk = self.packet::<false>(queries);
            hits.extend((0..queries.len()).map(|lane| walk.best(lane)));
        }
    }

    /// [`Self::blocker_past`] for each query, though perhaps not the same one; `blockers` is cleared first.
    pub fn blocker_each(&self, queries: &[Query], blockers: &mut Vec<Option<HitId>>) {
        blockers.clear();
        for queries in queries.chunks(LANES) {
            let walk = self.packet::<true>(queries);
            blockers.extend((0..queries.len()).map(|lane| walk.best(lane).map(|hit| hit.id)));
        }
    }

    /// Finds the nearest hit of each ray, or any within its limit.
    fn packet<'a, const ANY: bool>(&self, queries: &'a [Query]) -> Walk<'a> {
        let mut walk = Walk {
            queries,
            hit: 0,
            ids: [HitId { instance: 0, object: 0, part: 0 }; LANES],
            t: [0.0; LANES],
        };
        match self.levels.first().map_or(Lanes::Plain, |level| level.bvh.lanes()) {
            // SAFETY: a tree's lanes are never more than the processor has.
            #[cfg(target_arch = "x86_64")]
            Lanes::Avx2 => unsafe { self.walk_avx2::<ANY>(&mut walk) },
            #[cfg(target_arch = "x86_64")]
            Lanes::Avx512 => unsafe { self.walk_avx512::<ANY>(&mut walk) },
            // SAFETY: that is what everything was compiled for.
            _ => unsafe { self.walk::<rows::Base, ANY>(&mut walk) },
        }
        walk
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,fma")]
    fn walk_avx2<const ANY: bool>(&self, walk: &mut Walk) {
        // SAFETY: the features of this function.
        unsafe { self.walk::<rows::x86::Avx2, ANY>(walk) }
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,fma,avx512f,avx512vl,avx512dq")]
    fn walk_avx512<const ANY: bool>(&self, walk: &mut Walk) {
        // SAFETY: the features of this function.
        unsafe { self.walk::<rows::x86::Avx512, ANY>(walk) }
    }

    /// # Safety
    /// The processor has the instruction set of `R`.
    #[inline(always)]
    unsafe fn walk<R: Rows, const ANY: bool>(&self, walk: &mut Walk) {
        let Some(level) = self.levels.first() else { return };
        let Some(objects) = self.objects.get(level.first..) else { return };
        let mut packet = Packet::empty();
        let mut usable: Mask = 0;
        for (lane, query) in walk.queries.iter().enumerate() {
            let ray = &query.ray;
            walk.t[lane] = query.t_max;
            usable |= Mask::from(ray.error >= 0.0 && query.t_max >= 0.0) << lane;
            packet.set(lane, ray.origin, ray.direction, query.t_max, ray.error, &level.bvh);
        }
        let reach = (level.reach.amplify, level.reach.extent);
        let mut together = packet.finish::<R>(&level.bvh, reach) & usable;
        for (lane, query) in walk.queries.iter().enumerate() {
            // What is too large or too small for single precision goes alone.
            if together & 1 << lane == 0 {
                self.alone::<ANY>(walk, lane, query);
            }
        }
        let unbounded = objects.get(level.bounded..level.bounded + level.unbounded);
        for object in unbounded.unwrap_or_default() {
            let done = self.test::<ANY>(walk, object, together);
            together &= !done;
        }
        let mut leaves = Objects::<ANY> { world: self, level, objects, walk };
        // SAFETY: the caller answers for the instruction set.
        unsafe { level.bvh.visit_packet::<R, _>(&mut packet, together, &mut leaves) };
        if !self.instances.is_empty() {
            self.visit_instances_alone::<ANY>(walk, together);
        }
    }

    /// Answers a query by a single ray's walk.
    #[cold]
    fn alone<const ANY: bool>(&self, walk: &mut Walk, lane: usize, query: &Query) {
        let (departure, contacts) = (query.departure(), query.contacts());
        let (departure, Query { ray, t_max, .. }) = (departure.as_ref(), query);
        let best = if ANY {
            self.blocker_past(ray, *t_max, departure, contacts).map(|id| Hit { t: 0.0, id })
        } else {
            self.closest_past(ray, *t_max, departure, contacts)
        };
        if let Some(hit) = best {
            walk.keep(lane, hit);
        }
    }

    /// Tests an object for some of the rays; returns those that need no more, which are none where the nearest
    /// hit is wanted.
    #[inline(never)]
    fn test<const ANY: bool>(&self, walk: &mut Walk, object: &Object, mut rays: Mask) -> Mask {
        let mut done = 0;
        while rays != 0 {
            let lane = rays.trailing_zeros() as usize % LANES;
            rays &= rays - 1;
            done |= Mask::from(self.test_one::<ANY>(walk, object, lane)) << lane;
        }
        done
    }

    /// Tests an object for one of the rays; whether it needs no more.
    #[inline]
    fn test_one<const ANY: bool>(&self, walk: &mut Walk, object: &Object, lane: usize) -> bool {
        let Some(query) = walk.queries.get(lane) else { return false };
        let id = HitId { instance: HitId::NO_INSTANCE, object: object.id, part: 0 };
        let leaves = query.flags & LEAVES != 0 && query.from.same_object(&id);
        let local = LocalRay {
            origin: query.ray.origin,
            direction: query.ray.direction,
            error: query.ray.error,
            t_max: walk.t[lane],
            leaving: query.departure().filter(|_| leaves).as_ref().map(leaving),
        };
        let ask = if ANY { block } else { meet };
        let root = match self.transform(object.transform) {
            None => ask(id.instance, object, &local, query.contacts()),
            transform => ask(id.instance, object, &into(transform, &local), query.contacts()),
        };
        let Some(root) = root else { return false };
        let hit = Hit { t: root.t, id: HitId { part: root.part, ..id } };
        if ANY {
            let blocks = hit.t < query.t_max;
            if blocks {
                walk.keep(lane, hit);
            }
            return blocks;
        }
        if hit.t <= query.t_max && hit.comes_before(walk.best(lane)) {
            walk.keep(lane, hit);
        }
        false
    }

    /// Lets each ray alone visit the instances.
    #[inline(never)]
    fn visit_instances_alone<const ANY: bool>(&self, walk: &mut Walk, rays: Mask) {
        for (lane, query) in walk.queries.iter().enumerate() {
            let bit = 1 << lane;
            if rays & bit == 0 || (ANY && walk.hit & bit != 0) {
                continue;
            }
            let departure = query.departure();
            let departure = departure.as_ref();
            let best = walk.best(lane);
            let found = if ANY {
                self.any_instance(&query.ray, query.t_max, departure, query.contacts())
            } else {
                self.nearest_instance(&query.ray, walk.t[lane], departure, query.contacts())
            };
            if let Some(hit) = found.filter(|hit| hit.comes_before(best)) {
                walk.keep(lane, hit);
            }
        }
    }
}

/// The objects in the leaves of a level.
struct Objects<'a, 'w, 'q, const ANY: bool> {
    world: &'a World,
    level: &'a Level,
    objects: &'a [Object],
    walk: &'w mut Walk<'q>,
}

impl<R: Rows, const ANY: bool> PacketLeaves<R> for Objects<'_, '_, '_, ANY> {
    const ANY: bool = ANY;

    #[inline(always)]
    fn leaf_alone(&mut self, items: Range<usize>, lane: usize, packet: &Packet) -> Option<f64> {
        let filters = self.level.filters.get(items.clone()).unwrap_or_default();
        for (filter, object) in filters.iter().zip(self.objects.get(items).unwrap_or_default()) {
            // For all sixteen, which takes less than most exact tests. (The packet's limits may be old.)
            if filter.test::<R>(packet) & 1 << lane != 0
                && self.world.test_one::<ANY>(self.walk, object, lane)
            {
                return None;
            }
        }
        Some(self.walk.t[lane])
    }

    #[inline(always)]
    fn t_max(&self, lane: usize) -> f64 {
        self.walk.t[lane]
    }

    #[inline(always)]
    fn leaf(&mut self, items: Range<usize>, rays: Mask, packet: &mut Packet) -> Mask {
        let mut done = 0;
        let filters = self.level.filters.get(items.clone()).unwrap_or_default();
        for (filter, object) in filters.iter().zip(self.objects.get(items).unwrap_or_default()) {
            let rays = filter.test::<R>(packet) & rays & !done;
            if rays != 0 {
                let before = self.walk.t;
                done |= self.world.test::<ANY>(self.walk, object, rays);
                if !ANY {
                    self.walk.shorten(packet, rays, &before);
                }
            }
        }
        done
    }
}

impl Walk<'_> {
    /// The best hit of a ray so far.
    #[inline(always)]
    fn best(&self, lane: usize) -> Option<Hit> {
        let lane = lane % LANES;
        (self.hit & 1 << lane != 0).then(|| Hit { t: self.t[lane], id: self.ids[lane] })
    }

    #[inline(always)]
    fn keep(&mut self, lane: usize, hit: Hit) {
        let lane = lane % LANES;
        self.hit |= 1 << lane;
        self.ids[lane] = hit.id;
        self.t[lane] = hit.t;
    }

    /// Takes over how far the rays still go.
    #[inline(always)]
    fn shorten(&self, packet: &mut Packet, mut rays: Mask, before: &[f64; LANES]) {
        while rays != 0 {
            let lane = rays.trailing_zeros() as usize % LANES;
            rays &= rays - 1;
            if self.t[lane] != before[lane] {
                packet.shorten(lane, self.t[lane]);
            }
        }
    }
}
