// SPDX-License-Identifier: MIT OR Apache-2.0
//! Building from the root down: items are split in two until they are a leaf, and splits are joined to nodes of
//! eight: at the top, where threads share the work, as they are made, the largest first; of few items so that nodes are
//! fewest, see [`super::collapse`].
//!
//! A node knows how many nodes further each of its children is, so that subtrees can be built anywhere, by several
//! threads, and put one after the other with the same result as by one.

use dioptric_math::DVec3;
use rayon::prelude::*;

use super::bins::{Filled, Halves, Verdict, Weighed};
use super::collapse::{Below, Half, Splits};
use super::item::{Box32, Item, box_of, item_around, number};
use super::ray::MARGIN;
use super::{Bvh, Child, Lanes, MAX_DEPTH, Node, WIDTH};
use crate::bounds::Bounds;
use crate::memory;

/// Leaves hold no more items, even where nothing tells them apart.
const MAX_LEAF: usize = Child::MAX_COUNT;
/// The cost of a visit to a node, in tests of an item.
const VISIT_COST: f32 = 1.5;
/// Below this many items a second thread costs more than it saves.
const PARALLEL: usize = 4096;
/// From so many items on, the subtrees of a node are built by several threads, and nodes are made of the largest parts.
const MANY: usize = 1 << 15;
/// Guesses, and no more.
const ITEMS_PER_NODE: usize = 24;
const ITEMS_PER_SPLIT: usize = 6;
/// More items than this are split ahead by several threads.
const AHEAD: usize = 1 << 16;

/// What the leaves cost.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Costs {
    /// How many items are tested at once: 1, 2, 4 or 8.
    pub block: usize,
    /// The cost of a split, in such tests.
    pub visit: f32,
}

impl Costs {
    /// Items that are tested one by one.
    pub const SINGLE: Self = Self { block: 1, visit: VISIT_COST };

    /// The tests that so many items take.
    #[inline(always)]
    pub(super) fn tests(&self, items: u32) -> f32 {
        ((items + (self.block as u32 - 1)) >> self.block.trailing_zeros()) as f32
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
        .filter_map(|(b, index)| item_around(&b, center, index))
        .collect();
    let (bvh, items) = build_items(items, center, costs);
    (bvh, items.iter().map(number).collect())
}

/// Builds a tree over items, whose boxes are about `center`; returns them in the order of the leaves.
pub(crate) fn build_items(mut items: Vec<Item>, center: DVec3, costs: Costs) -> (Bvh, Vec<Item>) {
    items.truncate(Bvh::MAX_ITEMS);
    let lanes = Lanes::best();
    let mut bvh = Bvh { nodes: Vec::new(), center, extent: 0.0, depth: 1, lanes };
    if items.is_empty() {
        return (bvh, items);
    }
    let (bounds, centers) = around_all(&items);
    bvh.extent = bounds.largest();
    // Outside a pool `join` would start the global one.
    let parallel = rayon::current_thread_index().is_some();
    let builder = Builder { costs, lanes, parallel };
    let root = Range { items: &mut items, first: 0, depth: 0, bounds, centers };
    let root = builder.ahead(root, &mut Filled::new());
    let Subtree { pieces, depth } = match builder.split(root, &mut Filled::new()) {
        Ok(halves) => builder.subtree(halves),
        Err(leaf) => Subtree::of(leaf),
    };
    bvh.depth = depth;
    bvh.nodes = join(&pieces, parallel);
    (bvh, items)
}

/// The box around items, and the one around their centres.
fn around_all(items: &[Item]) -> (Box32, Box32) {
    if items.len() >= PARALLEL && rayon::current_thread_index().is_some() {
        let (left, right) = items.split_at(items.len() / 2);
        let (left, right) = rayon::join(|| around_all(left), || around_all(right));
        return (left.0.union(right.0), left.1.union(right.1));
    }
    items
        .iter()
        .map(box_of)
        .fold((Box32::EMPTY, Box32::EMPTY), |all, b| (all.0.union(b), all.1.union(b.center())))
}

/// A range of items that becomes a subtree.
pub(super) struct Range<'a> {
    items: &'a mut [Item],
    /// Where `items` begins among all.
    first: u32,
    /// Splits above.
    depth: usize,
    /// Around the items, and around their centres.
    bounds: Box32,
    centers: Box32,
}

