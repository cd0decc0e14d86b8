// SPDX-License-Identifier: MIT OR Apache-2.0
//! Building by the surface area heuristic over bins (Wald, "On fast Construction of SAH-based
//! Bounding Volume Hierarchies", IEEE Symposium on Interactive Ray Tracing, 2007).
//!
//! Every subtree owns a fixed part of the arrays (a range of `n` items needs at most `n - 1` nodes),
//! so that subtrees can be built by several threads with the same result as by one.

use dioptric_math::{DVec3, Vec4};

use super::item::{Box32, Item, box_of, item, number};
use super::widen::widen;
use super::{Bvh, Child, Lanes, MAX_DEPTH};
use crate::bounds::Bounds;

/// Bins for many items; a few have fewer.
const BINS: usize = 32;
const FEW_BINS: usize = 16;
/// Fewer items than this are a few.
const MANY: usize = 512;
/// Leaves hold no more items, even where nothing tells them apart.
const MAX_LEAF: usize = Child::MAX_COUNT;
/// The cost of a visit to a node, in tests of an item.
const VISIT_COST: f64 = 1.5;
/// Below this many items a second thread costs more than it saves.
pub(super) const PARALLEL: usize = 4096;

/// So many items are counted by several threads together.
const SHARED: usize = 1 << 16;

/// A split in two: the boxes of both sides and their children, as words for the same reason.
pub(super) type Split2 = [u32; 16];

fn pack(left: &Built, right: &Built) -> Split2 {
    let mut words = [0; 16];
    for (half, side) in words.chunks_exact_mut(8).zip([left, right]) {
        let numbers = side.bounds.min.to_array().into_iter().take(3);
        let numbers = numbers.chain(side.bounds.max.to_array().into_iter().take(3));
        for (word, x) in half.iter_mut().zip(numbers) {
            *word = x.to_bits();
        }
        half[7] = side.child.0;
    }
    words
}

pub(super) fn unpack(words: &Split2) -> [Built; 2] {
    let side = |at: usize| {
        let x = |i: usize| f32::from_bits(words[at + i]);
        Built {
            child: Child(words[at + 7]),
            bounds: Box32 {
                min: Vec4::new(x(0), x(1), x(2), 0.0),
                max: Vec4::new(x(3), x(4), x(5), 0.0),
            },
        }
    };
    [side(0), side(8)]
}

/// What the leaves cost.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Costs {
    /// How many items are tested at once: 1, 2, 4 or 8.
    pub block: usize,
    /// The cost of a split, in such tests.
    pub visit: f64,
}

impl Costs {
    /// Items that are tested one by one.
    pub const SINGLE: Self = Self { block: 1, visit: VISIT_COST };

    #[inline(always)]
    fn tests(&self, items: u32) -> f64 {
        f64::from((items + (self.block as u32 - 1)) >> self.block.trailing_zeros())
    }
}

pub(super) fn build(
    boxes: impl ExactSizeIterator<Item = Bounds>,
    center: DVec3,
    costs: Costs,
) -> (Bvh, Vec<u32>) {
    let items = boxes
        .take(Bvh::MAX_ITEMS)
        .zip(0..)
        .map(|(b, index)| {
            let b = Box32::around(&b, center);
            item(b.min.truncate().to_array(), b.max.truncate().to_array(), index)
        })
        .collect();
    let (bvh, items) = build_items(items, center, costs);
    (bvh, items.iter().map(number).collect())
}

/// Builds a tree over items, whose boxes are about `center`; returns them in the order of the leaves.
pub(crate) fn build_items(mut items: Vec<Item>, center: DVec3, costs: Costs) -> (Bvh, Vec<Item>) {
    items.truncate(Bvh::MAX_ITEMS);
    let mut bvh = Bvh { nodes: Vec::new(), center, extent: 0.0, depth: 1, lanes: Lanes::best() };
    if items.is_empty() {
        return (bvh, items);
    }
    // Cleared by the system, where it is looked at.
    let mut splits = vec![[0; 16]; items.len() - 1];
    crate::memory::advise(&splits);
    let (bounds, centers) = around_all(&items);
    let root = Range {
        items: &mut items,
        first: 0,
        splits: &mut splits,
        base: 0,
        depth: 0,
        costs,
        bounds,
        centers,
    }
    .build();
    bvh.extent = root.bounds.largest();
    widen(&mut bvh, &splits, &root);
    (bvh, items)
}

