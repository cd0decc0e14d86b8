// SPDX-License-Identifier: MIT OR Apache-2.0
//! Building by the surface area heuristic over bins (Wald, "On fast Construction of SAH-based
//! Bounding Volume Hierarchies", IEEE Symposium on Interactive Ray Tracing, 2007).
//!
//! Every subtree owns a fixed part of the arrays (a range of `n` items needs at most `n - 1` nodes),
//! so that subtrees can be built by several threads with the same result as by one.

use dioptric_math::DVec3;

use super::{Bvh, Child, Lanes, MAX_DEPTH, Node, WIDTH};
use crate::bounds::Bounds;

const BINS: usize = 16;
/// Leaves hold no more items, even where nothing tells them apart.
const MAX_LEAF: usize = Child::MAX_COUNT;
/// The cost of a visit to a node, in tests of an item.
const VISIT_COST: f64 = 1.5;
/// Below this many items a second thread costs more than it saves.
const PARALLEL: usize = 4096;

/// A box in single precision, about the tree's centre.
#[derive(Clone, Copy, Debug)]
pub(super) struct Box32 {
    min: [f32; 3],
    max: [f32; 3],
}

impl Box32 {
    const EMPTY: Self = Self { min: [f32::INFINITY; 3], max: [f32::NEG_INFINITY; 3] };

    /// One step further out than the nearest f32, which also covers the subtraction's rounding.
    pub(super) fn around(b: &Bounds, center: DVec3) -> Self {
        Self {
            min: (b.min - center).to_array().map(|x| (x as f32).next_down()),
            max: (b.max - center).to_array().map(|x| (x as f32).next_up()),
        }
    }

    pub(super) fn is_finite(&self) -> bool {
        // Also false where a corner is NaN.
        self.min.iter().chain(&self.max).all(|x| x.is_finite())
    }

    fn grow(&mut self, other: &Self) {
        for axis in 0..3 {
            // Not f32's own min and max, which take thrice the time to look for NaN.
            let (low, high) = (other.min[axis], other.max[axis]);
            self.min[axis] = if low < self.min[axis] { low } else { self.min[axis] };
            self.max[axis] = if high > self.max[axis] { high } else { self.max[axis] };
        }
    }

    /// The largest coordinate.
    fn largest(&self) -> f64 {
        self.min.iter().chain(&self.max).fold(0.0, |m, x| f64::from(x.abs()).max(m))
    }

    /// Half the surface, in f64 so that no scale overflows; 0 where empty.
    fn half_area(&self) -> f64 {
        let size = |i: usize| (f64::from(self.max[i]) - f64::from(self.min[i])).max(0.0);
        let (x, y, z) = (size(0), size(1), size(2));
        x * y + y * z + z * x
    }
}

#[derive(Clone, Copy)]
struct Item {
    bounds: Box32,
    index: u32,
}

impl Item {
    /// The box's middle on one axis; halves first, so that it cannot overflow.
    fn center(&self, axis: usize) -> f32 {
        0.5 * self.bounds.min[axis] + 0.5 * self.bounds.max[axis]
    }

    /// The box's middle.
    fn centers(&self) -> [f32; 3] {
        [self.center(0), self.center(1), self.center(2)]
    }
}

/// A split in two.
#[derive(Clone, Copy)]
struct Split2 {
    bounds: [Box32; 2],
    children: [Child; 2],
}

/// What the leaves cost.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Costs {
    /// How many items are tested at once.
    pub block: usize,
    /// The cost of a split, in such tests.
    pub visit: f64,
}

impl Costs {
    /// Items that are tested one by one.
    pub const SINGLE: Self = Self { block: 1, visit: VISIT_COST };

    fn tests(&self, items: usize) -> f64 {
        items.div_ceil(self.block) as f64
    }
}

