// SPDX-License-Identifier: MIT OR Apache-2.0
//! Rays side by side, component by component: as those who make them and walk with them in lanes want them.

use dioptric_math::DVec3;

use super::Hit;
use crate::bvh::packet::rows::{LANES, Mask};
use crate::ray::{Contacts, Departure, HitId, Ray};

/// One ray of a batch, with what [`super::World::closest_past`] takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Query {
    /// The ray.
    pub ray: Ray,
    /// How far it goes, in units of its direction.
    pub t_max: f64,
    leave: Leave,
}

/// Where a ray comes from. Kept flat: batches are written and copied all the time, and options with odd sizes
/// made that slow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leave {
    from: HitId,
    except: HitId,
    flags: u32,
}

const LEAVES: u32 = 1;
const OUTWARD: u32 = 2;
const CROSSES: u32 = 4;
const EXCEPTS: u32 = 8;

const NOBODY: HitId = HitId { instance: 0, object: 0, part: 0 };

impl Leave {
    /// From nowhere in particular.
    pub const NOTHING: Self = Self { from: NOBODY, except: NOBODY, flags: CROSSES };

    /// From a point, with what becomes of other surfaces there.
    #[inline]
    #[must_use]
    pub fn new(departure: Option<Departure>, contacts: Contacts) -> Self {
        let flag = |set: bool, flag: u32| if set { flag } else { 0 };
        Self {
            from: departure.map_or(NOBODY, |d| d.from),
            except: contacts.except.unwrap_or(NOBODY),
            flags: flag(departure.is_some(), LEAVES)
                | flag(departure.is_some_and(|d| d.outward), OUTWARD)
                | flag(contacts.crossed, CROSSES)
                | flag(contacts.except.is_some(), EXCEPTS),
        }
    }

    /// From a point of `from`, to the side from which it was reached; `except` is what was crossed there.
    #[inline(always)]
    #[must_use]
    pub fn back(from: HitId, outward: bool, except: Option<HitId>) -> Self {
        let flags = LEAVES | if outward { OUTWARD } else { 0 };
        match except {
            None => Self { from, except: NOBODY, flags },
            Some(except) => Self { from, except, flags: flags | EXCEPTS },
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

    /// The point that the ray leaves, if that is on this object.
    #[inline(always)]
    pub(super) fn departure_from(&self, id: &HitId) -> Option<Departure> {
        if self.from.same_object(id) { self.departure() } else { None }
    }
}

impl Query {
    /// A question to [`super::World::closest_each`] or [`super::World::blocker_each`].
    #[inline]
    #[must_use]
    pub fn new(ray: Ray, t_max: f64, departure: Option<Departure>, contacts: Contacts) -> Self {
        Self { ray, t_max, leave: Leave::new(departure, contacts) }
    }

    /// The point that the ray leaves.
    #[inline]
    #[must_use]
    pub fn departure(&self) -> Option<Departure> {
        self.leave.departure()
    }

    /// What becomes of other surfaces at that point.
    #[inline]
    #[must_use]
    pub fn contacts(&self) -> Contacts {
        self.leave.contacts()
    }
}

/// A number of each of sixteen rays.
pub type Sixteen = [f64; LANES];

/// Sixteen rays side by side.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub struct Bundle {
    /// Where they start.
    pub origin: [Sixteen; 3],
    /// Where they go.
    pub direction: [Sixteen; 3],
    /// Bounds on the errors of their origins.
    pub error: Sixteen,
    /// How far they go, in units of their directions.
    pub t_max: Sixteen,
    /// When they are cast.
    pub time: Sixteen,
    /// What they leave.
    pub leaves: [Leave; LANES],
}

impl Bundle {
    /// Rays of a bundle.
    pub const LANES: usize = LANES;

    /// Rays from nowhere that go nowhere.
    pub const EMPTY: Self = Self {
        origin: [[0.0; LANES]; 3],
        direction: [[0.0; LANES]; 3],
        error: [0.0; LANES],
        t_max: [-1.0; LANES],
        time: [0.0; LANES],
        leaves: [Leave::NOTHING; LANES],
    };

    /// Makes them rays that leave nothing, start exactly where they start and go on for ever, at time 0.
    #[inline(always)]
    pub const fn free(&mut self) {
        self.error = [0.0; LANES];
        self.t_max = [f64::INFINITY; LANES];
        self.time = [0.0; LANES];
        self.leaves = [Leave::NOTHING; LANES];
    }

