// SPDX-License-Identifier: MIT OR Apache-2.0
//! A surface's own colour: ambient light, its own light, and each light's diffuse term and highlight
//! behind its shadow.
//!
//! The points of a round are lit side by side, one light after the other: [`super::lit`] does the sums.

use dioptric_geometry::world::{Found, Passages};
use dioptric_math::Spectrum;
use dioptric_math::wide::wide;
use serde_json::json;

use super::lit::{AllAdd, AllFall, Between, Fall, LANES, Lit, Power, Row, get, lanes, put};
use super::recorder::Recorder;
use super::shadow::Start;
use super::shine::shine;
use super::told::{Sum, Told};
use super::whitted::{Met, Whitted};
use crate::scene::PlacedLight;
use crate::setting::render::Shadows;

/// Shadow rays that are cast together, where a light takes several samples.
const TOGETHER: usize = 512;

/// Memory that lighting uses again.
#[derive(Default)]
pub(super) struct Scratch {
    lit: Lit,
    /// The points once for each sample of a light.
    many: Lit,
    /// What picks the part of a light, for each of these.
    parts: Vec<[f64; 2]>,
    between: Vec<Between>,
    /// Rays that are cast, and what they find.
    wanted: Vec<u16>,
    found: Vec<Found>,
    passages: Passages,
    sums: Vec<Sum>,
    told: Vec<Told>,
}

/// A light, and how it is asked.
#[derive(Clone, Copy)]
pub(super) struct Asked<'a> {
    pub placed: &'a PlacedLight,
    /// Which of the lights it is.
    number: usize,
    pub samples: u32,
    /// What multiplies each sample.
    share: f64,
}

impl<R: Recorder> Whitted<'_, '_, R> {
    /// Works out the own colours: ambient, emission, and every light.
    pub(super) fn light(&mut self, points: &mut [Met<R::Id>], scratch: &mut Scratch) {
        let scene = self.scene;
        scratch.lit.clear();
        for (i, met) in points.iter_mut().enumerate().filter(|(_, met)| met.wants_own) {
            let (id, finish) = (met.way.id, &met.point.finish);
            let mut sum = scene.ambient * finish.ambient;
            if sum != Spectrum::ZERO {
                self.recorder.term(id, "ambient", sum, || {
                    (None, json!({"ambient": scene.ambient.to_array(), "color": finish.ambient.to_array()}))
                });
            }
            if finish.emission != Spectrum::ZERO {
                sum += finish.emission;
                self.recorder.term(id, "emission", finish.emission, || (None, json!({})));
            }
            met.own = sum;
            if finish.diffuse != Spectrum::ZERO || finish.highlight.is_some() {
                scratch.lit.push(met, i);
            }
        }
        if scratch.lit.rows.is_empty() {
            return;
        }
        for (number, placed) in scene.lights.iter().enumerate() {
            let samples = placed.light.samples().max(1);
            let asked = Asked { placed, number, samples, share: 1.0 / f64::from(samples) };
            if R::ENABLED {
                scratch.told.clear();
                scratch.told.resize_with(scratch.lit.rows.len(), Told::default);
            }
            if samples == 1 {
                self.one_sample(points, asked, scratch);
            } else {
                self.several_samples(points, asked, scratch);
            }
        }
        for (row, of) in scratch.lit.rows.iter().enumerate() {
            let met = &mut points[of.point as usize];
            met.own = get(&scratch.lit.blocks[row / LANES].own, row);
            met.stream = met.stream.ahead(scene.lights.len());
        }
    }