/// A part of the tree.
pub(super) enum Part<'a> {
    /// Not looked at yet.
    Range(Range<'a>),
    /// Two halves, and the box around them.
    Split(Box32, Box<[Part<'a>; 2]>),
    /// A leaf, and its box.
    Leaf(Box32, Child),
}

/// The parts of a node; those that are missing have boxes that no ray enters.
pub(super) type Parts<'a> = [Part<'a>; WIDTH];

impl Part<'_> {
    /// What is missing.
    pub const NONE: Self = Self::Leaf(Box32::EMPTY, Child::leaf(0, 1));

    const fn take(&mut self) -> Self {
        std::mem::replace(self, Self::NONE)
    }

    fn bounds(&self) -> &Box32 {
        match self {
            Self::Range(range) => &range.bounds,
            Self::Split(bounds, _) | Self::Leaf(bounds, _) => bounds,
        }
    }

    /// How much it is worth to be split; negative for a leaf.
    fn area(&self) -> f64 {
        match self {
            Self::Leaf(..) => -1.0,
            _ => self.bounds().half_area(),
        }
    }

    /// How many items may still be split.
    fn items(&self) -> usize {
        match self {
            Self::Range(range) => range.items.len(),
            Self::Split(_, halves) => halves[0].items() + halves[1].items(),
            Self::Leaf(..) => 0,
        }
    }

    /// The child that a leaf is.
    pub const fn child(&self) -> Child {
        match self {
            Self::Leaf(_, child) => *child,
            _ => Child::leaf(0, 1),
        }
    }
}

/// Nodes in pieces, to be put one after the other.
struct Subtree {
    pieces: Vec<Vec<Node>>,
    /// Nodes on the longest way.
    depth: usize,
}

impl Subtree {
    /// A node with nothing but a leaf.
    fn of(leaf: Part) -> Self {
        let child = leaf.child();
        let mut parts = [const { Part::NONE }; WIDTH];
        parts[0] = leaf;
        let mut node = node(&parts);
        node.children[0] = child;
        Self { pieces: vec![vec![node]], depth: 1 }
    }
}

struct Builder {
    costs: Costs,
    lanes: Lanes,
    /// Whether there are other threads to ask.
    parallel: bool,
}

