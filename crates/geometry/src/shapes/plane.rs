// SPDX-License-Identifier: MIT OR Apache-2.0
//! The infinite plane; as a solid, the half space below it.

use dioptric_math::bounds::gamma;
use dioptric_math::{DVec2, DVec3, normalize};
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::convex::{plane_root, root};
use super::frame::around;
use crate::bounds::Bounds;
use crate::ray::LocalRay;
use crate::shape::{Crossing, Described, LocalSurface, Root, Shape};

/// A plane through a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    point: DVec3,
    normal: DVec3,
}

static SCHEMA: Schema = Schema {
    kind: "plane",
    category: Category::Shape,
    summary: "an infinite plane",
    doc: "All points `p` with `(p - point) . normal = 0`. As a solid (in `union`, `difference` and their \
          like, and as a medium) it is the half space behind the normal, so a line crosses it once.\n\n\
          `uv`: distances from `point` along two tangents, in the plane's own units and without limits. With the \
          normal +y, u runs along +x and v along -z; with +z, u along +x and v along +y; other normals turn \
          these directions by the smallest rotation from +y.",
    params: &[
        Param::new("point", Type::Vec3, Default::Vec3([0.0; 3]), "A point of the plane."),
        Param::new(
            "normal",
            Type::Direction,
            Default::Vec3([0.0, 1.0, 0.0]),
            "The direction away from the solid half; of any length.",
        ),
    ],
    example: "plane(point = (0, -1, 0), material = matte(checker(\"white\", \"slategray\", size = 1)))\n\
              sphere(center = (0, 0, 0), radius = 1, material = matte(\"tomato\"))",
};

impl Plane {
    /// A plane; `None` where the normal is zero or not finite.
    #[must_use]
    pub fn new(point: DVec3, normal: DVec3) -> Option<Self> {
        Some(Self { point, normal: normalize(normal)? })
    }

    /// Rounding of the height of a point at `offset` from [`Self::point`].
    fn error(&self, offset: DVec3) -> f64 {
        gamma(8) * (self.point.abs().max_element() + offset.abs().max_element())
    }
}

impl Described for Plane {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args) -> Result<Self, Diagnostic> {
        Self::new(args.vec3("point")?.into(), args.vec3("normal")?.into()).ok_or_else(|| {
            args.error("normal", "wrong-value", "normal of plane: too large to be a direction")
                .help("write a vector of ordinary length, such as (0, 1, 0)")
        })
    }
}

impl Shape for Plane {
    fn bounds(&self) -> Bounds {
        // A normal along an axis bounds the half space on one side.
        let mut bounds = Bounds::EVERYTHING;
        for axis in 0..3 {
            if self.normal[axis] == 1.0 {
                bounds.max[axis] = self.point[axis];
            } else if self.normal[axis] == -1.0 {
                bounds.min[axis] = self.point[axis];
            }
        }
        bounds
    }

    fn is_solid(&self) -> bool {
        true
    }

    fn is_convex(&self) -> bool {
        true
    }

    fn intersect(&self, ray: &LocalRay) -> Option<Root> {
        if ray.leaving.is_some() {
            return None;
        }
        let offset = ray.origin - self.point;
        let (height, rate) = (offset.dot(self.normal), ray.direction.dot(self.normal));
        let t = plane_root(ray, height, rate, self.error(offset))?;
        root(ray, t, 0)
    }

    fn crossings(&self, ray: &LocalRay, out: &mut Vec<Crossing>) {
        let rate = ray.direction.dot(self.normal);
        let t = -(ray.origin - self.point).dot(self.normal) / rate;
        if ray.at(t).is_finite() {
            out.push(Crossing { t, part: 0, enters: rate < 0.0 });
        }
    }

    fn surface(&self, point: DVec3, _part: u32) -> LocalSurface {
        let normal = self.normal;
        let offset = point - self.point;
        let offset = offset - normal * offset.dot(normal);
        let (x, z) = around(normal);
        LocalSurface {
            point: self.point + offset,
            error: self.error(offset),
            normal,
            shading_normal: normal,
            uv: DVec2::new(offset.dot(x), -offset.dot(z)),
            dpdu: x,
            dpdv: -z,
        }
    }
}
