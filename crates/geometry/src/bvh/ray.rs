// SPDX-License-Identifier: MIT OR Apache-2.0
//! A ray as boxes see it.
//!
//! Slabs after Ize, "Robust BVH Ray Traversal", JCGT 2(2), 2013, with its relative factor replaced by
//! an absolute pad, which also covers hits a little behind the origin.

use dioptric_math::DVec3;

use super::Bvh;

/// A ray in single precision: about the tree's centre, its direction scaled so that the largest
/// component is 1.
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
    scale: f64,
}

/// Components of the direction below this part of the largest count as this much: over the whole scene
/// that moves a ray by less than its pad, and products with f32's coordinates stay finite.
const SMALLEST: f64 = 1e-9;
/// Coordinates above this are not looked at: all boxes are entered.
const LARGEST: f64 = 1e28;

impl BoxRay {
    /// A ray for this tree. All boxes count as larger by `pad` on every side: what the things in the
    /// leaves may lie outside of their boxes. The test's own errors come on top of that.
    #[inline]
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
        let smallest = (SMALLEST * scale).max(f64::MIN_POSITIVE);
        let mut this =
            Self { near: [0.0; 3], far: [0.0; 3], inverse: [0.0; 3], negative: [0; 3], scale };
        for axis in 0..3 {
            let d = direction[axis];
            let d = if d.abs() > smallest { d } else { smallest.copysign(d) };
            let step = pad.copysign(d);
            let (near, far, inverse) = if usable {
                let inverse = 1.0 / ((d / scale) as f32);
                let moved = |by: f64| (relative[axis] + by) as f32 * inverse;
                (moved(step), moved(-step), inverse)
            } else {
                (f32::MAX, f32::MIN, 1.0_f32.copysign(d as f32))
            };
            this.near[axis] = near;
            this.far[axis] = far;
            this.inverse[axis] = inverse;
            this.negative[axis] = usize::from(d < 0.0);
        }
        this
    }

    /// `t_max` in the scaled direction's units, rounded up.
    #[inline]
    pub(super) fn limit(&self, t_max: f64) -> f32 {
        ((t_max * self.scale) as f32).next_up().min(f32::MAX)
    }
}