    /// Adds a light that takes one sample.
    fn one_sample(&mut self, points: &[Met<R::Id>], asked: Asked, scratch: &mut Scratch) {
        let mut lit = std::mem::take(&mut scratch.lit);
        scratch.parts.clear();
        if !asked.placed.light.is_sharp() {
            let part = |of: &Row| points[of.point as usize].stream.ahead(asked.number).next_2d();
            scratch.parts.extend(lit.rows.iter().map(part));
        }
        self.ask(points, asked, &mut lit, scratch);
        wide(AllAdd { lit: &mut lit, between: &scratch.between, whole: true });
        if R::ENABLED {
            for (row, of) in lit.rows.iter().enumerate() {
                let [diffuse, highlight] = &lit.blocks[row / LANES].sum;
                let sum = Sum { diffuse: get(diffuse, row), highlight: get(highlight, row) };
                self.tell(&points[of.point as usize], asked, &sum, &mut scratch.told[row]);
            }
        }
        scratch.lit = lit;
    }

    /// Adds the mean over a light's samples.
    fn several_samples(&mut self, points: &[Met<R::Id>], asked: Asked, scratch: &mut Scratch) {
        let (mut lit, mut many) =
            (std::mem::take(&mut scratch.lit), std::mem::take(&mut scratch.many));
        let mut sums = std::mem::take(&mut scratch.sums);
        sums.clear();
        sums.resize(lit.rows.len(), Sum::default());
        let together = (TOGETHER / asked.samples as usize).max(1);
        for first in (0..lit.rows.len()).step_by(together) {
            many.clear();
            scratch.parts.clear();
            for row in first..(first + together).min(lit.rows.len()) {
                let stream = points[lit.rows[row].point as usize].stream;
                for part in stream.ahead(asked.number).pairs(asked.samples) {
                    many.push_again(&lit, row);
                    scratch.parts.push(part);
                }
            }
            self.ask(points, asked, &mut many, scratch);
            wide(AllAdd { lit: &mut many, between: &scratch.between, whole: false });
            for (row, of) in many.rows.iter().enumerate() {
                let [diffuse, highlight] = &many.blocks[row / LANES].sum;
                let sum = &mut sums[of.told as usize];
                sum.diffuse += get(diffuse, row);
                sum.highlight += get(highlight, row);
            }
        }
        for (row, (sum, of)) in sums.iter().zip(&lit.rows).enumerate() {
            let own = &mut lit.blocks[row / LANES].own;
            put(own, row, get(own, row) + (sum.diffuse + sum.highlight));
            if R::ENABLED {
                self.tell(&points[of.point as usize], asked, sum, &mut scratch.told[row]);
            }
        }
        (scratch.lit, scratch.many, scratch.sums) = (lit, many, sums);
    }

