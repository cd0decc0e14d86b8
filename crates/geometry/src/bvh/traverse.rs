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
        unsafe { lanes.run(Visit { bvh: self, ray, counter, leaf: Each { leaf, t_max } }) }
    }
}

/// Where things lie in a row.
#[derive(Clone, Copy)]
pub(crate) struct Shelf {
    start: *const u8,
    /// Bytes of each.
    stride: usize,
    /// The bits of a child that are its index.
    mask: u32,
}

impl Shelf {
    /// For things of which children have the index in these bits.
    #[inline(always)]
    pub fn of<I>(things: &[I], mask: usize) -> Self {
        Self { start: things.as_ptr().cast(), stride: size_of::<I>(), mask: mask as u32 }
    }
}

/// What is done with the leaves that are found.
pub(crate) trait Leaves<T: Test, C> {
    /// Whether any hit will do, so that it is not worth while to sort.
    const ANY: bool = false;

    /// Where the items are, to fetch them ahead of time; any address will do.
    #[inline(always)]
    fn shelf(&self) -> Shelf {
        Shelf { start: std::ptr::null(), stride: 0, mask: 0 }
    }

    /// Gets a range of items and returns how far is still of interest, in the units of [`BoxRay::limit`], or `None`
    /// to end the walk.
    ///
    /// # Safety
    /// The processor has the instruction set of `T`.
    unsafe fn visit(&mut self, items: Range<usize>, ray: &BoxRay, counter: &mut C) -> Option<f32>;
}

/// The same function for all instruction sets.
struct Each<F> {
    leaf: F,
    t_max: f64,
}

impl<T: Test, C, F: FnMut(Range<usize>, f64, &mut C) -> Option<f64>> Leaves<T, C> for Each<F> {
    #[inline(always)]
    unsafe fn visit(&mut self, items: Range<usize>, ray: &BoxRay, counter: &mut C) -> Option<f32> {
        self.t_max = (self.leaf)(items, self.t_max, counter)?;
        Some(ray.limit(self.t_max))
    }
}

/// A walk, to be run on some instruction set.
struct Visit<'a, C, F> {
    bvh: &'a Bvh,
    ray: &'a BoxRay,
    counter: &'a mut C,
    leaf: Each<F>,
}

impl<C: Counter, F: FnMut(Range<usize>, f64, &mut C) -> Option<f64>> Job for Visit<'_, C, F> {
    type Output = Option<f64>;

    #[inline(always)]
    unsafe fn run<T: Test>(mut self) -> Option<f64> {
        // SAFETY: the caller answers for the instruction set.
        let end = unsafe {
            let limit = self.ray.limit(self.leaf.t_max);
            walk_tree::<T, C, _>(self.bvh, self.ray, limit, self.counter, &mut self.leaf)
        };
        end.map(|()| self.leaf.t_max)
    }
}

