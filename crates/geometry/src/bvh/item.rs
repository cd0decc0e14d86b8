// SPDX-License-Identifier: MIT OR Apache-2.0
//! What a tree is built over: boxes in single precision with the numbers of what they hold.
//!
//! A box is its smallest coordinates and the opposites of its largest ones, so that the box around two is the
//! smaller one of each of eight numbers.

use dioptric_math::DVec3;
use rayon::prelude::*;

use crate::bounds::Bounds;
use crate::memory;

/// A box in single precision, about the tree's centre. The fourth and the last number mean nothing.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Box32(pub(super) [f32; 8]);

impl Box32 {
    pub(super) const EMPTY: Self = Self([f32::INFINITY; 8]);

    /// A box with these smallest and largest coordinates.
    pub(super) const fn new(min: [f32; 3], max: [f32; 3]) -> Self {
        Self([min[0], min[1], min[2], 0.0, -max[0], -max[1], -max[2], 0.0])
    }

    /// One step further out than the nearest f32, which also covers the subtraction's rounding.
    pub(super) fn around(b: &Bounds, center: DVec3) -> Self {
        let min = (b.min - center).to_array().map(|x| (x as f32).next_down());
        let max = (b.max - center).to_array().map(|x| (x as f32).next_up());
        Self::new(min, max)
    }

    pub(super) fn is_finite(&self) -> bool {
        // Also false where a corner is NaN.
        self.0.iter().all(|x| x.is_finite())
    }

    /// The smallest coordinate along an axis.
    #[inline(always)]
    pub(super) const fn min(&self, axis: usize) -> f32 {
        self.0[axis]
    }

    /// The largest coordinate along an axis.
    #[inline(always)]
    pub(super) const fn max(&self, axis: usize) -> f32 {
        -self.0[4 + axis]
    }

    #[inline(always)]
    pub(super) fn union(self, other: Self) -> Self {
        // Written as the processors' own minimum is.
        Self(std::array::from_fn(|i| if self.0[i] < other.0[i] { self.0[i] } else { other.0[i] }))
    }

    /// The largest coordinate.
    pub(super) fn largest(&self) -> f64 {
        (0..3).fold(0.0, |all, axis| {
            f64::from(self.min(axis).abs().max(self.max(axis).abs())).max(all)
        })
    }

    /// The box around its middle alone; halves first, so that it cannot overflow.
    #[inline(always)]
    pub(super) fn center(&self) -> Self {
        let b = &self.0;
        let middle: [f32; 4] = std::array::from_fn(|i| b[i] * 0.5 - b[4 + i] * 0.5);
        Self(std::array::from_fn(|i| if i < 4 { middle[i] } else { -middle[i - 4] }))
    }

    /// How wide it is along the axes; 0 where empty.
    #[inline(always)]
    pub(super) fn size(&self) -> [f32; 3] {
        [0, 1, 2].map(|axis| (self.max(axis) - self.min(axis)).max(0.0))
    }

    /// Half the surface, in f64 so that few scales overflow; 0 where empty.
    #[inline(always)]
    pub(super) fn half_area(&self) -> f64 {
        let [x, y, z] = self.size().map(f64::from);
        x * y + y * z + z * x
    }
}

/// What a tree is built over: a box about the tree's centre as [`Box32`] has it, and a number; eight words, so that
/// memory for them need not be cleared.
pub(crate) type Item = [f32; 8];

/// The number is kept among the coordinates; with this bit it is one that no sum takes long with.
const NUMBER: u32 = 1 << 30;

/// Makes an item. The box is finite and not empty, `number` below [`super::Bvh::MAX_ITEMS`] or anything for one that
/// stands alone.
#[inline(always)]
pub(crate) fn item(min: [f32; 3], max: [f32; 3], number: u32) -> Item {
    numbered(Box32::new(min, max), number)
}

#[inline(always)]
fn numbered(Box32(mut words): Box32, number: u32) -> Item {
    words[3] = f32::from_bits(number & (NUMBER - 1) | NUMBER);
    words
}

/// The item of a box; `None` where the box is empty, or not finite in single precision.
pub(crate) fn item_around(bounds: &Bounds, center: DVec3, number: u32) -> Option<Item> {
    let b = Box32::around(bounds, center);
    (!bounds.is_empty() && b.is_finite()).then(|| numbered(b, number))
}

/// The number of an item.
#[inline(always)]
pub(crate) fn number(item: &Item) -> u32 {
    item[3].to_bits() & (NUMBER - 1)
}

/// The largest extent of an item along an axis.
#[inline(always)]
pub(crate) fn extent(item: &Item) -> f32 {
    let [x, y, z] = box_of(item).size();
    x.max(y).max(z)
}

#[inline(always)]
pub(super) fn box_of(item: &Item) -> Box32 {
    Box32(*item)
}

/// Items that one thread makes in a row. Sums may depend on it, and so it must not depend on the threads.
const RUN: usize = 1 << 13;

/// Makes items of some of `count` things, side by side in the pool of threads that this is called in. `add` makes the
/// one of a thing, if any, and adds the thing to the sums of its run, which are returned in order.
pub(crate) fn make_items<S: Default + Send>(
    count: usize,
    add: impl Fn(&mut S, u32) -> Option<Item> + Sync,
) -> (Vec<Item>, Vec<S>) {
    // Cleared by the system, where it is looked at.
    let mut items: Vec<Item> = vec![[0.0; 8]; count];
    memory::advise(&items);
    let run = |(index, items): (usize, &mut [Item])| {
        let (mut sums, mut kept) = (S::default(), 0);
        let numbers = (index * RUN) as u32..;
        for number in numbers.take(items.len()) {
            if let Some(item) = add(&mut sums, number) {
                items[kept] = item;
                kept += 1;
            }
        }
        (kept, sums)
    };
    let runs: Vec<(usize, S)> = if rayon::current_thread_index().is_some() {
        items.par_chunks_mut(RUN).enumerate().map(run).collect()
    } else {
        items.chunks_mut(RUN).enumerate().map(run).collect()
    };
    if runs.iter().map(|(kept, _)| kept).sum::<usize>() < count {
        let mut end = 0;
        for (index, (kept, _)) in runs.iter().enumerate() {
            let start = index * RUN;
            items.copy_within(start..start + kept, end);
            end += kept;
        }
        items.truncate(end);
    }
    (items, runs.into_iter().map(|(_, sums)| sums).collect())
}
