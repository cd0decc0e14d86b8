// SPDX-License-Identifier: MIT OR Apache-2.0
//! Pools: a million things of one kind (atoms, bonds, thorns) as one shape, with a tree of their own.
//!
//! Each is the exact shape that it is alone, and each is a surface of its own: a pool is not solid, even
//! where what is in it is.

#![allow(unsafe_code)]

mod build;

use std::marker::PhantomData;
use std::ops::Range;

use dioptric_math::DVec3;
use dioptric_math::bounds::gamma;

use crate::bounds::Bounds;
use crate::bvh::balls::{BALLS, BallRay, Balls};
use crate::bvh::lanes::{Job, Test, apart};
use crate::bvh::ray::Start;
use crate::bvh::traverse::{Leaves, Shelf, fetch_line, walk_tree};
use crate::bvh::triangles::Sight;
use crate::bvh::{BoxRay, Bvh, Lanes, NoCount};
use crate::ray::{Leaving, LocalRay};
use crate::shape::{Crossing, LocalSurface, Root, Shape, SurfacePoint};
use crate::shapes::cone::Cone;
use crate::shapes::cylinder::Cylinder;
use crate::shapes::sphere::Sphere;

/// Many spheres. The part is the index of the sphere.
pub type Spheres = Pool<Sphere>;
/// Many cylinders. The part is 4 times the index of the cylinder, plus its own part (0 side, 1 base, 2 top).
pub type Cylinders = Pool<Cylinder>;
/// Many cones. The part is 4 times the index of the cone, plus its own part (0 side, 1 base, 2 top).
pub type Cones = Pool<Cone>;

/// What can be in a pool.
pub trait Pooled: Shape + Clone + Send + Sync {
    /// How many bits of a pool's part are the thing's own part.
    const PART_BITS: u32;

    /// Centre and radius of the ball that the thing is, if it is one: then single precision turns away most rays, and
    /// knows most hits.
    fn ball(&self) -> Option<(DVec3, f64)> {
        None
    }
}

impl Pooled for Sphere {
    const PART_BITS: u32 = 0;

    fn ball(&self) -> Option<(DVec3, f64)> {
        Some((self.center(), self.radius()))
    }
}

impl Pooled for Cylinder {
    const PART_BITS: u32 = 2;
}

impl Pooled for Cone {
    const PART_BITS: u32 = 2;
}

/// Many things of one kind, ready to be hit.
#[derive(Clone, Debug)]
pub struct Pool<S> {
    /// In the order of the tree's leaves.
    items: Vec<S>,
    /// The index that each of `items` was given with.
    index_of: Vec<u32>,
    /// Where in `items` each given thing is.
    place_of: Vec<u32>,
    /// Balls around the items, where they have some; then leaves are ranges of these packets, else of items.
    balls: Vec<Balls>,
    bvh: Bvh,
    bounds: Bounds,
    /// The largest coordinate.
    largest: f64,
}

impl<S: Pooled> Pool<S> {
    /// Runs the queries on these instructions, or the best below them that there are: for tests.
    #[doc(hidden)]
    pub fn use_lanes(&mut self, lanes: Lanes) {
        self.bvh.use_lanes(lanes);
    }

    /// How many there are, those that were left out included.
    #[must_use]
    pub fn len(&self) -> usize {
        self.place_of.len()
    }

