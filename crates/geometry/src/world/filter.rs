// SPDX-License-Identifier: MIT OR Apache-2.0
//! What single precision knows of an object: enough to turn most rays away that enter its box and miss it.

use dioptric_math::DVec3;

use crate::bounds::Bounds;
use crate::bvh::packet::Packet;
use crate::bvh::packet::rows::{LANES, Mask, Row, Rows};
use crate::shapes::AnyShape;

/// A simple figure around an object, about the centre of its tree.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(super) struct Filter {
    kind: Kind,
    /// Which rays that leave the object hit it no more.
    gone: Gone,
    radius: f32,
    center: [f32; 3],
    /// Along a tube, or at right angles to something flat.
    axis: [f32; 3],
    /// What is multiplied with a point's offset from the centre for its coordinates in something flat.
    sides: [[f32; 3]; 2],
    /// Half the length of a tube; or how far corners lie off a plane.
    extent: f32,
}

#[derive(Clone, Copy, Debug)]
enum Kind {
    /// All points within `radius` of `center`.
    Ball,
    /// All points within `radius` of the line through `center`, and within `extent` of it along the axis.
    Tube,
    /// The points of the plane through `center` that are within `radius` of it.
    Disc,
    /// The points of the plane through `center` with two coordinates of at least 0 whose sum is at most 1; both grow
    /// by at most `radius` a unit of length, and so does their sum.
    Triangle,
    /// The same with coordinates from -1 to 1.
    Rectangle,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Gone {
    /// Perhaps none.
    None,
    /// Those that leave it outwards: it is convex.
    Outward,
    /// All: it is flat.
    All,
}

/// What each ray of a packet leaves.
pub(super) struct Left {
    /// The object's id; NaN where there is none.
    object: Row,
    /// Rays that leave outwards.
    outward: Mask,
}

impl Left {
    /// No object.
    pub const NOTHING: Self = Self { object: Row::splat(f32::NAN), outward: 0 };

    /// From objects and whether they are left outwards.
    #[inline(always)]
    pub fn of(departures: impl Iterator<Item = Option<(u32, bool)>>) -> Self {
        // Larger numbers would be rounded.
        const EXACT: u32 = 1 << 24;
        let mut left = Self::NOTHING;
        for (lane, (object, outward)) in departures.enumerate().filter_map(|(i, d)| Some((i, d?))) {
            if object < EXACT {
                left.object.0[lane % LANES] = object as f32;
                left.outward |= Mask::from(outward) << lane;
            }
        }
        left
    }

    /// Which rays leave an object and do not hit it any more.
    #[inline(always)]
    pub fn gone<R: Rows>(&self, filter: &Filter, object: u32) -> Mask {
        if filter.gone == Gone::None {
            return 0;
        }
        let (left, object) = (R::load(&self.object), R::splat(object as f32));
        let own = left.le(object) & object.le(left);
        if filter.gone == Gone::All { own } else { own & self.outward }
    }
}

impl Filter {
    /// The figure around a shape; `placed` is its box in the tree's space, and `moved` tells that the shape has a
    /// transform.
    pub fn new(shape: &AnyShape, placed: &Bounds, moved: bool, center: DVec3) -> Self {
        let gone = match shape {
            _ if shape.is_flat() => Gone::All,
            _ if shape.is_convex() => Gone::Outward,
            _ => Gone::None,
        };
        let middle = placed.center();
        let half = placed.size() * 0.5;
        let ball =
            Self { gone, ..Self::make(Kind::Ball, half.length(), middle - center, DVec3::ZERO) };
        if moved {
            return ball;
        }
        let figure = match shape {
            AnyShape::Sphere(_) => Self { radius: up(half.max_element()), ..ball },
            AnyShape::Cylinder(s) => Self::tube(s.tube(), center),
            AnyShape::Cone(s) => Self::tube(s.tube(), center),
            AnyShape::Triangle(s) => Self::flat(s.flat(), center),
            AnyShape::Polygon(s) => Self::flat(s.flat(), center),
            AnyShape::Rectangle(s) => {
                let (plane, corners) = s.flat();
                Self::flat((plane, &corners, 0.0), center)
            }
            AnyShape::Disc(_) => {
                let on = shape.surface_point(middle, 0);
                let foot = middle - on.normal * (middle - on.point).dot(on.normal);
                Self::make(Kind::Disc, half.length(), foot - center, on.normal)
            }
            _ => ball,
        };
        Self { gone, ..figure }
    }

    fn tube((base, axis, height, radius): (DVec3, DVec3, f64, f64), center: DVec3) -> Self {
        let middle = base + axis * (0.5 * height) - center;
        Self { extent: up(0.5 * height), ..Self::make(Kind::Tube, radius, middle, axis) }
    }