impl Builder {
    /// Splits a part in two, or makes it the leaf that it is to be.
    #[inline]
    fn split<'a>(&self, part: Part<'a>, filled: &mut Filled) -> Result<[Part<'a>; 2], Part<'a>> {
        let range = match part {
            Part::Range(range) => range,
            Part::Split(_, halves) => return Ok(*halves),
            Part::Leaf(..) => return Err(part),
        };
        let Range { items, first, depth, bounds, centers } = range;
        let n = items.len();
        let leaf = Part::Leaf(bounds, Child::leaf(first as usize, n.min(MAX_LEAF)));
        // What is tested at once anyway is not worth a look.
        if n <= self.costs.block {
            return Err(leaf);
        }
        // Halving from here on must end within the depth that the traversal's stack allows.
        let must_halve = n.ilog2() as usize + 2 >= MAX_DEPTH - depth;
        let verdict = if must_halve {
            Verdict::Alike
        } else {
            let of = Weighed {
                items: &mut *items,
                bounds: &bounds,
                centers: &centers,
                costs: &self.costs,
            };
            of.split(self.lanes, filled)
        };
        let parts = match verdict {
            Verdict::Split(parts) => parts,
            Verdict::Leaf => return Err(leaf),
            Verdict::Alike if n <= MAX_LEAF => return Err(leaf),
            Verdict::Alike => halve(items, &centers),
        };
        let (left, right) = items.split_at_mut(parts.middle);
        let [a, b] = parts.bounds;
        let [c, d] = parts.centers;
        let (depth, middle) = (depth + 1, first + parts.middle as u32);
        Ok([
            Part::Range(Range { items: left, first, depth, bounds: a, centers: c }),
            Part::Range(Range { items: right, first: middle, depth, bounds: b, centers: d }),
        ])
    }

    /// Splits what is large, so that all threads have something to do.
    fn ahead<'a>(&self, range: Range<'a>, filled: &mut Filled) -> Part<'a> {
        let bounds = range.bounds;
        if range.items.len() < AHEAD || !self.parallel {
            return Part::Range(range);
        }
        match self.split(Part::Range(range), filled) {
            Err(leaf) => leaf,
            Ok(halves) => {
                let go_on = |part: Part<'a>, filled: &mut Filled| match part {
                    Part::Range(range) => self.ahead(range, filled),
                    other => other,
                };
                let [left, right] = halves;
                let (left, right) =
                    rayon::join(|| go_on(left, filled), || go_on(right, &mut Filled::new()));
                Part::Split(bounds, Box::new([left, right]))
            }
        }
    }

    /// Splits the largest parts until there are as many as a node has room for.
    fn open<'a>(&self, [a, b]: [Part<'a>; 2], filled: &mut Filled) -> Parts<'a> {
        let (mut parts, mut areas) = ([const { Part::NONE }; WIDTH], [-1.0; WIDTH]);
        (areas[0], areas[1]) = (a.area(), b.area());
        (parts[0], parts[1]) = (a, b);
        let mut used = 2;
        while used < WIDTH {
            let largest = (1..used).fold(0, |a, b| if areas[b] > areas[a] { b } else { a });
            if !(areas[largest] >= 0.0) {
                break;
            }
            match self.split(parts[largest].take(), filled) {
                Err(leaf) => {
                    areas[largest] = -1.0;
                    parts[largest] = leaf;
                }
                Ok([left, right]) => {
                    (areas[largest], areas[used]) = (left.area(), right.area());
                    (parts[largest], parts[used]) = (left, right);
                    used += 1;
                }
            }
        }
        parts
    }

    /// Adds the nodes of two halves with few items; returns how deep they are.
    fn join(&self, halves: [Part; 2], nodes: &mut Vec<Node>, filled: &mut Filled) -> usize {
        let items = halves[0].items() + halves[1].items();
        let bounds = halves[0].bounds().union(*halves[1].bounds());
        let mut splits = Splits::new(items / ITEMS_PER_SPLIT, &bounds);
        match self.split_all(bounds, halves, &mut splits, filled) {
            Below::Split(index) => splits.join(index, nodes),
            Below::Leaf(_) => 0,
        }
    }

    /// Splits two halves all the way down.
    fn split_all(
        &self,
        bounds: Box32,
        [a, b]: [Part; 2],
        splits: &mut Splits,
        filled: &mut Filled,
    ) -> Below {
        let mut half = |part: Part| {
            let bounds = *part.bounds();
            let below = match self.split(part, filled) {
                Ok(halves) => self.split_all(bounds, halves, splits, filled),
                Err(leaf) => Below::Leaf(leaf.child()),
            };
            Half { bounds, below }
        };
        let halves = [half(a), half(b)];
        splits.add(&bounds, halves)
    }

    /// Adds the node of two halves, each child followed by its own subtree; returns how deep it is.
    fn add(&self, halves: [Part; 2], nodes: &mut Vec<Node>, filled: &mut Filled) -> usize {
        if halves[0].items() + halves[1].items() < MANY {
            return self.join(halves, nodes, filled);
        }
        let parts = self.open(halves, filled);
        let (index, mut deepest) = (nodes.len(), 0);
        let mut node = node(&parts);
        nodes.push(node);
        for (part, child) in parts.into_iter().zip(&mut node.children) {
            match self.split(part, filled) {
                Ok(halves) => {
                    *child = Child::inner(nodes.len() - index);
                    deepest = deepest.max(self.add(halves, nodes, filled));
                }
                Err(leaf) => *child = leaf.child(),
            }
        }
        nodes[index] = node;
        1 + deepest
    }

    /// The subtree of two halves, by several threads where there is enough for them.
    fn subtree(&self, halves: [Part; 2]) -> Subtree {
        let filled = &mut Filled::new();
        let items = halves[0].items() + halves[1].items();
        if !self.parallel || items < MANY {
            let mut nodes = Vec::with_capacity(items / ITEMS_PER_NODE);
            let depth = self.add(halves, &mut nodes, filled);
            return Subtree { pieces: vec![nodes], depth };
        }
        let parts = self.open(halves, filled);
        let mut node = node(&parts);
        let below = |part: Part| match self.split(part, &mut Filled::new()) {
            Ok(halves) => Ok(self.subtree(halves)),
            Err(leaf) => Err(leaf.child()),
        };
        let below: Vec<_> = Vec::from(parts).into_par_iter().with_max_len(1).map(below).collect();
        let (mut pieces, mut count, mut deepest) = (vec![Vec::new()], 1, 0);
        for (below, child) in below.into_iter().zip(&mut node.children) {
            match below {
                Ok(subtree) => {
                    *child = Child::inner(count);
                    count += subtree.pieces.iter().map(Vec::len).sum::<usize>();
                    deepest = deepest.max(subtree.depth);
                    pieces.extend(subtree.pieces);
                }
                Err(leaf) => *child = leaf,
            }
        }
        pieces[0].push(node);
        Subtree { pieces, depth: 1 + deepest }
    }
}

