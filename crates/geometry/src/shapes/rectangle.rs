// SPDX-License-Identifier: MIT OR Apache-2.0
//! The rectangle, or any parallelogram: a corner and two edges.

use dioptric_math::bounds::gamma;
use dioptric_math::{DVec2, DVec3, normalize};
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::convex::{plane_root, root};
use crate::bounds::Bounds;
use crate::plain::Plain;
use crate::ray::LocalRay;
use crate::shape::{Crossing, Described, LocalSurface, Root, Shape, SurfacePoint};

/// A flat parallelogram, hit from both sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rectangle {
    corner: DVec3,
    edge_u: DVec3,
    edge_v: DVec3,
    normal: DVec3,
    /// `dual_u . edge_u = 1` and `dual_u . edge_v = 0`: the product with an offset from the corner is u.
    dual_u: DVec3,
    dual_v: DVec3,
    error: f64,
}

static SCHEMA: Schema = Schema {
    kind: "rectangle",
    category: Category::Shape,
    summary: "a flat rectangle or parallelogram",
    doc: "All points `corner + u edge_u + v edge_v` with u and v from 0 to 1. The edges need not be at right angles. \
          The normal is `edge_u x edge_v`: a picture on the rectangle is upright for who sees `edge_u` point to the \
          right and `edge_v` upwards. Not solid.\n\n\
          `uv`: the u and v of the formula.",
    params: &[
        Param::new(
            "corner",
            Type::Vec3,
            Default::Vec3([0.0; 3]),
            "The corner where u and v are 0.",
        ),
        Param::new(
            "edge_u",
            Type::Direction,
            Default::Vec3([1.0, 0.0, 0.0]),
            "From the corner along u, as long as the edge.",
        ),
        Param::new(
            "edge_v",
            Type::Direction,
            Default::Vec3([0.0, 1.0, 0.0]),
            "From the corner along v, as long as the edge.",
        ),
    ],
    example: "rectangle(corner = (-1, 0, 0), edge_u = (2, 0, 0), edge_v = (0, 1.5, 0), material = matte(\"tomato\"))",
};

impl Rectangle {
    /// A parallelogram; `None` where the edges are parallel, zero or not finite.
    #[must_use]
    pub fn new(corner: DVec3, edge_u: DVec3, edge_v: DVec3) -> Option<Self> {
        let (eu, ev) = (normalize(edge_u)?, normalize(edge_v)?);
        let cross = eu.cross(ev);
        // The sine of the angle between the edges: below this, rounding alone decides the normal.
        let sine = cross.length();
        if !(sine > 1e-9) {
            return None;
        }
        let normal = cross / sine;
        let dual_u = ev.cross(normal) / (sine * edge_u.length());
        let dual_v = normal.cross(eu) / (sine * edge_v.length());
        let scale = corner.abs() + edge_u.abs() + edge_v.abs();
        let error = gamma(16) * scale.max_element() / sine;
        let all = [corner, edge_u, edge_v, dual_u, dual_v];
        all.iter().all(|v| v.is_finite()).then_some(Self {
            corner,
            edge_u,
            edge_v,
            normal,
            dual_u,
            dual_v,
            error,
        })
    }

    /// The corner where u and v are 0, and the edges along u and v.
    #[must_use]
    pub const fn corner_and_edges(&self) -> (DVec3, [DVec3; 2]) {
        (self.corner, [self.edge_u, self.edge_v])
    }
}

impl Rectangle {
    /// Its numbers.
    pub(crate) fn plain(&self) -> Plain {
        let Self { corner: base, edge_u, edge_v, dual_u, dual_v, normal, error } = *self;
        let (edges, duals) = ([edge_u, edge_v], [dual_u, dual_v]);
        Plain { base, edges, duals, normal, radius: 0.0, error }
    }

    /// A point and the normal of its plane, and the corners in turn.
    pub(crate) fn flat(&self) -> ((DVec3, DVec3), [DVec3; 4]) {
        let (c, u, v) = (self.corner, self.edge_u, self.edge_v);
        ((c, self.normal), [c, c + u, c + u + v, c + v])
    }
}

impl Described for Rectangle {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args) -> Result<Self, Diagnostic> {
        let [corner, u, v] = [args.vec3("corner")?, args.vec3("edge_u")?, args.vec3("edge_v")?];
        Self::new(corner.into(), u.into(), v.into()).ok_or_else(|| {
            args.error("edge_v", "flat-shape", "edge_u and edge_v of the rectangle are parallel")
                .help(
                    "let edge_v point another way than edge_u, such as (0, 1, 0) beside (1, 0, 0)",
                )
        })
    }
}

impl Shape for Rectangle {
    fn bounds(&self) -> Bounds {
        let [c, u, v] = [self.corner, self.edge_u, self.edge_v];
        let tight = Bounds::of([c, c + u, c + v, c + u + v]);
        Bounds { min: tight.min - self.error, max: tight.max + self.error }
    }

    fn is_solid(&self) -> bool {
        false
    }

    fn is_convex(&self) -> bool {
        true
    }

    fn intersect(&self, ray: &LocalRay) -> Option<Root> {
        if ray.leaving.is_some() {
            return None;
        }
        let offset = ray.origin - self.corner;
        let (height, rate) = (offset.dot(self.normal), ray.direction.dot(self.normal));
        let t = plane_root(ray, height, rate, self.error)?;
        let p = offset + ray.direction * t;
        let unit = 0.0..=1.0;
        if unit.contains(&p.dot(self.dual_u)) && unit.contains(&p.dot(self.dual_v)) {
            root(ray, t, 0)
        } else {
            None
        }
    }

    fn crossings(&self, _ray: &LocalRay, _out: &mut Vec<Crossing>) {}

    #[inline(always)]
    fn surface_point(&self, point: DVec3, part: u32) -> SurfacePoint {
        self.surface(point, part).into()
    }

    #[inline(always)]
    fn surface(&self, point: DVec3, _part: u32) -> LocalSurface {
        let offset = point - self.corner;
        let uv = DVec2::new(offset.dot(self.dual_u), offset.dot(self.dual_v))
            .clamp(DVec2::ZERO, DVec2::ONE);
        LocalSurface {
            point: self.corner + (self.edge_u * uv.x + self.edge_v * uv.y),
            error: self.error,
            normal: self.normal,
            shading_normal: self.normal,
            uv,
            dpdu: self.edge_u,
            dpdv: self.edge_v,
        }
    }
}
