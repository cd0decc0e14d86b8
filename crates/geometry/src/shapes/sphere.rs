// SPDX-License-Identifier: MIT OR Apache-2.0
//! The sphere: all points at one distance from a centre.

use std::f64::consts::PI;

use dioptric_math::bounds::gamma;
use dioptric_math::{DVec2, DVec3, asin, normalize};
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::convex::{Chord, root};
use super::frame::longitude;
use crate::bounds::Bounds;
use crate::plain::Plain;
use crate::ray::LocalRay;
use crate::shape::{Crossing, Described, LocalSurface, Root, Shape, SurfacePoint};

/// A closed ball's surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    center: DVec3,
    radius: f64,
}

static SCHEMA: Schema = Schema {
    kind: "sphere",
    category: Category::Shape,
    summary: "a ball",
    doc: "All points at distance `radius` from `center`.\n\n\
          `uv`: u is the longitude, from 0 at -z over 0.25 at -x ... 0.5 at +z (the side towards the usual camera) to 1,\n\
          growing to the right as seen from +z; v is the latitude, 0 at the bottom (-y) and 1 at the top.\n\n\
          Roots after Haines, Günther and Akenine-Möller, \"Precision Improvements for Ray/Sphere Intersection\",\n\
          Ray Tracing Gems, 2019, chapter 7.",
    params: &[
        Param::new("center", Type::Vec3, Default::Vec3([0.0; 3]), "The middle."),
        Param::new(
            "radius",
            Type::Positive,
            Default::Number(1.0),
            "Distance from the middle to the surface.",
        ),
    ],
    example: "sphere(center = (0, 1, 0), radius = 1, material = matte(\"tomato\"))",
};

impl Sphere {
    /// A sphere; `radius` must be above 0.
    #[must_use]
    pub const fn new(center: DVec3, radius: f64) -> Self {
        Self { center, radius }
    }

    /// The middle.
    #[must_use]
    pub const fn center(&self) -> DVec3 {
        self.center
    }

    /// The distance from the middle to the surface.
    #[must_use]
    pub const fn radius(&self) -> f64 {
        self.radius
    }

    /// The two roots on the whole line.
    #[inline]
    fn chord(&self, ray: &LocalRay) -> Option<Chord> {
        let f = ray.origin - self.center;
        let d = ray.direction;
        let a = d.length_squared();
        let b = -f.dot(d);
        // The distance from the centre to the line, from a short vector: no cancellation of large squares.
        let nearest = f + d * (b / a);
        let discriminant = self.radius * self.radius - nearest.length_squared();
        // Written so that NaN is a miss.
        if !(discriminant >= 0.0) {
            return None;
        }
        let root = (a * discriminant).sqrt();
        let c = f.length_squared() - self.radius * self.radius;
        let q = b + root.copysign(b);
        let (t0, t1) = if q == 0.0 { (0.0, 0.0) } else { (c / q, q / a) };
        Some(Chord { near: (t0.min(t1), 0), far: (t0.max(t1), 0) })
    }

    /// Its numbers.
    pub(crate) fn plain(&self) -> Plain {
        let (edges, duals) = ([DVec3::ZERO; 2], [DVec3::ZERO; 2]);
        let (base, radius, error) = (self.center, self.radius, self.error());
        Plain { base, edges, duals, normal: DVec3::ZERO, radius, error }
    }

    /// Its middle, its radius, and a bound on the errors of points.
    pub(crate) fn numbers(&self) -> (DVec3, f64, f64) {
        (self.center, self.radius, self.error())
    }

    fn error(&self) -> f64 {
        gamma(16) * (self.center.abs().max_element() + self.radius)
    }
}

impl Described for Sphere {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args) -> Result<Self, Diagnostic> {
        Ok(Self::new(args.vec3("center")?.into(), args.number("radius")?))
    }
}

impl Shape for Sphere {
    fn bounds(&self) -> Bounds {
        let reach = self.radius + self.error();
        Bounds { min: self.center - reach, max: self.center + reach }
    }

    fn is_solid(&self) -> bool {
        true
    }

    fn is_convex(&self) -> bool {
        true
    }

    #[inline]
    fn intersect(&self, ray: &LocalRay) -> Option<Root> {
        if let Some(leaving) = ray.leaving {
            if leaving.outward {
                return None;
            }
            // One root is exactly 0; the sum of both is -2 b / a (Vieta).
            let t = -2.0 * (ray.origin - self.center).dot(ray.direction)
                / ray.direction.length_squared();
            return root(ray, t, 0);
        }
        self.chord(ray)?.first(ray, self.error(), |_| {
            let height = (ray.origin - self.center).length() - self.radius;
            (height, height)
        })
    }

    fn crossings(&self, ray: &LocalRay, out: &mut Vec<Crossing>) {
        if let Some(chord) = self.chord(ray) {
            chord.push_crossings(ray, out);
        }
    }

    fn surface(&self, point: DVec3, part: u32) -> LocalSurface {
        let SurfacePoint { point, error, normal, shading_normal } = self.surface_point(point, part);
        let uv =
            DVec2::new(longitude(normal.x, normal.z), asin(normal.y.clamp(-1.0, 1.0)) / PI + 0.5);
        // Derivatives of (sin a cos b, sin b, cos a cos b) with a = 2 pi (u - 1/2), b = pi (v - 1/2).
        let cos_b = (normal.x * normal.x + normal.z * normal.z).sqrt();
        let (sin_a, cos_a) =
            if cos_b > 0.0 { (normal.x / cos_b, normal.z / cos_b) } else { (0.0, 1.0) };
        let dpdu = DVec3::new(cos_a * cos_b, 0.0, -sin_a * cos_b) * (2.0 * PI * self.radius);
        let dpdv = DVec3::new(-sin_a * normal.y, cos_b, -cos_a * normal.y) * (PI * self.radius);
        LocalSurface { point, error, normal, shading_normal, uv, dpdu, dpdv }
    }

    #[inline(always)]
    fn surface_point(&self, point: DVec3, _part: u32) -> SurfacePoint {
        let normal = normalize(point - self.center).unwrap_or(DVec3::Y);
        let point = self.center + normal * self.radius;
        SurfacePoint { point, error: self.error(), normal, shading_normal: normal }
    }
}
