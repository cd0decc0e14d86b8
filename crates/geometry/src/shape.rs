// SPDX-License-Identifier: MIT OR Apache-2.0
//! What a shape must be able to answer. One file in `shapes/` per shape implements this and adds
//! one line to the registry there.

use dioptric_math::{DVec2, DVec3};
use dioptric_scene::{Args, Diagnostic, Schema};

use crate::bounds::Bounds;
use crate::ray::LocalRay;

/// The cheap answer: how far, and on which part. Everything else is worked out once, for the nearest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Root {
    /// Distance in units of the ray's direction, at least 0.
    pub t: f64,
    /// The part that is hit.
    pub part: u32,
}

/// One passage of the whole line (negative `t` too) through a solid's surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// Distance in units of the ray's direction.
    pub t: f64,
    /// The part that is crossed.
    pub part: u32,
    /// Whether the line goes into the solid here.
    pub enters: bool,
}

/// Everything about one point of a surface, in the shape's space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocalSurface {
    /// The point, moved onto the surface.
    pub point: DVec3,
    /// A bound on the distance from `point` to the exact surface.
    pub error: f64,
    /// Unit normal of the exact surface; outward on solids.
    pub normal: DVec3,
    /// Unit normal to shade with; differs from `normal` on triangles with vertex normals.
    pub shading_normal: DVec3,
    /// Surface coordinates, each shape's documentation says which; usually in `[0, 1]`.
    pub uv: DVec2,
    /// Derivative of the point by u.
    pub dpdu: DVec3,
    /// Derivative of the point by v.
    pub dpdv: DVec3,
}

/// What most shading needs of a point of a surface: [`LocalSurface`] without coordinates, which cost more
/// than all the rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// The point, moved onto the surface.
    pub point: DVec3,
    /// A bound on the distance from `point` to the exact surface.
    pub error: f64,
    /// Unit normal of the exact surface; outward on solids.
    pub normal: DVec3,
    /// Unit normal to shade with; differs from `normal` on triangles with vertex normals.
    pub shading_normal: DVec3,
}

impl From<LocalSurface> for SurfacePoint {
    #[inline(always)]
    fn from(s: LocalSurface) -> Self {
        let LocalSurface { point, error, normal, shading_normal, .. } = s;
        Self { point, error, normal, shading_normal }
    }
}

/// A shape that rays can hit.
///
/// Rules that the batteries of tests hold every shape to:
/// - `intersect` returns the nearest acceptable root. A root of a surface that is not being left is
///   judged as by [`LocalRay::accept`] and [`LocalRay::starts_at`]. Where [`LocalRay::leaving`] is set, the point being left is no
///   hit: on a convex closed solid an outward ray hits nothing and an inward one the far side; on a
///   plane part nothing of that part; on a quadric part the other root, `-2 b / a` (the equation
///   with its constant term set to the exact 0); on higher surfaces the deflated polynomial's roots.
///   Other parts of the same shape need `t` beyond the error bound.
/// - No constant in scene units: shapes scaled by 1e-6 or 1e6 behave the same.
/// - Hits come from inside as well as from outside.
pub trait Shape {
    /// A box around the shape; infinite where the shape is.
    fn bounds(&self) -> Bounds;

    /// Whether the shape is closed: has an inside, and `crossings` that alternate.
    fn is_solid(&self) -> bool;

    /// Whether a straight line crosses the shape's surface at most twice.
    fn is_convex(&self) -> bool;

    /// The nearest hit with `t` in `[0, ray.t_max]`.
    fn intersect(&self, ray: &LocalRay) -> Option<Root>;

    /// Any hit with `t` in `[0, ray.t_max)`, where that is found sooner than the nearest one.
    fn blocks(&self, ray: &LocalRay) -> Option<Root> {
        self.intersect(ray).filter(|root| root.t < ray.t_max)
    }

    /// Appends all crossings of the whole line, `-inf < t < inf`, sorted by `t`, alternately entering
    /// and leaving; ignores `error`, `t_max` and `leaving`. Nothing for shapes that are not solid.
    fn crossings(&self, ray: &LocalRay, out: &mut Vec<Crossing>);

    /// The surface at a point that a root gave; `part` is the root's.
    fn surface(&self, point: DVec3, part: u32) -> LocalSurface;

    /// The same without coordinates, to the last bit.
    fn surface_point(&self, point: DVec3, part: u32) -> SurfacePoint {
        self.surface(point, part).into()
    }

    /// Bytes that the shape keeps on the heap, where that is much: meshes and pools.
    fn memory_bytes(&self) -> usize {
        0
    }
}

/// A shape that a scene can write by itself, with numbers alone: what the registry needs to know of it.
/// (Meshes and pools are made from files and lists; whoever reads those makes the shape.)
pub trait Described: Shape + Sized {
    /// The shape's manual page and parameters.
    const SCHEMA: &'static Schema;

    /// Builds the shape from checked arguments.
    ///
    /// # Errors
    /// The arguments do not make a shape (zero height, collinear corners, ...).
    fn from_args(args: &Args) -> Result<Self, Diagnostic>;
}
