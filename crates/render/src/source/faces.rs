// SPDX-License-Identifier: MIT OR Apache-2.0
//! Flat faces with straight sides, found uniformly over the solid angle that they fill; a rectangle that is alone and far
//! away, uniformly over its area.
//!
//! Everything is worked out from differences of corners that stay exact far away, so that a face that fills
//! 1e-20 of the sky is sampled as well as one that fills half of it.

use dioptric_math::bounds::gamma;
use dioptric_math::{DVec3, atan2, normalize, sin};

use super::patch::{Found, Met};
use super::rectangle::{Rectangle, Spot, View};

/// A triangle, or a rectangle (right-angled).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Face {
    corner: DVec3,
    edges: [DVec3; 2],
    /// The product of the edges, and the unit vector along it.
    span: DVec3,
    normal: DVec3,
    area: f64,
    /// Unit vectors along the edges, and how long these are.
    axes: [DVec3; 2],
    lengths: [f64; 2],
    is_triangle: bool,
    /// Which part of the object it is.
    part: u32,
}

impl Face {
    /// The triangle between two edges that leave a corner; `None` where they span nothing.
    pub fn triangle(corner: DVec3, edges: [DVec3; 2], part: u32) -> Option<Self> {
        let span = edges[0].cross(edges[1]);
        let normal = normalize(span)?;
        let axes = [normalize(edges[0])?, normalize(edges[1])?];
        let lengths = edges.map(DVec3::length);
        let known = corner.is_finite() && span.is_finite();
        let area = 0.5 * span.length();
        let is_triangle = true;
        known.then_some(Self {
            corner,
            edges,
            span,
            normal,
            area,
            axes,
            lengths,
            is_triangle,
            part,
        })
    }

    /// Pushes a parallelogram: one face if it is a rectangle, else two.
    pub fn parallelogram(corner: DVec3, edges: [DVec3; 2], part: u32, out: &mut Vec<Self>) {
        let [u, v] = edges;
        if u.dot(v).abs() <= 1e-13 * u.length() * v.length() {
            let half = Self::triangle(corner, edges, part);
            out.extend(half.map(|f| Self { is_triangle: false, area: 2.0 * f.area, ..f }));
        } else {
            out.extend(Self::triangle(corner, [u, u + v], part));
            out.extend(Self::triangle(corner, [u + v, v], part));
        }
    }

    /// All corners.
    pub fn corners(&self) -> impl Iterator<Item = DVec3> + Clone {
        let (c, [u, v]) = (self.corner, self.edges);
        let rectangle = (!self.is_triangle).then_some(c + u + v);
        [c, c + u, c + v].into_iter().chain(rectangle)
    }

    /// A point, uniform over the area.
    pub fn point(&self, u: [f64; 2]) -> DVec3 {
        let [mut a, mut b] = u;
        if self.is_triangle && a + b > 1.0 {
            (a, b) = (1.0 - a, 1.0 - b);
        }
        self.corner + self.edges[0] * a + self.edges[1] * b
    }

    pub const fn area(&self) -> f64 {
        self.area
    }

    pub const fn part(&self) -> u32 {
        self.part
    }

    pub const fn normal(&self) -> DVec3 {
        self.normal
    }

    /// The way to its plane along the normal; `None` from points in it, within rounding.
    fn height(&self, point: DVec3) -> Option<f64> {
        let height = (self.corner - point).dot(self.normal);
        let rounding = gamma(32) * (self.corner.abs().max_element() + point.abs().max_element());
        (height.abs() > rounding).then_some(height)
    }

    /// A rectangle, if it is one.
    #[inline(always)]
    pub const fn rectangle(&self) -> Option<Rectangle> {
        let Self { corner, axes, lengths, normal, area, .. } = *self;
        if self.is_triangle {
            None
        } else {
            Some(Rectangle { corner, axes, lengths, normal, area })
        }
    }

    /// The face as it is seen from a point at a height.
    fn seen(&self, point: DVec3, height: f64) -> Option<Seen> {
        let a = self.corner - point;
        let ([e, f], det) = (self.edges, height.abs() * self.span.length());
        let view = self.rectangle().map(|r| r.view(point));
        let whole = match &view {
            None => solid_angle([a, a + e, a + f], det),
            Some(view) if !view.odd => view.solid_angle,
            Some(_) => {
                let d = a + e + f;
                solid_angle([a, a + e, d], det) + solid_angle([a, d, a + f], det)
            }
        };
        let usable = whole > 0.0 && whole.is_finite();
        usable.then_some(Seen { a, height, det, view, solid_angle: whole })
    }

