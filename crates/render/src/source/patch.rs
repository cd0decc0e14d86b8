// SPDX-License-Identifier: MIT OR Apache-2.0
//! Pieces of surface that light can be taken from: which direction to look for one, and how densely.

use dioptric_math::{DAffine3, DMat3, DVec3, normalize};

use super::ball::Ball;
use super::faces::Faces;
use super::ring::Ring;
use super::sheet::Sheet;
use super::triangles::Triangles;
use super::tube::Tube;

/// A point of a surface in a direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Found {
    /// Unit vector towards it.
    pub direction: DVec3,
    /// How far it is.
    pub distance: f64,
    /// Unit normal there, on either side.
    pub normal: DVec3,
    /// The density over solid angles with which it is found.
    pub density: f64,
    /// The part of the object.
    pub part: u32,
}

/// What is known of a point of a surface that a ray met.
#[derive(Clone, Copy, Debug)]
pub(super) struct Met {
    /// Unit vector from the ray's origin.
    pub direction: DVec3,
    pub distance: f64,
    /// Unit normal, on either side.
    pub normal: DVec3,
}

impl Met {
    /// A density over solid angles from one over areas.
    pub fn per_solid_angle(&self, per_area: f64) -> f64 {
        let cos = self.direction.dot(self.normal).abs();
        let density = per_area * self.distance * self.distance / cos;
        if density.is_finite() { density } else { 0.0 }
    }
}

/// A piece of surface.
#[derive(Clone, Debug)]
pub(super) enum Patch {
    Ball(Ball),
    Faces(Faces),
    Ring(Ring),
    Triangles(Triangles),
    Sheet(Sheet),
    Tube(Tube),
    /// A ball or a ring whose transform makes something else of it.
    Moved(Box<Moved>),
}

impl Patch {
    /// A point of it as seen from a point, for uniform `u`. Nothing where it cannot light the point.
    pub fn sample(&self, point: DVec3, u: [f64; 2]) -> Option<Found> {
        let found = match self {
            Self::Ball(ball) => ball.sample(point, u),
            Self::Faces(faces) => faces.sample(point, u),
            Self::Ring(ring) => ring.sample(point, u),
            Self::Triangles(triangles) => triangles.sample(point, u),
            Self::Sheet(sheet) => sheet.sample(point, u),
            Self::Tube(tube) => tube.sample(point, u),
            Self::Moved(moved) => moved.sample(point, u),
        }?;
        let usable = found.density > 0.0
            && found.density.is_finite()
            && found.distance > 0.0
            && found.distance.is_finite();
        usable.then_some(found)
    }

    /// Points spread evenly over its area, for the mean of what it sends: each with a normal and its part.
    pub fn spread(&self, count: u32) -> Vec<(DVec3, DVec3, u32)> {
        let points = (0..count).map(|i| {
            // Hammersley's set.
            let u = [
                (f64::from(i) + 0.5) / f64::from(count),
                f64::from(i.reverse_bits()) * (1.0 / 4_294_967_296.0),
            ];
            match self {
                Self::Ball(ball) => Some(ball.point(u)),
                Self::Faces(faces) => faces.point(u),
                Self::Ring(ring) => Some((ring.point(u), ring.normal, 0)),
                Self::Triangles(triangles) => {
                    triangles.point(u).map(|(p, face)| (p, face.normal(), face.part()))
                }
                Self::Sheet(sheet) => sheet.point(u).map(|(p, n)| (p, n, 0)),
                Self::Tube(tube) => Some(tube.point(u)),
                Self::Moved(_) => None,
            }
        });
        match self {
            Self::Moved(moved) => {
                let placed = moved.patch.spread(count).into_iter();
                placed.map(|(p, n, part)| (moved.place.transform_point3(p), n, part)).collect()
            }
            _ => points.flatten().collect(),
        }
    }

    /// Whether it has places that can be picked wherever they are seen from.
    pub const fn has_places(&self) -> bool {
        !matches!(self, Self::Moved(_))
    }