    /// Puts a ray into a lane.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, query: &Query) {
        let (lane, Query { ray, t_max, leave }) = (lane % LANES, query);
        let (origin, direction) = (ray.origin.to_array(), ray.direction.to_array());
        for axis in 0..3 {
            self.origin[axis][lane] = origin[axis];
            self.direction[axis][lane] = direction[axis];
        }
        self.error[lane] = ray.error;
        self.t_max[lane] = *t_max;
        self.time[lane] = ray.time;
        self.leaves[lane] = *leave;
    }

    /// Lets a ray leave a point of `from`, to the side from which it was reached; see [`Leave::back`]. Written number by
    /// number: what is put together elsewhere and copied as a whole makes the processor wait.
    #[inline(always)]
    pub fn leave_back(&mut self, lane: usize, from: &HitId, outward: bool) {
        let leave = &mut self.leaves[lane % LANES];
        leave.from.instance = from.instance;
        leave.from.object = from.object;
        leave.from.part = from.part;
        leave.except = NOBODY;
        leave.flags = LEAVES | if outward { OUTWARD } else { 0 };
    }

    /// Takes over a lane of another bundle.
    #[inline(always)]
    pub(super) fn take(&mut self, lane: usize, other: &Self, from: usize) {
        let (lane, from) = (lane % LANES, from % LANES);
        for axis in 0..3 {
            self.origin[axis][lane] = other.origin[axis][from];
            self.direction[axis][lane] = other.direction[axis][from];
        }
        self.error[lane] = other.error[from];
        self.t_max[lane] = other.t_max[from];
        self.time[lane] = other.time[from];
        self.leaves[lane] = other.leaves[from];
    }

    /// The object outside of groups that each ray leaves, and whether outwards.
    #[inline(always)]
    pub(super) fn left(&self) -> impl Iterator<Item = Option<(u32, bool)>> {
        self.leaves.iter().map(|leave| {
            let at_top = leave.flags & LEAVES != 0 && leave.from.instance == HitId::NO_INSTANCE;
            at_top.then_some((leave.from.object, leave.flags & OUTWARD != 0))
        })
    }

    /// A ray.
    #[inline(always)]
    #[must_use]
    pub fn ray(&self, lane: usize) -> Ray {
        let lane = lane % LANES;
        let vector = |v: &[Sixteen; 3]| DVec3::new(v[0][lane], v[1][lane], v[2][lane]);
        Ray {
            origin: vector(&self.origin),
            direction: vector(&self.direction),
            time: self.time[lane],
            error: self.error[lane],
        }
    }

    /// A ray with all that belongs to it.
    #[inline(always)]
    #[must_use]
    pub fn query(&self, lane: usize) -> Query {
        let lane = lane % LANES;
        Query { ray: self.ray(lane), t_max: self.t_max[lane], leave: self.leaves[lane] }
    }
}

/// Any number of rays, sixteen by sixteen.
#[derive(Clone, Debug, Default)]
pub struct Rays {
    bundles: Vec<Bundle>,
    count: usize,
}

impl Rays {
    /// How many there are.
    #[inline]
    #[must_use]
    pub const fn len(&self) -> usize {
        self.count
    }

    /// Whether there are none.
    #[inline]
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Takes all away.
    #[inline]
    pub const fn clear(&mut self) {
        // The bundles stay, and are used again.
        self.count = 0;
    }

    /// Adds a ray.
    #[inline]
    pub fn push(&mut self, query: &Query) {
        let at = self.count / LANES;
        if at == self.bundles.len() {
            self.bundles.push(Bundle::EMPTY);
        }
        self.bundles[at].set(self.count, query);
        self.count += 1;
    }

    /// Adds a ray that leaves what a lane of a bundle leaves, in another direction.
    #[inline(always)]
    pub fn push_lane(&mut self, from: &Bundle, lane: usize, direction: DVec3, t_max: f64) {
        let at = self.count / LANES;
        if at == self.bundles.len() {
            self.bundles.push(Bundle::EMPTY);
        }
        let (bundle, to, lane) = (&mut self.bundles[at], self.count % LANES, lane % LANES);
        for (axis, way) in direction.to_array().into_iter().enumerate() {
            bundle.origin[axis][to] = from.origin[axis][lane];
            bundle.direction[axis][to] = way;
        }
        (bundle.error[to], bundle.time[to]) = (from.error[lane], from.time[lane]);
        bundle.t_max[to] = t_max;
        bundle.leaves[to] = from.leaves[lane];
        self.count += 1;
    }

