// SPDX-License-Identifier: MIT OR Apache-2.0
//! Which source to look for: by about what each sends to the point.

use dioptric_geometry::world::Sixteen;
use dioptric_math::DVec3;
use dioptric_math::wide::{Kernel, wide};

use super::emitter::{Emitter, Facing};
use super::tree::{Entry, Parts, Tree};

/// How much of the chance does not go by what a source sends to the point: an estimate knows nothing of what is in
/// between. Few sources that can send something share it alike, many by what they send altogether.
const EVEN: f64 = 0.1;
/// So many are asked one by one.
const FEW: usize = 64;

/// Sources, and the chance of each at each point.
#[derive(Clone, Debug, Default)]
pub(super) struct Choice {
    emitters: Vec<Emitter>,
    /// Those that are asked one by one.
    single: Vec<u32>,
    /// All others, if there are many.
    tree: Tree,
    /// What each in the tree sends altogether, added up, and which it is.
    powers: Vec<(f64, u32)>,
}

/// What the sources that are asked one by one send together, and the tree.
struct Total {
    weight: f64,
    count: f64,
    tree: Option<Parts>,
}

impl Total {
    fn chance(&self, weight: f64) -> f64 {
        let [scale, even] = shares(self.weight, self.count);
        if weight > 0.0 { weight * scale + even } else { 0.0 }
    }
}

/// What multiplies a weight to make a chance of it, and what every one that is not 0 has besides.
#[inline(always)]
fn shares(weight: f64, count: f64) -> [f64; 2] {
    [(1.0 - EVEN) / weight, EVEN / count]
}

impl Choice {
    pub fn new(emitters: Vec<Emitter>) -> Self {
        let all = 0..emitters.len() as u32;
        let entries = emitters.iter().zip(all.clone());
        let entries: Vec<Entry> = entries
            .filter_map(|(e, emitter)| {
                e.reach().map(|reach| {
                    let asked = matches!(e, Emitter::Light(_));
                    Entry { reach, emitter, asked }
                })
            })
            .collect();
        if entries.len() <= FEW {
            return Self { emitters, single: all.collect(), ..Self::default() };
        }
        let mut sum = 0.0;
        let powers = entries.iter().map(|e| {
            sum += e.reach.power;
            (sum, e.emitter)
        });
        let powers = powers.collect();
        let tree = Tree::new(entries);
        let single = all.filter(|&e| !tree.has(e)).collect();
        Self { emitters, single, tree, powers }
    }

    /// The only one that there is.
    pub fn only(&self) -> Option<&Emitter> {
        if let [only] = self.emitters.as_slice() { Some(only) } else { None }
    }

    pub fn emitter(&self, emitter: u32) -> Option<&Emitter> {
        self.emitters.get(emitter as usize)
    }

    fn weight(&self, source: u32, point: DVec3, normal: Option<DVec3>) -> f64 {
        self.emitters.get(source as usize).map_or(0.0, |e| e.weight(point, normal))
    }

    /// What all send together; `keep` gets the weights of the first ones that are asked one by one.
    fn total(&self, point: DVec3, normal: Option<DVec3>, keep: &mut [f64]) -> Total {
        let mut total = Total { weight: 0.0, count: 0.0, tree: None };
        if !self.powers.is_empty() {
            let parts = self.tree.parts(&self.emitters, point, normal);
            if parts.total > 0.0 {
                (total.weight, total.count) = (parts.total, 1.0);
                total.tree = Some(parts);
            }
        }
        for (i, &source) in self.single.iter().enumerate() {
            let weight = self.weight(source, point, normal);
            if let Some(kept) = keep.get_mut(i) {
                *kept = weight;
            }
            if weight > 0.0 {
                total.weight += weight;
                total.count += 1.0;
            }
        }
        total
    }

    /// The source that a number in `[0, 1)` picks, and its chance.
    pub fn pick(&self, point: DVec3, normal: Option<DVec3>, pick: f64) -> Option<(u32, f64)> {
        if let [only] = self.emitters.as_slice() {
            return only.reaches(point, normal).then_some((0, 1.0));
        }
        let mut weights = [0.0; FEW];
        let total = self.total(point, normal, &mut weights);
        let mut rest = pick;
        let mut last = None;
        for (i, &source) in self.single.iter().enumerate() {
            let known = weights.get(i).copied();
            let weight = known.unwrap_or_else(|| self.weight(source, point, normal));
            let chance = total.chance(weight);
            if chance > 0.0 {
                last = Some((source, chance));
                if rest < chance {
                    return last;
                }
                rest -= chance;
            }
        }
        let Some(parts) = &total.tree else { return last };
        let chance = total.chance(parts.total);
        let rest = (rest / chance).min(1.0);
        let (source, by_place) = if rest < EVEN {
            let at = rest / EVEN * self.powers.last()?.0;
            let i = self.powers.partition_point(|&(sum, _)| sum <= at);
            let source = self.powers.get(i)?.1;
            (source, self.tree.chance(parts, &self.emitters, point, normal, source))
        } else {
            let rest = (rest - EVEN) / (1.0 - EVEN);
            self.tree.pick(parts, &self.emitters, point, normal, rest)?
        };
        let own = (1.0 - EVEN) * by_place + EVEN * self.share_of_power(source);
        (own > 0.0).then_some((source, own * chance))
    }

    /// Whether [`Self::pick_lanes`] knows them all.
    pub fn is_flat(&self) -> bool {
        self.powers.is_empty() && self.emitters.len() <= FEW
    }