    /// A place on it that was picked by its area.
    const fn spot(&self, spot: &Spot) -> Found {
        let Spot { direction, distance, density, .. } = *spot;
        Found { direction, distance, normal: self.normal, density, part: self.part }
    }

    /// The part of the face in one of the directions in which it is seen, uniform over them.
    fn sample(&self, seen: &Seen, u: [f64; 2]) -> Option<Found> {
        let ([e, f], a) = (self.edges, seen.a);
        let found = |direction: DVec3, distance: f64| {
            (distance > 0.0 && distance.is_finite()).then_some(Found {
                direction,
                distance,
                normal: self.normal,
                density: 1.0 / seen.solid_angle,
                part: self.part,
            })
        };
        if let (Some(rectangle), Some(view)) = (self.rectangle(), seen.view) {
            let look = rectangle.look(&view, u);
            if look.fits && !view.odd {
                return found(look.direction, look.distance);
            }
        }
        let direction = if self.is_triangle {
            in_triangle([a, a + e, a + f], [e, f], seen, u)?
        } else {
            // The two halves, each in proportion.
            let d = e + f;
            let first = solid_angle([a, a + e, a + d], seen.det) / seen.solid_angle;
            if u[0] < first {
                let half = Seen { solid_angle: first * seen.solid_angle, ..*seen };
                in_triangle([a, a + e, a + d], [e, d], &half, [u[0] / first, u[1]])?
            } else {
                let half = Seen { solid_angle: (1.0 - first) * seen.solid_angle, ..*seen };
                let rest = (u[0] - first) / (1.0 - first);
                in_triangle([a, a + d, a + f], [d, f], &half, [rest, u[1]])?
            }
        };
        found(direction, seen.height / direction.dot(self.normal))
    }
}

/// A face from a point.
#[derive(Clone, Copy)]
struct Seen {
    /// The way to the first corner.
    a: DVec3,
    /// The way to the plane along the normal.
    height: f64,
    /// Six times the volume between the point and the triangle of the edges, without sign.
    det: f64,
    view: Option<View>,
    solid_angle: f64,
}

/// The solid angle of a triangle whose corners are at these ways, `det` being `|a . (b x c)|` (van Oosterom and
/// Strackee, "The Solid Angle of a Plane Triangle", IEEE Trans. Biomed. Eng. 30(2), 1983).
fn solid_angle([a, b, c]: [DVec3; 3], det: f64) -> f64 {
    let [i, j, k] = [a, b, c].map(DVec3::length);
    2.0 * atan2(det, i * j * k + a.dot(b) * k + a.dot(c) * j + b.dot(c) * i)
}

/// A direction of a triangle, uniform over its solid angle (Arvo, "Stratified Sampling of Spherical Triangles",
/// SIGGRAPH 1995). `edges` lead from corner `a` to the others.
///
/// The area `w` of the part of the triangle up to the direction's great circle through `b` fixes the point C of
/// the side `a c` on that circle. Arvo's formula for the cosine of its way from `a` loses all digits for small
/// triangles; one minus it is, by the sums of sines and cosines,
/// `2 s^2 (2 - h) / (2 s^2 + h sin(A) sin(A - w))` with `s = sin(w / 2)`, the angle A at `a`, and
/// `h = 1 - cos` of the side `a b`.
fn in_triangle(
    [a, b, c]: [DVec3; 3],
    edges: [DVec3; 2],
    seen: &Seen,
    u: [f64; 2],
) -> Option<DVec3> {
    let [ua, ub] = [normalize(a)?, normalize(b)?];
    let [tb, tc] = edges.map(|e| e - ua * ua.dot(e));
    let angle = atan2(seen.det / a.length(), tb.dot(tc));
    let (sin_angle, w) = (sin(angle), u[0] * seen.solid_angle);
    let along = ua.dot(ub);
    let h = if along > 0.0 {
        let sine = ua.cross(edges[0]).length() / b.length();
        sine * sine / (1.0 + along)
    } else {
        1.0 - along
    };
    let s = sin(0.5 * w);
    let below = 2.0 * s * s + h * sin_angle * sin(angle - w);
    let up = if below > 0.0 { 2.0 * s * s * (2.0 - h) / below } else { 0.0 };
    // No further than to c.
    let end = if ua.dot(normalize(c)?) > 0.0 { 1.0 } else { 2.0 };
    let up = up.clamp(0.0, end);
    let on_side = ua * (1.0 - up) + normalize(tc)? * (up * (2.0 - up)).sqrt();
    let away = u[1] * 0.5 * (on_side - ub).length_squared();
    let out = on_side - ub * ub.dot(on_side);
    let direction = match normalize(out) {
        Some(out) => ub * (1.0 - away) + out * (away * (2.0 - away)).max(0.0).sqrt(),
        None => ub,
    };
    normalize(direction)
}

