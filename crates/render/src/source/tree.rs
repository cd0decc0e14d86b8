// SPDX-License-Identifier: MIT OR Apache-2.0
//! Many sources that weaken with distance, in a tree: a walk down picks one by about what each half of the rest sends to
//! the point (Conty Estevez and Kulla, "Importance Sampling of Many Lights with Adaptive Tree Splitting", PACMCGIT
//! 1(2), 2018; without the splitting).

use dioptric_geometry::Bounds;
use dioptric_math::DVec3;

use super::emitter::{Emitter, Facing, Reach};

/// Deeper than this halves are equal: a trail of turns fits in 64 bits.
const UNEVEN: u32 = 36;
/// Where to cut is looked for among so many places.
const BINS: usize = 16;

/// A part of the sources.
#[derive(Clone, Copy, Debug)]
struct Node {
    reach: Reach,
    /// The source of a leaf; else the second half: the first follows the node itself.
    next: u32,
    leaf: bool,
}

/// A source that goes into the tree.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    pub reach: Reach,
    pub emitter: u32,
}

/// The tree.
#[derive(Clone, Debug, Default)]
pub(super) struct Tree {
    nodes: Vec<Node>,
    /// By emitter: the turns to it, the first lowest; nothing for those that are elsewhere.
    trails: Vec<Option<u64>>,
}

impl Tree {
    pub fn new(mut entries: Vec<Entry>) -> Self {
        let count = entries.iter().map(|e| e.emitter as usize + 1).max().unwrap_or(0);
        let mut tree = Self { nodes: Vec::new(), trails: vec![None; count] };
        if !entries.is_empty() {
            tree.add(&mut entries, 0, 0);
        }
        tree
    }

    fn add(&mut self, entries: &mut [Entry], trail: u64, depth: u32) {
        if let [entry] = entries {
            self.trails[entry.emitter as usize] = Some(trail);
            self.nodes.push(Node { reach: entry.reach, next: entry.emitter, leaf: true });
            return;
        }
        let at = self.nodes.len();
        self.nodes.push(Node { reach: around(entries), next: 0, leaf: false });
        let place = cut(entries, depth);
        let (first, second) = entries.split_at_mut(place);
        self.add(first, trail, depth + 1);
        self.nodes[at].next = self.nodes.len() as u32;
        self.add(second, trail | (1 << depth.min(63)), depth + 1);
    }

    /// About what all of it sends to a point.
    pub fn weight(&self, point: DVec3, normal: Option<DVec3>) -> f64 {
        self.nodes.first().map_or(0.0, |node| node.reach.weight(point, normal))
    }

    /// The halves below a node, and the chance of the first.
    fn halves(
        &self,
        emitters: &[Emitter],
        at: usize,
        node: &Node,
        point: DVec3,
        normal: Option<DVec3>,
    ) -> Option<([usize; 2], f64)> {
        let halves = [at + 1, node.next as usize];
        let weigh = |i: usize| match self.nodes.get(i) {
            // The last ones are asked themselves, who may know better.
            Some(Node { leaf: true, next, .. }) => {
                emitters.get(*next as usize).map_or(0.0, |e| e.weight(point, normal))
            }
            Some(node) => node.reach.weight(point, normal),
            None => 0.0,
        };
        let (first, second) = (weigh(halves[0]), weigh(halves[1]));
        let chance = first / (first + second);
        (first + second > 0.0 && chance.is_finite()).then_some((halves, chance))
    }

    /// The source that a number in `[0, 1)` picks, and its chance.
    pub fn pick(
        &self,
        emitters: &[Emitter],
        point: DVec3,
        normal: Option<DVec3>,
        pick: f64,
    ) -> Option<(u32, f64)> {
        let (mut at, mut chance, mut rest) = (0, 1.0, pick);
        loop {
            let node = self.nodes.get(at)?;
            if node.leaf {
                return Some((node.next, chance));
            }
            let ([first, second], share) = self.halves(emitters, at, node, point, normal)?;
            (at, chance, rest) = if rest < share {
                (first, chance * share, rest / share)
            } else {
                let other = 1.0 - share;
                (second, chance * other, (rest - share) / other)
            };
        }
    }

