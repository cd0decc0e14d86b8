// SPDX-License-Identifier: MIT OR Apache-2.0
//! Joining splits in two to nodes of eight so that rays visit as few nodes as can be: for each split and each number of
//! children of a node that it may become, the best way is found from those of its halves (Ylitie, Karras and Laine,
//! "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", HPG 2017, section 3.1; leaves are what
//! splitting made them).

use super::build::{Part, Parts, node};
use super::item::Box32;
use super::{Child, Node, WIDTH};

/// A half of a split.
#[derive(Clone, Copy)]
pub(super) struct Half {
    pub bounds: Box32,
    pub below: Below,
}

/// What is in it.
#[derive(Clone, Copy)]
pub(super) enum Below {
    /// The split with this number.
    Split(u32),
    Leaf(Child),
}

/// What a part of the tree costs as 1, 2, ... children of a node at most: the areas of the nodes in it.
type Costs = [f32; WIDTH - 1];

struct Split {
    halves: [Half; 2],
    costs: Costs,
}

/// A part of the tree, split in two all the way down; halves before what they are halves of.
pub(super) struct Splits {
    splits: Vec<Split>,
    /// Areas count as many times this, so that they are not too large for single precision.
    scale: f64,
}

impl Splits {
    /// None yet, for about so many, within a box.
    pub fn new(count: usize, bounds: &Box32) -> Self {
        let scale = 1.0 / bounds.half_area();
        Self {
            splits: Vec::with_capacity(count),
            scale: if scale.is_finite() { scale } else { 0.0 },
        }
    }

    /// Adds a split, and returns its number.
    pub fn add(&mut self, bounds: &Box32, halves: [Half; 2]) -> Below {
        let [a, b] = [self.costs(&halves[0]), self.costs(&halves[1])];
        let area = (bounds.half_area() * self.scale) as f32;
        let mut costs = [area + shared(&a, &b, WIDTH); WIDTH - 1];
        for k in 2..WIDTH {
            costs[k - 1] = costs[k - 2].min(shared(&a, &b, k));
        }
        self.splits.push(Split { halves, costs });
        Below::Split((self.splits.len() - 1) as u32)
    }

    fn costs(&self, half: &Half) -> Costs {
        match half.below {
            Below::Split(index) => self.splits[index as usize].costs,
            // The same however it is done.
            Below::Leaf(_) => [0.0; WIDTH - 1],
        }
    }

    /// Adds the nodes of a split, each child followed by what is below it; returns how deep they are.
    pub fn join(&self, index: u32, nodes: &mut Vec<Node>) -> usize {
        let (mut halves, mut used) = ([None; WIDTH], 0);
        self.share(index, WIDTH, &mut |half| {
            halves[used] = Some(half);
            used += 1;
        });
        let mut parts: Parts = [const { Part::NONE }; WIDTH];
        for (part, half) in parts.iter_mut().zip(&halves) {
            if let Some(Half { bounds, below }) = half {
                let child = if let Below::Leaf(child) = below { *child } else { Child::leaf(0, 1) };
                *part = Part::Leaf(*bounds, child);
            }
        }
        let (index, mut deepest) = (nodes.len(), 0);
        let mut node = node(&parts);
        nodes.push(node);
        for ((child, part), half) in node.children.iter_mut().zip(&parts).zip(&halves) {
            *child = part.child();
            if let Some(Half { below: Below::Split(split), .. }) = half {
                *child = Child::inner(nodes.len() - index);
                deepest = deepest.max(self.join(*split, nodes));
            }
        }
        nodes[index] = node;
        1 + deepest
    }

    /// The halves that a split becomes as `k` children.
    fn share(&self, index: u32, k: usize, out: &mut impl FnMut(Half)) {
        let split = &self.splits[index as usize];
        let [a, b] = [self.costs(&split.halves[0]), self.costs(&split.halves[1])];
        let best = shared(&a, &b, k);
        let left = (1..k).find(|&j| a[j - 1] + b[k - j - 1] == best).unwrap_or(1);
        for (half, k) in split.halves.iter().zip([left, k - left]) {
            match half.below {
                Below::Leaf(_) => out(*half),
                Below::Split(index) => {
                    let costs = &self.splits[index as usize].costs;
                    // With fewer, where that is as good.
                    let k = (1..k).find(|&j| costs[j - 1] == costs[k - 1]).unwrap_or(k);
                    if k == 1 { out(*half) } else { self.share(index, k, out) }
                }
            }
        }
    }
}

/// What two halves cost as `k` children together.
fn shared(a: &Costs, b: &Costs, k: usize) -> f32 {
    (1..k).fold(f32::INFINITY, |least, j| least.min(a[j - 1] + b[k - j - 1]))
}
