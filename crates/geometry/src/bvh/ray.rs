// SPDX-License-Identifier: MIT OR Apache-2.0
//! A ray as boxes see it.
//!
//! Slabs after Ize, "Robust BVH Ray Traversal", JCGT 2(2), 2013, with its relative factor replaced by
//! an absolute pad, which also covers hits a little behind the origin.

use dioptric_math::{DVec3, Vec4};

use super::Bvh;

/// A ray in single precision: about the tree's centre, its direction scaled so that the largest
/// component is about 1.
///
/// The box test is `plane * inverse - near` and `plane * inverse - far`, fused or not.
#[derive(Clone, Copy, Debug)]
pub struct BoxRay {
    /// The origin moved by the pad along the direction, in each axis, times `inverse`: near planes come
    /// earlier.
    pub(super) near: [f32; 3],
    /// The origin moved back, times `inverse`: far planes come later.
    pub(super) far: [f32; 3],
    /// 1 / direction.
    pub(super) inverse: [f32; 3],
    /// 1 where the direction is negative: which side of a box is the near one.
    pub(super) negative: [usize; 3],
    /// From `t` to the scaled direction's.
    pub(super) scale: f64,
}

/// Components of the direction below this part of the largest count as this much: up to a box
/// that moves a ray by less than its pad and the box's margin, and products with f32's coordinates stay finite.
const SMALLEST: f32 = 1e-9;
/// What the test of a box may be off by, as a part of the largest coordinates of origin and box together: the ray's pad
/// has it for the origin, boxes in the tree are larger by it for their own.
///
/// In units of 2^-24 of both: the rounding of the scaled direction 1, of its inverse 1, of the origin 1, of moving it 1,
/// of its product 1, of the plane's product 1, of the difference 2, since both products together may be twice as
/// large, and of the larger box 1; directions that are nearly along a plane ([`SMALLEST`]) 1; the rest for the
/// roundings of the pads.
pub(super) const MARGIN: f32 = 18.0 / (1u32 << 24) as f32;
/// Covers two roundings.
const UP: f32 = 1.0 + 3e-7;
/// Coordinates above this are not looked at: all boxes are entered.
const LARGEST: f32 = 1e28;

/// A ray in single precision before the boxes' planes are looked at; what filters of the things in the leaves are
/// made of, too.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Start {
    pub ray: BoxRay,
    /// Where it starts, about the tree's centre.
    pub origin: Vec4,
    /// Where it goes, scaled so that the largest component is about 1.
    pub direction: Vec4,
    /// 1 over that.
    pub inverse: Vec4,
    /// The largest coordinate of the origin, about the tree's centre, rounded up.
    pub away: f32,
    /// The axis along which the direction is longest.
    pub axis: usize,
    /// Whether single precision is any use.
    pub usable: bool,
}

impl BoxRay {
    /// A ray for this tree. All boxes count as larger by `pad` on every side: what the things in the
    /// leaves may lie outside of their boxes. The test's own errors come on top of that.
    #[inline(always)]
    #[must_use]
    pub fn new(origin: DVec3, direction: DVec3, bvh: &Bvh, pad: f64) -> Self {
        Start::new(origin, direction, bvh, pad as f32).ray
    }
}

impl Start {
    /// See [`BoxRay::new`]; the pad may be off by a rounding.
    #[inline(always)]
    pub fn new(origin: DVec3, direction: DVec3, bvh: &Bvh, pad: f32) -> Self {
        let relative = single(origin - bvh.center);
        let away = relative.abs().max_element() * UP;
        let reach = away + bvh.extent as f32;
        // The last term counts where f32 has few digits left.
        let pad = pad * UP + away * MARGIN + f32::MIN_POSITIVE;
        let near_one = single(direction);
        let size = near_one.abs().max_element();
        // False where NaN, too. A ray without use enters all boxes.
        let mut usable = reach + pad < LARGEST;
        // Nearly always so, and a division less.
        let (direction, scale) = if size > 0.5 && size < 2.0 {
            (near_one, 1.0)
        } else {
            let scale = direction.abs().max_element();
            usable &= scale > 0.0 && scale < f64::INFINITY;
            // Scales below 1e-308 have no inverse, but the largest number does as well.
            (single(direction * (1.0 / scale).min(f64::MAX)), scale)
        };
        let size = direction.abs();
        let inverse = Vec4::ONE / size.max(Vec4::splat(SMALLEST)).copysign(direction);
        let step = Vec4::splat(pad).copysign(direction);
        let ray = if usable {
            BoxRay {
                near: ((relative + step) * inverse).truncate().to_array(),
                far: ((relative - step) * inverse).truncate().to_array(),
                inverse: inverse.truncate().to_array(),
                negative: [0, 1, 2].map(|axis| (direction[axis].to_bits() >> 31) as usize),
                scale,
            }
        } else {
            let negative = [0, 1, 2].map(|axis| (direction[axis].to_bits() >> 31) as usize);
            let inverse = negative.map(|side| 1.0 - 2.0 * side as f32);
            BoxRay { near: [f32::MAX; 3], far: [f32::MIN; 3], inverse, negative, scale }
        };
        let longest = size.cmpeq(Vec4::splat(size.max_element())).bitmask();
        let axis = (longest.trailing_zeros() as usize).min(2);
        Self { ray, origin: relative, direction, inverse, away, axis, usable }
    }
}

#[inline(always)]
fn single(v: DVec3) -> Vec4 {
    Vec4::new(v.x as f32, v.y as f32, v.z as f32, 0.0)
}

impl BoxRay {
    /// `t_max` in the scaled direction's units, rounded up.
    #[inline(always)]
    pub(crate) fn limit(&self, t_max: f64) -> f32 {
        // Cheaper than the next number up, and no less.
        (((t_max * self.scale) as f32) * UP + f32::MIN_POSITIVE).min(f32::MAX)
    }
}