    /// Whether there is nothing.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.place_of.is_empty()
    }

    /// The thing with an index; `None` for those that were left out.
    #[must_use]
    pub fn get(&self, index: u32) -> Option<&S> {
        self.items.get(*self.place_of.get(index as usize)? as usize)
    }

    /// Whether there is any hit with `t` in `[0, ray.t_max)`, as [`Shape::blocks`] has it, but sooner: what is certain is
    /// not looked at again.
    #[must_use]
    pub fn hides(&self, ray: &LocalRay) -> bool {
        // SAFETY: a tree's instruction set is one that the processor has.
        unsafe { self.bvh.lanes().run(Cast::<S, true, false> { pool: self, ray }) }.is_some()
    }

    /// The thing that a part belongs to; another one for parts of nothing.
    fn of_part(&self, part: u32) -> Option<&S> {
        self.get(part >> S::PART_BITS).or_else(|| self.items.first())
    }

    /// The part of the thing at a place that has this part itself.
    fn part(&self, place: usize, own: u32) -> u32 {
        self.index_of.get(place).map_or(0, |index| index << S::PART_BITS | own)
    }

    /// The nearest hit of one thing by a ray that leaves a point of another one, if any of this pool:
    /// surfaces within the error of the origin are passed.
    #[inline(always)]
    fn meet(&self, ray: &LocalRay, place: usize) -> Option<Root> {
        let item = self.items.get(place)?;
        let Some(leaving) = ray.leaving else {
            let root = item.intersect(ray)?;
            return Some(Root { t: root.t, part: self.part(place, root.part) });
        };
        let own = leaving.part & ((1 << S::PART_BITS) - 1);
        let root = if self.part(place, own) == leaving.part {
            item.intersect(&LocalRay { leaving: Some(Leaving { part: own, ..leaving }), ..*ray })?
        } else {
            let alone = LocalRay { leaving: None, ..*ray };
            let root = item.intersect(&alone)?;
            let surface = item.surface_point(ray.at(root.t), root.part);
            if root.t * ray.direction.length() > ray.error + surface.error {
                root
            } else {
                let outward = ray.direction.dot(surface.normal) > 0.0;
                let passed = Some(Leaving { part: root.part, outward });
                item.intersect(&LocalRay { leaving: passed, ..*ray })?
            }
        };
        Some(Root { t: root.t, part: self.part(place, root.part) })
    }
}

impl<S: Pooled> Shape for Pool<S> {
    fn bounds(&self) -> Bounds {
        self.bounds
    }

    fn is_solid(&self) -> bool {
        false
    }

    fn is_convex(&self) -> bool {
        false
    }

    fn intersect(&self, ray: &LocalRay) -> Option<Root> {
        // SAFETY: a tree's instruction set is one that the processor has.
        unsafe { self.bvh.lanes().run(Cast::<S, false, true> { pool: self, ray }) }
    }

    fn blocks(&self, ray: &LocalRay) -> Option<Root> {
        // SAFETY: as above.
        unsafe { self.bvh.lanes().run(Cast::<S, true, true> { pool: self, ray }) }
    }

    fn crossings(&self, _ray: &LocalRay, _out: &mut Vec<Crossing>) {}

    fn surface(&self, point: DVec3, part: u32) -> LocalSurface {
        let own = part & ((1 << S::PART_BITS) - 1);
        match self.of_part(part) {
            Some(item) => item.surface(point, own),
            None => Sphere::new(point, 0.0).surface(point, 0),
        }
    }

    fn surface_point(&self, point: DVec3, part: u32) -> SurfacePoint {
        let own = part & ((1 << S::PART_BITS) - 1);
        match self.of_part(part) {
            Some(item) => item.surface_point(point, own),
            None => Sphere::new(point, 0.0).surface_point(point, 0),
        }
    }

    fn memory_bytes(&self) -> usize {
        self.bvh.memory_bytes()
            + self.items.capacity() * size_of::<S>()
            + self.balls.capacity() * size_of::<Balls>()
            + (self.index_of.capacity() + self.place_of.capacity()) * size_of::<u32>()
    }
}

/// A ray and a pool, to be run on some instruction set. Without `WHERE`, all that is told is whether there is a hit.
struct Cast<'a, S, const ANY: bool, const WHERE: bool> {
    pool: &'a Pool<S>,
    ray: &'a LocalRay,
}

impl<S: Pooled, const ANY: bool, const WHERE: bool> Job for Cast<'_, S, ANY, WHERE> {
    type Output = Option<Root>;

    #[inline(always)]
    unsafe fn run<T: Test>(self) -> Option<Root> {
        let Self { pool, ray } = self;
        let (origin, direction) = (apart(&ray.origin), apart(&ray.direction));
        let pad = ray.error + gamma(256) * (origin.abs().max_element() + pool.largest);
        let pad = pad as f32 * UP;
        let start = Start::new(origin, direction, &pool.bvh, pad);
        let ball_ray = BallRay::new(&start, pool.bvh.extent() as f32, pad);
        let limit = start.ray.limit(ray.t_max);
        let mut hits = Hits::<S, T, ANY> {
            pool,
            ray,
            ball_ray,
            best: None,
            t_max: ray.t_max,
            pending: None,
            before: limit * LESS - TINY,
            limit,
            lanes: PhantomData::<T>,
        };
        // SAFETY: the caller answers for the instruction set.
        unsafe { walk_tree::<T, _, _>(&pool.bvh, &start.ray, limit, &mut NoCount, &mut hits) };
        match hits.pending {
            // One that the ray may leave must be asked.
            Some(_) if !WHERE && ray.leaving.is_none() => Some(Root { t: 0.0, part: 0 }),
            Some((place, _)) => hits.exact(place).or(hits.best),
            None => hits.best,
        }
    }
}

