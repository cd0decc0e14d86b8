// SPDX-License-Identifier: MIT OR Apache-2.0
//! The flat polygon: convex or not, with any number of holes.

use dioptric_math::bounds::gamma;
use dioptric_math::{DVec2, DVec3, normalize};
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type, Value};

use super::convex::{plane_root, root};
use super::frame::around;
use super::sheared::{Shear, area};
use crate::bounds::Bounds;
use crate::ray::LocalRay;
use crate::shape::{Crossing, Described, LocalSurface, Root, Shape, SurfacePoint};

/// Corners may lie off the common plane by this share of the polygon's size, and by [`OFF_PLACE`] of
/// their coordinates: as much as numbers written with five or six digits do.
const OFF_PLANE: f64 = 1e-4;
const OFF_PLACE: f64 = 1e-6;

/// The outline and its holes, all in one plane.
#[derive(Clone, Debug, PartialEq)]
pub struct Polygon {
    loops: Box<[Box<[DVec3]>]>,
    /// The mean of the outline's corners, and the plane's normal.
    center: DVec3,
    normal: DVec3,
    /// A box around all corners, with room for rounding.
    bounds: Bounds,
    /// Smallest corner and extent in the directions of u and v, from `center`.
    uv_min: DVec2,
    uv_size: DVec2,
    error: f64,
}

/// What is wrong with the corners of a polygon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PolygonError {
    /// Loop `0` is the outline, the others are holes: fewer than three different corners.
    TooFew(usize),
    /// All corners lie on a line, or they are not finite.
    NoArea,
    /// A corner's loop and index, and how far it lies off the plane.
    OffPlane(usize, usize, f64),
}

static SCHEMA: Schema = Schema {
    kind: "polygon",
    category: Category::Shape,
    summary: "a flat polygon, with holes if wanted",
    doc: "The flat surface inside the outline `points` and outside of the `holes`: a point belongs to it where a line from \
          it to the outside crosses an odd number of edges. Outlines may be concave. The normal points to who sees the \
          points counterclockwise (for outlines that cross themselves: around the larger area); the order of the holes' \
          points does not matter. Polygons that share edges leave no gap and do not overlap. Not solid.\n\n\
          `uv`: the rectangle around the polygon, 0 to 1. With the normal +y, u runs along +x and v along -z; with +z, u \
          along +x and v along +y; other normals turn these directions by the smallest rotation from +y.\n\n\
          Normal after Sutherland, Sproull and Schumacker, \"A Characterization of Ten Hidden-Surface Algorithms\", ACM \
          Computing Surveys 6(1), 1974 (Newell's method).",
    params: &[
        Param::required("points", Type::List(&Type::Vec3), "The corners of the outline in order."),
        Param::new(
            "holes",
            Type::List(&Type::List(&Type::Vec3)),
            Default::Absent,
            "A list of holes, each a list of corners in the same plane.",
        ),
    ],
    example: "polygon(points = [(-1, 0, 0), (1, 0, 0), (1, 1.5, 0), (0, 0.8, 0), (-1, 1.5, 0)],\n        \
              holes = [[(-0.2, 0.2, 0), (0.2, 0.2, 0), (0, 0.5, 0)]], material = matte(\"tomato\"))",
};

impl Polygon {
    /// A polygon of an outline, the first loop, and holes.
    ///
    /// # Errors
    /// See [`PolygonError`].
    pub fn new(loops: impl IntoIterator<Item = Vec<DVec3>>) -> Result<Self, PolygonError> {
        let mut loops: Vec<Vec<DVec3>> = loops.into_iter().collect();
        for (i, corners) in loops.iter_mut().enumerate() {
            corners.dedup();
            while corners.len() > 1 && corners.first() == corners.last() {
                corners.pop();
            }
            if corners.len() < 3 {
                return Err(PolygonError::TooFew(i));
            }
        }
        let outline = loops.first().ok_or(PolygonError::TooFew(0))?;
        let tight = Bounds::of(loops.iter().flatten().copied());
        let size = tight.size().max_element();
        let scale = tight.min.abs().max(tight.max.abs()).max_element();
        let first = outline.first().copied().unwrap_or_default();
        let mean = outline.iter().map(|&p| (p - first) / size).sum::<DVec3>();
        let center = first + mean * (size / outline.len() as f64);
        let twice_area = newell(outline, center, size);
        // Of a square with that size the area is 1; below this, rounding alone decides the normal.
        if !(twice_area.length() > 1e-12) {
            return Err(PolygonError::NoArea);
        }
        let normal = normalize(twice_area).ok_or(PolygonError::NoArea)?;
        for (i, corners) in loops.iter().enumerate() {
            for (k, &p) in corners.iter().enumerate() {
                let off = (p - center).dot(normal).abs();
                if !(off <= OFF_PLANE * size + OFF_PLACE * scale) {
                    return Err(PolygonError::OffPlane(i, k, off));
                }
            }
        }
        let (x, z) = around(normal);
        let planar = |p: DVec3| DVec2::new((p - center).dot(x), -(p - center).dot(z));
        let start = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        let (low, high) = outline
            .iter()
            .map(|&p| planar(p))
            .fold(start, |(low, high), p| (low.min(p), high.max(p)));
        let error = gamma(16) * scale;
        // The plane leaves corners that are not quite in it on either side.
        let off =
            loops.iter().flatten().fold(0.0_f64, |m, &p| m.max((p - center).dot(normal).abs()));
        let bounds =
            Bounds { min: tight.min - (error + 2.0 * off), max: tight.max + (error + 2.0 * off) };
        Ok(Self {
            loops: loops.into_iter().map(Vec::into_boxed_slice).collect(),
            center,
            normal,
            bounds,
            uv_min: low,
            uv_size: high - low,
            error,
        })
    }

