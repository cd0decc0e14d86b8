// SPDX-License-Identifier: MIT OR Apache-2.0
//! The immutable thing that rays are cast into: objects, and instances of groups of objects, each
//! level with its own tree of boxes.
//!
//! [`WorldBuilder`] makes a [`World`]; the queries are in `query`. Nothing here has a unit: all
//! tolerances come from the ray's and the surfaces' error bounds and from the rounding of the
//! transforms, so that worlds scaled or moved answer the same.

mod batch;
mod builder;
mod cast;
mod filter;
mod passages;
mod query;
mod rays;
mod surfaces;

use dioptric_math::bounds::gamma;
use dioptric_math::{DAffine3, DVec2, DVec3};

use self::filter::Filter;
use crate::bounds::Bounds;
use crate::bvh::{BoxRay, Bvh, Lanes};
use crate::plain::Plain;
use crate::ray::HitId;
use crate::shape::SurfacePoint;
use crate::shapes::AnyShape;
use crate::transform::Transform;

pub use builder::{GroupId, PlacementError, WorldBuilder};
pub use cast::each;
pub use passages::Passages;
pub use rays::{Bundle, Found, Leave, Query, Rays, Sixteen};
pub use surfaces::Surfaces;

/// Marks objects and instances without a transform.
const NO_TRANSFORM: u32 = u32::MAX;

/// A point where a ray meets a surface: what [`World::surface`] needs to work out the rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance in units of the ray's direction, at least 0.
    pub t: f64,
    /// What was hit.
    pub id: HitId,
}

impl Hit {
    /// Whether it is the one to keep: nearer, or as near and with the lower id.
    #[inline]
    pub(crate) fn comes_before(&self, other: Option<Self>) -> bool {
        other.is_none_or(|o| self.t < o.t || (self.t == o.t && self.id < o.id))
    }
}

/// Everything about one point of a surface, in the ray's space; lengths in its units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// The point, moved onto the surface.
    pub point: DVec3,
    /// A bound on the distance from `point` to the exact surface: a ray's [`crate::Ray::error`].
    pub error: f64,
    /// Unit normal of the exact surface; outward on solids, under mirror images too.
    pub normal: DVec3,
    /// Unit normal to shade with, on the same side as `normal`.
    pub shading_normal: DVec3,
    /// Surface coordinates as the shape's documentation says.
    pub uv: DVec2,
    /// Derivative of the point by u.
    pub dpdu: DVec3,
    /// Derivative of the point by v.
    pub dpdv: DVec3,
    /// The point in the object's own space, where its shape was described.
    pub local_point: DVec3,
    /// The unit normal in the object's own space.
    pub local_normal: DVec3,
}

impl From<Surface> for SurfacePoint {
    fn from(s: Surface) -> Self {
        let Surface { point, error, normal, shading_normal, .. } = s;
        Self { point, error, normal, shading_normal }
    }
}

/// A shape in its place.
#[derive(Clone, Debug)]
struct Object {
    shape: AnyShape,
    id: u32,
    transform: u32,
}

/// A group in its place.
#[derive(Clone, Debug)]
struct Instance {
    group: u32,
    id: u32,
    transform: u32,
}

/// Things with a tree over those of them that are bounded. They lie together in one array, from
/// `first`: the bounded in the tree's order, then the unbounded, then the empty ones.
#[derive(Clone, Debug)]
struct Level {
    bvh: Bvh,
    first: usize,
    bounded: usize,
    unbounded: usize,
    bounds: Bounds,
    reach: Reach,
    /// Of the bounded things in the tree's order; only of the objects outside of groups.
    filters: Vec<Filter>,
}

/// How far the numeric hits of a level's things may lie outside of their exact boxes, as
/// `gamma(256) (amplify |origin| + extent) + amplify error` for a ray.
///
/// Hits are found in the things' own spaces. An error there comes back multiplied by the transform's
/// stretch, and an error of the ray's origin goes there multiplied by its inverse's.
#[derive(Clone, Copy, Debug)]
struct Reach {
    amplify: f64,
    extent: f64,
}

impl Reach {
    const NONE: Self = Self { amplify: 1.0, extent: 0.0 };

    /// The worst of both; NaN is the very worst.
    fn or(self, other: Self) -> Self {
        let worse =
            |a: f64, b: f64| if a.is_nan() || b.is_nan() { f64::INFINITY } else { a.max(b) };
        Self {
            amplify: worse(self.amplify, other.amplify),
            extent: worse(self.extent, other.extent),
        }
    }

