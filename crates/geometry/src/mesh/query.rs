// SPDX-License-Identifier: MIT OR Apache-2.0
//! Casting rays at a mesh.

use std::marker::PhantomData;
use std::ops::Range;

use dioptric_math::DVec3;

use super::line::{Corners, Line, exact, nearest, normal};
use super::{LARGE, Mesh};
use crate::bvh::lanes::{Job, Test, apart};
use crate::bvh::ray::Start;
use crate::bvh::traverse::{Leaves, Shelf, walk_tree};
use crate::bvh::triangles::{Aim, SIDE_BY_SIDE, Sight};
use crate::bvh::{BoxRay, NoCount};
use crate::ray::{Leaving, LocalRay};
use crate::shape::{Crossing, Root};

/// Beyond this many times the error of a ray's origin nothing touches it.
const CONTACT_REACH: f64 = 1e6;
/// How many times the error counts as near a point that is left: generously, for next to an edge the way through
/// the inside is as short as the error is.
const NEAR: f64 = 8.0;

impl Mesh {
    /// What hits may lie outside of the boxes, and rays beside what they mean.
    #[inline(always)]
    fn pad(&self, origin: DVec3, error: f64) -> f64 {
        let largest = origin.abs().max_element();
        error + 4.0 * self.error + dioptric_math::bounds::gamma(64) * largest
    }

    /// The nearest hit; of several at the same `t` that of the lowest triangle.
    #[inline]
    pub(super) fn closest(&self, ray: &LocalRay) -> Option<Root> {
        // SAFETY: a tree's instruction set is one that the processor has.
        unsafe { self.bvh.lanes().run(Cast::<false, true> { mesh: self, ray }) }
    }

    /// Any hit before `t_max`.
    #[inline]
    pub(super) fn any(&self, ray: &LocalRay) -> Option<Root> {
        // SAFETY: as above.
        unsafe { self.bvh.lanes().run(Cast::<true, true> { mesh: self, ray }) }
    }

    /// Whether there is any hit with `t` in `[0, ray.t_max)`, as [`crate::Shape::blocks`] has it, but sooner: what is
    /// certain is not looked at again.
    #[inline]
    #[must_use]
    pub fn hides(&self, ray: &LocalRay) -> bool {
        // SAFETY: as above.
        unsafe { self.bvh.lanes().run(Cast::<true, false> { mesh: self, ray }) }.is_some()
    }

    /// Where the ray hits one triangle, if it does, as [`crate::Shape`] has the rules; `t_max` is not looked at.
    /// The corners are turned as the line has them.
    #[inline(always)]
    fn meet(&self, ray: &LocalRay, line: &Line, part: u32, corners: &Corners) -> Option<f64> {
        let seen = line.see(corners);
        let passage = line.pass(corners, &seen);
        let Some(leaving) = ray.leaving else {
            if let Some(passage) = passage
                && passage.t > 0.0
            {
                return Some(passage.t);
            }
            // Cheap and nearly always so: it is elsewhere.
            let bound = ray.error + self.error;
            let [i, j, k] = [seen[0][2], seen[1][2], seen[2][2]];
            let here = i.min(j).min(k) <= bound && i.max(j).max(k) >= -bound;
            return (here && self.starts_on(ray, part)).then_some(0.0);
        };
        if part == leaving.part {
            return None;
        }
        if let Some(passage) = passage {
            // The common case: well ahead.
            let [x, y, z] = passage.normal;
            let height = passage.t * line.rate(&passage.normal).abs();
            let bound = ray.error + self.error;
            if passage.t > 0.0 && height * height > bound * bound * (x * x + y * y + z * z) {
                return Some(passage.t);
            }
        }
        self.meet_near(ray, leaving, part, passage.map(|p| p.t))
    }

