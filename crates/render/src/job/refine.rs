// SPDX-License-Identifier: MIT OR Apache-2.0
//! The second pass of adaptive pictures: more samples for the pixels that want them.
//!
//! What a tile's own pixels say of each other is decided as soon as the tile is there; only along its edges what is known
//! of pixels must wait for the tiles beside ([`Borders`]).
//!
//! The pixels to be refined are few in each tile, so that they are put in a row, tile after tile, and shared out in parts
//! that fill batches of samples: rays are cast fastest together.

use std::sync::Mutex;

use dioptric_scene::Diagnostic;
use rayon::ThreadPool;

use super::adaptive::{self, Summary};
use super::borders::{Borders, is_outer};
use super::pass::{BATCH, BLOCK, Sampled, blocks, sample, work_through};
use super::{Control, PassProgress, Region, Shoot, State, lock};
use crate::film::{Film, FilmPixel, FirstSums};
use crate::setting::render::RenderSettings;

/// The most samples of a part, in batches: what is left over of the last one should not matter.
const BATCHES: usize = 8;

/// Parts that each thread gets at least, so that all are done at about the same time.
const PARTS_EACH: usize = 8;

/// A pixel that wants more samples, and what is known of its first ones.
pub(super) type Wanted = ([u32; 2], Summary);

/// The pixels of a tile of this side (those at a region's end may be smaller) that want more samples by what the tile shows; these are not finished, nor are those that lie
/// beside other tiles.
pub(super) fn choose_within(
    settings: &RenderSettings,
    tile: &Region,
    side: u32,
    sampled: &mut Sampled,
) -> Vec<Wanted> {
    if settings.max_samples <= settings.samples {
        return Vec::new();
    }
    let wanted = adaptive::wanted_within(settings, tile, &sampled.summaries);
    for ((pixel, wanted), place) in sampled.pixels.iter_mut().zip(&wanted).zip(tile.pixels()) {
        pixel.set_finished(!wanted && !is_outer(side, place));
    }
    let found = blocks(tile)
        .into_iter()
        .filter_map(|(i, place)| (*wanted.get(i)?).then_some((place, *sampled.summaries.get(i)?)));
    found.collect()
}

/// What is to be refined, tile by tile.
pub(super) struct Choice {
    borders: Borders,
    side: u32,
    tiles: Vec<(Region, Vec<Wanted>)>,
}

impl Choice {
    /// Nothing yet of a region.
    ///
    /// # Errors
    /// There is not enough memory.
    pub fn new(around: Region) -> Result<Self, Diagnostic> {
        Ok(Self { borders: Borders::new(around)?, side: around.tile_side(), tiles: Vec::new() })
    }

    /// Notes what a tile shows.
    pub fn note(&mut self, tile: &Region, sampled: &Sampled, wanted: Vec<Wanted>) {
        for (pixel, summary) in tile.pixels().zip(&sampled.summaries) {
            self.borders.set(pixel, summary);
        }
        self.tiles.push((*tile, wanted));
    }

    /// Now that all tiles are there: all pixels of the film that are to be refined, tile after tile. The others are marked
    /// as finished.
    fn finish(mut self, settings: &RenderSettings, film: &mut Film) -> Vec<Wanted> {
        self.tiles.sort_by_key(|(tile, _)| (tile.y, tile.x));
        let (mut all, mut chosen) = (Vec::new(), Vec::new());
        let side = self.side;
        for (tile, wanted) in self.tiles {
            let first = all.len();
            all.extend(wanted.into_iter().filter(|([x, y], _)| film.pixel(*x, *y).is_some()));
            let inner = all.len();
            chosen.clear();
            chosen.resize(tile.area() as usize, false);
            for ([x, y], _) in &all[first..] {
                tile.index(*x, *y).into_iter().for_each(|i| chosen[i] = true);
            }
            let outer = tile.pixels().zip(&chosen).filter(|(place, _)| is_outer(side, *place));
            for (place, _) in outer.filter(|(_, chosen)| !**chosen) {
                let Some(pixel) = film.pixel_mut(place[0], place[1]) else { continue };
                let at = |place| self.borders.get(place);
                if adaptive::unlike_neighbour(settings, place, at) {
                    all.extend(at(place).map(|summary| (place, *summary)));
                } else {
                    pixel.set_finished(true);
                }
            }
            if all.len() > inner {
                all[first..].sort_by_key(|([x, y], _)| (y / BLOCK, x / BLOCK, *y, *x));
            }
        }
        all
    }
}