    fn pad(&self, origin: DVec3, error: f64) -> f64 {
        gamma(256) * (self.amplify * origin.abs().max_element() + self.extent)
            + self.amplify * error
    }
}

impl Level {
    fn box_ray(&self, origin: DVec3, direction: DVec3, error: f64) -> BoxRay {
        BoxRay::new(origin, direction, &self.bvh, self.reach.pad(origin, error))
    }
}

/// Objects and instances, ready to be hit.
#[derive(Clone, Debug)]
pub struct World {
    /// The objects of all groups; those outside of groups first.
    objects: Vec<Object>,
    /// Where the object with an id is in `objects`.
    place_of: Vec<u32>,
    transforms: Vec<Transform>,
    /// Level 0 holds the objects outside of groups, level `i` those of group `i - 1`.
    levels: Vec<Level>,
    instances: Vec<Instance>,
    instance_place_of: Vec<u32>,
    instance_level: Level,
}

impl World {
    /// A box around everything; infinite where something is.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        self.levels
            .first()
            .map_or(Bounds::EMPTY, |top| top.bounds)
            .union(self.instance_level.bounds)
    }

    /// The number of objects in all groups. Their ids are `0 .. object_count`.
    #[must_use]
    pub fn object_count(&self) -> usize {
        self.objects.len()
    }

    /// The number of instances. Their ids are `0 .. instance_count`.
    #[must_use]
    pub fn instance_count(&self) -> usize {
        self.instances.len()
    }

    /// The shape of an object.
    #[must_use]
    pub fn shape(&self, object: u32) -> Option<&AnyShape> {
        self.object(object).map(|o| &o.shape)
    }

    /// The surface of an object outside of groups, if it is a rectangle or a ball that lies as it was described.
    #[must_use]
    pub fn plain(&self, object: u32) -> Option<Plain> {
        let found = self.object(object).filter(|found| found.transform == NO_TRANSFORM)?;
        match &found.shape {
            AnyShape::Rectangle(shape) if !self.is_in_group(object) => Some(shape.plain()),
            AnyShape::Sphere(shape) if !self.is_in_group(object) => Some(shape.plain()),
            _ => None,
        }
    }

    /// Whether an object belongs to a group, whose instances show it: no hit of it is without an instance.
    #[must_use]
    pub fn is_in_group(&self, object: u32) -> bool {
        let first = self.levels.get(1).map_or(usize::MAX, |level| level.first);
        self.place_of.get(object as usize).is_some_and(|&place| place as usize >= first)
    }

    /// The matrix from an object's own space to the space of rays; `None` where the hit is not of this
    /// world.
    #[must_use]
    pub fn object_to_ray(&self, id: HitId) -> Option<DAffine3> {
        let matrix =
            |index: u32| self.transform(index).map_or(DAffine3::IDENTITY, |t| *t.to_world());
        let object = matrix(self.object(id.object)?.transform);
        match id.instance {
            HitId::NO_INSTANCE => Some(object),
            instance => Some(matrix(self.instance(instance)?.transform) * object),
        }
    }

    /// Bytes on the heap, without what is inside of combinations and polygons.
    #[must_use]
    pub fn memory_bytes(&self) -> usize {
        let levels = self.levels.iter().chain([&self.instance_level]);
        self.objects.capacity() * size_of::<Object>()
            + (self.place_of.capacity() + self.instance_place_of.capacity()) * size_of::<u32>()
            + self.transforms.capacity() * size_of::<Transform>()
            + self.instances.capacity() * size_of::<Instance>()
            + self.levels.capacity() * size_of::<Level>()
            + levels
                .map(|level| {
                    level.bvh.memory_bytes() + level.filters.capacity() * size_of::<Filter>()
                })
                .sum::<usize>()
            + self.objects.iter().map(|o| o.shape.memory_bytes()).sum::<usize>()
    }

    /// Runs the queries on these instructions, or the best below them that there are: for tests.
    #[doc(hidden)]
    pub fn use_lanes(&mut self, lanes: Lanes) {
        for level in self.levels.iter_mut().chain([&mut self.instance_level]) {
            level.bvh.use_lanes(lanes);
        }
    }

    fn object(&self, id: u32) -> Option<&Object> {
        self.objects.get(*self.place_of.get(id as usize)? as usize)
    }

    fn instance(&self, id: u32) -> Option<&Instance> {
        self.instances.get(*self.instance_place_of.get(id as usize)? as usize)
    }

    fn transform(&self, index: u32) -> Option<&Transform> {
        self.transforms.get(index as usize)
    }
}
