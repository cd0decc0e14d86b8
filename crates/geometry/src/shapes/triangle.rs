// SPDX-License-Identifier: MIT OR Apache-2.0
//! The single triangle, with normals and surface coordinates at its corners if wanted.

use dioptric_math::bounds::gamma;
use dioptric_math::{DVec2, DVec3, normalize, orthonormal_basis};
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type, Value};

use super::convex::root;
use super::outline::{Facet, Halves, Room, Spread};
use super::sheared::{Shear, area, triangle_normal};
use crate::bounds::Bounds;
use crate::ray::LocalRay;
use crate::shape::{Crossing, Described, LocalSurface, Root, Shape, SurfacePoint};

/// A flat triangle, hit from both sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle {
    facet: Facet<Halves<1>>,
    corners: [DVec3; 3],
    normals: Option<[DVec3; 3]>,
    uvs: [DVec2; 3],
}

/// The surface coordinates where none are given.
const UVS: [DVec2; 3] = [DVec2::ZERO, DVec2::X, DVec2::Y];

static SCHEMA: Schema = Schema {
    kind: "triangle",
    category: Category::Shape,
    summary: "a triangle, flat or with smooth shading",
    doc: "The triangle `a`, `b`, `c`, hit from both sides. Its normal points to who sees the corners counterclockwise; \
          where `normals` are given and most of them point to the other side, the normal does too. With `normals` the \
          surface is shaded with their interpolation. Not solid.\n\n\
          `uv`: interpolated from `uvs`; without them 0, 0 at `a`, u = 1 at `b` and v = 1 at `c`.\n\n\
          Triangles that share corners leave no gap between them: Woop, Benthin and Wald, \"Watertight Ray/Triangle \
          Intersection\", JCGT 2(1), 2013.",
    params: &[
        Param::required("a", Type::Vec3, "A corner."),
        Param::required("b", Type::Vec3, "The next corner."),
        Param::required("c", Type::Vec3, "The last corner."),
        Param::new(
            "normals",
            Type::List(&Type::Direction),
            Default::Absent,
            "Three normals to shade with, at `a`, `b` and `c`; of any length.",
        ),
        Param::new(
            "uvs",
            Type::List(&Type::Vec2),
            Default::Absent,
            "Three pairs of surface coordinates, at `a`, `b` and `c`.",
        ),
    ],
    example: "triangle(a = (-1, 0, 0), b = (1, 0, 0), c = (0, 1.5, 0), material = matte(\"tomato\"))",
};

impl Triangle {
    /// A flat triangle; `None` where the corners lie on a line or are not finite.
    #[must_use]
    pub fn new(corners: [DVec3; 3]) -> Option<Self> {
        let [a, b, c] = corners;
        let (normal, sine) = triangle_normal(a, b, c)?;
        let scale = Bounds::of(corners.map(DVec3::abs)).max.max_element();
        let error = gamma(16) * scale / sine;
        let relative = corners.map(|p| p - a);
        let filter =
            Spread::of(&relative, normal).and_then(|spread| Halves::new(&relative, normal, spread));
        let (room, filter) = filter.unwrap_or((Room::NONE, Halves::NONE));
        let facet = Facet { point: a, normal, error, room, filter };
        Some(Self { facet, corners, normals: None, uvs: UVS })
    }

    /// The same triangle, shaded with the interpolation of these normals (of any length but 0).
    #[must_use]
    pub fn with_normals(mut self, normals: [DVec3; 3]) -> Self {
        let normals = normals.map(|n| normalize(n).unwrap_or(self.facet.normal));
        if normals.iter().sum::<DVec3>().dot(self.facet.normal) < 0.0 {
            self.facet.normal = -self.facet.normal;
        }
        self.normals = Some(normals);
        self
    }

    /// The same triangle with these surface coordinates.
    #[must_use]
    pub const fn with_uvs(mut self, uvs: [DVec2; 3]) -> Self {
        self.uvs = uvs;
        self
    }

