// SPDX-License-Identifier: MIT OR Apache-2.0
//! The flat disc, with or without a hole.

use dioptric_math::bounds::gamma;
use dioptric_math::{DVec2, DVec3, normalize};
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::convex::{plane_root, root};
use super::frame::around;
use crate::bounds::Bounds;
use crate::ray::LocalRay;
use crate::shape::{Crossing, Described, LocalSurface, Root, Shape};

/// All points of a plane between two circles around one centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc {
    center: DVec3,
    normal: DVec3,
    radius: f64,
    inner_radius: f64,
}

static SCHEMA: Schema = Schema {
    kind: "disc",
    category: Category::Shape,
    summary: "a flat disc, or a ring",
    doc: "All points of the plane through `center` that are at least `inner_radius` and at most `radius` away from it. \
          Not solid; hit from both sides.\n\n\
          `uv`: the square around the disc, 0 to 1, with 0.5 at the centre. With the normal +y, u runs along +x and v \
          along -z; with +z, u along +x and v along +y; other normals turn these directions by the smallest \
          rotation from +y.",
    params: &[
        Param::new("center", Type::Vec3, Default::Vec3([0.0; 3]), "The middle."),
        Param::new(
            "normal",
            Type::Direction,
            Default::Vec3([0.0, 1.0, 0.0]),
            "The direction that the disc faces; of any length.",
        ),
        Param::new("radius", Type::Positive, Default::Number(1.0), "Radius of the rim."),
        Param::new(
            "inner_radius",
            Type::NON_NEGATIVE,
            Default::Number(0.0),
            "Radius of the hole; below `radius`.",
        ),
    ],
    example: "disc(center = (0, 1, 0), normal = (0, 1, 2), radius = 1, inner_radius = 0.4, material = matte(\"tomato\"))",
};

impl Disc {
    /// A disc; `None` where the normal is no direction.
    #[must_use]
    pub fn new(center: DVec3, normal: DVec3, radius: f64, inner_radius: f64) -> Option<Self> {
        Some(Self { center, normal: normalize(normal)?, radius, inner_radius })
    }

    /// The middle.
    #[must_use]
    pub const fn center(&self) -> DVec3 {
        self.center
    }

    /// The unit vector that it faces.
    #[must_use]
    pub const fn normal(&self) -> DVec3 {
        self.normal
    }

    /// The radius of the hole, 0 for none, and that of the rim.
    #[must_use]
    pub const fn radii(&self) -> [f64; 2] {
        [self.inner_radius, self.radius]
    }

    fn error(&self) -> f64 {
        gamma(12) * (self.center.abs().max_element() + self.radius)
    }
}

impl Described for Disc {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args) -> Result<Self, Diagnostic> {
        let (radius, inner) = (args.number("radius")?, args.number("inner_radius")?);
        if !(inner < radius) {
            return Err(args
                .error(
                    "inner_radius",
                    "no-ring",
                    format!("inner_radius of the disc is {inner}, not below its radius {radius}"),
                )
                .help("make inner_radius smaller, or leave it out for a disc without a hole"));
        }
        Self::new(args.vec3("center")?.into(), args.vec3("normal")?.into(), radius, inner)
            .ok_or_else(|| {
                args.error("normal", "wrong-value", "normal of disc: too large to be a direction")
                    .help("write a vector of ordinary length, such as (0, 1, 0)")
            })
    }
}

impl Shape for Disc {
    fn bounds(&self) -> Bounds {
        circle_bounds(self.center, self.normal, self.radius)
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
        let offset = ray.origin - self.center;
        let (height, rate) = (offset.dot(self.normal), ray.direction.dot(self.normal));
        let t = plane_root(ray, height, rate, self.error())?;
        let distance2 = (offset + ray.direction * t).length_squared();
        if distance2 <= self.radius * self.radius
            && distance2 >= self.inner_radius * self.inner_radius
        {
            root(ray, t, 0)
        } else {
            None
        }
    }

    fn crossings(&self, _ray: &LocalRay, _out: &mut Vec<Crossing>) {}

    fn surface(&self, point: DVec3, _part: u32) -> LocalSurface {
        let normal = self.normal;
        let offset = point - self.center;
        let offset = offset - normal * offset.dot(normal);
        let (x, z) = around(normal);
        let diameter = 2.0 * self.radius;
        let uv = DVec2::new(0.5 + offset.dot(x) / diameter, 0.5 - offset.dot(z) / diameter);
        LocalSurface {
            point: self.center + offset,
            error: self.error(),
            normal,
            shading_normal: normal,
            uv: uv.clamp(DVec2::ZERO, DVec2::ONE),
            dpdu: x * diameter,
            dpdv: -z * diameter,
        }
    }
}

/// A box around the circle with unit normal `axis`: along x it reaches `radius sqrt(1 - axis.x^2)`.
pub(crate) fn circle_bounds(center: DVec3, axis: DVec3, radius: f64) -> Bounds {
    let reach = |a: f64, b: f64| (a * a + b * b).sqrt();
    let extent = DVec3::new(reach(axis.y, axis.z), reach(axis.x, axis.z), reach(axis.x, axis.y));
    let half = extent * radius + gamma(12) * (center.abs().max_element() + radius);
    Bounds { min: center - half, max: center + half }
}
