// SPDX-License-Identifier: MIT OR Apache-2.0
//! Pools: a million things of one kind (atoms, bonds, thorns) as one shape, with a tree of their own.
//!
//! Each is the exact shape that it is alone, and each is a surface of its own: a pool is not solid, even
//! where what is in it is.

use dioptric_math::DVec3;

use crate::bounds::Bounds;
use crate::bvh::{BoxRay, Bvh, NoCount};
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

/// Coordinates of things in a pool are smaller.
const LARGEST: f64 = 1e30;

/// What can be in a pool.
pub trait Pooled: Shape + Clone + Send + Sync {
    /// How many bits of a pool's part are the thing's own part.
    const PART_BITS: u32;
}

impl Pooled for Sphere {
    const PART_BITS: u32 = 0;
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
    bvh: Bvh,
    bounds: Bounds,
}

impl<S: Pooled> Pool<S> {
    /// Builds the tree over some things; those whose boxes are empty or reach beyond 10^30 are left out. `None` where there are more than parts can number (2^32, or 2^30 of those with parts).
    ///
    /// Uses the pool of threads that it is called in, if any; the result is the same for any number.
    #[must_use]
    pub fn new(given: Vec<S>) -> Option<Self> {
        if given.len() as u64 > 1 << (32 - S::PART_BITS) {
            return None;
        }
        let mut bounds = Bounds::EMPTY;
        for b in given.iter().map(Shape::bounds) {
            let largest = b.min.abs().max(b.max.abs()).max_element();
            if largest < LARGEST && !b.is_empty() {
                bounds = bounds.union(b);
            }
        }
        let center = if bounds.is_empty() { DVec3::ZERO } else { bounds.center() };
        let kept: Vec<u32> = (0..given.len() as u32)
            .filter(|&i| {
                let b = given.get(i as usize).map_or(Bounds::EMPTY, Shape::bounds);
                b.union(bounds) == bounds && Bvh::can_hold(&b, center)
            })
            .collect();
        let boxes =
            kept.iter().map(|&i| given.get(i as usize).map_or(Bounds::EMPTY, Shape::bounds));
        let (bvh, order) = Bvh::build(boxes, center);
        let index_of: Vec<u32> =
            order.iter().filter_map(|&i| kept.get(i as usize).copied()).collect();
        let mut place_of = vec![u32::MAX; given.len()];
        for (&index, place) in index_of.iter().zip(0..) {
            if let Some(slot) = place_of.get_mut(index as usize) {
                *slot = place;
            }
        }
        let items = index_of.iter().filter_map(|&i| given.get(i as usize).cloned()).collect();
        Some(Self { items, index_of, place_of, bvh, bounds })
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
            let surface = item.surface(ray.at(root.t), root.part);
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
        let mut best: Option<Root> = None;
        let largest = ray.origin.abs().max_element();
        let pad = ray.error + dioptric_math::bounds::gamma(256) * largest;
        let box_ray = BoxRay::new(ray.origin, ray.direction, &self.bvh, pad);
        self.bvh.visit(&box_ray, ray.t_max, &mut NoCount, |range, t_max, _| {
            let mut local = LocalRay { t_max, ..*ray };
            for place in range {
                if let Some(root) = self.meet(&local, place)
                    && best.is_none_or(|b| root.t < b.t || (root.t == b.t && root.part < b.part))
                {
                    best = Some(root);
                    local.t_max = root.t;
                }
            }
            Some(local.t_max)
        });
        best
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
            + (self.index_of.capacity() + self.place_of.capacity()) * size_of::<u32>()
    }
}
