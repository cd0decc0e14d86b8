// SPDX-License-Identifier: MIT OR Apache-2.0
//! Walking the tree with sixteen rays at once: a node that several of them enter is fetched once.
//!
//! The order of the walk is that of one of the rays; the others may have to visit more than they would alone,
//! but what they find is the same.

pub mod rows;

use std::ops::Range;

use dioptric_math::DVec3;
use dioptric_math::bounds::gamma;

use self::rows::{LANES, Mask, Row, Rows};
use super::{Bvh, Child, MAX_DEPTH, WIDTH};

/// Sixteen rays as boxes see them: about the tree's centre, with directions of length 1. Filled by
/// [`Self::set`] for each ray, then [`Self::finish`].
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

    /// Puts a ray into a lane.
    #[inline(always)]
    pub fn set(
        &mut self,
        lane: usize,
        origin: DVec3,
        direction: DVec3,
        t_max: f64,
        error: f64,
        bvh: &Bvh,
    ) {
        let relative = origin - bvh.center;
        for axis in 0..3 {
            self.origin[axis].0[lane] = relative[axis] as f32;
            self.direction[axis].0[lane] = direction[axis] as f32;
        }
        self.limit.0[lane] = t_max as f32;
        self.pad.0[lane] = error as f32;
    }

    /// Works out what walks need, for the `(amplify, extent)` of [`crate::world`]'s reach. Returns the rays that
    /// are fit for single precision; the others must not walk.
    #[inline(always)]
    pub fn finish<R: Rows>(&mut self, bvh: &Bvh, (amplify, extent): (f64, f64)) -> Mask {
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
        let pad = R::load(&self.pad)
            .mul_add(R::splat(amplify as f32), outside)
            .add(reach.mul(R::splat(16.0 / 16_777_216.0)))
            .mul_add(R::splat(UP), R::splat(f32::MIN_POSITIVE));
        pad.store(&mut self.pad);
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
            o[axis].add(pad).mul(inverse).store(&mut self.low[axis]);
            o[axis].sub(pad).mul(inverse).store(&mut self.high[axis]);
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

/// A level leaves at most this many tasks behind.
const LEFT: usize = WIDTH - 1;

/// What is still to be visited, by which rays, and where they enter it.
#[derive(Clone, Copy)]
struct Task {
    near: Row,
    child: Child,
    rays: Mask,
    /// Where the first of the rays enters.
    first: f32,
}

/// What is done at the leaves. (No closure: those would be compiled without the features of the function that
/// they are used in, and calls of single instructions are slow.)
pub trait Leaves<R: Rows> {
    /// Tests a leaf's items for `rays`. May shorten rays; returns those that need no more leaves.
    fn leaf(&mut self, items: Range<usize>, rays: Mask, packet: &mut Packet) -> Mask;
}

impl Bvh {
    /// Hands every leaf whose box some of `rays` enter to `leaves`, with these rays, nearer boxes first.
    #[inline(always)]
    pub fn visit_packet<R: Rows>(
        &self,
        packet: &mut Packet,
        rays: Mask,
        leaves: &mut impl Leaves<R>,
    ) {
        // A small stack is faster to set up.
        if self.depth <= 6 {
            self.walk_packet::<{ 6 * LEFT + 1 }, R>(packet, rays, leaves);
        } else if self.depth <= 16 {
            self.walk_packet::<{ 16 * LEFT + 1 }, R>(packet, rays, leaves);
        } else {
            self.walk_packet::<{ MAX_DEPTH * LEFT + 1 }, R>(packet, rays, leaves);
        }
    }

    #[inline(always)]
    fn walk_packet<const STACK: usize, R: Rows>(
        &self,
        packet: &mut Packet,
        mut alive: Mask,
        leaves: &mut impl Leaves<R>,
    ) {
        if self.nodes.is_empty() || alive == 0 {
            return;
        }
        let root = Child::inner(0);
        let nothing = Task { near: Row::splat(0.0), child: root, rays: 0, first: 0.0 };
        let mut stack = [nothing; STACK];
        let mut top = 0;
        let (mut at, mut rays) = (root, alive);
        loop {
            if let Some(index) = at.node() {
                let node = &self.nodes[index];
                let bottom = top;
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
                    let mut task = Task {
                        near: Row::splat(0.0),
                        child: node.children[lane],
                        rays: entered,
                        first: 0.0,
                    };
                    near.store(&mut task.near);
                    task.first = task.near.0[entered.trailing_zeros() as usize % LANES];
                    // Sorted, the nearest on top.
                    let mut slot = top;
                    while slot > bottom && stack[slot - 1].first < task.first {
                        stack[slot] = stack[slot - 1];
                        slot -= 1;
                    }
                    stack[slot] = task;
                    top += 1;
                }
            } else {
                alive &= !leaves.leaf(at.items(), rays, packet);
                if alive == 0 {
                    return;
                }
            }
            loop {
                if top == 0 {
                    return;
                }
                top -= 1;
                let task = &stack[top];
                // Not `<`: another hit at the same distance may have a lower id.
                rays = R::load(&task.near).le(R::load(&packet.limit)) & task.rays & alive;
                if rays != 0 {
                    at = task.child;
                    break;
                }
            }
        }
    }
}