    /// Around what lies in a plane (a point of it and its normal) between corners, which lie so far off it at most.
    fn flat(((point, normal), corners, off): (Plane, &[DVec3], f64), center: DVec3) -> Self {
        let on_plane = |p: DVec3| p - normal * (p - point).dot(normal);
        let corners: Vec<DVec3> = corners.iter().map(|&p| on_plane(p)).collect();
        let middle = on_plane(Bounds::of(corners.iter().copied()).center());
        let radius = corners.iter().fold(0.0, |all: f64, &p| all.max((p - middle).length()));
        let disc =
            Self { extent: up(off), ..Self::make(Kind::Disc, radius, middle - center, normal) };
        let figure = match corners.as_slice() {
            &[a, b, c] => duals(b - a, c - a, normal).map(|(u, v)| (Kind::Triangle, a, u, v)),
            _ if corners.len() <= FEW_CORNERS => around(&corners, normal, middle),
            _ => None,
        };
        let Some((kind, origin, u, v)) = figure else { return disc };
        let steepest = u.length().max(v.length()).max((u + v).length());
        let sides = [u, v].map(single);
        let all = Self { sides, ..Self::make(kind, steepest, origin - center, normal) };
        if all.radius.is_finite() { Self { extent: disc.extent, ..all } } else { disc }
    }

    fn make(kind: Kind, radius: f64, center: DVec3, axis: DVec3) -> Self {
        Self {
            kind,
            gone: Gone::None,
            radius: up(radius),
            center: single(center),
            axis: single(axis),
            sides: [[0.0; 3]; 2],
            extent: 0.0,
        }
    }