    /// Whether the line through `origin` along `direction` passes through it, by the parity of the
    /// edges to one side. An edge that the line meets counts as on that side, whichever way the edge
    /// runs, so exactly one of two neighbours has it.
    fn is_passed(&self, origin: DVec3, direction: DVec3) -> bool {
        let shear = Shear::new(origin, direction);
        let mut inside = false;
        for corners in &self.loops {
            let Some(&last) = corners.last() else { continue };
            let mut a = shear.project(last);
            for &corner in corners {
                let b = shear.project(corner);
                if (a.y > 0.0) != (b.y > 0.0) {
                    let right = if a.y < b.y { area(a, b) >= 0.0 } else { area(b, a) >= 0.0 };
                    inside ^= right;
                }
                a = b;
            }
        }
        inside
    }
}

/// Twice the area times the normal (counterclockwise), in units of `size`.
fn newell(corners: &[DVec3], center: DVec3, size: f64) -> DVec3 {
    let next = corners.iter().skip(1).chain(corners.first());
    corners.iter().zip(next).map(|(&a, &b)| ((a - center) / size).cross((b - center) / size)).sum()
}

/// The points of a list of points.
fn points(list: &[Value]) -> Vec<DVec3> {
    let point = |v: &Value| match v {
        Value::Vec3(p) => Some(DVec3::from(*p)),
        _ => None,
    };
    list.iter().filter_map(point).collect()
}

impl Described for Polygon {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args) -> Result<Self, Diagnostic> {
        let mut loops = vec![points(&args.list("points")?)];
        loops.extend(args.list("holes")?.iter().map(|hole| points(&hole.items())));
        let place = |i: usize| if i == 0 { "points" } else { "holes" };
        let name = |i: usize| if i == 0 { "the polygon".to_owned() } else { format!("hole {i}") };
        Self::new(loops).map_err(|why| match why {
            PolygonError::TooFew(i) => args
                .error(
                    place(i),
                    "too-few-points",
                    format!("{} has fewer than 3 different points", name(i)),
                )
                .help("give at least three points that are not the same"),
            PolygonError::NoArea => args
                .error("points", "flat-shape", "the points of the polygon lie on a line")
                .help("move one of the points off the line"),
            PolygonError::OffPlane(i, k, off) => args
                .error(
                    place(i),
                    "not-planar",
                    format!("point {} of {} lies {off} off the polygon's plane", k + 1, name(i)),
                )
                .help("move it into the plane, or cut the polygon into triangles"),
        })
    }
}

impl Shape for Polygon {
    fn bounds(&self) -> Bounds {
        self.bounds
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
        let height = (ray.origin - self.center).dot(self.normal);
        let t = plane_root(ray, height, ray.direction.dot(self.normal), self.error)?;
        // Most rays pass the plane far from the outline. NaN is a miss.
        let p = ray.at(t);
        let room = ray.error + gamma(4) * (ray.origin.abs().max_element() + p.abs().max_element());
        if !((p + room).cmpge(self.bounds.min).all() && (p - room).cmple(self.bounds.max).all()) {
            return None;
        }
        // A ray that starts on the plane must start on the polygon.
        let direction = if t > 0.0 { ray.direction } else { self.normal };
        if self.is_passed(ray.origin, direction) { root(ray, t, 0) } else { None }
    }

    fn crossings(&self, _ray: &LocalRay, _out: &mut Vec<Crossing>) {}

    fn surface(&self, point: DVec3, _part: u32) -> LocalSurface {
        let normal = self.normal;
        let offset = point - self.center;
        let offset = offset - normal * offset.dot(normal);
        let (x, z) = around(normal);
        let uv = (DVec2::new(offset.dot(x), -offset.dot(z)) - self.uv_min) / self.uv_size;
        LocalSurface {
            point: self.center + offset,
            error: self.error,
            normal,
            shading_normal: normal,
            uv: uv.clamp(DVec2::ZERO, DVec2::ONE),
            dpdu: x * self.uv_size.x,
            dpdv: -z * self.uv_size.y,
        }
    }

    fn surface_point(&self, point: DVec3, _part: u32) -> SurfacePoint {
        let normal = self.normal;
        let offset = point - self.center;
        let offset = offset - normal * offset.dot(normal);
        SurfacePoint {
            point: self.center + offset,
            error: self.error,
            normal,
            shading_normal: normal,
        }
    }
}
