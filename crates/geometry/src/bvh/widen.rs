// SPDX-License-Identifier: MIT OR Apache-2.0
//! From a tree of splits in two to the one of nodes with eight children that the queries walk.

use rayon::prelude::*;

use super::build::{Built, PARALLEL, Split2, unpack};
use super::item::Box32;
use super::{Bvh, Child, Node, WIDTH};

/// The parts of a node of eight: of the parts so far the one with the largest box is split on, as long as
/// there is room.
fn open(splits: &[Split2], root: &Built) -> ([Built; WIDTH], usize) {
    let mut parts = [Built { child: Child::default(), bounds: Box32::EMPTY }; WIDTH];
    // Leaves stay as they are.
    let area = |part: &Built| part.child.node().map_or(-1.0, |_| part.bounds.half_area());
    let mut areas = [-1.0; WIDTH];
    (parts[0], areas[0]) = (*root, area(root));
    let mut used = 1;
    while used < WIDTH {
        let largest = (1..used).fold(0, |a, b| if areas[b] > areas[a] { b } else { a });
        let Some(split) = parts[largest].child.node().and_then(|index| splits.get(index)) else {
            break;
        };
        let [left, right] = unpack(split);
        (parts[largest], areas[largest]) = (left, area(&left));
        (parts[used], areas[used]) = (right, area(&right));
        used += 1;
    }
    (parts, used)
}

fn node(parts: &[Built; WIDTH]) -> Node {
    Node {
        planes: std::array::from_fn(|plane| {
            let side = |b: &Box32| if plane % 2 == 0 { b.min } else { b.max }[plane / 2];
            parts.map(|part| side(&part.bounds))
        }),
        children: parts.map(|part| part.child),
    }
}

/// What becomes a node, how deep it will be, and the node and lane that refer to it.
struct Pending {
    subtree: Built,
    depth: usize,
    parent: Option<(usize, usize)>,
}

/// Joins splits in two to nodes of eight, counted from 0, and returns how deep they are. Each node is followed by
/// its first child's subtree.
fn subtree(splits: &[Split2], root: &Built) -> (Vec<Node>, usize) {
    let (mut nodes, mut deepest) = (Vec::new(), 1);
    let mut pending = vec![Pending { subtree: *root, depth: 1, parent: None }];
    while let Some(Pending { subtree, depth, parent }) = pending.pop() {
        let (parts, used) = open(splits, &subtree);
        let index = nodes.len();
        deepest = deepest.max(depth);
        nodes.push(node(&parts));
        if let Some((parent, lane)) = parent
            && let Some(node) = nodes.get_mut(parent)
        {
            node.children[lane] = Child::inner(index);
        }
        for lane in (0..used).rev() {
            if parts[lane].child.node().is_some() {
                let parent = Some((index, lane));
                pending.push(Pending { subtree: parts[lane], depth: depth + 1, parent });
            }
        }
    }
    (nodes, deepest)
}

/// The same for the whole tree, the root's children by several threads.
pub(super) fn widen(bvh: &mut Bvh, splits: &[Split2], root: &Built) {
    let (parts, _) = open(splits, root);
    let widened = |part: &Built| {
        let inner = part.child.node().is_some() && part.bounds.min.x <= part.bounds.max.x;
        inner.then(|| subtree(splits, part))
    };
    let below: Vec<_> = if splits.len() >= PARALLEL && rayon::current_thread_index().is_some() {
        parts.par_iter().map(widened).collect()
    } else {
        parts.iter().map(widened).collect()
    };
    let count = below.iter().flatten().map(|(nodes, _)| nodes.len()).sum::<usize>();
    bvh.nodes = crate::memory::with_capacity(1 + count);
    bvh.nodes.push(node(&parts));
    for (lane, (nodes, depth)) in below.into_iter().enumerate().filter_map(|(i, b)| Some((i, b?))) {
        let first = bvh.nodes.len();
        bvh.nodes[0].children[lane] = Child::inner(first);
        bvh.depth = bvh.depth.max(1 + depth);
        bvh.nodes.extend(nodes.into_iter().map(|mut node| {
            for lane in 0..WIDTH {
                // Missing children keep what they have, which nobody asks for.
                if let Some(index) = node.children[lane].node()
                    && node.planes[0][lane] < f32::INFINITY
                {
                    node.children[lane] = Child::inner(first + index);
                }
            }
            node
        }));
    }
}
