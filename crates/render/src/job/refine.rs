// SPDX-License-Identifier: MIT OR Apache-2.0
//! The second pass of adaptive pictures: more samples for the pixels that want them.
//!
//! These pixels are few in each tile, so that they are put in a row, tile after tile, and shared out in parts that fill
//! batches of samples: rays are cast fastest together.

use std::sync::{Mutex, PoisonError};

use rayon::ThreadPool;

use super::adaptive::{self, Summary};
use super::pass::{BATCH, Sampled, blocks, sample, work_through};
use super::{Control, PassProgress, Region, Shoot, State, lock};
use crate::film::FilmPixel;
use crate::setting::render::RenderSettings;

/// The most samples of a part, in batches: what is left over of the last one should not matter.
const BATCHES: usize = 8;

/// Parts that each thread gets at least, so that all are done at about the same time.
const PARTS_EACH: usize = 8;

/// Samples the pixels that want it further.
pub(super) fn refine(
    settings: &RenderSettings,
    around: &Region,
    pool: &ThreadPool,
    shoot: &dyn Shoot,
    control: &Control,
    state: &mut State,
) {
    let summaries = std::mem::take(&mut state.summaries);
    let Some(chosen) = choose(settings, around, &summaries, pool, control, state) else { return };
    state.progress = PassProgress { pass: 1, passes: 2, done: 0, total: chosen.len() as u64 };
    let each = settings.max_samples.saturating_sub(settings.samples).max(1) as usize;
    let fair = chosen.len() / (pool.current_num_threads() * PARTS_EACH);
    let length = (BATCHES * BATCH / each).min(fair).max(BATCH / each).max(1);
    let parts: Vec<&[[u32; 2]]> = chosen.chunks(length).collect();
    let shared = Mutex::new(state);
    work_through(pool, &parts, control, |places: &[[u32; 2]]| {
        let base: Vec<FilmPixel> = {
            let film = &lock(&shared).film;
            places.iter().map(|&[x, y]| film.pixel(x, y).copied().unwrap_or_default()).collect()
        };
        let own = |[x, y]: [u32; 2]| around.index(x, y).and_then(|i| summaries.get(i)).copied();
        let sampled = refine_part(settings, places, base, own, shoot, control);
        lock(&shared).store_refined(places, &sampled, control);
    });
}

/// Decides for every pixel, marks those that are finished, and returns the others, tile after tile; nothing if
/// cancelled meanwhile.
fn choose(
    settings: &RenderSettings,
    around: &Region,
    summaries: &[Summary],
    pool: &ThreadPool,
    control: &Control,
    state: &mut State,
) -> Option<Vec<[u32; 2]>> {
    let tiles = state.film.region().tiles();
    let chosen = Mutex::new(Vec::new());
    let film = Mutex::new(&mut state.film);
    let complete = work_through(pool, &tiles, control, |tile| {
        let (wanted, even): (Vec<_>, Vec<_>) = blocks(&tile)
            .into_iter()
            .partition(|&place| adaptive::wants_more(settings, around, summaries, place));
        let mut film = lock(&film);
        for [x, y] in even {
            if let Some(pixel) = film.pixel_mut(x, y) {
                pixel.finished = true;
            }
        }
        if !wanted.is_empty() {
            lock(&chosen).push((tile, wanted));
        }
    });
    let mut chosen = chosen.into_inner().unwrap_or_else(PoisonError::into_inner);
    chosen.sort_by_key(|(tile, _)| (tile.y, tile.x));
    complete.then(|| chosen.into_iter().flat_map(|(_, wanted)| wanted).collect())
}

/// Gives pixels their first share of samples, and the rest to those that are uneven by then; `own` is the summary of a
/// pixel's base samples.
fn refine_part(
    settings: &RenderSettings,
    places: &[[u32; 2]],
    base: Vec<FilmPixel>,
    own: impl Fn([u32; 2]) -> Option<Summary>,
    shoot: &dyn Shoot,
    control: &Control,
) -> Sampled {
    let share = adaptive::first_share(settings);
    let samples = settings.samples..share;
    let all = places.iter().copied().enumerate();
    let mut sampled = sample(settings, all, base, samples, shoot, control);
    if share == settings.max_samples {
        return sampled;
    }
    let uneven = |&i: &usize| {
        let summary = own(places[i]).zip(sampled.summaries.get(i));
        sampled.complete[i]
            && summary.is_some_and(|(own, later)| own.with(later).is_uneven(settings.threshold))
    };
    let wanted: Vec<usize> = (0..places.len()).filter(uneven).collect();
    let base = wanted.iter().map(|&i| sampled.pixels[i]).collect();
    let rest = wanted.iter().map(|&i| places[i]).enumerate();
    let more = sample(settings, rest, base, share..settings.max_samples, shoot, control);
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
    fn store_refined(&mut self, places: &[[u32; 2]], sampled: &Sampled, control: &Control) {
        let [mut low, mut high] = [[u32::MAX; 2], [0; 2]];
        for ((&[x, y], pixel), _) in
            places.iter().zip(&sampled.pixels).zip(&sampled.complete).filter(|(_, done)| **done)
        {
            if let Some(slot) = self.film.pixel_mut(x, y) {
                *slot = *pixel;
                slot.finished = true;
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
