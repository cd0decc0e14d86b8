// SPDX-License-Identifier: MIT OR Apache-2.0
//! Many sources that weaken with distance, in a tree: a walk down picks one by about what each half of the rest sends to
//! the point (Conty Estevez and Kulla, "Importance Sampling of Many Lights with Adaptive Tree Splitting", PACMCGIT
//! 1(2), 2018).
//!
//! Near the point a whole half says little of what is in it. So the walk does not begin at the root, but at one of some
//! parts, picked by weight: the root cut in halves again and again, the heaviest first.

use dioptric_geometry::Bounds;
use dioptric_math::{DVec3, normalize};

use super::emitter::{Emitter, Facing, Reach};

/// Parts are not weighed as a whole where the point is nearer to them than so many times their radius, and they are not
/// small to it: their halves are weighed instead.
const NEAR: f64 = 3.0;
/// What is small: a part of all that is sent.
const SMALL: f64 = 1.0 / 32.0;
/// The most parts that are weighed against each other at once.
const WIDE: usize = 20;
/// Deeper than this halves are equal, so that nothing is deeper than twice this.
const UNEVEN: u32 = 40;
/// Where to cut is looked for among so many places.
const BINS: usize = 16;

/// A part of the sources.
#[derive(Clone, Copy, Debug)]
struct Node {
    reach: Reach,
    /// The source of a leaf; else the second half: the first follows the node itself.
    next: u32,
    /// Its nodes are those up to here.
    end: u32,
    leaf: bool,
    asked: bool,
}

/// A source that goes into the tree.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    pub reach: Reach,
    pub emitter: u32,
    /// Whether it knows better than its reach what it sends to a point.
    pub asked: bool,
}

/// The tree.
#[derive(Clone, Debug, Default)]
pub(super) struct Tree {
    nodes: Vec<Node>,
    /// By emitter: its leaf, or [`NONE`] for those that are elsewhere.
    leaves: Vec<u32>,
}

const NONE: u32 = u32::MAX;

/// Parts of a tree, and what each sends to a point.
pub(super) struct Parts {
    parts: [(u32, f64); WIDE],
    count: usize,
    /// About what all of them send.
    pub total: f64,
}

impl Tree {
    pub fn new(mut entries: Vec<Entry>) -> Self {
        let count = entries.iter().map(|e| e.emitter as usize + 1).max().unwrap_or(0);
        let mut tree = Self { nodes: Vec::new(), leaves: vec![NONE; count] };
        if !entries.is_empty() {
            tree.add(&mut entries, 0);
        }
        tree
    }

    fn add(&mut self, entries: &mut [Entry], depth: u32) {
        let at = self.nodes.len();
        if let [entry] = entries {
            self.leaves[entry.emitter as usize] = at as u32;
            self.nodes.push(Node {
                reach: entry.reach,
                next: entry.emitter,
                end: at as u32 + 1,
                leaf: true,
                asked: entry.asked,
            });
            return;
        }
        self.nodes.push(Node {
            reach: around(entries),
            next: 0,
            end: 0,
            leaf: false,
            asked: false,
        });
        let place = cut(entries, depth);
        let (first, second) = entries.split_at_mut(place);
        self.add(first, depth + 1);
        self.nodes[at].next = self.nodes.len() as u32;
        self.add(second, depth + 1);
        self.nodes[at].end = self.nodes.len() as u32;
    }

    /// Whether a source is in it.
    pub fn has(&self, emitter: u32) -> bool {
        self.leaf(emitter).is_some()
    }

    fn leaf(&self, emitter: u32) -> Option<u32> {
        self.leaves.get(emitter as usize).copied().filter(|&leaf| leaf != NONE)
    }

    fn weigh(&self, emitters: &[Emitter], node: u32, point: DVec3, normal: Option<DVec3>) -> f64 {
        match self.nodes.get(node as usize) {
            // Lights know better themselves.
            Some(Node { leaf: true, asked: true, next, .. }) => {
                emitters.get(*next as usize).map_or(0.0, |e| e.weight(point, normal))
            }
            Some(node) => node.reach.weight(point, normal),
            None => 0.0,
        }
    }

    /// The parts that are weighed against each other at a point: the heaviest is cut in halves as long as that helps.
    pub fn parts(&self, emitters: &[Emitter], point: DVec3, normal: Option<DVec3>) -> Parts {
        let root = self.weigh(emitters, 0, point, normal);
        let mut parts = Parts { parts: [(0, root); WIDE], count: 1, total: root };
        // What those weigh that are to be cut.
        let coarse = |at: u32, weight: f64| match self.nodes.get(at as usize) {
            Some(node) if !node.leaf && node.reach.is_near(point, NEAR) => weight,
            _ => 0.0,
        };
        let mut weights = [0.0; WIDE];
        weights[0] = coarse(0, root);
        while parts.count < WIDE {
            let (mut i, mut most) = (0, 0.0);
            for (k, &weight) in weights[..parts.count].iter().enumerate() {
                (i, most) = if weight > most { (k, weight) } else { (i, most) };
            }
            if most <= SMALL * parts.total {
                break;
            }
            let (at, weight) = parts.parts[i];
            let Some(node) = self.nodes.get(at as usize) else { break };
            parts.total -= weight;
            for (place, half) in [(i, at + 1), (parts.count, node.next)] {
                let weight = self.weigh(emitters, half, point, normal);
                parts.parts[place] = (half, weight);
                parts.total += weight;
                weights[place] = coarse(half, weight);
            }
            parts.count += 1;
        }
        // Without what the differences have left over.
        parts.total = parts.parts[..parts.count].iter().map(|part| part.1).sum();
        parts
    }