    /// A triangle that is met about where the ray leaves another one of this mesh: a neighbour that
    /// rises from the left one's side blocks the way at once, or edges would leak; one that falls away
    /// from it cannot be met there, whatever rounding says.
    #[inline(never)]
    fn meet_near(
        &self,
        ray: &LocalRay,
        leaving: Leaving,
        part: u32,
        t: Option<f64>,
    ) -> Option<f64> {
        let corners = &self.corners(part)?;
        let bound = NEAR * (ray.error + self.error);
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
    #[inline(never)]
    fn starts_on(&self, ray: &LocalRay, part: u32) -> bool {
        let Some(corners) = &self.corners(part) else { return false };
        let bound = ray.error + self.error;
        let (normal, offset) = (normal(corners), ray.origin - exact(corners[0]));
        let height = normal.dot(offset);
        if height.abs() > 2.0 * bound * normal.length()
            || !is_near(ray.origin, corners, bound)
            || !ray.direction.is_finite()
        {
            return false;
        }
        let unit = self.outward(part, corners);
        let (height, rate) = (offset.dot(unit), ray.direction.dot(unit));
        let behind = rate != 0.0 && !(-height / rate > 0.0);
        let bounded = behind && height.abs() <= bound;
        bounded && ray.starts_at(nearest(ray.origin, corners), self.error)
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
            let box_ray = BoxRay::new(origin, way, &self.bvh, self.pad(ray.origin, ray.error));
            self.bvh.visit(&box_ray, f64::INFINITY, &mut NoCount, |range, t_max, _| {
                let first = range.start & (LARGE - 1);
                for packet in self.packets.get(first..first + range.len()).unwrap_or_default() {
                    for lane in lanes_of(packet.all()) {
                        let part = packet.parts[lane];
                        let corners = packet.get(lane, [0, 1, 2]);
                        let Some(passage) = line.pass_once(&corners) else { continue };
                        let falls = line.rate(&passage.normal) < 0.0;
                        out.push(Crossing { t: passage.t, part, enters: falls != self.inverted });
                    }
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
    let (a, b, c) =
        (exact(corners[0]) - point, exact(corners[1]) - point, exact(corners[2]) - point);
    let (low, high) = (a.min(b).min(c), a.max(b).max(c));
    low.max_element() <= bound && high.min_element() >= -bound
}

/// The numbers of the bits that are set.
#[inline(always)]
fn lanes_of(mut bits: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = bits.trailing_zeros() as usize % SIDE_BY_SIDE;
        (bits != 0).then(|| {
            bits &= bits - 1;
            lane
        })
    })
}

/// A ray and a mesh, to be run on some instruction set. Without `WHERE`, all that is told is whether there is a hit.
struct Cast<'a, const ANY: bool, const WHERE: bool> {
    mesh: &'a Mesh,
    ray: &'a LocalRay,
}

impl<const ANY: bool, const WHERE: bool> Job for Cast<'_, ANY, WHERE> {
    type Output = Option<Root>;

    #[inline(always)]
    unsafe fn run<T: Test>(self) -> Option<Root> {
        let Self { mesh, ray } = self;
        let (origin, direction) = (apart(&ray.origin), apart(&ray.direction));
        let single = &mesh.single;
        let error = ray.error as f32 * UP;
        // What hits may lie outside of the boxes, and rays beside what they mean; the errors of coordinates that are
        // as large as the origin's are less than what boxes have room for.
        let start = Start::new(origin, direction, &mesh.bvh, error + single.pad);
        let near = NEAR as f32 * (error + single.error);
        let certain = if ray.leaving.is_none() { 0.0 } else { CONTACT_REACH as f32 * near * UP };
        let away = start.away + single.center;
        let aim = Aim::new(&start, origin, away, (single.largest, single.edge, near), certain);
        let limit = start.ray.limit(ray.t_max);
        let across = start.direction.abs().max_element();
        let depth = (limit * (across * UP)).min(f32::MAX);
        let mut hits = Hits::<T, ANY> {
            mesh,
            ray,
            aim,
            across,
            limits: 1.0 / across * (UP * UP),
            depth,
            before: depth * LESS - TINY,
            limit,
            best: None,
            t_max: ray.t_max,
            pending: None,
            left: ray.leaving.map_or(u32::MAX, |leaving| leaving.part),
            lanes: PhantomData::<T>,
        };
        // SAFETY: the caller answers for the instruction set.
        unsafe {
            walk_tree::<T, _, _>(&mesh.bvh, &start.ray, limit, &mut NoCount, &mut hits);
        }
        match hits.pending {
            Some(_) if !WHERE => Some(Root { t: 0.0, part: 0 }),
            Some((packet, lane, _)) => hits.certain(packet, lane).or(hits.best),
            None => hits.best,
        }
    }
}

/// Covers roundings to single precision.
const UP: f32 = 1.0 + 3e-7;
/// Covers those of [`Hits::depth`] and more.
const LESS: f32 = 1.0 - 3e-6;
/// Where single precision has few digits left, nothing is certain.
const TINY: f32 = 1e-36;

/// What has been found so far.
///
/// Nearly all passages are certain in single precision, and so is which of them is the nearest: that one is
/// confirmed when the walk is over, for only its `t` must be exact. What is left out without being confirmed
/// lies behind it for certain. All else is confirmed at once.
struct Hits<'a, T: Test, const ANY: bool> {
    mesh: &'a Mesh,
    ray: &'a LocalRay,
    aim: Aim,
    /// Depths for each unit of the boxes' limit.
    across: f32,
    /// And the other way.
    limits: f32,
    /// The nearest one that is confirmed, and where it is.
    best: Option<Root>,
    t_max: f64,
    /// The nearest one that is certain and to be confirmed: packet, lane, and the depth that it lies before.
    pending: Option<(usize, usize, f32)>,
    /// What lies before this depth is nearer than both.
    before: f32,
    /// Up to which depth hits are of interest.
    depth: f32,
    /// The same for boxes.
    limit: f32,
    /// The triangle that the ray leaves.
    left: u32,
    lanes: PhantomData<T>,
}

