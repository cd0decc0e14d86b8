// SPDX-License-Identifier: MIT OR Apache-2.0
//! A ray as boxes see it.
//!
//! Slabs after Ize, "Robust BVH Ray Traversal", JCGT 2(2), 2013, with its relative factor replaced by
//! an absolute pad, which also covers hits a little behind the origin.

use dioptric_math::DVec3;

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

/// Components of the direction below this part of the largest count as this much: over the whole scene
/// that moves a ray by less than its pad, and products with f32's coordinates stay finite.
const SMALLEST: f32 = 1e-9;
/// Covers two roundings.
const UP: f32 = 1.0 + 3e-7;
/// Coordinates above this are not looked at: all boxes are entered.
const LARGEST: f64 = 1e28;

impl BoxRay {
    /// A ray for this tree. All boxes count as larger by `pad` on every side: what the things in the
    /// leaves may lie outside of their boxes. The test's own errors come on top of that.
    #[inline(always)]
    #[must_use]
    pub fn new(origin: DVec3, direction: DVec3, bvh: &Bvh, pad: f64) -> Self {
        let scale = direction.abs().max_element();
        let relative = origin - bvh.center;
        let reach = relative.abs().max_element() + bvh.extent;
        // In units of 2^-24 of the reach: the rounding of the scaled direction 1, of its inverse 1, of the
        // moved origin 1, of its product 1, of the plane's product 1 and of the difference 2, since both
        // products together may be twice the reach; then the double errors of the products. The last
        // term counts where f32 has few digits left.
        let pad = pad + reach * (16.0 / f64::from(1u32 << 24)) + f64::from(f32::MIN_POSITIVE);
        // False where NaN, too. A ray without use enters all boxes.
        let usable = reach + pad < LARGEST && scale > 0.0 && scale < f64::INFINITY;
        if !usable {
            let negative = [0, 1, 2].map(|axis| usize::from(direction[axis].is_sign_negative()));
            let inverse = negative.map(|side| 1.0 - 2.0 * side as f32);
            return Self { near: [f32::MAX; 3], far: [f32::MIN; 3], inverse, negative, scale };
        }
        // Nearly always so, and a division less.
        let (direction, scale) = if scale > 0.5 && scale < 2.0 {
            (direction, 1.0)
        } else {
            // Scales below 1e-308 have no inverse, but the largest number does as well.
            (direction * (1.0 / scale).min(f64::MAX), scale)
        };
        let (x, near_x, far_x) = axis(direction.x, relative.x, pad);
        let (y, near_y, far_y) = axis(direction.y, relative.y, pad);
        let (z, near_z, far_z) = axis(direction.z, relative.z, pad);
        let side = |inverse: f32| (inverse.to_bits() >> 31) as usize;
        Self {
            near: [near_x, near_y, near_z],
            far: [far_x, far_y, far_z],
            inverse: [x, y, z],
            negative: [side(x), side(y), side(z)],
            scale,
        }
    }

    /// `t_max` in the scaled direction's units, rounded up.
    #[inline(always)]
    pub(crate) fn limit(&self, t_max: f64) -> f32 {
        // Cheaper than the next number up, and no less.
        (((t_max * self.scale) as f32) * UP + f32::MIN_POSITIVE).min(f32::MAX)
    }
}

/// The inverse of a component of the scaled direction, and the origin moved both ways by the pad times it.
#[inline(always)]
fn axis(direction: f64, origin: f64, pad: f64) -> (f32, f32, f32) {
    let d = direction as f32;
    let d = if d.abs() > SMALLEST { d } else { SMALLEST.copysign(d) };
    let inverse = 1.0 / d;
    let step = pad.copysign(direction);
    (inverse, (origin + step) as f32 * inverse, (origin - step) as f32 * inverse)
}