/// Covers roundings to single precision.
const UP: f32 = 1.0 + 3e-7;
/// Covers those of [`BoxRay::limit`] and more.
const LESS: f32 = 1.0 - 3e-6;
/// Where single precision has few digits left, nothing is certain.
const TINY: f32 = 1e-36;

/// What has been found so far, as for meshes: which ball is the nearest is nearly always certain in single precision,
/// and that one is asked when the walk is over.
struct Hits<'a, S, T, const ANY: bool> {
    pool: &'a Pool<S>,
    ray: &'a LocalRay,
    ball_ray: BallRay,
    /// The nearest one that was asked, and where it is hit.
    best: Option<Root>,
    t_max: f64,
    /// The nearest one that is certain and to be asked: its place, and before what limit it is hit.
    pending: Option<(usize, f32)>,
    /// What is hit before this limit is nearer than both.
    before: f32,
    /// Up to which limit hits are of interest.
    limit: f32,
    lanes: PhantomData<T>,
}

impl<S: Pooled, T, const ANY: bool> Hits<'_, S, T, ANY> {
    /// Asks one thing; what it answers if that is the nearest so far.
    #[inline(always)]
    fn exact(&self, place: usize) -> Option<Root> {
        let root = self.pool.meet(self.ray, place)?;
        let is_nearest = root.t < self.t_max
            || (!ANY
                && root.t == self.t_max
                && self.best.is_none_or(|b| root.t < b.t || root.part < b.part));
        is_nearest.then_some(root)
    }

    /// The same at once; `None` to end the walk.
    #[inline(always)]
    fn ask(&mut self, place: usize, ray: &BoxRay) -> Option<()> {
        let Some(root) = self.exact(place) else { return Some(()) };
        self.best = Some(root);
        self.t_max = root.t;
        if ANY {
            self.pending = None;
            return None;
        }
        let limit = ray.limit(root.t);
        self.before = self.before.min(limit * LESS - TINY);
        self.limit = self.limit.min(limit);
        Some(())
    }
}

impl<S: Pooled, T: Test, const ANY: bool> Leaves<T, NoCount> for Hits<'_, S, T, ANY> {
    const ANY: bool = ANY;

    #[inline(always)]
    fn shelf(&self) -> Shelf {
        if self.pool.balls.is_empty() {
            Shelf::of(&self.pool.items, Bvh::MAX_ITEMS - 1)
        } else {
            Shelf::of(&self.pool.balls, Bvh::MAX_ITEMS - 1)
        }
    }

    #[inline(always)]
    unsafe fn visit(&mut self, items: Range<usize>, ray: &BoxRay, _: &mut NoCount) -> Option<f32> {
        let pool = self.pool;
        if pool.balls.is_empty() {
            for place in items {
                self.ask(place, ray)?;
            }
            return Some(self.limit);
        }
        for balls in pool.balls.get(items).unwrap_or_default() {
            let sight = if self.ball_ray.usable {
                // SAFETY: the caller answers for the instruction set.
                unsafe { T::balls(balls, &self.ball_ray, self.limit) }
            } else {
                let all = |all, i| all | u32::from(!f32::is_nan(balls.radii[i])) << i;
                Sight::unknown((0..BALLS).fold(0, all))
            };
            let mut kept = sight.kept;
            while kept != 0 {
                let lane = kept.trailing_zeros() as usize % BALLS;
                kept &= kept - 1;
                let place = balls.first as usize + lane;
                if sight.sure & 1 << lane != 0 {
                    let (from, to) = (sight.from[lane], sight.to[lane]);
                    if to < self.before {
                        fetch_line(pool.items.as_ptr().wrapping_add(place).cast());
                        fetch_line(pool.index_of.as_ptr().wrapping_add(place).cast());
                        self.pending = Some((place, to));
                        if ANY {
                            return None;
                        }
                        self.before = from;
                        self.limit = to;
                        continue;
                    }
                    if self.pending.is_some_and(|(_, end)| from > end) {
                        continue;
                    }
                }
                self.ask(place, ray)?;
            }
        }
        Some(self.limit)
    }
}