    /// A point and the normal of its plane, the corners, and how far these lie off the plane, rounding aside.
    pub(crate) const fn flat(&self) -> ((DVec3, DVec3), &[DVec3], f64) {
        ((self.facet.point, self.facet.normal), &self.corners, 0.0)
    }

    /// Its corners, its normal, and those at its corners.
    pub(crate) const fn numbers(&self) -> ([DVec3; 3], DVec3, Option<&[DVec3; 3]>) {
        (self.corners, self.facet.normal, self.normals.as_ref())
    }

    /// Its corners.
    #[must_use]
    pub const fn corners(&self) -> [DVec3; 3] {
        self.corners
    }

    /// Whether the line through `origin` along `direction` passes through it, its edges included.
    fn is_passed(&self, origin: DVec3, direction: DVec3) -> bool {
        let shear = Shear::new(origin, direction);
        let [a, b, c] = self.corners.map(|p| shear.project(p));
        let (u, v, w) = (area(b, c), area(c, a), area(a, b));
        let within = (u >= 0.0 && v >= 0.0 && w >= 0.0) || (u <= 0.0 && v <= 0.0 && w <= 0.0);
        within && u + v + w != 0.0
    }
}

impl Triangle {
    /// The point with these weights of the corners.
    fn at(&self, weights: [f64; 3]) -> SurfacePoint {
        let [a, b, c] = self.corners;
        let (e, f) = (b - a, c - a);
        let blend = |v: [DVec3; 3]| v[0] * weights[0] + v[1] * weights[1] + v[2] * weights[2];
        SurfacePoint {
            point: a + (e * weights[1] + f * weights[2]),
            error: gamma(8) * (a.abs() + e.abs() + f.abs()).max_element(),
            normal: self.facet.normal,
            shading_normal: self
                .normals
                .and_then(|n| normalize(blend(n)))
                .unwrap_or(self.facet.normal),
        }
    }
}

impl Described for Triangle {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args) -> Result<Self, Diagnostic> {
        let corners = [args.vec3("a")?, args.vec3("b")?, args.vec3("c")?].map(DVec3::from);
        let mut triangle = Self::new(corners).ok_or_else(|| {
            args.error("c", "flat-shape", "the corners of the triangle lie on a line")
                .help("move one of the corners off the line through the other two")
        })?;
        if let Some(normals) = three(args, "normals", |v| match v {
            Value::Vec3(n) => Some(DVec3::from(*n)),
            _ => None,
        })? {
            triangle = triangle.with_normals(normals);
        }
        if let Some(uvs) = three(args, "uvs", |v| match v {
            Value::Vec2(uv) => Some(DVec2::from(*uv)),
            _ => None,
        })? {
            triangle = triangle.with_uvs(uvs);
        }
        Ok(triangle)
    }
}

impl Shape for Triangle {
    fn bounds(&self) -> Bounds {
        let tight = Bounds::of(self.corners);
        let error = gamma(8) * tight.min.abs().max(tight.max.abs()).max_element();
        Bounds { min: tight.min - error, max: tight.max + error }
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
        let (t, known) = self.facet.pass(ray, Halves::encloses)?;
        // A ray that starts on the plane must start on the triangle.
        let is_passed = || {
            let direction = if t > 0.0 { ray.direction } else { self.facet.normal };
            self.is_passed(ray.origin, direction)
        };
        if known.unwrap_or_else(is_passed) { root(ray, t, 0) } else { None }
    }

    fn crossings(&self, _ray: &LocalRay, _out: &mut Vec<Crossing>) {}

    fn surface(&self, point: DVec3, _part: u32) -> LocalSurface {
        let weights = barycentric(self.corners, self.facet.normal, point);
        let [a, b, c] = self.corners;
        let (e, f) = (b - a, c - a);
        let [uv_a, uv_b, uv_c] = self.uvs;
        let (g, h) = (uv_b - uv_a, uv_c - uv_a);
        let turn = g.x * h.y - g.y * h.x;
        let (dpdu, dpdv) = ((e * h.y - f * g.y) / turn, (f * g.x - e * h.x) / turn);
        // Coordinates that do not span the triangle have no directions: any tangents will do.
        let (dpdu, dpdv) = if dpdu.is_finite() && dpdv.is_finite() {
            (dpdu, dpdv)
        } else {
            orthonormal_basis(self.facet.normal)
        };
        let SurfacePoint { point, error, normal, shading_normal } = self.at(weights);
        LocalSurface {
            point,
            error,
            normal,
            shading_normal,
            uv: uv_a + (g * weights[1] + h * weights[2]),
            dpdu,
            dpdv,
        }
    }