    /// The chance of a source.
    pub fn chance(
        &self,
        emitters: &[Emitter],
        point: DVec3,
        normal: Option<DVec3>,
        emitter: u32,
    ) -> f64 {
        let Some(mut trail) = self.trails.get(emitter as usize).copied().flatten() else {
            return 0.0;
        };
        let (mut at, mut chance) = (0, 1.0);
        while let Some(node) = self.nodes.get(at) {
            if node.leaf {
                return chance;
            }
            let Some(([first, second], share)) = self.halves(emitters, at, node, point, normal)
            else {
                return 0.0;
            };
            (at, chance) = if trail & 1 == 0 {
                (first, chance * share)
            } else {
                (second, chance * (1.0 - share))
            };
            trail >>= 1;
        }
        0.0
    }

    /// Whether a source is in it.
    pub fn has(&self, emitter: u32) -> bool {
        self.trails.get(emitter as usize).copied().flatten().is_some()
    }
}

/// A ball around some sources, and what they send.
fn around(entries: &[Entry]) -> Reach {
    let bounds = entries.iter().fold(Bounds::EMPTY, |all, e| all.union(bounds_of(&e.reach)));
    let center = bounds.min + (bounds.max - bounds.min) * 0.5;
    let radius = entries
        .iter()
        .fold(0.0, |r: f64, e| r.max((e.reach.center - center).length() + e.reach.radius));
    let power = entries.iter().map(|e| e.reach.power).sum();
    // Rounding must leave nobody outside.
    Reach { center, radius: radius * (1.0 + 1e-9), facing: Facing::All, power }
}

fn bounds_of(reach: &Reach) -> Bounds {
    Bounds { min: reach.center - reach.radius, max: reach.center + reach.radius }
}

/// Sorts the sources by where to cut, and says where: between 1 and all but one. The cost of a half is what it sends,
/// times the surface of its box.
fn cut(entries: &mut [Entry], depth: u32) -> usize {
    let half = entries.len() / 2;
    let centers = entries.iter().map(|e| e.reach.center);
    let (low, high) = centers
        .fold((DVec3::splat(f64::INFINITY), DVec3::splat(f64::NEG_INFINITY)), |(low, high), c| {
            (low.min(c), high.max(c))
        });
    let size = high - low;
    let axis = (0..3).fold(0, |best, k| if size[k] > size[best] { k } else { best });
    let key = |e: &Entry| e.reach.center[axis];
    entries.sort_by(|a, b| key(a).total_cmp(&key(b)).then(a.emitter.cmp(&b.emitter)));
    if depth > UNEVEN || !(size[axis] > 0.0) {
        return half;
    }
    let bin =
        |e: &Entry| (((key(e) - low[axis]) / size[axis] * BINS as f64) as usize).min(BINS - 1);
    let mut bins = [(Bounds::EMPTY, 0.0, 0); BINS];
    for entry in entries.iter() {
        let (bounds, sum, count) = &mut bins[bin(entry)];
        *bounds = bounds.union(bounds_of(&entry.reach));
        *sum += entry.reach.power;
        *count += 1;
    }
    let mut after = [0.0; BINS];
    let (mut bounds, mut sum) = (Bounds::EMPTY, 0.0);
    for i in (1..BINS).rev() {
        bounds = bounds.union(bins[i].0);
        sum += bins[i].1;
        after[i] = cost(&bounds, sum);
    }
    let (mut bounds, mut sum, mut count) = (Bounds::EMPTY, 0.0, 0);
    let mut best = (f64::INFINITY, half);
    for i in 0..BINS - 1 {
        bounds = bounds.union(bins[i].0);
        sum += bins[i].1;
        count += bins[i].2;
        let both = cost(&bounds, sum) + after[i + 1];
        if both < best.0 && count > 0 && count < entries.len() {
            best = (both, count);
        }
    }
    best.1
}

fn cost(bounds: &Bounds, power: f64) -> f64 {
    if bounds.is_empty() {
        return 0.0;
    }
    let s = bounds.max - bounds.min;
    power * (s.x * s.y + s.y * s.z + s.z * s.x)
}