/// The box around items, and the one around their centres.
fn around_all(items: &[Item]) -> (Box32, Box32) {
    let run = |items: &[Item]| {
        let mut all = (Box32::EMPTY, Box32::EMPTY);
        for b in items.iter().map(box_of) {
            let c = b.center();
            all = (all.0.union(b), all.1.union(Box32 { min: c, max: c }));
        }
        all
    };
    if items.len() >= PARALLEL && rayon::current_thread_index().is_some() {
        let (left, right) = items.split_at(items.len() / 2);
        let (left, right) = rayon::join(|| around_all(left), || around_all(right));
        return (left.0.union(right.0), left.1.union(right.1));
    }
    run(items)
}

/// A built subtree.
#[derive(Clone, Copy)]
pub(super) struct Built {
    pub child: Child,
    pub bounds: Box32,
}

/// A range of items that becomes a subtree, with the part of the arrays that it owns.
struct Range<'a> {
    items: &'a mut [Item],
    /// Where `items` begins among all.
    first: u32,
    splits: &'a mut [Split2],
    /// Where `splits` begins among all.
    base: u32,
    depth: usize,
    costs: Costs,
    /// Around the items, and around their centres.
    bounds: Box32,
    centers: Box32,
}

/// Items in two parts: the number of the first ones, and the boxes of both, as of [`Range`].
struct Parts {
    middle: usize,
    bounds: [Box32; 2],
    centers: [Box32; 2],
}

impl Range<'_> {
    fn build(self) -> Built {
        let n = self.items.len();
        let bounds = self.bounds;
        let leaf = Built { child: Child::leaf(self.first as usize, n.min(MAX_LEAF)), bounds };
        // What is tested at once anyway is not worth a look.
        if n <= self.costs.block {
            return leaf;
        }
        // Halving from here on must end within the depth that the traversal's stack allows.
        let levels_left = MAX_DEPTH - self.depth;
        let must_halve = n.ilog2() as usize + 2 >= levels_left;
        let split =
            if must_halve { None } else { Split::best(self.items, &self.centers, &self.costs) };
        let parts = match split {
            Some(s) => {
                let cost = self.costs.visit * bounds.half_area() + s.cost;
                if n <= MAX_LEAF && cost >= self.costs.tests(n as u32) * bounds.half_area() {
                    return leaf;
                }
                s.partition(self.items)
            }
            None if n <= MAX_LEAF => return leaf,
            None => halve(self.items, &self.centers),
        };
        let middle = parts.middle;
        let (left, right) = self.items.split_at_mut(middle);
        let Some((split, rest)) = self.splits.split_first_mut() else { return leaf };
        let (left_splits, right_splits) = rest.split_at_mut(middle - 1);
        let (depth, costs) = (self.depth + 1, self.costs);
        let left = Range {
            items: left,
            first: self.first,
            splits: left_splits,
            base: self.base + 1,
            depth,
            costs,
            bounds: parts.bounds[0],
            centers: parts.centers[0],
        };
        let right = Range {
            items: right,
            first: self.first + middle as u32,
            splits: right_splits,
            base: self.base + middle as u32,
            depth,
            costs,
            bounds: parts.bounds[1],
            centers: parts.centers[1],
        };
        // Outside a pool `join` would start the global one.
        let (left, right) = if n >= PARALLEL && rayon::current_thread_index().is_some() {
            rayon::join(|| left.build(), || right.build())
        } else {
            (left.build(), right.build())
        };
        *split = pack(&left, &right);
        Built { child: Child::inner(self.base as usize), bounds }
    }
}

/// Which bins an item falls into, on all axes.
#[derive(Clone, Copy)]
struct Binning {
    low: Vec4,
    scale: Vec4,
    last: Vec4,
}

impl Binning {
    fn new(centers: &Box32, bins: usize) -> Self {
        let width = centers.max - centers.min;
        let scale = width.to_array().map(|w| if w > 0.0 { bins as f32 / w } else { 0.0 });
        Self {
            low: centers.min,
            scale: Vec4::from_array(scale),
            last: Vec4::splat((bins - 1) as f32),
        }
    }

    #[inline(always)]
    fn bins(&self, center: Vec4) -> [u32; 4] {
        // A NaN (0 times infinity, in boxes of nearly no size) becomes 0.
        whole(((center - self.low) * self.scale).max(Vec4::ZERO).min(self.last))
    }
}

/// What falls into the bins of each axis.
struct Filled {
    bins: [[Box32; BINS]; 3],
    counts: [[u32; BINS]; 3],
}

