// SPDX-License-Identifier: MIT OR Apache-2.0
//! Where to split items in two: the surface area heuristic over bins (Wald, "On fast Construction of SAH-based
//! Bounding Volume Hierarchies", IEEE Symposium on Interactive Ray Tracing, 2007).
//!
//! Minima and sums that do not depend on their order, so that all instruction sets and threads find the same.

use dioptric_math::{Vec4, Vec4Swizzles};

use super::item::{Box32, Item};
use super::lanes::eight::Eight;
use super::lanes::{Job, Lanes, Test};
use super::{Child, Costs};

/// Bins for many items; a few have fewer.
const BINS: usize = 32;
const FEW_BINS: usize = 16;
/// Fewer items than this are a few.
const MANY: usize = 512;
/// So many items are counted by several threads together.
const SHARED: usize = 1 << 16;

/// Items in two parts: the number of the first ones, and the boxes of both and around their centres.
pub(super) struct Halves {
    pub middle: usize,
    pub bounds: [Box32; 2],
    pub centers: [Box32; 2],
}

/// What is to become of items.
pub(super) enum Verdict {
    /// They are in two parts now, as is cheapest.
    Split(Halves),
    /// They are cheapest as one leaf.
    Leaf,
    /// Their centres are one point.
    Alike,
}

/// Which bins a centre falls into, on all axes.
#[derive(Clone, Copy)]
struct Binning {
    low: Vec4,
    scale: Vec4,
    last: Vec4,
    used: usize,
}

/// Added to this number, whole parts are the lowest bits.
const SHIFT: f32 = (1 << 23) as f32;

impl Binning {
    #[inline(always)]
    fn new(centers: &Box32, items: usize) -> Self {
        let used = if items < MANY { items.clamp(4, FEW_BINS) } else { BINS };
        let scale = |axis: usize| {
            let width = centers.max(axis) - centers.min(axis);
            if width > 0.0 { used as f32 / width } else { 0.0 }
        };
        Self {
            low: Vec4::new(centers.min(0), centers.min(1), centers.min(2), 0.0),
            scale: Vec4::new(scale(0), scale(1), scale(2), 0.0),
            last: Vec4::splat(SHIFT + (used - 1) as f32),
            used,
        }
    }

    /// The bins of a centre, as the lowest bits.
    #[inline(always)]
    fn of(&self, center: Vec4) -> [u32; 4] {
        // Half less is rounded to the part that is meant.
        let place = (center - self.low) * self.scale + Vec4::splat(SHIFT - 0.5);
        // A NaN (0 times infinity, in boxes of nearly no size) becomes 0.
        let [x, y, z, w] = place.max(Vec4::splat(SHIFT)).min(self.last).to_array();
        // Written out: `map` on arrays is a call.
        [x.to_bits(), y.to_bits(), z.to_bits(), w.to_bits()]
    }
}

/// The middle of a box; halves first, so that it cannot overflow.
///
/// # Safety
/// The processor has the instruction set.
#[inline(always)]
unsafe fn center<E: Eight>(b: E) -> Vec4 {
    // SAFETY: the caller answers for the instruction set.
    let (low, high) = unsafe { (b.low(), b.high()) };
    low * 0.5 - high * 0.5
}

/// What falls into the bins of each axis: room for one range after the other.
#[repr(align(64))]
pub(super) struct Filled {
    bins: [[Box32; BINS]; 3],
    counts: [[u32; BINS]; 3],
}

impl Filled {
    /// Room for bins.
    pub(super) const fn new() -> Self {
        Self { bins: [[Box32::EMPTY; BINS]; 3], counts: [[0; BINS]; 3] }
    }

    /// # Safety
    /// The processor has the instruction set.
    #[inline(always)]
    unsafe fn fill<E: Eight>(&mut self, binning: &Binning, items: &[Item]) {
        let used = binning.used.min(BINS);
        // SAFETY, here and below: the caller answers for the instruction set.
        let nothing = unsafe { E::splat(f32::INFINITY) };
        for (bins, counts) in self.bins.iter_mut().zip(&mut self.counts) {
            for Box32(bin) in &mut bins[..used] {
                unsafe { nothing.store(bin) };
            }
            counts[..used].fill(0);
        }
        for item in items {
            let b = unsafe { E::load(item) };
            let bins = binning.of(unsafe { center(b) });
            for ((bins, counts), bin) in self.bins.iter_mut().zip(&mut self.counts).zip(bins) {
                let bin = bin as usize % BINS;
                let Box32(around) = &mut bins[bin];
                unsafe { E::load(around).min(b).store(around) };
                counts[bin] += 1;
            }
        }
    }

    fn join(&mut self, other: &Self) {
        for axis in 0..3 {
            for bin in 0..BINS {
                self.bins[axis][bin] = self.bins[axis][bin].union(other.bins[axis][bin]);
                self.counts[axis][bin] += other.counts[axis][bin];
            }
        }
    }
}

/// Fills bins.
struct Fill<'a> {
    binning: &'a Binning,
    items: &'a [Item],
    filled: &'a mut Filled,
}