    /// Adds a ray from a point, whose direction and length are not known yet.
    #[inline(always)]
    pub fn push_from(&mut self, origin: DVec3, error: f64, time: f64, leave: Leave) {
        let (at, lane) = (self.count / LANES, self.count % LANES);
        if at == self.bundles.len() {
            self.bundles.push(Bundle::EMPTY);
        }
        let bundle = &mut self.bundles[at];
        for (axis, x) in origin.to_array().into_iter().enumerate() {
            bundle.origin[axis][lane] = x;
        }
        (bundle.error[lane], bundle.time[lane]) = (error, time);
        let slot = &mut bundle.leaves[lane];
        (slot.from, slot.except, slot.flags) = (leave.from, leave.except, leave.flags);
        self.count += 1;
    }

    /// Adds the rays of a bundle that `fill` fills, up to `count` of them: those whose bits it returns.
    pub fn append(&mut self, count: usize, fill: impl FnOnce(&mut Bundle) -> Mask) -> Mask {
        let (at, from) = (self.count / LANES, self.count % LANES);
        if at == self.bundles.len() {
            self.bundles.push(Bundle::EMPTY);
        }
        let all = if count < LANES { (1 << count) - 1 } else { Mask::MAX };
        if from == 0 {
            let filled = fill(&mut self.bundles[at]) & all;
            if filled == all {
                self.count += count;
                return filled;
            }
            let bundle = self.bundles[at].clone();
            self.pick(&bundle, filled);
            return filled;
        }
        let mut bundle = Bundle::EMPTY;
        let filled = fill(&mut bundle) & all;
        self.pick(&bundle, filled);
        filled
    }

    /// Adds some rays of a bundle.
    fn pick(&mut self, bundle: &Bundle, lanes: Mask) {
        for lane in (0..LANES).filter(|lane| lanes & 1 << lane != 0) {
            self.push(&bundle.query(lane));
        }
    }

    /// All of them; lanes beyond the last ray mean nothing.
    #[inline]
    #[must_use]
    pub fn bundles(&self) -> &[Bundle] {
        &self.bundles[..self.count.div_ceil(LANES)]
    }

    /// The same, to be changed.
    #[inline]
    #[must_use]
    pub fn bundles_mut(&mut self) -> &mut [Bundle] {
        &mut self.bundles[..self.count.div_ceil(LANES)]
    }

    /// Moves the last rays into `out`, which is cleared first: all, or between `most` and `most` + 15 of them.
    pub fn take_last(&mut self, most: usize, out: &mut Self) {
        out.clear();
        let first = self.count.saturating_sub(most) / LANES;
        if first == 0 {
            std::mem::swap(self, out);
            return;
        }
        out.bundles.splice(.., self.bundles.drain(first..));
        out.count = self.count - first * LANES;
        self.count = first * LANES;
    }
}

/// What sixteen rays hit.
#[derive(Clone, Copy, Debug)]
pub struct Found {
    /// A bit for each ray that hit something.
    pub hit: Mask,
    /// The hits, where there are some.
    pub ids: [HitId; LANES],
    /// Their distances; where there is no hit, how far the ray goes. (No distances of things in the way.)
    pub t: Sixteen,
}

impl Found {
    /// Nothing.
    pub const NOTHING: Self = Self { hit: 0, ids: [NOBODY; LANES], t: [0.0; LANES] };

    /// What a ray hit.
    #[inline(always)]
    #[must_use]
    pub fn best(&self, lane: usize) -> Option<Hit> {
        let lane = lane % LANES;
        (self.hit & 1 << lane != 0).then(|| Hit { t: self.t[lane], id: self.ids[lane] })
    }

    #[inline(always)]
    pub(super) fn keep(&mut self, lane: usize, hit: Hit) {
        let lane = lane % LANES;
        self.hit |= 1 << lane;
        self.ids[lane] = hit.id;
        self.t[lane] = hit.t;
    }
}
