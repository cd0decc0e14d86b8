// SPDX-License-Identifier: MIT OR Apache-2.0
//! The tetrahedron: the solid between four points.

use dioptric_math::bounds::gamma;
use dioptric_math::{DVec2, DVec3};
use dioptric_scene::{Args, Category, Diagnostic, Param, Schema, Type};

use super::convex::{Chord, root};
use super::sheared::triangle_normal;
use super::triangle::barycentric;
use crate::bounds::Bounds;
use crate::ray::LocalRay;
use crate::shape::{Crossing, Described, LocalSurface, Root, Shape};

/// Part `i` is the face opposite to corner `i`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tetrahedron {
    faces: [Face; 4],
    bounds: Bounds,
    error: f64,
}

/// Corners counterclockwise as seen from outside.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Face {
    corners: [DVec3; 3],
    normal: DVec3,
}

impl Face {
    fn height(&self, p: DVec3) -> f64 {
        (p - self.corners[0]).dot(self.normal)
    }
}

static SCHEMA: Schema = Schema {
    kind: "tetrahedron",
    category: Category::Shape,
    summary: "the solid between four points",
    doc: "A pyramid with three sides and a triangular base, in any order of its corners.\n\n\
          `uv`: on each face 0, 0 at one corner, u = 1 at the second and v = 1 at the third, counterclockwise as seen \
          from outside, the corners taken in the order `a`, `b`, `c`, `d` as far as that allows.\n\n\
          Parts: the faces opposite to `a`, `b`, `c` and `d`. A line is clipped by the four half spaces (Cyrus and Beck, \
          \"Generalized Two- and Three-Dimensional Clipping\", Computers & Graphics 3, 1978).",
    params: &[
        Param::required("a", Type::Vec3, "A corner."),
        Param::required("b", Type::Vec3, "A corner."),
        Param::required("c", Type::Vec3, "A corner."),
        Param::required("d", Type::Vec3, "A corner."),
    ],
    example: "tetrahedron(a = (-1, 0, 0.6), b = (1, 0, 0.6), c = (0, 0, -1.1), d = (0, 1.6, 0), material = matte(\"tomato\"))",
};

impl Tetrahedron {
    /// A tetrahedron; `None` where all corners lie in a plane, or are not finite.
    #[must_use]
    pub fn new(corners: [DVec3; 4]) -> Option<Self> {
        let [a, b, c, d] = corners;
        let scale = Bounds::of(corners.map(DVec3::abs)).max.max_element();
        let mut error = 0.0_f64;
        let mut face = |corners: [DVec3; 3], opposite: DVec3| {
            let [p, q, r] = corners;
            let (normal, sine) = triangle_normal(p, q, r)?;
            error = error.max(gamma(16) * scale / sine);
            let depth = (opposite - p).dot(normal);
            // The fourth corner must be off the plane by more than rounding.
            let size = (q - p).abs().max((r - p).abs()).max_element();
            if !(depth.abs() > 1e-12 * size) {
                return None;
            }
            Some(match depth < 0.0 {
                true => Face { corners, normal },
                false => Face { corners: [p, r, q], normal: -normal },
            })
        };
        let faces =
            [face([b, c, d], a)?, face([a, c, d], b)?, face([a, b, d], c)?, face([a, b, c], d)?];
        let tight = Bounds::of(corners);
        let bounds = Bounds { min: tight.min - error, max: tight.max + error };
        Some(Self { faces, bounds, error })
    }

    /// The corners of each face, counterclockwise as seen from outside.
    #[must_use]
    pub fn faces(&self) -> [[DVec3; 3]; 4] {
        self.faces.map(|face| face.corners)
    }

    fn chord(&self, ray: &LocalRay, left: Option<u32>) -> Chord {
        let mut chord = Chord::LINE;
        for (face, part) in self.faces.iter().zip(0..) {
            let rate = ray.direction.dot(face.normal);
            if left != Some(part) {
                chord.clip(face.height(ray.origin), rate, part);
            }
        }
        chord
    }
}

impl Described for Tetrahedron {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args) -> Result<Self, Diagnostic> {
        let corners = [args.vec3("a")?, args.vec3("b")?, args.vec3("c")?, args.vec3("d")?];
        Self::new(corners.map(DVec3::from)).ok_or_else(|| {
            args.error("d", "flat-shape", "the corners of the tetrahedron lie in a plane").help(
                "move d off the plane through a, b and c; for a flat shape use triangle or polygon",
            )
        })
    }
}

impl Shape for Tetrahedron {
    fn bounds(&self) -> Bounds {
        self.bounds
    }

    fn is_solid(&self) -> bool {
        true
    }

    fn is_convex(&self) -> bool {
        true
    }

    fn intersect(&self, ray: &LocalRay) -> Option<Root> {
        if let Some(leaving) = ray.leaving {
            if leaving.outward {
                return None;
            }
            let far = self.chord(ray, Some(leaving.part)).far;
            return root(ray, far.0, far.1);
        }
        let chord = self.chord(ray, None);
        if !chord.is_some() || chord.near.0 > ray.t_max {
            return None;
        }
        chord.first(ray, self.error, |part| {
            let heights = self.faces.map(|face| face.height(ray.origin));
            let own = heights.get(part as usize).copied().unwrap_or(f64::INFINITY);
            (own, heights.into_iter().fold(f64::NEG_INFINITY, f64::max))
        })
    }

    fn crossings(&self, ray: &LocalRay, out: &mut Vec<Crossing>) {
        self.chord(ray, None).push_crossings(ray, out);
    }

    fn surface(&self, point: DVec3, part: u32) -> LocalSurface {
        let face = &self.faces[part as usize % 4];
        let [a, b, c] = face.corners;
        let [_, u, v] = barycentric(face.corners, face.normal, point);
        let (e, f) = (b - a, c - a);
        LocalSurface {
            point: a + (e * u + f * v),
            error: gamma(8) * (a.abs() + e.abs() + f.abs()).max_element(),
            normal: face.normal,
            shading_normal: face.normal,
            uv: DVec2::new(u, v),
            dpdu: e,
            dpdv: f,
        }
    }
}