    /// Asks a light what it sends to the points, and finds out what is between.
    fn ask(&mut self, points: &[Met<R::Id>], asked: Asked, lit: &mut Lit, scratch: &mut Scratch) {
        let Scratch { parts, between, wanted, found, passages, told, .. } = scratch;
        fall(asked, lit, parts, between);
        if R::ENABLED {
            for (at, between) in between.iter().enumerate() {
                for lane in lanes(between.asked) {
                    let row = lit.rows[at * LANES + lane];
                    let block = &lit.blocks[at];
                    let told = &mut told[row.told as usize];
                    told.cosine += asked.share * block.cosine[lane];
                    if (between.bright | between.dark) & 1 << lane != 0 {
                        let point = &points[row.point as usize].point;
                        let direction = lit.rays.bundles()[at].ray(lane).direction;
                        told.in_front += 1;
                        told.diffuse_unshadowed += get(&block.term, lane);
                        told.highlight_unshadowed +=
                            shine(point, direction, get(&block.arriving, lane));
                    }
                }
            }
        }
        wanted.clear();
        for (at, between) in between.iter_mut().enumerate() {
            for lane in lanes(between.dark) {
                let point = &points[lit.rows[at * LANES + lane].point as usize].point;
                let direction = lit.rays.bundles()[at].ray(lane).direction;
                let arriving = get(&lit.blocks[at].arriving, lane);
                if shine(point, direction, arriving) != Spectrum::ZERO {
                    between.bright |= 1 << lane;
                }
            }
            wanted.push(between.bright);
        }
        let scene = self.scene;
        let shadows = scene.settings.shadows;
        if shadows == Shadows::None {
            found.clear();
            found.resize(wanted.len(), Found::NOTHING);
        } else {
            self.counts.shadow += wanted.iter().map(|w| u64::from(w.count_ones())).sum::<u64>();
            scene.world.blockers_of_rays(lit.rays.bundles(), wanted, found);
        }
        for (at, (between, found)) in between.iter_mut().zip(&*found).enumerate() {
            (between.passed, between.tinted) = (between.bright & !found.hit, false);
            let block = &mut lit.blocks[at];
            let tinted = shadows == Shadows::Tinted;
            if tinted || scene.has_holes {
                let mut shaded = found.hit;
                for lane in lanes(found.hit) {
                    shaded &= !(u16::from(scene.is_opaque(found.ids[lane])) << lane);
                }
                if shaded != 0 {
                    scene.world.hits_of_rays(&lit.rays.bundles()[at], shaded, passages);
                }
                for lane in lanes(shaded) {
                    let query = lit.rays.bundles()[at].query(lane);
                    let start = Start::of(&query);
                    let visibility =
                        scene.passes(&start, query.t_max, tinted, passages.of(lane).iter());
                    if visibility != Spectrum::ZERO {
                        if !between.tinted {
                            between.tinted = true;
                            block.visibility = [[1.0; LANES]; 3];
                        }
                        between.passed |= 1 << lane;
                        put(&mut block.visibility, lane, visibility);
                    }
                }
            }
            if block.power == Power::Mixed {
                // Only now: a highlight costs more than all the rest.
                block.strength = [0.0; LANES];
                for lane in lanes(between.passed) {
                    let point = &points[lit.rows[at * LANES + lane].point as usize].point;
                    let direction = lit.rays.bundles()[at].ray(lane).direction;
                    if let Some(h) = &point.finish.highlight {
                        block.strength[lane] =
                            h.strength(point.normal, direction, -point.ray.direction);
                    }
                }
            }
        }
        if R::ENABLED {
            for (at, between) in between.iter().enumerate() {
                for lane in lanes(between.bright) {
                    let told = &mut told[lit.rows[at * LANES + lane].told as usize];
                    if between.passed & 1 << lane != 0 {
                        let visibility = if between.tinted {
                            get(&lit.blocks[at].visibility, lane)
                        } else {
                            Spectrum::ONE
                        };
                        told.visibility += visibility * asked.share;
                    }
                    let query = lit.rays.bundles()[at].query(lane);
                    self.list_blockers(&query, &mut told.blockers);
                }
            }
        }
    }
}

/// Asks a light what it sends to the points.
fn fall(asked: Asked, lit: &mut Lit, parts: &[[f64; 2]], between: &mut Vec<Between>) {
    let Asked { placed, share, .. } = asked;
    let sharp = placed.light.sharp();
    between.clear();
    between.resize(lit.rays.bundles().len(), Between::default());
    for (at, between) in between.iter_mut().enumerate() {
        between.asked = lit.lanes(at);
    }
    if let Some(light) = sharp {
        wide(AllFall { lit, light, between });
    }
    for (at, between) in between.iter_mut().enumerate() {
        if sharp.is_some() && !between.odd {
            continue;
        }
        let (rays, block) = (&mut lit.rays.bundles_mut()[at], &mut lit.blocks[at]);
        for lane in lanes(between.asked) {
            let part = parts.get(at * LANES + lane).copied().unwrap_or([0.5; 2]);
            match placed.light.sample(rays.ray(lane).origin, part) {
                Some(sample) => {
                    put(&mut rays.direction, lane, sample.direction);
                    rays.t_max[lane] = sample.distance;
                    put(&mut block.arriving, lane, sample.arriving);
                }
                None => between.asked &= !(1 << lane),
            }
        }
        wide(Fall { rays, block, share, between });
    }
}