/// Hands every leaf whose box the ray enters within `limit` to `leaf`, nearer boxes first; `None` if it ended that.
///
/// # Safety
/// The processor has the instruction set of `T`.
#[inline(always)]
pub(crate) unsafe fn walk_tree<T: Test, C: Counter, L: Leaves<T, C>>(
    bvh: &Bvh,
    ray: &BoxRay,
    limit: f32,
    counter: &mut C,
    leaf: &mut L,
) -> Option<()> {
    // SAFETY: the caller answers for the instruction set.
    unsafe { walk_below(bvh, ray, Child::inner(0), limit, counter, leaf) }
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
    mut limit: f32,
    counter: &mut C,
    leaf: &mut L,
) -> Option<()> {
    if bvh.nodes.is_empty() {
        return Some(());
    }
    // SAFETY: the caller answers for the instruction set.
    let spread = unsafe { T::spread(ray, &bvh.nodes) };
    let shelves = [Shelf::of(&bvh.nodes, Child::LEAF as usize - 1), leaf.shelf()];
    let mut tasks = Tasks::new();
    let mut top = 0;
    let mut at = from;
    loop {
        if let Some(index) = at.node() {
            debug_assert!(index < bvh.nodes.len());
            // SAFETY: children that are nodes are among the tree's.
            let node = unsafe { bvh.nodes.get_unchecked(index) };
            // Asked for now, or it would be waited for after the planes.
            fetch_line(std::ptr::from_ref(&node.children).cast());
            counter.boxes(WIDTH as u32);
            // SAFETY: the caller answers for the instruction set.
            let (near, mut entered) = unsafe { T::enter(&bvh.nodes, index, &spread, limit) };
            let task = |entered: u32| {
                let lane = entered.trailing_zeros() as usize % WIDTH;
                Task::new(node.children[lane], near[lane])
            };
            // What has to wait is fetched meanwhile. No branch: which it is cannot be foreseen.
            let ahead = |task: Task| {
                let child = task.child().0;
                let shelf = &shelves[(child >> 31) as usize];
                fetch(shelf.start.wrapping_add((child & shelf.mask) as usize * shelf.stride));
            };
            if entered != 0 {
                let others = entered & (entered - 1);
                if others == 0 {
                    // SAFETY: as above.
                    at = unsafe { T::only(node, entered) };
                    continue;
                }
                let first = task(entered);
                entered = others;
                let second = task(entered);
                entered &= entered - 1;
                let (mut nearer, mut farther) = (first.min(second), first.max(second));
                ahead(farther);
                if entered == 0 {
                    tasks.push(&mut top, farther);
                    at = nearer.child();
                    continue;
                }
                // Three and more: sorted into the stack, the nearest on top; the nearest of all is next.
                let bottom = top;
                tasks.push(&mut top, farther);
                while entered != 0 {
                    let next = task(entered);
                    entered &= entered - 1;
                    (nearer, farther) = (nearer.min(next), nearer.max(next));
                    ahead(farther);
                    if L::ANY {
                        tasks.push(&mut top, farther);
                    } else {
                        tasks.insert(&mut top, bottom, farther);
                    }
                }
                at = nearer.child();
                continue;
            }
        } else {
            // SAFETY: as above.
            limit = unsafe { leaf.visit(at.items(), ray, counter) }?;
        }
        loop {
            let Some(task) = tasks.pop(&mut top) else { return Some(()) };
            // Not `<`: another hit at the same t may have a lower id.
            if task.0 >> 32 <= u64::from(limit.to_bits()) {
                at = task.child();
                break;
            }
        }
    }
}

/// Room for what the longest way leaves behind. It is not cleared, which would take as long as some walks. How many
/// are set is a number of its own, so that it can be in a register.
struct Tasks([MaybeUninit<Task>; MAX_DEPTH * LEFT]);

impl Tasks {
    #[inline(always)]
    const fn new() -> Self {
        Self([const { MaybeUninit::uninit() }; MAX_DEPTH * LEFT])
    }

    /// Sets one more.
    #[inline(always)]
    fn push(&mut self, top: &mut usize, task: Task) {
        debug_assert!(*top < self.0.len());
        // SAFETY: no way from the root is longer, and a node leaves no more behind.
        *unsafe { self.0.get_unchecked_mut(*top) } = MaybeUninit::new(task);
        *top += 1;
    }

    /// Adds one to those above `bottom`, which are sorted, the nearest on top.
    #[inline(always)]
    fn insert(&mut self, top: &mut usize, bottom: usize, task: Task) {
        let mut slot = *top;
        self.push(top, task);
        while slot > bottom {
            // SAFETY: slots up to `top` are in it.
            let below = unsafe { *self.0.get_unchecked(slot - 1) };
            // SAFETY: the tasks below `top` are set.
            if unsafe { below.assume_init() } >= task {
                break;
            }
            // SAFETY: as above.
            *unsafe { self.0.get_unchecked_mut(slot) } = below;
            slot -= 1;
        }
        // SAFETY: as above.
        *unsafe { self.0.get_unchecked_mut(slot) } = MaybeUninit::new(task);
    }

    #[inline(always)]
    fn pop(&mut self, top: &mut usize) -> Option<Task> {
        *top = top.checked_sub(1)?;
        // SAFETY: the tasks below the former `top` are set.
        Some(unsafe { self.0.get_unchecked(*top).assume_init() })
    }
}

/// Asks for a cache line.
#[inline(always)]
pub(crate) fn fetch_line(address: *const u8) {
    #[cfg(target_arch = "x86_64")]
    // SAFETY: fetching ahead touches no memory as the language has it, and any address will do.
    unsafe {
        std::arch::x86_64::_mm_prefetch::<{ std::arch::x86_64::_MM_HINT_T0 }>(address.cast());
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = address;
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
