// SPDX-License-Identifier: MIT OR Apache-2.0
//! A surface's own colour: ambient light, its own light, and each light's diffuse term and highlight
//! behind its shadow.
//!
//! The points of a round are lit side by side, one light after the other: [`super::lit`] does the sums.

use dioptric_geometry::world::{Found, Passages};
use dioptric_math::Spectrum;
use dioptric_math::wide::wide;
use serde_json::json;

use super::lit::{AllAdd, AllFall, Between, Block, Fall, Lit, Power, lanes};
use super::recorder::Recorder;
use super::shadow::Start;
use super::shine::shine;
use super::told::{Sum, Told};
use super::whitted::{Follow, Whitted};
use crate::lanes::{LANES, get, put};
use crate::material::Finish;
use crate::scene::{Answer, PlacedLight};
use crate::setting::render::Shadows;

/// Shadow rays that are cast together, where a light takes several samples.
const TOGETHER: usize = 512;

/// Memory that lighting uses again.
#[derive(Default)]
pub(super) struct Scratch {
    pub lit: Lit,
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

/// What a round met, as lights ask for it: by the points' numbers.
pub(super) struct Points<'p, 'a, I> {
    /// What the materials answer.
    pub finishes: &'p [[Option<Answer<'a>>; LANES]],
    /// The rays that met them.
    pub legs: &'p mut [Follow<I>],
}

impl<I: Copy> Points<'_, '_, I> {
    fn finish(&self, number: u32) -> &Finish {
        let number = number as usize;
        let answer = self.finishes.get(number / LANES).and_then(|all| all[number % LANES].as_ref());
        answer.map_or(&Finish::HOLE, |answer| answer)
    }

    /// A light's highlight at one of them.
    fn shine(&self, number: u32, lit: &Lit, row: usize) -> Spectrum {
        let (block, rays) = (lit.block(row / LANES), lit.rays(row / LANES));
        let (direction, arriving) = (rays.ray(row).direction, get(&block.arriving, row));
        shine(self.finish(number), looks(block, row), direction, arriving)
    }
}

/// The normal of a point, and the direction towards the viewer.
fn looks(block: &Block, lane: usize) -> [dioptric_math::DVec3; 2] {
    [block.normal(lane), get(&block.viewer, lane)]
}

impl<R: Recorder> Whitted<'_, '_, R> {
    /// What a point shows by itself, without any light: ambient, and what its surface sends out.
    #[inline(always)]
    pub(super) fn glow(&mut self, id: R::Id, finish: &Finish) -> Spectrum {
        let ambient = self.scene.ambient;
        let mut sum = ambient * finish.ambient;
        if sum != Spectrum::ZERO {
            self.recorder.term(id, "ambient", sum, || {
                (None, json!({"ambient": ambient.to_array(), "color": finish.ambient.to_array()}))
            });
        }
        if finish.emission != Spectrum::ZERO {
            sum += finish.emission;
            self.recorder.term(id, "emission", finish.emission, || (None, json!({})));
        }
        sum
    }

    /// Adds every light to the own colours of the points that are to be lit.
    pub(super) fn light(&mut self, points: &mut Points<R::Id>, scratch: &mut Scratch) {
        let scene = self.scene;
        if scratch.lit.is_dark() {
            return;
        }
        for (number, placed) in scene.lights.iter().enumerate() {
            let samples = placed.light.samples().max(1);
            let asked = Asked { placed, number, samples, share: 1.0 / f64::from(samples) };
            if R::ENABLED {
                scratch.told.clear();
                scratch.told.resize_with(scratch.lit.len() * LANES, Told::default);
            }
            if samples == 1 {
                self.one_sample(points, asked, scratch);
            } else {
                self.several_samples(points, asked, scratch);
            }
        }
        for number in scratch.lit.numbers() {
            let stream = &mut points.legs[number].stream;
            *stream = stream.ahead(scene.lights.len());
        }
    }

    /// Adds a light that takes one sample.
    fn one_sample(&mut self, points: &Points<R::Id>, asked: Asked, scratch: &mut Scratch) {
        let mut lit = std::mem::take(&mut scratch.lit);
        scratch.parts.clear();
        if !asked.placed.light.is_sharp() {
            scratch.parts.resize(lit.len() * LANES, [0.5; 2]);
            for number in lit.numbers() {
                let mut stream = points.legs[number].stream.ahead(asked.number);
                scratch.parts[number] = stream.next_2d();
            }
        }
        self.ask(points, asked, &mut lit, scratch);
        let kept = R::ENABLED;
        wide(AllAdd { lit: lit.parts(), between: &scratch.between, whole: true, kept });
        if R::ENABLED {
            for row in lit.numbers() {
                let [diffuse, highlight] = &lit.block(row / LANES).sum;
                let sum = Sum { diffuse: get(diffuse, row), highlight: get(highlight, row) };
                let (id, finish) = (points.legs[row].way.id, points.finish(row as u32));
                self.tell(id, finish, asked, &sum, &mut scratch.told[row]);
            }
        }
        scratch.lit = lit;
    }

