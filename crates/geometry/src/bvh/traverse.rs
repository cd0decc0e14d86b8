// SPDX-License-Identifier: MIT OR Apache-2.0
//! Walking the tree, near boxes first.
//!
//! Slabs after Ize, "Robust BVH Ray Traversal", JCGT 2(2), 2013, with its relative factor replaced by
//! an absolute pad in [`BoxRay`], which also covers hits a little behind the origin.

use std::ops::Range;

use dioptric_math::DVec3;

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

/// A ray as boxes see it.
#[derive(Clone, Copy, Debug)]
pub struct BoxRay {
    /// The origin moved by the pad along the direction, in each axis: near planes come earlier.
    near: [f64; 3],
    /// The origin moved back: far planes come later.
    far: [f64; 3],
    inverse: [f64; 3],
    /// 1 where the direction is negative: which side of a box is the far one.
    negative: [usize; 3],
}

impl BoxRay {
    /// A ray for the tree with this centre. All boxes count as larger by `pad` on every side.
    ///
    /// The pad must be at least `gamma(8)` times (the largest coordinate of the origin and of the boxes),
    /// for the test's own errors, and what the things in the leaves may lie outside of their boxes.
    #[must_use]
    pub fn new(origin: DVec3, direction: DVec3, center: DVec3, pad: f64) -> Self {
        let pad = pad.min(f64::MAX * 0.25); // also where it is NaN
        let o = (origin - center).to_array();
        let d = direction.to_array();
        let step = d.map(|x| pad.copysign(x));
        Self {
            near: [0, 1, 2].map(|i| o[i] + step[i]),
            far: [0, 1, 2].map(|i| o[i] - step[i]),
            inverse: d.map(|x| 1.0 / x),
            negative: d.map(|x| usize::from(x.is_sign_negative())),
        }
    }
}

impl Node {
    /// Where the ray enters the two boxes, at least 0; infinite where it misses or enters after `t_max`.
    #[inline]
    fn enter(&self, ray: &BoxRay, t_max: f64) -> [f64; 2] {
        let mut near = [0.0; 2];
        let mut far = [t_max; 2];
        for axis in 0..3 {
            let near_plane = self.planes[2 * axis + ray.negative[axis]];
            let far_plane = self.planes[2 * axis + 1 - ray.negative[axis]];
            for side in 0..2 {
                let t0 = (f64::from(near_plane[side]) - ray.near[axis]) * ray.inverse[axis];
                let t1 = (f64::from(far_plane[side]) - ray.far[axis]) * ray.inverse[axis];
                // In this order a NaN (0 times infinity: along a plane of the box) changes nothing.
                near[side] = if t0 > near[side] { t0 } else { near[side] };
                far[side] = if t1 < far[side] { t1 } else { far[side] };
            }
        }
        [0, 1].map(|side| if near[side] <= far[side] { near[side] } else { f64::INFINITY })
    }
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
        mut leaf: impl FnMut(Range<usize>, f64, &mut C) -> Option<f64>,
    ) -> Option<f64> {
        if self.nodes.is_empty() {
            return Some(t_max);
        }
        // Infinite marks a miss: no finite scene reaches as far.
        let mut t_max = t_max.min(f64::MAX);
        let mut stack = [(Child { first: 0, count: 0 }, 0.0); MAX_DEPTH];
        let mut top = 0;
        let mut at = Child { first: 0, count: 0 };
        loop {
            if at.count == 0 {
                let node = &self.nodes[at.first as usize];
                counter.boxes(2);
                let enter = node.enter(ray, t_max);
                let second = usize::from(enter[0] <= enter[1]);
                let first = 1 - second;
                if enter[first] < f64::INFINITY {
                    if enter[second] < f64::INFINITY {
                        stack[top] = (node.children[second], enter[second]);
                        top += 1;
                    }
                    at = node.children[first];
                    continue;
                }
            } else {
                let first = at.first as usize;
                t_max = leaf(first..first + at.count as usize, t_max, counter)?;
            }
            loop {
                if top == 0 {
                    return Some(t_max);
                }
                top -= 1;
                // Not `<`: another hit at the same t may have a lower id.
                if stack[top].1 <= t_max {
                    at = stack[top].0;
                    break;
                }
            }
        }
    }
}
