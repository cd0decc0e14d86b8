// SPDX-License-Identifier: MIT OR Apache-2.0
//! Building by the surface area heuristic over bins (Wald, "On fast Construction of SAH-based
//! Bounding Volume Hierarchies", IEEE Symposium on Interactive Ray Tracing, 2007).
//!
//! Every subtree owns a fixed part of the arrays (a range of `n` items needs at most `n - 1` nodes),
//! so that subtrees can be built by several threads with the same result as by one.

use dioptric_math::DVec3;

use super::{Child, MAX_DEPTH, Node};
use crate::bounds::Bounds;

const BINS: usize = 16;
/// Leaves hold more only where nothing tells their items apart... and never more than this.
const MAX_LEAF: usize = 8;
/// The cost of a visit to a node, in tests of an item.
const VISIT_COST: f64 = 1.0;
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
            self.min[axis] = self.min[axis].min(other.min[axis]);
            self.max[axis] = self.max[axis].max(other.max[axis]);
        }
    }

    /// Half the surface, in f64 so that no scale overflows; 0 where empty.
    fn half_area(&self) -> f64 {
        let [x, y, z] =
            [0, 1, 2].map(|i| (f64::from(self.max[i]) - f64::from(self.min[i])).max(0.0));
        x * y + y * z + z * x
    }
}

#[derive(Clone, Copy)]
struct Item {
    bounds: Box32,
    index: u32,
}

impl Item {
    /// The box's middle; halves first, so that it cannot overflow.
    fn center(&self, axis: usize) -> f32 {
        0.5 * self.bounds.min[axis] + 0.5 * self.bounds.max[axis]
    }
}

const EMPTY_NODE: Node = Node {
    planes: [
        [f32::INFINITY; 2],
        [f32::NEG_INFINITY; 2],
        [f32::INFINITY; 2],
        [f32::NEG_INFINITY; 2],
        [f32::INFINITY; 2],
        [f32::NEG_INFINITY; 2],
    ],
    children: [Child { first: 0, count: 0 }; 2],
};

pub(super) fn build(
    boxes: impl ExactSizeIterator<Item = Bounds>,
    center: DVec3,
) -> (Vec<Node>, Vec<u32>) {
    let mut items: Vec<Item> = boxes
        .zip(0..)
        .map(|(b, index)| Item { bounds: Box32::around(&b, center), index })
        .collect();
    if items.is_empty() {
        return (Vec::new(), Vec::new());
    }
    let mut loose = vec![EMPTY_NODE; items.len().saturating_sub(1).max(1)];
    let root = Range { items: &mut items, first: 0, nodes: &mut loose, base: 0, depth: 0 }.build();
    let nodes = if root.child.count > 0 {
        // One leaf only: a root with one child.
        set_child(&mut loose[0], 0, &root);
        vec![loose[0]]
    } else {
        compact(&loose, root.nodes)
    };
    (nodes, items.iter().map(|item| item.index).collect())
}

/// A built subtree.
struct Built {
    child: Child,
    bounds: Box32,
    /// Nodes used.
    nodes: usize,
}

fn set_child(node: &mut Node, side: usize, built: &Built) {
    for axis in 0..3 {
        node.planes[2 * axis][side] = built.bounds.min[axis];
        node.planes[2 * axis + 1][side] = built.bounds.max[axis];
    }
    node.children[side] = built.child;
}

/// A range of items that becomes a subtree, with the part of the arrays that it owns.
struct Range<'a> {
    items: &'a mut [Item],
    /// Where `items` begins among all.
    first: u32,
    nodes: &'a mut [Node],
    /// Where `nodes` begins among all.
    base: u32,
    depth: usize,
}