    /// The chance of the first half of a node.
    fn chance_of_first(
        &self,
        emitters: &[Emitter],
        halves: [u32; 2],
        point: DVec3,
        normal: Option<DVec3>,
    ) -> Option<f64> {
        let [first, second] = halves.map(|half| self.weigh(emitters, half, point, normal));
        let chance = first / (first + second);
        (first + second > 0.0 && chance.is_finite()).then_some(chance)
    }

    /// The source that a number in `[0, 1)` picks, and its chance.
    pub fn pick(
        &self,
        parts: &Parts,
        emitters: &[Emitter],
        point: DVec3,
        normal: Option<DVec3>,
        pick: f64,
    ) -> Option<(u32, f64)> {
        let mut rest = pick * parts.total;
        let mut chosen = None;
        for &(node, weight) in parts.parts.get(..parts.count)?.iter().filter(|part| part.1 > 0.0) {
            chosen = Some((node, weight));
            if rest < weight {
                break;
            }
            rest -= weight;
        }
        let (mut at, weight) = chosen?;
        let (mut chance, mut rest) = (weight / parts.total, (rest / weight).min(1.0));
        loop {
            let node = self.nodes.get(at as usize)?;
            if node.leaf {
                return Some((node.next, chance));
            }
            let halves = [at + 1, node.next];
            let share = self.chance_of_first(emitters, halves, point, normal)?;
            (at, chance, rest) = if rest < share {
                (halves[0], chance * share, rest / share)
            } else {
                let other = 1.0 - share;
                (halves[1], chance * other, (rest - share) / other)
            };
        }
    }

    /// The chance of a source.
    pub fn chance(
        &self,
        parts: &Parts,
        emitters: &[Emitter],
        point: DVec3,
        normal: Option<DVec3>,
        emitter: u32,
    ) -> f64 {
        let Some(leaf) = self.leaf(emitter) else { return 0.0 };
        let has = |at: u32| at <= leaf && self.nodes.get(at as usize).is_some_and(|n| leaf < n.end);
        let mut all = parts.parts.get(..parts.count).unwrap_or_default().iter();
        let Some(&(mut at, weight)) = all.find(|part| has(part.0)) else { return 0.0 };
        let mut chance = weight / parts.total;
        while at != leaf {
            let Some(node) = self.nodes.get(at as usize).filter(|node| !node.leaf) else {
                return 0.0;
            };
            let halves = [at + 1, node.next];
            let Some(share) = self.chance_of_first(emitters, halves, point, normal) else {
                return 0.0;
            };
            (at, chance) = if leaf < node.next {
                (halves[0], chance * share)
            } else {
                (halves[1], chance * (1.0 - share))
            };
        }
        chance
    }
}

/// A box and a ball around some sources, and what they send.
fn around(entries: &[Entry]) -> Reach {
    let bounds = entries.iter().fold(Bounds::EMPTY, |all, e| all.union(bounds_of(&e.reach)));
    let half = (bounds.max - bounds.min) * 0.5;
    let center = bounds.min + half;
    let radius = entries
        .iter()
        .fold(0.0, |r: f64, e| r.max((e.reach.center - center).length() + e.reach.radius));
    let power = entries.iter().map(|e| e.reach.power).sum();
    // Rounding must leave nobody outside.
    let room = 1.0 + 1e-9;
    Reach { center, radius: radius * room, half: half * room, facing: facing(entries), power }
}

/// To where they shine together, if all of them shine to one side and these sides are alike.
fn facing(entries: &[Entry]) -> Facing {
    let front = |e: &Entry| match e.reach.facing {
        Facing::Front(n) => Some(n),
        _ => None,
    };
    let sum = entries.iter().try_fold(DVec3::ZERO, |sum, e| Some(sum + front(e)?));
    let Some(axis) = sum.and_then(normalize) else { return Facing::All };
    let cos = entries.iter().filter_map(front).fold(1.0, |least: f64, n| least.min(axis.dot(n)));
    // Rounding must leave nobody outside.
    let cos = cos - 1e-9;
    if cos > 0.0 { Facing::Cone(axis, [cos, (1.0 - cos * cos).sqrt()]) } else { Facing::All }
}

fn bounds_of(reach: &Reach) -> Bounds {
    Bounds { min: reach.center - reach.half, max: reach.center + reach.half }
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
