// SPDX-License-Identifier: MIT OR Apache-2.0
//! Building pools: the box around all, the tree, then the things and the balls around them in the order of its leaves.

use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering};

use dioptric_math::DVec3;
use rayon::prelude::*;

use super::{Pool, Pooled};
use crate::bounds::{Bounds, Middle};
use crate::bvh::balls::{BALLS, Balls};
use crate::bvh::build::build_items;
use crate::bvh::item::{item_around, make_items, number};
use crate::bvh::{Bvh, Costs};
use crate::memory;
use crate::shape::Shape;

/// Balls are tested a packet at a time.
const BALL_COSTS: Costs = Costs { block: BALLS, visit: 0.4 };
/// Coordinates of things in a pool are smaller.
const LARGEST: f64 = 1e30;
/// Things that one thread looks at in a row.
const RUN: usize = 1 << 13;

impl<S: Pooled> Pool<S> {
    /// Builds the tree over some things; those whose boxes are empty or reach beyond 10^30 are left out. `None` where
    /// there are more than parts can number (2^32, or 2^30 of those with parts).
    ///
    /// Uses the pool of threads that it is called in, if any; the result is the same for any number.
    #[must_use]
    pub fn new(given: Vec<S>) -> Option<Self> {
        if given.len() as u64 > 1 << (32 - S::PART_BITS) {
            return None;
        }
        let parallel = rayon::current_thread_index().is_some();
        let runs: Vec<(Bounds, Middle)> = if parallel {
            given.par_chunks(RUN).map(around).collect()
        } else {
            given.chunks(RUN).map(around).collect()
        };
        let all = |(bounds, middle): (Bounds, Middle), run: &(Bounds, Middle)| {
            (bounds.union(run.0), middle.and(run.1))
        };
        let (bounds, middle) = runs.iter().fold((Bounds::EMPTY, Middle::NONE), all);
        let center = middle.of(&bounds);
        let count = given.len().min(Bvh::MAX_ITEMS);
        let (items, _) = make_items(count, |(): &mut (), index| {
            let b = given.get(index as usize)?.bounds();
            let inside = b.union(bounds) == bounds;
            inside.then(|| item_around(&b, center, index)).flatten()
        });
        let has_balls = given.first().is_some_and(|s| s.ball().is_some());
        let costs = if has_balls { BALL_COSTS } else { Costs::SINGLE };
        let (mut bvh, items) = build_items(items, center, costs);
        let mut index_of = vec![0; items.len()];
        let mut place_of: Vec<AtomicU32> = Vec::with_capacity(given.len());
        place_of.resize_with(given.len(), || AtomicU32::new(u32::MAX));
        let mut things = memory::with_capacity(items.len());
        let thing = |((place, item), index): ((usize, _), &mut u32)| {
            *index = number(item);
            place_of[*index as usize].store(place as u32, Ordering::Relaxed);
            given[*index as usize].clone()
        };
        if parallel {
            things.par_extend(items.par_iter().enumerate().zip(&mut index_of).map(thing));
        } else {
            things.extend(items.iter().enumerate().zip(&mut index_of).map(thing));
        }
        let place_of = place_of.into_iter().map(AtomicU32::into_inner).collect();
        drop((given, items));
        let fill = |range: Range<usize>| {
            (balls(things.get(range.clone()).unwrap_or_default(), range.start, center), false)
        };
        let balls = if has_balls { bvh.pack_leaves(BALLS, 0, fill) } else { Vec::new() };
        let largest = if bounds.is_empty() {
            0.0
        } else {
            bounds.min.abs().max(bounds.max.abs()).max_element()
        };
        Some(Self { largest, items: things, index_of, place_of, balls, bvh, bounds })
    }
}

/// The box around those that can be in a pool, and their middle.
fn around<S: Pooled>(things: &[S]) -> (Bounds, Middle) {
    let is_small = |b: &Bounds| {
        let largest = b.min.abs().max(b.max.abs()).max_element();
        largest < LARGEST && !b.is_empty()
    };
    let (mut bounds, mut middle) = (Bounds::EMPTY, Middle::NONE);
    for b in things.iter().map(Shape::bounds).filter(is_small) {
        bounds = bounds.union(b);
        middle.add(&b);
    }
    (bounds, middle)
}

/// Balls around things that follow each other.
fn balls<S: Pooled>(things: &[S], first: usize, middle: DVec3) -> Balls {
    let mut balls = Balls::empty(first as u32);
    for (lane, (center, radius)) in things.iter().filter_map(Pooled::ball).enumerate() {
        let center = center - middle;
        balls.centers[0][lane] = center.x as f32;
        balls.centers[1][lane] = center.y as f32;
        balls.centers[2][lane] = center.z as f32;
        balls.radii[lane] = (radius as f32).next_up();
    }
    balls
}