    /// Adds the mean over a light's samples.
    fn several_samples(&mut self, points: &Points<R::Id>, asked: Asked, scratch: &mut Scratch) {
        let (mut lit, mut many) =
            (std::mem::take(&mut scratch.lit), std::mem::take(&mut scratch.many));
        let mut sums = std::mem::take(&mut scratch.sums);
        sums.clear();
        sums.resize(lit.len() * LANES, Sum::default());
        let together = (TOGETHER / asked.samples as usize).max(1);
        let numbers: Vec<usize> = lit.numbers().collect();
        for numbers in numbers.chunks(together) {
            many.begin(0);
            scratch.parts.clear();
            for &number in numbers {
                let mut stream = points.legs[number].stream.ahead(asked.number);
                for part in stream.pairs(asked.samples) {
                    many.push_again(&lit, number);
                    scratch.parts.push(part);
                }
            }
            self.ask(points, asked, &mut many, scratch);
            let between = &scratch.between;
            wide(AllAdd { lit: many.parts(), between, whole: false, kept: true });
            for row in many.numbers() {
                let [diffuse, highlight] = &many.block(row / LANES).sum;
                let sum = &mut sums[many.row(row).told as usize];
                sum.diffuse += get(diffuse, row);
                sum.highlight += get(highlight, row);
            }
        }
        for &number in &numbers {
            let sum = &sums[number];
            let own = &mut lit.block_mut(number / LANES).own;
            put(own, number, get(own, number) + (sum.diffuse + sum.highlight));
            if R::ENABLED {
                let (id, finish) = (points.legs[number].way.id, points.finish(number as u32));
                self.tell(id, finish, asked, sum, &mut scratch.told[number]);
            }
        }
        (scratch.lit, scratch.many, scratch.sums) = (lit, many, sums);
    }

    /// Asks a light what it sends to the points, and finds out what is between.
    fn ask(&mut self, points: &Points<R::Id>, asked: Asked, lit: &mut Lit, scratch: &mut Scratch) {
        let Scratch { parts, between, wanted, found, passages, told, .. } = scratch;
        fall(asked, lit, parts, between);
        if R::ENABLED {
            for (at, between) in between.iter().enumerate() {
                for lane in lanes(between.asked) {
                    let row = lit.row(at * LANES + lane);
                    let block = lit.block(at);
                    let told = &mut told[row.told as usize];
                    told.cosine += asked.share * block.cosine[lane];
                    if (between.bright | between.dark) & 1 << lane != 0 {
                        told.in_front += 1;
                        told.diffuse_unshadowed += get(&block.term, lane);
                        told.highlight_unshadowed +=
                            points.shine(row.point, lit, at * LANES + lane);
                    }
                }
            }
        }
        wanted.clear();
        for (at, between) in between.iter_mut().enumerate() {
            for lane in lanes(between.dark) {
                let number = at * LANES + lane;
                if points.shine(lit.row(number).point, lit, number) != Spectrum::ZERO {
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
            scene.world.blockers_of_rays(lit.all_rays(), wanted, found);
        }
        let tinted = shadows == Shadows::Tinted;
        let may_pass = (tinted || scene.has_holes) && !scene.all_opaque;
        for (at, (between, found)) in between.iter_mut().zip(&*found).enumerate() {
            (between.passed, between.tinted) = (between.bright & !found.hit, false);
            if may_pass {
                let mut shaded = found.hit;
                for lane in lanes(found.hit) {
                    shaded &= !(u16::from(scene.is_opaque(found.ids[lane])) << lane);
                }
                if shaded != 0 {
                    scene.world.hits_of_rays(lit.rays(at), shaded, passages);
                }
                for lane in lanes(shaded) {
                    let query = lit.rays(at).query(lane);
                    let start = Start::of(&query);
                    let visibility =
                        scene.passes(&start, query.t_max, tinted, passages.of(lane).iter());
                    if visibility != Spectrum::ZERO {
                        let block = lit.block_mut(at);
                        if !between.tinted {
                            between.tinted = true;
                            block.visibility = [[1.0; LANES]; 3];
                        }
                        between.passed |= 1 << lane;
                        put(&mut block.visibility, lane, visibility);
                    }
                }
            }
            if lit.block(at).power == Power::Mixed {
                // Only now: a highlight costs more than all the rest.
                let mut strength = [0.0; LANES];
                for lane in lanes(between.passed) {
                    let finish = points.finish(lit.row(at * LANES + lane).point);
                    let direction = lit.rays(at).ray(lane).direction;
                    if let Some(h) = &finish.highlight {
                        let [normal, viewer] = looks(lit.block(at), lane);
                        strength[lane] = h.strength(normal, direction, viewer);
                    }
                }
                lit.block_mut(at).strength = strength;
            }
        }
        if R::ENABLED {
            for (at, between) in between.iter().enumerate() {
                for lane in lanes(between.bright) {
                    let told = &mut told[lit.row(at * LANES + lane).told as usize];
                    if between.passed & 1 << lane != 0 {
                        let visibility = if between.tinted {
                            get(&lit.block(at).visibility, lane)
                        } else {
                            Spectrum::ONE
                        };
                        told.visibility += visibility * asked.share;
                    }
                    let query = lit.rays(at).query(lane);
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
    let asked_by = |live: &u16| Between { asked: *live, ..Between::default() };
    between.extend(lit.parts().live.iter().map(asked_by));
    if let Some(light) = sharp {
        wide(AllFall { lit: lit.parts(), light, between });
    }
    let all = lit.parts();
    let blocks = all.rays.iter_mut().zip(all.blocks).zip(between).enumerate();
    for (at, ((rays, block), between)) in blocks {
        if between.asked == 0 || sharp.is_some() && !between.odd {
            continue;
        }
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