    /// Which of the rays may hit. Coordinates are wrong by at most a few 2^-24 of the reach each, which the
    /// packet's pads are for.
    #[inline(always)]
    pub fn test<R: Rows>(&self, packet: &Packet) -> Mask {
        let d = load::<R>(&packet.direction);
        let f = minus(load::<R>(&packet.origin), splat(self.center));
        let pad = R::load(&packet.pad);
        let room = R::splat(self.radius).add(pad);
        // Added to squares, which lose their digits below.
        let least = R::splat(f32::MIN_POSITIVE);
        match self.kind {
            Kind::Ball => {
                // The point of the line that is nearest to the centre, from a short vector.
                let b = dot(f, d);
                let n = minus(f, [d[0].mul(b), d[1].mul(b), d[2].mul(b)]);
                let near = dot(n, n).le(room.mul_add(room, least));
                // The whole ball lies behind, or beyond the limit.
                let ahead = b.le(room) & R::splat(0.0).sub(b).sub(room).le(R::load(&packet.limit));
                near & ahead
            }
            Kind::Tube => {
                let a = splat::<R>(self.axis);
                let n = [
                    d[1].mul(a[2]).sub(d[2].mul(a[1])),
                    d[2].mul(a[0]).sub(d[0].mul(a[2])),
                    d[0].mul(a[1]).sub(d[1].mul(a[0])),
                ];
                // The line's distance from the axis times the sine s of their angle is at most s times the room, and
                // twice the pad: the error of n counts with the whole reach, however small n is. Without the root:
                // (a + b)^2 is at most a^2 (1 + 1/64) + 65 b^2, and a little more for roundings.
                let square = dot(n, n);
                let apart = dot(f, n);
                let within = room.mul(room).mul(square).mul_add(R::splat(1.016), least);
                let near = apart.mul(apart).le(pad.mul(pad).mul_add(R::splat(261.0), within));
                // Where ray and axis are nearest to each other, along both, and how far from there the ray is in the
                // tube at most. Numerators are off by less than a pad; where the sine is at least 1/4, its square is
                // off by less than its 2^-18th part, which of the numerators is less than 8 pads. And 1/s is at most
                // (1 + 1/s^2) / 2.
                let (cosine, along, ahead) = (dot(d, a), dot(f, a), dot(f, d));
                let over = R::splat(1.0).div(square);
                let t = cosine.mul(along).sub(ahead).mul(over);
                let height = along.sub(cosine.mul(ahead)).mul(over);
                let error = pad.mul(over).mul(R::splat(16.0));
                let half = over.add(R::splat(1.0)).mul(R::splat(0.500_001)).mul_add(room, error);
                let beside = cosine.abs().mul_add(half, R::splat(self.extent)).add(error);
                let zero = R::splat(0.0);
                let passes = zero.sub(half).le(t)
                    & t.sub(half).le(R::load(&packet.limit))
                    & height.abs().le(beside);
                near & (passes | square.le(R::splat(1.0 / 16.0)))
            }
            Kind::Disc | Kind::Triangle | Kind::Rectangle => {
                let a = splat::<R>(self.axis);
                let slope = dot(a, d);
                let steep = slope.abs();
                let zero = R::splat(0.0);
                let over = R::splat(1.0).div(slope);
                let t = zero.sub(dot(a, f).mul(over));
                // Errors of the height, of the slope (2^-22 at most) and two roundings, and how far the object may
                // lie off the plane, over the slope.
                let error = t.abs().mul_add(R::splat(5e-7), pad.mul(R::splat(6.0)));
                let wrong = error.add(R::splat(self.extent)).mul(over.abs());
                let p = [d[0].mul_add(t, f[0]), d[1].mul_add(t, f[1]), d[2].mul_add(t, f[2])];
                let far = match self.kind {
                    Kind::Triangle | Kind::Rectangle => {
                        let (u, v) = (dot(p, splat(self.sides[0])), dot(p, splat(self.sides[1])));
                        // The place is wrong by no more than that and two pads, the products by another one.
                        let wrong = pad.mul_add(R::splat(3.0), wrong);
                        let slack = R::splat(self.radius).mul(wrong);
                        let most = R::splat(1.0).add(slack);
                        if matches!(self.kind, Kind::Triangle) {
                            let low = zero.sub(slack);
                            u.le(low) | v.le(low) | most.le(u.add(v))
                        } else {
                            most.le(u.abs()) | most.le(v.abs())
                        }
                    }
                    _ => {
                        let room = room.add(wrong);
                        room.mul_add(room, least).le(dot(p, p))
                    }
                };
                let behind = t.le(zero.sub(wrong));
                let beyond = R::load(&packet.limit).add(wrong).le(t);
                // Nothing is said of rays along the plane.
                !(far | behind | beyond) | steep.le(R::splat(1e-6))
            }
        }
    }
}

/// A point of a plane, and its normal.
type Plane = (DVec3, DVec3);

/// Outlines with more corners are seen as discs.
const FEW_CORNERS: usize = 8;

/// The vectors whose products with `u` and `v` are 1 and 0, and 0 and 1, in the plane of both.
fn duals(u: DVec3, v: DVec3, normal: DVec3) -> Option<(DVec3, DVec3)> {
    let (a, b) = (v.cross(normal), normal.cross(u));
    let (a, b) = (a / u.dot(a), b / v.dot(b));
    (a.is_finite() && b.is_finite()).then_some((a, b))
}

/// The least parallelogram around corners, of those with two sides along neighbouring edges, or with one along an edge
/// and a right angle.
fn around(corners: &[DVec3], normal: DVec3, middle: DVec3) -> Option<(Kind, DVec3, DVec3, DVec3)> {
    let mut best: Option<(f64, DVec3, DVec3, DVec3)> = None;
    let n = corners.len();
    for i in 0..n {
        let (before, at, after) = (corners[(i + n - 1) % n], corners[i], corners[(i + 1) % n]);
        let along = after - at;
        for other in [before - at, normal.cross(along)] {
            let Some((u, v)) = duals(along, other, normal) else { continue };
            let range = |side: DVec3| {
                let start = (f64::INFINITY, f64::NEG_INFINITY);
                corners.iter().fold(start, |(low, high), &p| {
                    let x = (p - middle).dot(side);
                    (low.min(x), high.max(x))
                })
            };
            let ((u0, u1), (v0, v1)) = (range(u), range(v));
            let area = (u1 - u0) * (v1 - v0) * along.cross(other).length();
            // Half a width is 1.
            let (half_u, half_v) = (0.5 * (u1 - u0), 0.5 * (v1 - v0));
            let origin = middle + along * (u0 + half_u) + other * (v0 + half_v);
            if area > 0.0 && best.is_none_or(|b| area < b.0) {
                best = Some((area, origin, u / half_u, v / half_v));
            }
        }
    }
    let (_, origin, u, v) = best?;
    Some((Kind::Rectangle, origin, u, v))
}

fn single(v: DVec3) -> [f32; 3] {
    v.to_array().map(|x| x as f32)
}

#[inline(always)]
fn load<R: Rows>(rows: &[Row; 3]) -> [R; 3] {
    [R::load(&rows[0]), R::load(&rows[1]), R::load(&rows[2])]
}

#[inline(always)]
fn splat<R: Rows>(v: [f32; 3]) -> [R; 3] {
    [R::splat(v[0]), R::splat(v[1]), R::splat(v[2])]
}

#[inline(always)]
fn minus<R: Rows>(a: [R; 3], b: [R; 3]) -> [R; 3] {
    [a[0].sub(b[0]), a[1].sub(b[1]), a[2].sub(b[2])]
}

#[inline(always)]
fn dot<R: Rows>(a: [R; 3], b: [R; 3]) -> R {
    a[0].mul_add(b[0], a[1].mul_add(b[1], a[2].mul(b[2])))
}

fn up(x: f64) -> f32 {
    (x as f32).next_up()
}