/// Some faces: two halves of a parallelogram, or all of a convex solid.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Faces {
    faces: Vec<Face>,
    /// Whether they enclose a convex solid, their normals outward: then those that face away from a point
    /// outside are behind the others.
    closed: bool,
}

/// The most that are looked at for each sample.
pub(super) const MOST: usize = 16;

impl Faces {
    /// `None` where there are none or too many.
    pub fn new(faces: Vec<Face>, closed: bool) -> Option<Self> {
        (!faces.is_empty() && faces.len() <= MOST).then_some(Self { faces, closed })
    }

    /// The faces of a convex solid, their edges put in the order that makes their normals point outwards.
    pub fn solid(mut faces: Vec<Face>) -> Option<Self> {
        let corners = faces.iter().flat_map(Face::corners);
        let (sum, count) = corners.fold((DVec3::ZERO, 0.0), |(s, n), c| (s + c, n + 1.0));
        for face in &mut faces {
            if (face.corner - sum / count).dot(face.normal) < 0.0 {
                face.edges.reverse();
                (face.span, face.normal) = (-face.span, -face.normal);
            }
        }
        Self::new(faces, true)
    }

    pub fn faces(&self) -> &[Face] {
        &self.faces
    }

    /// The way from a point to the sides of a box around it that holds all faces.
    pub fn half(&self, center: DVec3) -> DVec3 {
        let corners = self.faces.iter().flat_map(Face::corners);
        let room = 1.0 + 1e-9;
        corners.fold(DVec3::ZERO, |half, c| half.max((c - center).abs())) * room
    }

    pub fn area(&self) -> f64 {
        self.faces.iter().map(Face::area).sum()
    }

    /// A point, uniform over the area, its normal and part.
    pub fn point(&self, u: [f64; 2]) -> Option<(DVec3, DVec3, u32)> {
        let mut rest = u[0] * self.area();
        for face in &self.faces {
            let own = face.area();
            if rest < own {
                return Some((face.point([rest / own, u[1]]), face.normal, face.part));
            }
            rest -= own;
        }
        None
    }

    /// The faces that a point sees, and all their solid angle.
    fn seen(&self, point: DVec3) -> ([Option<Seen>; MOST], f64) {
        let mut heights = [None; MOST];
        let mut outside = false;
        for (height, face) in heights.iter_mut().zip(&self.faces) {
            *height = face.height(point);
            outside |= self.closed && height.is_some_and(|h| h < 0.0);
        }
        let mut all = [None; MOST];
        let mut sum = 0.0;
        for ((seen, face), height) in all.iter_mut().zip(&self.faces).zip(heights) {
            *seen = height.filter(|&h| !outside || h < 0.0).and_then(|h| face.seen(point, h));
            sum += seen.map_or(0.0, |s: Seen| s.solid_angle);
        }
        (all, sum)
    }

    pub fn sample(&self, point: DVec3, u: [f64; 2]) -> Option<Found> {
        if let [face] = self.faces.as_slice() {
            let height = face.height(point)?;
            return match face.rectangle().filter(|r| r.is_far(point)) {
                Some(far) => Some(face.spot(&far.spot(point, u))),
                None => face.sample(&face.seen(point, height)?, u),
            };
        }
        let (all, sum) = self.seen(point);
        let mut rest = u[0] * sum;
        for (seen, face) in all.iter().zip(&self.faces) {
            let Some(seen) = seen else { continue };
            if rest < seen.solid_angle {
                let found = face.sample(seen, [rest / seen.solid_angle, u[1]])?;
                return Some(Found { density: 1.0 / sum, ..found });
            }
            rest -= seen.solid_angle;
        }
        None
    }

    /// The density with which [`Self::sample`] finds what a ray met of it.
    pub fn density(&self, point: DVec3, met: &Met) -> f64 {
        let sum = match self.faces.as_slice() {
            [face] if face.rectangle().is_some_and(|r| r.is_far(point)) => {
                let per_area = face.height(point).map_or(0.0, |_| 1.0 / face.area);
                return met.per_solid_angle(per_area);
            }
            [face] => {
                let seen = face.height(point).and_then(|h| face.seen(point, h));
                seen.map_or(0.0, |s| s.solid_angle)
            }
            _ => self.seen(point).1,
        };
        if sum > 0.0 { 1.0 / sum } else { 0.0 }
    }
}
