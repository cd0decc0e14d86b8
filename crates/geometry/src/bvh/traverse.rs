// SPDX-License-Identifier: MIT OR Apache-2.0
//! Walking the tree, near boxes first.
//!
//! Slabs after Ize, "Robust BVH Ray Traversal", JCGT 2(2), 2013, with its relative factor replaced by
//! an absolute pad in [`BoxRay`], which also covers hits a little behind the origin. Lanes are glam's,
//! which are SSE2 or NEON registers; they only reject (invariant 2), so no bit of a hit depends on them.

use std::ops::Range;

use dioptric_math::{DVec3, Vec4};

use super::{Bvh, Child, MAX_DEPTH, Node};

/// Counts what a query costs; the empty one, [`NoCount`], compiles to nothing.
pub trait Counter {
    /// `n` boxes were tested.
    fn boxes(&mut self, n: u32);
    /// `n` shapes were tested.
    fn shapes(&mut self, n: u32);
}

/// Counts nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoCount;

impl Counter for NoCount {
    fn boxes(&mut self, _: u32) {}
    fn shapes(&mut self, _: u32) {}
}

/// How many tests a query took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Count {
    /// Tests of boxes.
    pub boxes: u64,
    /// Tests of shapes.
    pub shapes: u64,
}

impl Counter for Count {
    fn boxes(&mut self, n: u32) {
        self.boxes += u64::from(n);
    }

    fn shapes(&mut self, n: u32) {
        self.shapes += u64::from(n);
    }
}

/// A ray as boxes see it, in single precision: about the tree's centre, its direction scaled so that
/// the largest component is 1.
#[derive(Clone, Copy, Debug)]
pub struct BoxRay {
    /// The origin moved by the pad along the direction, in each axis: near planes come earlier.
    near: [Vec4; 3],
    /// The origin moved back: far planes come later.
    far: [Vec4; 3],
    inverse: [Vec4; 3],
    /// 1 where the direction is negative: which side of a box is the far one.
    negative: [usize; 3],
    /// From `t` to the scaled direction's.
    scale: f64,
}

/// Components of the direction below this part of the largest count as this much: over the whole scene
/// that moves a ray by less than its pad.
const SMALLEST: f64 = 1e-30;

impl BoxRay {
    /// A ray for this tree. All boxes count as larger by `pad` on every side: what the things in the
    /// leaves may lie outside of their boxes. The test's own errors come on top of that.
    #[must_use]
    pub fn new(origin: DVec3, direction: DVec3, bvh: &Bvh, pad: f64) -> Self {
        let scale = direction.abs().max_element();
        let relative = origin - bvh.center;
        let reach = relative.abs().max_element() + bvh.extent;
        // The origin's rounding to f32 and three more roundings, each 2^-24 of the reach at most; the
        // last term where f32 has few digits left.
        let pad = pad + reach * (8.0 / f64::from(1u32 << 24)) + f64::from(f32::MIN_POSITIVE);
        let in_range = reach + pad < 1e30; // false where NaN, too
        let mut this = Self {
            near: [Vec4::ZERO; 3],
            far: [Vec4::ZERO; 3],
            inverse: [Vec4::ZERO; 3],
            negative: [0; 3],
            scale,
        };
        for axis in 0..3 {
            let d = direction[axis];
            let smallest = (SMALLEST * scale).max(f64::MIN_POSITIVE);
            let d = if d.abs() > smallest { d } else { smallest.copysign(d) };
            let step = 1.0_f64.copysign(d);
            // Without a usable origin all boxes are entered.
            let (near, far) = if in_range {
                (relative[axis] + pad * step, relative[axis] - pad * step)
            } else {
                (f64::from(f32::MAX) * step, f64::from(f32::MAX) * -step)
            };
            this.near[axis] = Vec4::splat(near as f32);
            this.far[axis] = Vec4::splat(far as f32);
            this.inverse[axis] = Vec4::splat((scale / d) as f32);
            this.negative[axis] = usize::from(d < 0.0);
        }
        this
    }