impl Job for Fill<'_> {
    type Output = ();

    #[inline(always)]
    unsafe fn run<T: Test>(self) {
        // SAFETY: the caller answers for the instruction set.
        unsafe { self.filled.fill::<T::Eight>(self.binning, self.items) };
    }
}

impl Fill<'_> {
    /// The same by all threads of the pool.
    fn share(self, lanes: Lanes) {
        let Self { binning, items, filled } = self;
        if items.len() < SHARED {
            // SAFETY: a tree's instruction set is one that the processor has.
            return unsafe { lanes.run(Fill { binning, items, filled }) };
        }
        let (left, right) = items.split_at(items.len() / 2);
        let mut more = Filled::new();
        rayon::join(
            || Fill { binning, items: left, filled }.share(lanes),
            || Fill { binning, items: right, filled: &mut more }.share(lanes),
        );
        filled.join(&more);
    }
}

/// Items with the box around them and the one around their centres.
pub(super) struct Weighed<'a> {
    pub items: &'a mut [Item],
    pub bounds: &'a Box32,
    pub centers: &'a Box32,
    pub costs: &'a Costs,
}

impl Weighed<'_> {
    /// Splits the items where it is cheapest, if it is cheaper than a leaf where they can be one.
    pub fn split(self, lanes: Lanes, filled: &mut Filled) -> Verdict {
        let binning = Binning::new(self.centers, self.items.len());
        let shared = self.items.len() >= SHARED && rayon::current_thread_index().is_some();
        if shared {
            Fill { binning: &binning, items: self.items, filled }.share(lanes);
        }
        // SAFETY: a tree's instruction set is one that the processor has.
        unsafe { lanes.run(Split { of: self, binning, filled, shared }) }
    }
}

struct Split<'a, 'b> {
    of: Weighed<'a>,
    binning: Binning,
    filled: &'b mut Filled,
    /// Whether the bins are filled.
    shared: bool,
}

impl Job for Split<'_, '_> {
    type Output = Verdict;

    #[inline(always)]
    unsafe fn run<T: Test>(self) -> Verdict {
        let Self { of: Weighed { items, bounds, costs, .. }, binning, filled, shared } = self;
        // SAFETY, here and below: the caller answers for the instruction set.
        if !shared {
            unsafe { filled.fill::<T::Eight>(&binning, items) };
        }
        let unit = unit(bounds);
        let count = items.len() as u32;
        let best = unsafe { filled.best::<T::Eight>(&binning, count, unit, costs) };
        let Some(best) = best else { return Verdict::Alike };
        if items.len() <= Child::MAX_COUNT {
            let area = unsafe { half_area(T::Eight::load(&bounds.0), unit) };
            if costs.visit * area + best.cost >= costs.tests(count) * area {
                return Verdict::Leaf;
            }
        }
        let bounds = unsafe { filled.around::<T::Eight>(&binning, &best) };
        let (middle, centers) = unsafe { partition::<T::Eight>(items, &binning, &best) };
        Verdict::Split(Halves { middle, bounds, centers })
    }
}

/// Sizes are multiplied with this before areas are worked out, so that single precision is enough for boxes of
/// any size.
#[inline(always)]
fn unit(bounds: &Box32) -> f32 {
    let [x, y, z] = bounds.size();
    let largest = x.max(y).max(z);
    if largest > f32::MIN_POSITIVE { 1.0 / largest } else { 0.0 }
}

/// Half the surface; 0 where empty.
///
/// # Safety
/// The processor has the instruction set.
#[inline(always)]
unsafe fn half_area<E: Eight>(b: E, unit: f32) -> f32 {
    // SAFETY: the caller answers for the instruction set.
    let (low, high) = unsafe { (b.low(), b.high()) };
    // Empty ones are negative, infinitely.
    let size = (-low - high).max(Vec4::ZERO) * unit;
    let products = size * size.yzxw();
    products.x + products.y + products.z
}

/// Between which bins to split.
struct Best {
    axis: usize,
    /// The first bin of the right side.
    bin: usize,
    /// Tests times half areas, both sides.
    cost: f32,
}

impl Filled {
    /// The cheapest split between two bins on any axis; `None` where all are in one bin.
    ///
    /// # Safety
    /// The processor has the instruction set.
    #[inline(always)]
    unsafe fn best<E: Eight>(
        &self,
        binning: &Binning,
        items: u32,
        unit: f32,
        costs: &Costs,
    ) -> Option<Best> {
        let used = binning.used.min(BINS);
        // SAFETY, here and below: the caller answers for the instruction set.
        let nothing = unsafe { E::splat(f32::INFINITY) };
        // Right to left: what lies right of each boundary; then left to right.
        let mut right = [[0.0_f32; 3]; BINS];
        let (mut bounds, mut counts) = ([nothing; 3], [0; 3]);
        for bin in (1..used).rev() {
            for axis in 0..3 {
                bounds[axis] = unsafe { bounds[axis].min(E::load(&self.bins[axis][bin].0)) };
                counts[axis] += self.counts[axis][bin];
                right[bin][axis] =
                    unsafe { half_area(bounds[axis], unit) } * costs.tests(counts[axis]);
            }
        }
        let mut best = Best { axis: 0, bin: 0, cost: f32::INFINITY };
        let (mut bounds, mut counts) = ([nothing; 3], [0; 3]);
        for (bin, right) in right.iter().enumerate().take(used).skip(1) {
            for axis in 0..3 {
                bounds[axis] = unsafe { bounds[axis].min(E::load(&self.bins[axis][bin - 1].0)) };
                counts[axis] += self.counts[axis][bin - 1];
                let left = unsafe { half_area(bounds[axis], unit) } * costs.tests(counts[axis]);
                let cost = left + right[axis];
                let both_sides = counts[axis] != 0 && counts[axis] != items;
                if both_sides && cost < best.cost {
                    best = Best { axis, bin, cost };
                }
            }
        }
        (best.bin > 0).then_some(best)
    }