    /// A point of it wherever it is seen from: uniform over the area, of a ball over those parts that are seen.
    pub fn place(&self, point: DVec3, u: [f64; 2]) -> Option<Found> {
        let (there, normal, part) = match self {
            Self::Ball(ball) => return ball.sample(point, u),
            Self::Faces(faces) => faces.point(u)?,
            Self::Ring(ring) => (ring.point(u), ring.normal, 0),
            Self::Triangles(triangles) => {
                let (there, face) = triangles.point(u)?;
                (there, face.normal(), face.part())
            }
            Self::Sheet(sheet) => sheet.point(u).map(|(p, n)| (p, n, 0))?,
            Self::Tube(tube) => tube.point(u),
            Self::Moved(_) => return None,
        };
        let way = there - point;
        let distance = way.length();
        let direction = way / distance;
        let met = Met { direction, distance, normal };
        Some(Found {
            direction,
            distance,
            normal,
            density: self.density_of_place(point, &met),
            part,
        })
    }

    /// The density with which [`Self::place`] finds what a ray met of it.
    pub fn density_of_place(&self, point: DVec3, met: &Met) -> f64 {
        let area = match self {
            Self::Ball(ball) => return ball.density(point),
            Self::Faces(faces) => faces.area(),
            Self::Ring(ring) => ring.area(),
            Self::Triangles(triangles) => triangles.area(),
            Self::Sheet(sheet) => sheet.area(),
            Self::Tube(tube) => tube.area(),
            Self::Moved(_) => return 0.0,
        };
        met.per_solid_angle(1.0 / area)
    }

    /// The density with which [`Self::sample`] finds what a ray met of it.
    pub fn density(&self, point: DVec3, met: &Met) -> f64 {
        match self {
            Self::Ball(ball) => ball.density(point),
            Self::Faces(faces) => faces.density(point, met),
            Self::Ring(ring) => ring.density(point, met),
            Self::Triangles(triangles) => met.per_solid_angle(1.0 / triangles.area()),
            Self::Sheet(sheet) => met.per_solid_angle(1.0 / sheet.area()),
            Self::Tube(tube) => met.per_solid_angle(1.0 / tube.area()),
            Self::Moved(moved) => moved.density(point, met),
        }
    }
}

/// A patch in its own space. Directions are carried along: where `m` takes directions there from here, a solid
/// angle grows by `|det m| / |m d|^3`.
#[derive(Clone, Debug)]
pub(super) struct Moved {
    pub patch: Patch,
    place: DAffine3,
    to_own: DAffine3,
    det: f64,
}

impl Moved {
    pub fn new(patch: Patch, place: DAffine3) -> Self {
        let to_own = place.inverse();
        let det = to_own.matrix3.determinant().abs();
        Self { patch, place, to_own, det }
    }

    /// From its own space to that of rays: of points, and of normals.
    pub fn frames(&self) -> (&DAffine3, DMat3) {
        (&self.place, self.to_own.matrix3.transpose())
    }

    fn density_here(&self, direction: DVec3, density: f64) -> f64 {
        let length = (self.to_own.matrix3 * direction).length();
        density * self.det / (length * length * length)
    }

    fn sample(&self, point: DVec3, u: [f64; 2]) -> Option<Found> {
        let found = self.patch.sample(self.to_own.transform_point3(point), u)?;
        let way = self.place.transform_vector3(found.direction);
        let direction = normalize(way)?;
        Some(Found {
            direction,
            distance: found.distance * way.length(),
            normal: normalize(self.to_own.matrix3.transpose() * found.normal)?,
            density: self.density_here(direction, found.density),
            part: found.part,
        })
    }

    fn density(&self, point: DVec3, met: &Met) -> f64 {
        let way = self.to_own.matrix3 * met.direction;
        let Some(direction) = normalize(way) else { return 0.0 };
        let normal = self.place.matrix3.transpose() * met.normal;
        let own = Met {
            direction,
            distance: met.distance * way.length(),
            normal: normalize(normal).unwrap_or(met.normal),
        };
        let density = self.patch.density(self.to_own.transform_point3(point), &own);
        let density = self.density_here(met.direction, density);
        if density.is_finite() { density } else { 0.0 }
    }
}