    /// `t_max` in the scaled direction's units, rounded up.
    fn limit(&self, t_max: f64) -> f32 {
        ((t_max * self.scale) as f32).next_up().min(f32::MAX)
    }
}

impl Node {
    /// Where the ray enters the boxes, at least 0, and a bit for each box that it enters at `limit` or
    /// before.
    #[inline]
    fn enter(&self, ray: &BoxRay, limit: f32) -> ([f32; 4], u32) {
        let mut near = Vec4::ZERO;
        let mut far = Vec4::splat(limit);
        for axis in 0..3 {
            let side = ray.negative[axis];
            // No NaN: the inverse is finite and at least 1, and only planes can be infinite.
            let t0 = (self.planes[2 * axis + side] - ray.near[axis]) * ray.inverse[axis];
            let t1 = (self.planes[2 * axis + 1 - side] - ray.far[axis]) * ray.inverse[axis];
            near = near.max(t0);
            far = far.min(t1);
        }
        (near.to_array(), near.cmple(far).bitmask())
    }
}

/// What is still to be visited, and where the ray enters it.
#[derive(Clone, Copy)]
struct Task {
    child: Child,
    near: f32,
}

impl Bvh {
    /// Hands every leaf whose box the ray enters at `t <= t_max` to `leaf`, nearer boxes first.
    ///
    /// `leaf` gets the range of items and the present `t_max`, and returns the new one, or `None` to
    /// end the walk; then `None` is returned here too, else the last `t_max`.
    #[inline]
    pub fn visit<C: Counter>(
        &self,
        ray: &BoxRay,
        t_max: f64,
        counter: &mut C,
        leaf: impl FnMut(Range<usize>, f64, &mut C) -> Option<f64>,
    ) -> Option<f64> {
        // A level leaves at most three tasks behind. A small stack is faster to set up.
        if self.depth <= 4 {
            self.walk::<16, C>(ray, t_max, counter, leaf)
        } else if self.depth <= 21 {
            self.walk::<64, C>(ray, t_max, counter, leaf)
        } else {
            self.walk::<{ 3 * MAX_DEPTH + 1 }, C>(ray, t_max, counter, leaf)
        }
    }

    #[inline]
    fn walk<const STACK: usize, C: Counter>(
        &self,
        ray: &BoxRay,
        mut t_max: f64,
        counter: &mut C,
        mut leaf: impl FnMut(Range<usize>, f64, &mut C) -> Option<f64>,
    ) -> Option<f64> {
        if self.nodes.is_empty() {
            return Some(t_max);
        }
        let mut limit = ray.limit(t_max);
        let mut stack = [Task { child: Child { first: 0, count: 0 }, near: 0.0 }; STACK];
        let mut top = 0;
        let mut at = Child { first: 0, count: 0 };
        loop {
            if at.count == 0 {
                let node = &self.nodes[at.first as usize];
                counter.boxes(4);
                let (near, mut entered) = node.enter(ray, limit);
                if entered != 0 {
                    let bottom = top;
                    while entered != 0 {
                        let lane = entered.trailing_zeros() as usize;
                        entered &= entered - 1;
                        // Sorted, the nearest on top.
                        let task = Task { child: node.children[lane], near: near[lane] };
                        let mut slot = top;
                        while slot > bottom && stack[slot - 1].near < task.near {
                            stack[slot] = stack[slot - 1];
                            slot -= 1;
                        }
                        stack[slot] = task;
                        top += 1;
                    }
                    top -= 1;
                    at = stack[top].child;
                    continue;
                }
            } else {
                let first = at.first as usize;
                t_max = leaf(first..first + at.count as usize, t_max, counter)?;
                limit = ray.limit(t_max);
            }
            loop {
                if top == 0 {
                    return Some(t_max);
                }
                top -= 1;
                // Not `<`: another hit at the same t may have a lower id.
                if stack[top].near <= limit {
                    at = stack[top].child;
                    break;
                }
            }
        }
    }
}