impl<T: Test, const ANY: bool> Hits<'_, T, ANY> {
    /// Asks one triangle exactly; what it answers if it is the nearest so far.
    #[inline(always)]
    fn exact(&self, packet: usize, lane: usize) -> Option<Root> {
        let packet = self.mesh.packets.get(packet)?;
        let part = packet.parts[lane];
        let line = Line::new(self.ray.origin, self.ray.direction);
        let corners = packet.get(lane, line.axes);
        let t = self.mesh.meet(self.ray, &line, part, &corners)?;
        let is_nearest = t < self.t_max
            || (!ANY && t == self.t_max && self.best.is_none_or(|b| t < b.t || part < b.part));
        is_nearest.then_some(Root { t, part })
    }

    /// The same for one that is certainly passed ahead.
    #[inline(always)]
    fn certain(&self, packet: usize, lane: usize) -> Option<Root> {
        let line = Line::new(self.ray.origin, self.ray.direction);
        let found = self.mesh.packets.get(packet)?;
        match line.cut(&found.get(lane, line.axes)) {
            Some(t) if t < self.t_max => Some(Root { t, part: found.parts[lane] }),
            _ => self.exact(packet, lane),
        }
    }

    /// The same for one that is not certain; whether it is the nearest so far.
    #[inline(never)]
    fn confirm(&mut self, packet: usize, lane: usize, ray: &BoxRay) -> bool {
        let Some(root) = self.exact(packet, lane) else { return false };
        self.best = Some(root);
        self.t_max = root.t;
        let limit = ray.limit(root.t);
        let depth = (limit * (self.across * UP)).min(f32::MAX);
        self.before = self.before.min(depth * LESS - TINY);
        self.depth = self.depth.min(depth);
        self.limit = self.limit.min(limit);
        true
    }
}

impl<T: Test, const ANY: bool> Leaves<T, NoCount> for Hits<'_, T, ANY> {
    const ANY: bool = ANY;

    #[inline(always)]
    fn shelf(&self) -> Shelf {
        Shelf::of(&self.mesh.packets, LARGE - 1)
    }

    #[inline(always)]
    unsafe fn visit(&mut self, items: Range<usize>, ray: &BoxRay, _: &mut NoCount) -> Option<f32> {
        let margin = if items.start & LARGE == 0 { self.aim.margin } else { f32::INFINITY };
        let first = items.start & (LARGE - 1);
        for (packet, index) in self
            .mesh
            .packets
            .get(first..first + items.len())
            .unwrap_or_default()
            .iter()
            .zip(first..)
        {
            let sight = if self.aim.usable {
                // SAFETY: the caller answers for the instruction set.
                unsafe { T::triangles(packet, &self.aim, margin, self.aim.depths(self.depth)) }
            } else {
                Sight::unknown(packet.all())
            };
            for lane in lanes_of(sight.kept) {
                if sight.sure & 1 << lane != 0 {
                    let (from, to) = (sight.from[lane], sight.to[lane]);
                    if packet.parts[lane] == self.left {
                        continue;
                    }
                    if to < self.before {
                        self.pending = Some((index, lane, to));
                        if ANY {
                            return None;
                        }
                        self.before = from;
                        self.depth = to;
                        // Shorter than the minimum of numbers that may be NaN.
                        let limit = to * self.limits + f32::MIN_POSITIVE;
                        self.limit = if limit < self.limit { limit } else { self.limit };
                        continue;
                    }
                    if self.pending.is_some_and(|(_, _, end)| from > end) {
                        continue;
                    }
                }
                if self.confirm(index, lane, ray) && ANY {
                    self.pending = None;
                    return None;
                }
            }
        }
        Some(self.limit)
    }
}