impl Range<'_> {
    fn build(self) -> Built {
        let n = self.items.len();
        let mut bounds = Box32::EMPTY;
        let mut centers = Box32::EMPTY;
        for item in self.items.iter() {
            bounds.grow(&item.bounds);
            let c = [0, 1, 2].map(|axis| item.center(axis));
            centers.grow(&Box32 { min: c, max: c });
        }
        let leaf = Built { child: Child { first: self.first, count: n as u32 }, bounds, nodes: 0 };
        if n == 1 {
            return leaf;
        }
        // Halving from here on must end within the depth that the traversal's stack allows.
        let levels_left = MAX_DEPTH - self.depth;
        let must_halve = n.ilog2() as usize + 2 >= levels_left;
        let split = if must_halve { None } else { Split::best(self.items, &centers) };
        let middle = match split {
            Some(s) => {
                let cost = VISIT_COST * bounds.half_area() + s.cost;
                if n <= MAX_LEAF && cost >= n as f64 * bounds.half_area() {
                    return leaf;
                }
                s.partition(self.items)
            }
            None if n <= MAX_LEAF => return leaf,
            None => halve(self.items, &centers),
        };
        let (left, right) = self.items.split_at_mut(middle);
        let Some((node, rest)) = self.nodes.split_first_mut() else { return leaf };
        let (left_nodes, right_nodes) = rest.split_at_mut(middle - 1);
        let depth = self.depth + 1;
        let left =
            Range { items: left, first: self.first, nodes: left_nodes, base: self.base + 1, depth };
        let right = Range {
            items: right,
            first: self.first + middle as u32,
            nodes: right_nodes,
            base: self.base + middle as u32,
            depth,
        };
        // Outside a pool `join` would start the global one.
        let (left, right) = if n >= PARALLEL && rayon::current_thread_index().is_some() {
            rayon::join(|| left.build(), || right.build())
        } else {
            (left.build(), right.build())
        };
        set_child(node, 0, &left);
        set_child(node, 1, &right);
        Built {
            child: Child { first: self.base, count: 0 },
            bounds,
            nodes: 1 + left.nodes + right.nodes,
        }
    }
}

/// Which bin an item falls into.
#[derive(Clone, Copy)]
struct Binning {
    axis: usize,
    low: f32,
    scale: f32,
}

impl Binning {
    fn bin(&self, item: &Item) -> usize {
        // A NaN (0 times infinity, in boxes of nearly no size) becomes 0.
        (((item.center(self.axis) - self.low) * self.scale) as usize).min(BINS - 1)
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
    fn best(items: &[Item], centers: &Box32) -> Option<Self> {
        let mut best: Option<Self> = None;
        for axis in 0..3 {
            let low = centers.min[axis];
            let width = centers.max[axis] - low;
            if !(width > 0.0) {
                continue;
            }
            let binning = Binning { axis, low, scale: BINS as f32 / width };
            let mut bins = [(Box32::EMPTY, 0usize); BINS];
            for item in items {
                let (bounds, count) = &mut bins[binning.bin(item)];
                bounds.grow(&item.bounds);
                *count += 1;
            }
            // Right to left: what lies right of each boundary; then left to right.
            let mut right = [0.0; BINS];
            let (mut bounds, mut count) = (Box32::EMPTY, 0);
            for bin in (1..BINS).rev() {
                bounds.grow(&bins[bin].0);
                count += bins[bin].1;
                right[bin] = bounds.half_area() * count as f64;
            }
            let (mut bounds, mut count) = (Box32::EMPTY, 0);
            for bin in 1..BINS {
                bounds.grow(&bins[bin - 1].0);
                count += bins[bin - 1].1;
                let cost = bounds.half_area() * count as f64 + right[bin];
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

/// Closes the gaps between the nodes, each followed by its first child's subtree.
fn compact(loose: &[Node], used: usize) -> Vec<Node> {
    let mut nodes = Vec::with_capacity(used);
    // Where a node is now, and the (parent, side) that refers to it.
    let mut pending = vec![(0u32, None)];
    while let Some((at, parent)) = pending.pop() {
        let index = nodes.len() as u32;
        let node: Node = loose[at as usize];
        nodes.push(node);
        if let Some((parent, side)) = parent {
            let parent: &mut Node = &mut nodes[parent as usize];
            parent.children[side as usize].first = index;
        }
        for side in [1u8, 0] {
            let child = node.children[usize::from(side)];
            if child.count == 0 {
                pending.push((child.first, Some((index, side))));
            }
        }
    }
    nodes
}