pub(super) fn build(
    boxes: impl ExactSizeIterator<Item = Bounds>,
    center: DVec3,
    costs: Costs,
) -> (Bvh, Vec<u32>) {
    let mut items: Vec<Item> = boxes
        .take(Bvh::MAX_ITEMS)
        .zip(0..)
        .map(|(b, index)| Item { bounds: Box32::around(&b, center), index })
        .collect();
    let mut bvh = Bvh { nodes: Vec::new(), center, extent: 0.0, depth: 1, lanes: Lanes::best() };
    if items.is_empty() {
        return (bvh, Vec::new());
    }
    let unused = Split2 { bounds: [Box32::EMPTY; 2], children: [Child::default(); 2] };
    let mut splits = vec![unused; items.len() - 1];
    let root = Range { items: &mut items, first: 0, splits: &mut splits, base: 0, depth: 0, costs }
        .build();
    bvh.extent = root.bounds.largest();
    let order = items.iter().map(|item| item.index).collect();
    drop(items);
    widen(&mut bvh, &splits, &root);
    bvh.nodes = crate::memory::fitted(std::mem::take(&mut bvh.nodes));
    (bvh, order)
}

/// A built subtree.
#[derive(Clone, Copy)]
struct Built {
    child: Child,
    bounds: Box32,
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
}

impl Range<'_> {
    fn build(self) -> Built {
        let n = self.items.len();
        let mut bounds = Box32::EMPTY;
        let mut centers = Box32::EMPTY;
        for item in self.items.iter() {
            bounds.grow(&item.bounds);
            let c = item.centers();
            centers.grow(&Box32 { min: c, max: c });
        }
        let leaf = Built { child: Child::leaf(self.first as usize, n.min(MAX_LEAF)), bounds };
        if n == 1 {
            return leaf;
        }
        // Halving from here on must end within the depth that the traversal's stack allows.
        let levels_left = MAX_DEPTH - self.depth;
        let must_halve = n.ilog2() as usize + 2 >= levels_left;
        let split = if must_halve { None } else { Split::best(self.items, &centers, &self.costs) };
        let middle = match split {
            Some(s) => {
                let cost = self.costs.visit * bounds.half_area() + s.cost;
                if n <= MAX_LEAF && cost >= self.costs.tests(n) * bounds.half_area() {
                    return leaf;
                }
                s.partition(self.items)
            }
            None if n <= MAX_LEAF => return leaf,
            None => halve(self.items, &centers),
        };
        let (left, right) = self.items.split_at_mut(middle);
        let Some((split, rest)) = self.splits.split_first_mut() else { return leaf };
        let (left_splits, right_splits) = rest.split_at_mut(middle - 1);
        let depth = self.depth + 1;
        let left = Range {
            items: left,
            first: self.first,
            splits: left_splits,
            base: self.base + 1,
            depth,
            costs: self.costs,
        };
        let right = Range {
            items: right,
            first: self.first + middle as u32,
            splits: right_splits,
            base: self.base + middle as u32,
            depth,
            costs: self.costs,
        };
        // Outside a pool `join` would start the global one.
        let (left, right) = if n >= PARALLEL && rayon::current_thread_index().is_some() {
            rayon::join(|| left.build(), || right.build())
        } else {
            (left.build(), right.build())
        };
        *split =
            Split2 { bounds: [left.bounds, right.bounds], children: [left.child, right.child] };
        Built { child: Child::inner(self.base as usize), bounds }
    }
}

/// Which bin an item falls into.
#[derive(Clone, Copy)]
struct Binning {
    axis: usize,
    low: f32,
    scale: f32,
    last: usize,
}

impl Binning {
    fn bin(&self, item: &Item) -> usize {
        // A NaN (0 times infinity, in boxes of nearly no size) becomes 0.
        (((item.center(self.axis) - self.low) * self.scale) as usize).min(self.last)
    }
}

struct Split {
    binning: Binning,
    /// The first bin of the right side.
    bin: usize,
    /// Items times half areas, both sides.
    cost: f64,
}

