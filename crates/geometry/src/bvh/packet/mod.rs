// SPDX-License-Identifier: MIT OR Apache-2.0
//! Walking the tree with sixteen rays at once: a node that several of them enter is fetched once.
//!
//! The rays may have to visit more than each would alone, but what they find is the same. Where only a few of
//! them are left in a part of the tree, each walks it alone.

#![allow(unsafe_code)]

pub mod rows;

use std::marker::PhantomData;
use std::mem::MaybeUninit;
use std::ops::Range;

use dioptric_math::bounds::gamma;

use self::rows::{LANES, Mask, Row, Rows};
use super::ray::MARGIN;
use super::traverse::{LEFT, Leaves, NoCount, walk_below};
use super::{BoxRay, Bvh, Child, MAX_DEPTH, WIDTH};

/// Sixteen rays as boxes see them: about the tree's centre, with directions of length 1. Filled by
/// [`Self::fill`], then [`Self::finish`].
#[derive(Clone, Debug)]
pub struct Packet {
    /// Origins.
    pub origin: [Row; 3],
    /// Directions of length 1.
    pub direction: [Row; 3],
    /// How far each ray goes: what lies beyond is not entered.
    pub limit: Row,
    /// By how much boxes and filters count as larger, for all errors of what is worked out here and of what
    /// lies in the leaves.
    pub pad: Row,
    /// The lengths of the rays' own directions.
    length: Row,
    /// 1 over the directions, and where box planes at the origin would be met with pads to either side.
    inverse: [Row; 3],
    low: [Row; 3],
    high: [Row; 3],
}

/// Beyond this many units single precision is not trusted with a ray.
const FARTHEST: f32 = 1e12;

/// The least component of a direction of length 1, which moves a ray by far less than its pad.
const SMALLEST: f32 = 1e-15;

/// Squared lengths of directions that are taken.
const LENGTHS: (f32, f32) = (1e-20, 1e20);

/// Covers three roundings.
const UP: f32 = 1.0 + 1e-6;

impl Packet {
    /// Room for sixteen rays that go nowhere.
    #[inline(always)]
    #[must_use]
    pub const fn empty() -> Self {
        let none = [Row::splat(0.0); 3];
        Self {
            origin: none,
            direction: none,
            limit: Row::splat(-1.0),
            pad: Row::splat(0.0),
            length: Row::splat(0.0),
            inverse: none,
            low: none,
            high: none,
        }
    }

    /// Takes sixteen rays: origins, directions, how far they go in units of these, and errors of the origins.
    #[inline(always)]
    pub(crate) fn fill<R: Rows>(
        &mut self,
        origin: &[[f64; LANES]; 3],
        direction: &[[f64; LANES]; 3],
        t_max: &[f64; LANES],
        error: &[f64; LANES],
        bvh: &Bvh,
    ) {
        let center = bvh.center.to_array();
        for axis in 0..3 {
            R::narrow(&origin[axis], center[axis]).store(&mut self.origin[axis]);
            R::narrow(&direction[axis], 0.0).store(&mut self.direction[axis]);
        }
        R::narrow(t_max, 0.0).store(&mut self.limit);
        R::narrow(error, 0.0).store(&mut self.pad);
    }

    /// Works out what walks need, for the `(amplify, extent)` of [`crate::world`]'s reach. Returns the rays that
    /// are fit for single precision; the others must not walk.
    #[inline(always)]
    pub(crate) fn finish<R: Rows>(&mut self, bvh: &Bvh, (amplify, extent): (f64, f64)) -> Mask {
        let o = [R::load(&self.origin[0]), R::load(&self.origin[1]), R::load(&self.origin[2])];
        let d =
            [R::load(&self.direction[0]), R::load(&self.direction[1]), R::load(&self.direction[2])];
        let largest = o[0].abs().max(o[1].abs()).max(o[2].abs());
        let reach = largest.add(R::splat(bvh.extent as f32));
        // How far hits may lie outside of their boxes: see `Reach::pad`; the origin itself is at most the
        // relative one and the centre together. Then the origin's rounding to f32 and those of the tests, each
        // at most 2^-24 of the reach.
        let center = bvh.center.abs().max_element();
        let outside = largest.add(R::splat(center as f32)).mul_add(
            R::splat((amplify * gamma(256)) as f32),
            R::splat((extent * gamma(256)) as f32),
        );
        let outside = R::load(&self.pad).mul_add(R::splat(amplify as f32), outside);
        let pad = outside
            .add(reach.mul(R::splat(16.0 / 16_777_216.0)))
            .mul_add(R::splat(UP), R::splat(f32::MIN_POSITIVE));
        pad.store(&mut self.pad);
        // Boxes have what they need for their own coordinates.
        let moved = outside
            .add(largest.mul(R::splat(MARGIN)))
            .mul_add(R::splat(UP), R::splat(f32::MIN_POSITIVE));
        let length2 = d[0].mul_add(d[0], d[1].mul_add(d[1], d[2].mul(d[2])));
        let length = length2.sqrt();
        length.store(&mut self.length);
        R::load(&self.limit)
            .mul(length)
            .mul_add(R::splat(UP), R::splat(f32::MIN_POSITIVE))
            .min(R::splat(f32::MAX))
            .store(&mut self.limit);
        let over = R::splat(1.0).div(length);
        for axis in 0..3 {
            let unit = d[axis].mul(over);
            let inverse = R::splat(1.0).div(unit.away_from_zero(SMALLEST));
            unit.store(&mut self.direction[axis]);
            inverse.store(&mut self.inverse[axis]);
            o[axis].add(moved).mul(inverse).store(&mut self.low[axis]);
            o[axis].sub(moved).mul(inverse).store(&mut self.high[axis]);
        }
        // Never true for NaN.
        reach.add(pad).le(R::splat(FARTHEST))
            & R::splat(LENGTHS.0).le(length2)
            & length2.le(R::splat(LENGTHS.1))
    }

