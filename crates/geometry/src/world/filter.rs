// SPDX-License-Identifier: MIT OR Apache-2.0
//! What single precision knows of an object: enough to turn most rays away that enter its box and miss it.

use dioptric_math::DVec3;

use crate::bounds::Bounds;
use crate::bvh::packet::Packet;
use crate::bvh::packet::rows::{Mask, Row, Rows};
use crate::shapes::AnyShape;

/// A simple figure around an object, about the centre of its tree.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
pub(super) struct Filter {
    kind: Kind,
    radius: f32,
    center: [f32; 3],
    /// Along a tube, or at right angles to a disc.
    axis: [f32; 3],
}

#[derive(Clone, Copy, Debug)]
enum Kind {
    /// All points within `radius` of `center`.
    Ball,
    /// All points within `radius` of the line through `center`.
    Tube,
    /// The points of the plane through `center` that are within `radius` of it.
    Disc,
}

impl Filter {
    /// The figure around a shape; `placed` is its box in the tree's space, and `moved` tells that the shape has a
    /// transform.
    pub fn new(shape: &AnyShape, placed: &Bounds, moved: bool, center: DVec3) -> Self {
        let middle = placed.center();
        let half = placed.size() * 0.5;
        let ball = Self::make(Kind::Ball, half.length(), middle - center, DVec3::ZERO);
        if moved {
            return ball;
        }
        match shape {
            AnyShape::Sphere(_) => Self { radius: up(half.max_element()), ..ball },
            AnyShape::Cylinder(s) => Self::tube(s.tube(), center),
            AnyShape::Cone(s) => Self::tube(s.tube(), center),
            AnyShape::Triangle(_)
            | AnyShape::Polygon(_)
            | AnyShape::Rectangle(_)
            | AnyShape::Disc(_) => {
                let on = shape.surface_point(middle, 0);
                let foot = middle - on.normal * (middle - on.point).dot(on.normal);
                Self::make(Kind::Disc, half.length(), foot - center, on.normal)
            }
            _ => ball,
        }
    }

    fn tube((base, axis, radius): (DVec3, DVec3, f64), center: DVec3) -> Self {
        Self::make(Kind::Tube, radius, base - center, axis)
    }

    fn make(kind: Kind, radius: f64, center: DVec3, axis: DVec3) -> Self {
        let single = |v: DVec3| v.to_array().map(|x| x as f32);
        Self { kind, radius: up(radius), center: single(center), axis: single(axis) }
    }

    /// Which of the rays may hit. Coordinates are wrong by at most a few 2^-24 of the reach each, which the
    /// packet's pads are for.
    #[inline(always)]
    pub fn test<R: Rows>(&self, packet: &Packet) -> Mask {
        let d = load::<R>(&packet.direction);
        let f = minus(load::<R>(&packet.origin), splat(self.center));
        let pad = R::load(&packet.pad);
        let room = R::splat(self.radius).add(pad);
        match self.kind {
            Kind::Ball => {
                // The point of the line that is nearest to the centre, from a short vector.
                let b = dot(f, d);
                let n = minus(f, [d[0].mul(b), d[1].mul(b), d[2].mul(b)]);
                let near = dot(n, n).le(room.mul(room));
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
                // Twice the pad: the error of n counts with the whole reach, however small n is.
                let apart = dot(f, n).abs();
                apart.le(room.mul_add(dot(n, n).sqrt(), pad.add(pad)))
            }
            Kind::Disc => {
                let a = splat::<R>(self.axis);
                let slope = dot(a, d);
                let steep = slope.abs();
                let zero = R::splat(0.0);
                let t = zero.sub(dot(a, f).div(slope));
                // Errors of the height and of the slope (2^-22 at most), over the slope.
                let error = t.abs().mul_add(R::splat(5e-7), pad.mul(R::splat(6.0)));
                let wrong = error.div(steep);
                let p = [d[0].mul_add(t, f[0]), d[1].mul_add(t, f[1]), d[2].mul_add(t, f[2])];
                let room = room.add(wrong);
                let far = room.mul(room).le(dot(p, p));
                let behind = t.le(zero.sub(wrong));
                let beyond = R::load(&packet.limit).add(wrong).le(t);
                // Nothing is said of rays along the plane.
                !(far | behind | beyond) | steep.le(R::splat(1e-6))
            }
        }
    }
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