    fn surface_point(&self, point: DVec3, _part: u32) -> SurfacePoint {
        self.at(barycentric(self.corners, self.facet.normal, point))
    }
}

/// The weights of the corners for a point of the triangle: none below 0, their sum 1.
pub(crate) fn barycentric(corners: [DVec3; 3], normal: DVec3, point: DVec3) -> [f64; 3] {
    let [a, b, c] = corners.map(|p| p - point);
    let areas = [b.cross(c), c.cross(a), a.cross(b)].map(|v| v.dot(normal));
    let sum: f64 = areas.iter().sum();
    let weights = areas.map(|w| (w / sum).max(0.0));
    let sum: f64 = weights.iter().sum();
    if sum > 0.0 { weights.map(|w| w / sum) } else { [1.0, 0.0, 0.0] }
}

/// A list of exactly three things, or none.
fn three<T>(
    args: &Args,
    name: &str,
    read: impl Fn(&Value) -> Option<T>,
) -> Result<Option<[T; 3]>, Diagnostic> {
    if !args.is_written(name) {
        return Ok(None);
    }
    let items: Vec<T> = args.list(name)?.iter().filter_map(read).collect();
    let count = items.len();
    <[T; 3]>::try_from(items).map(Some).map_err(|_| {
        args.error(name, "wrong-count", format!("{name} of the triangle: expected 3, got {count}"))
            .help("give one for each of a, b and c, or leave it out")
    })
}

#[cfg(test)]
mod tests {
    use dioptric_math::pow;
    use dioptric_math::random::Random;

    use super::super::convex::plane_root;
    use super::super::outline::testing::{direction, trouble};
    use super::*;

    /// The test without the filter.
    fn plainly(triangle: &Triangle, ray: &LocalRay) -> Option<Root> {
        let Facet { point, normal, error, .. } = triangle.facet;
        let height = (ray.origin - point).dot(normal);
        let t = plane_root(ray, height, ray.direction.dot(normal), error)?;
        let direction = if t > 0.0 { ray.direction } else { normal };
        if triangle.is_passed(ray.origin, direction) { root(ray, t, 0) } else { None }
    }

    #[test]
    fn the_filter_changes_nothing() {
        let mut r = Random::new(78);
        let (mut hits, mut rays, mut filters) = (0, 0, 0);
        for _ in 0..2000 {
            let scale = [1e-6, 1.0, 1e6][(r.bits() % 3) as usize];
            let offset = direction(&mut r) * [0.0, 1.0, 1e5][(r.bits() % 3) as usize];
            // From fair ones to needles and slivers.
            let (a, b, thin) =
                (direction(&mut r), direction(&mut r), pow(10.0, r.uniform(-13.0, 0.0)));
            let c = [direction(&mut r), a + (b - a) * r.unit(), a][(r.bits() % 3) as usize];
            let c = c + direction(&mut r) * thin;
            let corners = [a, b, c].map(|p| (p + offset) * scale);
            let Some(triangle) = Triangle::new(corners) else { continue };
            filters += usize::from(triangle.facet.room != Room::NONE);
            for _ in 0..200 {
                let ray = trouble(&corners, triangle.facet.normal, triangle.facet.error, &mut r);
                let expected = plainly(&triangle, &ray);
                assert_eq!(triangle.intersect(&ray), expected, "{triangle:?} {ray:?}");
                rays += 1;
                hits += usize::from(expected.is_some());
            }
        }
        println!("{hits} of {rays} rays hit; {filters} triangles with filters");
        assert!(
            rays > 300_000 && hits * 10 > rays && hits * 2 < rays && filters > 1000,
            "{hits} {rays} {filters}"
        );
    }
}
