// SPDX-License-Identifier: MIT OR Apache-2.0
//! Walking the tree, near boxes first: one walk, compiled once for each instruction set.

use std::ops::Range;

use super::lanes::plain::Plain;
use super::lanes::{Lanes, Test};
use super::{BoxRay, Bvh, Child, MAX_DEPTH, WIDTH};

/// Counts what a query costs; the empty one, [`NoCount`], compiles to nothing.
pub trait Counter {
    /// Whether it counts: then the instruction set is always the same, and so are the counts.
    const COUNTS: bool = true;
    /// `n` boxes were tested.
    fn boxes(&mut self, n: u32);
    /// `n` shapes were tested.
    fn shapes(&mut self, n: u32);
}

/// Counts nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoCount;

impl Counter for NoCount {
    const COUNTS: bool = false;
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

/// What is still to be visited: the bits of where the ray enters it above those of the child. Distances
/// are at least 0, so these numbers are in the order of the distances.
#[derive(Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord)]
struct Task(u64);

impl Task {
    #[inline(always)]
    fn new(child: Child, near: f32) -> Self {
        Self(u64::from(near.to_bits()) << 32 | u64::from(child.0))
    }

    #[inline(always)]
    fn child(self) -> Child {
        Child(self.0 as u32)
    }

    #[inline(always)]
    fn near(self) -> f32 {
        f32::from_bits((self.0 >> 32) as u32)
    }
}

/// A level leaves at most this many tasks behind.
const LEFT: usize = WIDTH - 1;

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
        let lanes = if C::COUNTS { Lanes::Plain } else { self.lanes };
        match lanes {
            #[cfg(target_arch = "x86_64")]
            // SAFETY: a tree's `lanes` are never more than the processor has.
            Lanes::Avx512 => unsafe { visit_avx512(self, ray, t_max, counter, leaf) },
            #[cfg(target_arch = "x86_64")]
            // SAFETY: as above.
            Lanes::Avx2 => unsafe { visit_avx2(self, ray, t_max, counter, leaf) },
            // SAFETY: there is no instruction set to answer for.
            _ => unsafe { sized::<Plain, C>(self, ray, t_max, counter, leaf) },
        }
    }
}

/// # Safety
/// The processor has the instruction set.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,avx512f,avx512vl,avx512dq")]
fn visit_avx512<C: Counter>(
    bvh: &Bvh,
    ray: &BoxRay,
    t_max: f64,
    counter: &mut C,
    leaf: impl FnMut(Range<usize>, f64, &mut C) -> Option<f64>,
) -> Option<f64> {
    // SAFETY: the features of this function.
    unsafe { sized::<super::lanes::avx512::Avx512, C>(bvh, ray, t_max, counter, leaf) }
}

/// # Safety
/// The processor has the instruction set.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn visit_avx2<C: Counter>(
    bvh: &Bvh,
    ray: &BoxRay,
    t_max: f64,
    counter: &mut C,
    leaf: impl FnMut(Range<usize>, f64, &mut C) -> Option<f64>,
) -> Option<f64> {
    // SAFETY: the features of this function.
    unsafe { sized::<super::lanes::avx2::Avx2, C>(bvh, ray, t_max, counter, leaf) }
}

/// A small stack is faster to set up.
///
/// # Safety
/// The processor has the instruction set of `T`.
#[inline(always)]
unsafe fn sized<T: Test, C: Counter>(
    bvh: &Bvh,
    ray: &BoxRay,
    t_max: f64,
    counter: &mut C,
    leaf: impl FnMut(Range<usize>, f64, &mut C) -> Option<f64>,
) -> Option<f64> {
    // SAFETY: the caller answers for the instruction set.
    unsafe {
        if bvh.depth <= 4 {
            walk::<T, { 4 * LEFT + 1 }, C>(bvh, ray, t_max, counter, leaf)
        } else if bvh.depth <= 16 {
            walk::<T, { 16 * LEFT + 1 }, C>(bvh, ray, t_max, counter, leaf)
        } else {
            walk::<T, { MAX_DEPTH * LEFT + 1 }, C>(bvh, ray, t_max, counter, leaf)
        }
    }
}

/// # Safety
/// The processor has the instruction set of `T`.
#[inline(always)]
unsafe fn walk<T: Test, const STACK: usize, C: Counter>(
    bvh: &Bvh,
    ray: &BoxRay,
    mut t_max: f64,
    counter: &mut C,
    mut leaf: impl FnMut(Range<usize>, f64, &mut C) -> Option<f64>,
) -> Option<f64> {
    if bvh.nodes.is_empty() {
        return Some(t_max);
    }
    // SAFETY: the caller answers for the instruction set.
    let spread = unsafe { T::spread(ray) };
    let mut limit = ray.limit(t_max);
    let mut stack = [Task(0); STACK];
    let mut top = 0;
    let mut at = Child::inner(0);
    loop {
        if let Some(index) = at.node() {
            let node = &bvh.nodes[index];
            counter.boxes(WIDTH as u32);
            // SAFETY: the caller answers for the instruction set.
            let (near, mut entered) = unsafe { T::enter(node, &spread, limit) };
            let task = |entered: u32| {
                let lane = entered.trailing_zeros() as usize % WIDTH;
                Task::new(node.children[lane], near[lane])
            };
            if entered != 0 {
                let first = task(entered);
                entered &= entered - 1;
                if entered == 0 {
                    at = first.child();
                    continue;
                }
                let second = task(entered);
                entered &= entered - 1;
                let (mut nearer, mut farther) = (first.min(second), first.max(second));
                if entered == 0 {
                    stack[top] = farther;
                    top += 1;
                    at = nearer.child();
                    continue;
                }
                // Three and more: sorted into the stack, the nearest on top.
                let bottom = top;
                stack[top] = farther;
                top += 1;
                while entered != 0 {
                    let next = task(entered);
                    entered &= entered - 1;
                    (nearer, farther) = (nearer.min(next), nearer.max(next));
                    let mut slot = top;
                    while slot > bottom && stack[slot - 1] < farther {
                        stack[slot] = stack[slot - 1];
                        slot -= 1;
                    }
                    stack[slot] = farther;
                    top += 1;
                }
                at = nearer.child();
                continue;
            }
        } else {
            t_max = leaf(at.items(), t_max, counter)?;
            limit = ray.limit(t_max);
        }
        loop {
            if top == 0 {
                return Some(t_max);
            }
            top -= 1;
            // Not `<`: another hit at the same t may have a lower id.
            if stack[top].near() <= limit {
                at = stack[top].child();
                break;
            }
        }
    }
}