/// A node without its children; their boxes.
pub(super) fn node(parts: &Parts) -> Node {
    let mut node = Node { planes: [[0.0; WIDTH]; 6], children: [Child::default(); WIDTH] };
    for (lane, part) in parts.iter().enumerate() {
        let bounds = part.bounds();
        let margin = margin(bounds);
        for axis in 0..3 {
            node.planes[2 * axis][lane] = bounds.min(axis) - margin;
            node.planes[2 * axis + 1][lane] = bounds.max(axis) + margin;
        }
    }
    node
}

/// What the test of a box may be off by for the sake of the box's own numbers, see [`super::ray::MARGIN`]; the tree
/// has it in its boxes, so that a large one among small ones makes only its own larger.
fn margin(bounds: &Box32) -> f32 {
    // No more than f32 has: what is missing has infinite coordinates, and must not become NaN.
    let largest = (0..3)
        .fold(0.0_f32, |all, axis| all.max(bounds.min(axis).abs()).max(bounds.max(axis).abs()));
    if largest.is_finite() { largest * MARGIN } else { 0.0 }
}

/// All nodes in one piece, their children counted from the first.
fn join(pieces: &[Vec<Node>], parallel: bool) -> Vec<Node> {
    let mut count = 0;
    let mut starts = Vec::with_capacity(pieces.len());
    for piece in pieces {
        starts.push(count);
        count += piece.len();
    }
    let absolute = |index: usize| {
        let piece = starts.partition_point(|&start| start <= index) - 1;
        let mut node = pieces[piece][index - starts[piece]];
        for child in &mut node.children {
            if let Some(further) = child.node() {
                *child = Child::inner(index + further);
            }
        }
        node
    };
    let mut nodes = memory::with_capacity(count);
    if parallel {
        nodes.par_extend((0..count).into_par_iter().with_min_len(512).map(absolute));
    } else {
        nodes.extend((0..count).map(absolute));
    }
    nodes
}

/// Splits at the median of the centres on the widest axis.
fn halve(items: &mut [Item], centers: &Box32) -> Halves {
    let middle = items.len() / 2;
    let width = centers.size();
    let axis = (0..3).fold(0, |a, b| if width[b] > width[a] { b } else { a });
    if width[axis] > 0.0 {
        let key = |item: &Item| (box_of(item).center().min(axis), number(item));
        items.select_nth_unstable_by(middle, |a, b| {
            let ((a, i), (b, j)) = (key(a), key(b));
            a.total_cmp(&b).then(i.cmp(&j))
        });
    }
    let (left, right) = items.split_at(middle);
    let [left, right] = [left, right].map(around_all);
    Halves { middle, bounds: [left.0, right.0], centers: [left.1, right.1] }
}