impl Split {
    /// The cheapest split between two bins on any axis; `None` where all centres are one point.
    fn best(items: &[Item], centers: &Box32, costs: &Costs) -> Option<Self> {
        let mut best: Option<Self> = None;
        for axis in 0..3 {
            let low = centers.min[axis];
            let width = centers.max[axis] - low;
            if !(width > 0.0) {
                continue;
            }
            // A few items need no more bins than that.
            let used = items.len().clamp(4, BINS);
            let binning = Binning { axis, low, scale: used as f32 / width, last: used - 1 };
            let mut bins = [(Box32::EMPTY, 0usize); BINS];
            for item in items {
                let (bounds, count) = &mut bins[binning.bin(item)];
                bounds.grow(&item.bounds);
                *count += 1;
            }
            // Right to left: what lies right of each boundary; then left to right.
            let mut right = [0.0; BINS];
            let (mut bounds, mut count) = (Box32::EMPTY, 0);
            for bin in (1..used).rev() {
                bounds.grow(&bins[bin].0);
                count += bins[bin].1;
                right[bin] = bounds.half_area() * costs.tests(count);
            }
            let (mut bounds, mut count) = (Box32::EMPTY, 0);
            for bin in 1..used {
                bounds.grow(&bins[bin - 1].0);
                count += bins[bin - 1].1;
                let cost = bounds.half_area() * costs.tests(count) + right[bin];
                let one_side = count == 0 || count == items.len();
                if !one_side && best.as_ref().is_none_or(|b| cost < b.cost) {
                    best = Some(Self { binning, bin, cost });
                }
            }
        }
        best
    }

    /// Moves the left side's items to the front and returns their number.
    fn partition(&self, items: &mut [Item]) -> usize {
        let mut left = 0;
        for i in 0..items.len() {
            if self.binning.bin(&items[i]) < self.bin {
                items.swap(left, i);
                left += 1;
            }
        }
        left
    }
}

/// Splits at the median of the centres on the widest axis.
fn halve(items: &mut [Item], centers: &Box32) -> usize {
    let middle = items.len() / 2;
    let width = |axis: usize| centers.max[axis] - centers.min[axis];
    let axis = (0..3).fold(0, |a, b| if width(b) > width(a) { b } else { a });
    if width(axis) > 0.0 {
        let key = |item: &Item| (item.center(axis), item.index);
        items.select_nth_unstable_by(middle, |a, b| {
            let ((a, i), (b, j)) = (key(a), key(b));
            a.total_cmp(&b).then(i.cmp(&j))
        });
    }
    middle
}

/// What becomes a node, how deep it will be, and the node and lane that refer to it.
struct Pending {
    subtree: Built,
    depth: usize,
    parent: Option<(usize, usize)>,
}

/// Joins splits in two to nodes of eight: of the parts of a node the one with the largest box is split
/// on, as long as there is room. Each node is followed by its first child's subtree.
fn widen(bvh: &mut Bvh, splits: &[Split2], root: &Built) {
    let mut pending = vec![Pending { subtree: *root, depth: 1, parent: None }];
    while let Some(Pending { subtree, depth, parent }) = pending.pop() {
        let mut parts = [Built { child: Child::default(), bounds: Box32::EMPTY }; WIDTH];
        parts[0] = subtree;
        let mut used = 1;
        while used < WIDTH {
            let inner = (0..used).filter_map(|i| Some((i, parts[i].child.node()?)));
            let area = |i: usize| parts[i].bounds.half_area();
            let largest = inner.max_by(|a, b| area(a.0).total_cmp(&area(b.0)));
            let Some((largest, index)) = largest else { break };
            let Some(split) = splits.get(index) else { break };
            let [left, right] =
                [0, 1].map(|i| Built { child: split.children[i], bounds: split.bounds[i] });
            parts[largest] = left;
            parts[used] = right;
            used += 1;
        }
        let index = bvh.nodes.len();
        bvh.depth = bvh.depth.max(depth);
        bvh.nodes.push(Node {
            planes: std::array::from_fn(|plane| {
                let side = |b: &Box32| if plane % 2 == 0 { b.min } else { b.max }[plane / 2];
                parts.map(|part| side(&part.bounds))
            }),
            children: parts.map(|part| part.child),
        });
        if let Some((parent, lane)) = parent
            && let Some(node) = bvh.nodes.get_mut(parent)
        {
            node.children[lane] = Child::inner(index);
        }
        for lane in (0..used).rev() {
            if parts[lane].child.node().is_some() {
                pending.push(Pending {
                    subtree: parts[lane],
                    depth: depth + 1,
                    parent: Some((index, lane)),
                });
            }
        }
    }
}
