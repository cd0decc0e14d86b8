// SPDX-License-Identifier: MIT OR Apache-2.0
//! The flat polygon: convex or not, with any number of holes.

use dioptric_math::bounds::gamma;
use dioptric_math::{DVec2, DVec3, normalize};
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type, Value};

use super::convex::root;
use super::frame::around;
use super::outline::{Cells, Facet, Halves, Outline, Room, Spread};
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
    /// Around the mean of the outline's corners.
    facet: Facet<Filter>,
    outline: Outline,
    /// A box around all corners, with room for rounding.
    bounds: Bounds,
    /// Smallest corner and extent in the directions of u and v, from `center`.
    uv_min: DVec2,
    uv_size: DVec2,
    /// How far corners lie off the plane.
    off: f64,
}

/// What can tell without looking at the edges whether a point is inside.
#[derive(Clone, Debug, PartialEq)]
enum Filter {
    /// For triangles and quadrangles.
    Four(Halves<1>),
    /// For other small convex ones.
    Eight(Box<Halves<2>>),
    /// For all others.
    Cells(Box<Cells>),
    /// For tiny and vast ones, and those where rounding says more than the numbers.
    None,
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
        let outline = Outline::new(&loops);
        let (room, filter) =
            Filter::new(&outline, center, normal).unwrap_or((Room::NONE, Filter::None));
        let facet = Facet { point: center, normal, error, room, filter };
        Ok(Self { facet, outline, bounds, uv_min: low, uv_size: high - low, off })
    }

    /// The unit normal of its plane, and the corners of its outline and of each hole.
    #[must_use]
    pub fn rings(&self) -> (DVec3, Vec<Vec<DVec3>>) {
        (self.facet.normal, self.outline.loops().map(<[DVec3]>::to_vec).collect())
    }

    /// A point and the normal of its plane, and a bound on the errors of points.
    pub(crate) const fn numbers(&self) -> (DVec3, DVec3, f64) {
        (self.facet.point, self.facet.normal, self.facet.error)
    }

    /// A point and the normal of its plane, the corners of its outline and holes, and how far these lie off the plane.
    pub(crate) fn flat(&self) -> ((DVec3, DVec3), &[DVec3], f64) {
        ((self.facet.point, self.facet.normal), self.outline.corners(), self.off)
    }

    /// The exact test of a ray that passes the plane.
    fn is_met(&self, ray: &LocalRay, t: f64) -> bool {
        // Most rays pass the plane far from the outline. Along the plane where they do so is little known (see
        // module `outline`), but a hit is next to the polygon in any case. NaN is a miss.
        let p = ray.at(t);
        let reach = ray.origin.abs().max_element() + p.abs().max_element() + self.facet.error;
        let slant = ray.direction.abs().element_sum() / ray.direction.dot(self.facet.normal).abs();
        let size = self.bounds.size().max_element();
        let room =
            ray.error + ((self.off + gamma(256) * reach) * slant).min(size) + gamma(4) * reach;
        if !((p + room).cmpge(self.bounds.min).all() && (p - room).cmple(self.bounds.max).all()) {
            return false;
        }
        // A ray that starts on the plane must start on the polygon.
        let direction = if t > 0.0 { ray.direction } else { self.facet.normal };
        self.outline.is_passed(ray.origin, direction)
    }
}

impl Filter {
    fn new(outline: &Outline, center: DVec3, normal: DVec3) -> Option<(Room, Self)> {
        let relative: Vec<DVec3> = outline.corners().iter().map(|&p| p - center).collect();
        let spread = Spread::of(&relative, normal)?;
        if outline.is_simple() {
            if let Some((room, halves)) = Halves::new(&relative, normal, spread) {
                return Some((room, Self::Four(halves)));
            }
            if let Some((room, halves)) = Halves::new(&relative, normal, spread) {
                return Some((room, Self::Eight(Box::new(halves))));
            }
        }
        let (room, cells) = Cells::new(outline, center, around(normal), spread)?;
        Some((room, Self::Cells(Box::new(cells))))
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
        let (t, known) = self.facet.pass(ray, |filter, p| match filter {
            Filter::Four(halves) => halves.encloses(p),
            Filter::Eight(halves) => halves.encloses(p),
            Filter::Cells(cells) => Some(cells.encloses(p).unwrap_or_else(|near| {
                cells.is_passed(near, &self.outline, ray.origin, ray.direction)
            })),
            Filter::None => None,
        })?;
        if known.unwrap_or_else(|| self.is_met(ray, t)) { root(ray, t, 0) } else { None }
    }

    fn crossings(&self, _ray: &LocalRay, _out: &mut Vec<Crossing>) {}

    fn surface(&self, point: DVec3, _part: u32) -> LocalSurface {
        let normal = self.facet.normal;
        let offset = point - self.facet.point;
        let offset = offset - normal * offset.dot(normal);
        let (x, z) = around(normal);
        let uv = (DVec2::new(offset.dot(x), -offset.dot(z)) - self.uv_min) / self.uv_size;
        LocalSurface {
            point: self.facet.point + offset,
            error: self.facet.error,
            normal,
            shading_normal: normal,
            uv: uv.clamp(DVec2::ZERO, DVec2::ONE),
            dpdu: x * self.uv_size.x,
            dpdv: -z * self.uv_size.y,
        }
    }

    fn memory_bytes(&self) -> usize {
        self.outline.memory_bytes()
            + match &self.facet.filter {
                Filter::Four(_) | Filter::None => 0,
                Filter::Eight(halves) => size_of_val(&**halves),
                Filter::Cells(cells) => size_of_val(&**cells) + cells.memory_bytes(),
            }
    }

    fn surface_point(&self, point: DVec3, _part: u32) -> SurfacePoint {
        let normal = self.facet.normal;
        let offset = point - self.facet.point;
        let offset = offset - normal * offset.dot(normal);
        SurfacePoint {
            point: self.facet.point + offset,
            error: self.facet.error,
            normal,
            shading_normal: normal,
        }
    }
}

#[cfg(test)]
mod tests;