impl Binning {
    fn fill(&self, items: &[Item]) -> Filled {
        if items.len() >= SHARED && rayon::current_thread_index().is_some() {
            let (left, right) = items.split_at(items.len() / 2);
            let (mut all, more) = rayon::join(|| self.fill(left), || self.fill(right));
            for axis in 0..3 {
                for bin in 0..BINS {
                    all.bins[axis][bin] = all.bins[axis][bin].union(more.bins[axis][bin]);
                    all.counts[axis][bin] += more.counts[axis][bin];
                }
            }
            return all;
        }
        let mut bins = [[Box32::EMPTY; BINS]; 3];
        let mut counts = [[0_u32; BINS]; 3];
        for b in items.iter().map(box_of) {
            let [x, y, z, _] = self.bins(b.center()).map(|bin| bin as usize % BINS);
            bins[0][x] = bins[0][x].union(b);
            bins[1][y] = bins[1][y].union(b);
            bins[2][z] = bins[2][z].union(b);
            counts[0][x] += 1;
            counts[1][y] += 1;
            counts[2][z] += 1;
        }
        Filled { bins, counts }
    }
}

/// The whole parts of numbers between 0 and [`BINS`].
#[inline(always)]
fn whole(x: Vec4) -> [u32; 4] {
    // Added to this number, whole parts are the lowest bits.
    const SHIFT: f32 = (1 << 23) as f32;
    // Rounds to the nearest, or up: half less is the part that is meant, or for whole numbers perhaps one less.
    let shifted = (x - Vec4::splat(0.499_999_97)).max(Vec4::ZERO) + Vec4::splat(SHIFT);
    shifted.to_array().map(|x| x.to_bits() & 31)
}

#[derive(Clone, Copy)]
struct Split {
    binning: Binning,
    axis: usize,
    /// The first bin of the right side.
    bin: u32,
    bounds: [Box32; 2],
    /// Items times half areas, both sides.
    cost: f64,
}

impl Split {
    /// The cheapest split between two bins on any axis; `None` where all centres are one point.
    fn best(items: &[Item], centers: &Box32, costs: &Costs) -> Option<Self> {
        let used = if items.len() < MANY { items.len().clamp(4, FEW_BINS) } else { BINS };
        let binning = Binning::new(centers, used);
        let Filled { bins, counts } = binning.fill(items);
        let mut best: Option<(f64, usize, usize)> = None;
        for axis in 0..3 {
            if !(binning.scale[axis] > 0.0) {
                continue;
            }
            let (bins, counts) = (&bins[axis], &counts[axis]);
            // Right to left: what lies right of each boundary; then left to right.
            let mut right = [0.0; BINS];
            let (mut bounds, mut count) = (Box32::EMPTY, 0);
            for bin in (1..used).rev() {
                bounds = bounds.union(bins[bin]);
                count += counts[bin];
                right[bin] = bounds.half_area() * costs.tests(count);
            }
            let (mut bounds, mut count) = (Box32::EMPTY, 0);
            for bin in 1..used {
                bounds = bounds.union(bins[bin - 1]);
                count += counts[bin - 1];
                let cost = bounds.half_area() * costs.tests(count) + right[bin];
                let one_side = count == 0 || count as usize == items.len();
                if !one_side && best.is_none_or(|b| cost < b.0) {
                    best = Some((cost, axis, bin));
                }
            }
        }
        let (cost, axis, bin) = best?;
        let (left, right) = bins[axis].split_at(bin);
        let bounds = [left, right].map(|side| side.iter().fold(Box32::EMPTY, |a, b| a.union(*b)));
        Some(Self { binning, axis, bin: bin as u32, bounds, cost })
    }

    /// Moves the left side's items to the front.
    fn partition(&self, items: &mut [Item]) -> Parts {
        let mut middle = 0;
        let mut centers = [Box32::EMPTY; 2];
        for i in 0..items.len() {
            let item = items[i];
            let c = box_of(&item).center();
            let on_left = self.binning.bins(c)[self.axis] < self.bin;
            let side = &mut centers[usize::from(!on_left)];
            *side = side.union(Box32 { min: c, max: c });
            // No branch: which side comes next cannot be foreseen.
            items[i] = items[middle];
            items[middle] = item;
            middle += usize::from(on_left);
        }
        Parts { middle, bounds: self.bounds, centers }
    }
}

/// Splits at the median of the centres on the widest axis.
fn halve(items: &mut [Item], centers: &Box32) -> Parts {
    let middle = items.len() / 2;
    let width = centers.max - centers.min;
    let axis = (0..3).fold(0, |a, b| if width[b] > width[a] { b } else { a });
    if width[axis] > 0.0 {
        let key = |item: &Item| (box_of(item).center()[axis], number(item));
        items.select_nth_unstable_by(middle, |a, b| {
            let ((a, i), (b, j)) = (key(a), key(b));
            a.total_cmp(&b).then(i.cmp(&j))
        });
    }
    let (left, right) = items.split_at(middle);
    let [left, right] = [left, right].map(around_all);
    Parts { middle, bounds: [left.0, right.0], centers: [left.1, right.1] }
}