    /// Shortens a ray, in units of its own direction.
    #[inline(always)]
    pub fn shorten(&mut self, lane: usize, t: f64) {
        let limit = t as f32 * self.length.0[lane] * UP + f32::MIN_POSITIVE;
        self.limit.0[lane] = limit.min(f32::MAX);
    }

    /// One ray by itself.
    #[inline(always)]
    fn one(&self, lane: usize) -> BoxRay {
        let mut ray = BoxRay {
            near: [0.0; 3],
            far: [0.0; 3],
            inverse: [0.0; 3],
            negative: [0; 3],
            scale: f64::from(self.length.0[lane] * UP),
        };
        for axis in 0..3 {
            let (low, high) = (self.low[axis].0[lane], self.high[axis].0[lane]);
            let inverse = self.inverse[axis].0[lane];
            let negative = inverse < 0.0;
            ray.near[axis] = if negative { high } else { low };
            ray.far[axis] = if negative { low } else { high };
            ray.inverse[axis] = inverse;
            ray.negative[axis] = usize::from(negative);
        }
        ray
    }

    /// Where each ray enters a box, and a bit for those that do so within their limits.
    #[inline(always)]
    fn enter<R: Rows>(&self, low: [f32; 3], high: [f32; 3]) -> (R, Mask) {
        let mut near = R::splat(0.0);
        let mut far = R::load(&self.limit);
        for axis in 0..3 {
            let inverse = R::load(&self.inverse[axis]);
            let t0 = R::splat(low[axis]).mul_sub(inverse, R::load(&self.low[axis]));
            let t1 = R::splat(high[axis]).mul_sub(inverse, R::load(&self.high[axis]));
            near = near.max(t0.min(t1));
            far = far.min(t0.max(t1));
        }
        (near, near.le(far))
    }
}

/// So few rays are faster each alone: a node's eight boxes are tested for one ray at once, or one box for sixteen
/// rays.
const FEW: u32 = 2;

/// What is still to be visited, by which rays, and where the first of them enters it.
#[derive(Clone, Copy)]
struct Task {
    near: f32,
    child: Child,
    rays: Mask,
}

/// What is done at the leaves. (No closure: those would be compiled without the features of the function that
/// they are used in, and calls of single instructions are slow.)
pub(crate) trait PacketLeaves<R: Rows> {
    /// Whether the rays ask for any hit; else for the nearest one.
    const ANY: bool;

    /// Tests a leaf's items for `rays`. May shorten rays; returns those that need no more leaves.
    fn leaf(&mut self, items: Range<usize>, rays: Mask, packet: &mut Packet) -> Mask;

    /// Tests a leaf's items for one of the rays: the new `t_max`, or nothing if it needs no more leaves.
    fn leaf_alone(&mut self, items: Range<usize>, lane: usize, packet: &Packet) -> Option<f64>;

    /// How far a ray goes, in units of its direction.
    fn t_max(&self, lane: usize) -> f64;
}

impl Bvh {
    /// Hands every leaf whose box some of `rays` enter to `leaves`, with these rays, nearer boxes first.
    ///
    /// # Safety
    /// The processor has the instruction set of `R`.
    #[inline(always)]
    pub(crate) unsafe fn visit_packet<R: Rows, L: PacketLeaves<R>>(
        &self,
        packet: &mut Packet,
        rays: Mask,
        leaves: &mut L,
    ) {
        // A small stack is faster to set up.
        // SAFETY: the caller answers for the instruction set.
        unsafe {
            if self.depth <= 16 {
                self.walk_packet::<{ 16 * LEFT + 1 }, R, L>(packet, rays, leaves);
            } else {
                self.walk_packet::<{ MAX_DEPTH * LEFT + 1 }, R, L>(packet, rays, leaves);
            }
        }
    }

