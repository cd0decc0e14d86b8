// SPDX-License-Identifier: MIT OR Apache-2.0
//! Walking the tree, near boxes first: one walk, compiled once for each instruction set.

use std::mem::MaybeUninit;
use std::ops::Range;

use super::lanes::{Job, Lanes, Test};
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
pub(super) const LEFT: usize = WIDTH - 1;

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
        // SAFETY: a tree's `lanes` are never more than the processor has.
        unsafe { lanes.run(Visit { bvh: self, ray, t_max, counter, leaf: Each(leaf) }) }
    }
}

/// What is done with the leaves that are found.
pub(crate) trait Leaves<T: Test, C> {
    /// Whether any hit will do, so that it is not worth while to sort.
    const ANY: bool = false;

    /// Where the items from `first` on are, to fetch them ahead of time; any address will do.
    #[inline(always)]
    fn address(&self, _first: usize) -> *const u8 {
        std::ptr::null()
    }

    /// Gets a range of items and the present `t_max`, returns the new one or `None` to end the walk.
    ///
    /// # Safety
    /// The processor has the instruction set of `T`.
    unsafe fn visit(&mut self, items: Range<usize>, t_max: f64, counter: &mut C) -> Option<f64>;
}

/// The same function for all instruction sets.
struct Each<F>(F);

impl<T: Test, C, F: FnMut(Range<usize>, f64, &mut C) -> Option<f64>> Leaves<T, C> for Each<F> {
    #[inline(always)]
    unsafe fn visit(&mut self, items: Range<usize>, t_max: f64, counter: &mut C) -> Option<f64> {
        (self.0)(items, t_max, counter)
    }
}

/// A walk, to be run on some instruction set.
struct Visit<'a, C, F> {
    bvh: &'a Bvh,
    ray: &'a BoxRay,
    t_max: f64,
    counter: &'a mut C,
    leaf: Each<F>,
}

impl<C: Counter, F: FnMut(Range<usize>, f64, &mut C) -> Option<f64>> Job for Visit<'_, C, F> {
    type Output = Option<f64>;

    #[inline(always)]
    unsafe fn run<T: Test>(mut self) -> Option<f64> {
        // SAFETY: the caller answers for the instruction set.
        unsafe {
            walk_tree::<T, C, _>(self.bvh, self.ray, self.t_max, self.counter, &mut self.leaf)
        }
    }
}

/// Hands every leaf whose box the ray enters at `t <= t_max` to `leaf`, nearer boxes first.
///
/// # Safety
/// The processor has the instruction set of `T`.
#[inline(always)]
pub(crate) unsafe fn walk_tree<T: Test, C: Counter, L: Leaves<T, C>>(
    bvh: &Bvh,
    ray: &BoxRay,
    t_max: f64,
    counter: &mut C,
    leaf: &mut L,
) -> Option<f64> {
    // SAFETY: the caller answers for the instruction set.
    unsafe { walk_below(bvh, ray, Child::inner(0), t_max, counter, leaf) }
}

/// The same for the part of the tree below `from`.
///
/// # Safety
/// The processor has the instruction set of `T`.
#[inline(always)]
pub(super) unsafe fn walk_below<T: Test, C: Counter, L: Leaves<T, C>>(
    bvh: &Bvh,
    ray: &BoxRay,
    from: Child,
    mut t_max: f64,
    counter: &mut C,
    leaf: &mut L,
) -> Option<f64> {
    if bvh.nodes.is_empty() {
        return Some(t_max);
    }
    // SAFETY: the caller answers for the instruction set.
    let spread = unsafe { T::spread(ray) };
    let mut limit = ray.limit(t_max);
    let mut stack = Stack::new();
    let mut at = from;
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
            // What has to wait is fetched meanwhile.
            let ahead = |task: Task| {
                fetch(match task.child().node() {
                    Some(index) => bvh.nodes.as_ptr().wrapping_add(index).cast(),
                    None => leaf.address(task.child().items().start),
                });
            };
            if entered != 0 {
                let others = entered & (entered - 1);
                if others == 0 {
                    at = node.children[entered.trailing_zeros() as usize % WIDTH];
                    continue;
                }
                let first = task(entered);
                entered = others;
                let second = task(entered);
                entered &= entered - 1;
                let (mut nearer, mut farther) = (first.min(second), first.max(second));
                ahead(farther);
                if entered == 0 {
                    stack.push(farther);
                    at = nearer.child();
                    continue;
                }
                // Three and more: sorted into the stack, the nearest on top; the nearest of all is next.
                let bottom = stack.top;
                stack.push(farther);
                while entered != 0 {
                    let next = task(entered);
                    entered &= entered - 1;
                    (nearer, farther) = (nearer.min(next), nearer.max(next));
                    ahead(farther);
                    if L::ANY {
                        stack.push(farther);
                    } else {
                        stack.insert(bottom, farther);
                    }
                }
                at = nearer.child();
                continue;
            }
        } else {
            // SAFETY: as above.
            t_max = unsafe { leaf.visit(at.items(), t_max, counter) }?;
            limit = ray.limit(t_max);
        }
        loop {
            let Some(task) = stack.pop() else { return Some(t_max) };
            // Not `<`: another hit at the same t may have a lower id.
            if task.near() <= limit {
                at = task.child();
                break;
            }
        }
    }
}

/// Room for what the longest way leaves behind. It is not cleared, which would take as long as some walks.
struct Stack {
    tasks: [MaybeUninit<Task>; MAX_DEPTH * LEFT],
    /// The tasks below are set.
    top: usize,
}

impl Stack {
    #[inline(always)]
    const fn new() -> Self {
        Self { tasks: [const { MaybeUninit::uninit() }; MAX_DEPTH * LEFT], top: 0 }
    }

    /// Sets one more.
    #[inline(always)]
    fn push(&mut self, task: Task) {
        self.tasks[self.top] = MaybeUninit::new(task);
        self.top += 1;
    }

    /// Adds one to those above `bottom`, which are sorted, the nearest on top.
    #[inline(always)]
    fn insert(&mut self, bottom: usize, task: Task) {
        let mut slot = self.top;
        self.push(task);
        while slot > bottom {
            let below = self.tasks[slot - 1];
            // SAFETY: the tasks below `top` are set.
            if unsafe { below.assume_init() } >= task {
                break;
            }
            self.tasks[slot] = below;
            slot -= 1;
        }
        self.tasks[slot] = MaybeUninit::new(task);
    }

    #[inline(always)]
    fn pop(&mut self) -> Option<Task> {
        self.top = self.top.checked_sub(1)?;
        // SAFETY: the tasks below the former `top` are set.
        Some(unsafe { self.tasks[self.top].assume_init() })
    }
}

/// Asks for the five cache lines from an address on.
#[inline(always)]
fn fetch(address: *const u8) {
    #[cfg(target_arch = "x86_64")]
    for line in 0..5 {
        // SAFETY: fetching ahead touches no memory as the language has it, and any address will do.
        unsafe {
            std::arch::x86_64::_mm_prefetch::<{ std::arch::x86_64::_MM_HINT_T0 }>(
                address.wrapping_add(64 * line).cast(),
            );
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = address;
}