/// Samples the pixels that want it further.
pub(super) fn refine(
    settings: &RenderSettings,
    choice: Choice,
    pool: &ThreadPool,
    shoot: &dyn Shoot,
    control: &Control,
    state: &mut State,
) {
    if settings.max_samples <= settings.samples {
        return;
    }
    let chosen = choice.finish(settings, &mut state.film);
    state.progress = PassProgress { pass: 1, passes: 2, done: 0, total: chosen.len() as u64 };
    let each = (settings.max_samples - settings.samples) as usize;
    let fair = chosen.len() / (pool.current_num_threads() * PARTS_EACH);
    let length = (BATCHES * BATCH / each).min(fair).max(BATCH / each).max(1);
    let parts: Vec<&[Wanted]> = chosen.chunks(length).collect();
    let shared = Mutex::new(state);
    work_through(pool, &parts, control, |part: &[Wanted]| {
        let base: (Vec<FilmPixel>, Vec<FirstSums>) = {
            let film = &lock(&shared).film;
            let pixels = part.iter().map(|([x, y], _)| film.pixel(*x, *y).copied());
            let firsts = part.iter().filter_map(|([x, y], _)| film.first(*x, *y).copied());
            (pixels.map(Option::unwrap_or_default).collect(), firsts.collect())
        };
        let sampled = refine_part(settings, part, base, shoot, control);
        lock(&shared).store_refined(part, &sampled, control);
    });
}

/// Gives pixels their first share of samples, and the rest to those that are uneven by then.
fn refine_part(
    settings: &RenderSettings,
    part: &[Wanted],
    base: (Vec<FilmPixel>, Vec<FirstSums>),
    shoot: &dyn Shoot,
    control: &Control,
) -> Sampled {
    let share = adaptive::first_share(settings);
    let samples = settings.samples..share;
    let all = part.iter().map(|(place, _)| *place).enumerate();
    let mut sampled = sample(settings, all, base, samples, shoot, control);
    if share == settings.max_samples {
        return sampled;
    }
    let uneven = |&i: &usize| {
        let own = part[i].1.with(&sampled.summaries[i]);
        sampled.complete[i] && own.is_uneven(settings.threshold)
    };
    let wanted: Vec<usize> = (0..part.len()).filter(uneven).collect();
    let pixels = wanted.iter().map(|&i| sampled.pixels[i]).collect();
    let firsts = wanted.iter().filter_map(|&i| sampled.firsts.get(i).copied()).collect();
    let rest = wanted.iter().map(|&i| part[i].0).enumerate();
    let more =
        sample(settings, rest, (pixels, firsts), share..settings.max_samples, shoot, control);
    for (&i, first) in wanted.iter().zip(more.firsts) {
        sampled.firsts[i] = first;
    }
    for ((i, pixel), complete) in wanted.into_iter().zip(more.pixels).zip(more.complete) {
        sampled.pixels[i] = pixel;
        // Not where it was cancelled meanwhile.
        sampled.complete[i] = complete;
    }
    sampled.rays.add(&more.rays);
    sampled
}

impl State {
    /// Stores pixels with all their samples.
    fn store_refined(&mut self, part: &[Wanted], sampled: &Sampled, control: &Control) {
        let [mut low, mut high] = [[u32::MAX; 2], [0; 2]];
        for (i, &([x, y], _)) in part.iter().enumerate().filter(|(i, _)| sampled.complete[*i]) {
            if let Some((slot, first)) = self.film.slots(x, y) {
                *slot = sampled.pixels[i];
                slot.set_finished(true);
                first.into_iter().zip(sampled.firsts.get(i)).for_each(|(slot, new)| *slot = *new);
            }
            (low, high) = ([low[0].min(x), low[1].min(y)], [high[0].max(x), high[1].max(y)]);
            self.progress.done += 1;
        }
        self.film.rays.add(&sampled.rays);
        if low[0] <= high[0] {
            let [width, height] = [high[0] - low[0] + 1, high[1] - low[1] + 1];
            self.report(Region { x: low[0], y: low[1], width, height }, control);
        }
    }
}