    /// # Safety
    /// The processor has the instruction set of `R`.
    #[inline(always)]
    unsafe fn walk_packet<const STACK: usize, R: Rows, L: PacketLeaves<R>>(
        &self,
        packet: &mut Packet,
        mut alive: Mask,
        leaves: &mut L,
    ) {
        if self.nodes.is_empty() || alive == 0 {
            return;
        }
        let mut stack = Stack::<STACK>::new();
        let (mut at, mut rays) = (Child::inner(0), alive);
        loop {
            if rays.count_ones() <= FEW {
                while rays != 0 {
                    let lane = rays.trailing_zeros() as usize % LANES;
                    rays &= rays - 1;
                    // SAFETY: the caller answers for the instruction set.
                    if unsafe { self.walk_alone::<R, L>(packet, lane, at, leaves) } {
                        alive &= !(1 << lane);
                    } else if !L::ANY {
                        packet.shorten(lane, leaves.t_max(lane));
                    }
                }
                if alive == 0 {
                    return;
                }
            } else if let Some(index) = at.node() {
                let node = &self.nodes[index];
                let bottom = stack.top;
                for lane in 0..WIDTH {
                    let p = &node.planes;
                    // Children that are missing are last.
                    if p[0][lane] == f32::INFINITY {
                        break;
                    }
                    let low = [p[0][lane], p[2][lane], p[4][lane]];
                    let high = [p[1][lane], p[3][lane], p[5][lane]];
                    let (near, entered) = packet.enter::<R>(low, high);
                    let entered = entered & rays;
                    if entered == 0 {
                        continue;
                    }
                    let near = if L::ANY { 0.0 } else { near.least(entered) };
                    let task = Task { near, child: node.children[lane], rays: entered };
                    if L::ANY {
                        stack.push(task);
                    } else {
                        stack.insert(bottom, task);
                    }
                }
            } else {
                alive &= !leaves.leaf(at.items(), rays, packet);
                if alive == 0 {
                    return;
                }
            }
            loop {
                let Some(task) = stack.pop() else { return };
                rays = task.rays & alive;
                if !L::ANY {
                    // Not `<`: another hit at the same distance may have a lower id.
                    rays &= R::splat(task.near).le(R::load(&packet.limit));
                }
                if rays != 0 {
                    at = task.child;
                    break;
                }
            }
        }
    }

    /// Lets one ray of a packet walk a part of the tree; whether it needs no more.
    ///
    /// # Safety
    /// The processor has the instruction set of `R`.
    #[inline(always)]
    unsafe fn walk_alone<R: Rows, L: PacketLeaves<R>>(
        &self,
        packet: &Packet,
        lane: usize,
        from: Child,
        leaves: &mut L,
    ) -> bool {
        let ray = packet.one(lane);
        let limit = ray.limit(leaves.t_max(lane));
        let mut alone = Alone { leaves, lane, packet, rows: PhantomData::<R> };
        // SAFETY: the caller answers for the instruction set.
        let end = unsafe {
            walk_below::<R::One, _, _>(self, &ray, from, limit, &mut NoCount, &mut alone)
        };
        end.is_none()
    }
}

/// Room for what the longest way leaves behind. It is not cleared, which would take as long as some walks.
struct Stack<const ROOM: usize> {
    tasks: [MaybeUninit<Task>; ROOM],
    /// The tasks below are set.
    top: usize,
}

impl<const ROOM: usize> Stack<ROOM> {
    #[inline(always)]
    const fn new() -> Self {
        Self { tasks: [const { MaybeUninit::uninit() }; ROOM], top: 0 }
    }

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
            // SAFETY: the tasks below `top` are set.
            let below = unsafe { self.tasks[slot - 1].assume_init() };
            if below.near >= task.near {
                break;
            }
            self.tasks[slot] = MaybeUninit::new(below);
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

/// The leaves for one ray of a packet.
struct Alone<'a, L, R> {
    leaves: &'a mut L,
    lane: usize,
    packet: &'a Packet,
    rows: PhantomData<R>,
}

impl<R: Rows, L: PacketLeaves<R>> Leaves<R::One, NoCount> for Alone<'_, L, R> {
    const ANY: bool = L::ANY;

    #[inline(always)]
    unsafe fn visit(&mut self, items: Range<usize>, ray: &BoxRay, _: &mut NoCount) -> Option<f32> {
        let t_max = self.leaves.leaf_alone(items, self.lane, self.packet)?;
        Some(ray.limit(t_max))
    }
}