    /// [`Self::pick`] for sixteen points: which each gets, and its chance, 0 where there is none.
    pub fn pick_lanes(&self, picks: &mut Picks) {
        let Picks { weights, .. } = picks;
        weights.resize(self.emitters.len(), [0.0; LANES]);
        wide(Weights { emitters: &self.emitters, picks });
        for (emitter, weights) in self.emitters.iter().zip(&mut picks.weights) {
            if !has_lanes(emitter) {
                for (lane, weight) in weights.iter_mut().enumerate() {
                    let at = |v: &[Sixteen; 3]| DVec3::new(v[0][lane], v[1][lane], v[2][lane]);
                    *weight = emitter.weight(at(&picks.point), Some(at(&picks.normal)));
                }
            }
        }
        wide(Pick(picks));
    }

    /// The chance of a source.
    pub fn chance(&self, point: DVec3, normal: Option<DVec3>, source: u32) -> f64 {
        if let [only] = self.emitters.as_slice() {
            return if only.reaches(point, normal) { 1.0 } else { 0.0 };
        }
        if self.tree.has(source) {
            let total = self.total(point, normal, &mut []);
            let Some(parts) = &total.tree else { return 0.0 };
            let by_place = self.tree.chance(parts, &self.emitters, point, normal, source);
            let own = (1.0 - EVEN) * by_place + EVEN * self.share_of_power(source);
            return total.chance(parts.total) * own;
        }
        let weight = self.weight(source, point, normal);
        if weight > 0.0 { self.total(point, normal, &mut []).chance(weight) } else { 0.0 }
    }

    /// What it sends altogether, of all in the tree.
    fn share_of_power(&self, source: u32) -> f64 {
        // The powers lie in the order of the sources.
        let i = self.powers.partition_point(|&(_, e)| e < source);
        let before = if i > 0 { self.powers[i - 1].0 } else { 0.0 };
        let (Some(own), Some(all)) = (self.powers.get(i), self.powers.last()) else { return 0.0 };
        (own.0 - before) / all.0
    }
}

use crate::lanes::LANES;

/// Sixteen points that choose a source each.
#[derive(Clone, Debug)]
pub(super) struct Picks {
    pub point: [Sixteen; 3],
    pub normal: [Sixteen; 3],
    pub pick: Sixteen,
    /// By emitter.
    weights: Vec<Sixteen>,
    pub emitter: [u32; LANES],
    pub chance: Sixteen,
}

impl Picks {
    pub const EMPTY: Self = Self {
        point: [[0.0; LANES]; 3],
        normal: [[0.0; LANES]; 3],
        pick: [0.0; LANES],
        weights: Vec::new(),
        emitter: [0; LANES],
        chance: [0.0; LANES],
    };
}

/// Whether [`Weights`] knows it.
#[inline(always)]
fn has_lanes(emitter: &Emitter) -> bool {
    matches!(emitter, Emitter::Glow(glow) if !matches!(glow.reach.facing, Facing::Cone(..)))
}

/// Works out the weights of all surfaces that glow.
struct Weights<'a> {
    emitters: &'a [Emitter],
    picks: &'a mut Picks,
}

impl Kernel for Weights<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Picks { point: [px, py, pz], normal: [nx, ny, nz], weights, .. } = self.picks;
        for (emitter, weights) in self.emitters.iter().zip(weights) {
            let Emitter::Glow(glow) = emitter else { continue };
            let reach = glow.reach;
            if let Some(flat) = reach.flat() {
                for i in 0..LANES {
                    let point = DVec3::new(px[i], py[i], pz[i]);
                    let normal = DVec3::new(nx[i], ny[i], nz[i]);
                    weights[i] = reach.weight_flat(flat, point, normal);
                }
            } else {
                for i in 0..LANES {
                    let point = DVec3::new(px[i], py[i], pz[i]);
                    let normal = DVec3::new(nx[i], ny[i], nz[i]);
                    weights[i] = reach.weight_all(point, normal);
                }
            }
        }
    }
}

/// Picks by weights.
struct Pick<'a>(&'a mut Picks);

impl Kernel for Pick<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Picks { pick, weights, emitter, chance, .. } = self.0;
        let (mut sum, mut count) = ([0.0; LANES], [0.0; LANES]);
        for weights in &*weights {
            for i in 0..LANES {
                sum[i] += weights[i];
                count[i] += if weights[i] > 0.0 { 1.0 } else { 0.0 };
            }
        }
        let (mut scale, mut even, mut rest) = ([0.0; LANES], [0.0; LANES], *pick);
        for i in 0..LANES {
            [scale[i], even[i]] = shares(sum[i], count[i]);
        }
        let mut at = [0.0; LANES];
        *chance = [0.0; LANES];
        let mut number = 0.0;
        for weights in &*weights {
            for i in 0..LANES {
                // Once the rest is below 0 the choice is made.
                let own = weights[i] * scale[i] + even[i];
                let open = (weights[i] > 0.0) & (rest[i] >= 0.0);
                at[i] = if open { number } else { at[i] };
                chance[i] = if open { own } else { chance[i] };
                let left = if rest[i] < own { -1.0 } else { rest[i] - own };
                rest[i] = if open { left } else { rest[i] };
            }
            number += 1.0;
        }
        for i in 0..LANES {
            emitter[i] = at[i] as u32;
        }
    }
}