    /// The boxes of both sides.
    ///
    /// # Safety
    /// The processor has the instruction set.
    #[inline(always)]
    unsafe fn around<E: Eight>(&self, binning: &Binning, best: &Best) -> [Box32; 2] {
        let (left, right) = self.bins[best.axis][..binning.used].split_at(best.bin);
        // Written out: `map` on arrays is a call.
        // SAFETY: the caller answers for the instruction set.
        unsafe { [around::<E>(left), around::<E>(right)] }
    }
}

/// The box around all.
///
/// # Safety
/// The processor has the instruction set.
#[inline(always)]
unsafe fn around<E: Eight>(boxes: &[Box32]) -> Box32 {
    let mut all = Box32::EMPTY;
    // SAFETY: the caller answers for the instruction set.
    unsafe {
        boxes.iter().fold(E::splat(f32::INFINITY), |a, b| a.min(E::load(&b.0))).store(&mut all.0);
    }
    all
}

/// Moves the left side's items to the front; their number, and the boxes around the centres of both sides.
///
/// # Safety
/// The processor has the instruction set.
#[inline(always)]
unsafe fn partition<E: Eight>(
    items: &mut [Item],
    binning: &Binning,
    best: &Best,
) -> (usize, [Box32; 2]) {
    const SIDES: [f32; 2] = [f32::INFINITY, f32::NEG_INFINITY];
    let (axis, bin) = (best.axis % 4, best.bin as u32 | SHIFT.to_bits());
    let mut middle = 0;
    // SAFETY, here and below: the caller answers for the instruction set.
    let (mut left, mut right) = unsafe { (E::splat(f32::INFINITY), E::splat(f32::INFINITY)) };
    for i in 0..items.len() {
        let item = items[i];
        let center = unsafe { center(E::load(&item)) };
        let on_left = usize::from(binning.of(center)[axis] < bin);
        unsafe {
            let own = E::of(center, -center);
            // No branch: which side comes next cannot be foreseen.
            left = left.min(own.max(E::splat(SIDES[on_left])));
            right = right.min(own.max(E::splat(SIDES[1 - on_left])));
        }
        items[i] = items[middle];
        items[middle] = item;
        middle += on_left;
    }
    let mut centers = [Box32::EMPTY; 2];
    unsafe {
        left.store(&mut centers[0].0);
        right.store(&mut centers[1].0);
    }
    (middle, centers)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::item::{box_of, item, number};

    #[test]
    fn every_instruction_set_splits_alike() {
        let coordinate =
            |i: u32, axis: u32| ((i * 7919 + axis * 104_729) % 1009) as f32 * 0.37 - 90.0;
        let items: Vec<Item> = (0..700)
            .map(|i| {
                let low = [0, 1, 2].map(|axis| coordinate(i, axis));
                item(low, low.map(|x| x + (i % 13) as f32), i)
            })
            .collect();
        let around =
            |boxes: &mut dyn Iterator<Item = Box32>| boxes.fold(Box32::EMPTY, Box32::union);
        for count in [9, 40, 700] {
            let bounds = around(&mut items[..count].iter().map(box_of));
            let centers = around(&mut items[..count].iter().map(|i| box_of(i).center()));
            let split = |lanes| {
                let mut items = items[..count].to_vec();
                let costs = &Costs::SINGLE;
                let of = Weighed { items: &mut items, bounds: &bounds, centers: &centers, costs };
                let Verdict::Split(halves) = of.split(lanes, &mut Filled::new()) else {
                    panic!("{count} items are no leaf");
                };
                let (left, right) = items.split_at(halves.middle);
                for (side, half) in [left, right].into_iter().enumerate() {
                    assert!(!half.is_empty());
                    let bounds = around(&mut half.iter().map(box_of));
                    assert_eq!(bounds.0[..3], halves.bounds[side].0[..3]);
                    assert_eq!(bounds.0[4..7], halves.bounds[side].0[4..7]);
                }
                (items.iter().map(number).collect::<Vec<_>>(), halves.centers.map(|c| c.0))
            };
            assert_eq!(split(Lanes::Plain), split(Lanes::best()));
        }
    }
}
