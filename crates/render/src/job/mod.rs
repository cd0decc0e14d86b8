// SPDX-License-Identifier: MIT OR Apache-2.0
//! Making a picture: tiles over threads, progress, and a way to stop.
//!
//! A pixel's samples are added in order by one thread, so its bits do not depend on how the work is shared.
//! Samples of neighbouring pixels are shot together: see [`pass`]. Adaptive pictures are made in two passes: all pixels with few samples, then more
//! for those that the first pass picked (see [`adaptive`]).

pub mod adaptive;
mod pass;

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use dioptric_scene::Diagnostic;
use rayon::ThreadPool;

pub use adaptive::samples_of_pixel;

use self::adaptive::Summary;
use self::pass::{Sampled, sample_tile, work_through};
use crate::film::{Film, FilmPixel, Radiance, filled};
use crate::region::Region;
use crate::sampling::{Antialias, PixelSample, Stream};
use crate::setting::render::RenderSettings;
use crate::stats::RayCounts;

/// One camera sample to be shot.
#[derive(Clone, Copy, Debug)]
pub struct Shot {
    /// Where it lies.
    pub sample: PixelSample,
    /// The numbers for the rest of its way.
    pub stream: Stream,
}

/// Shoots camera samples.
pub trait Shoot: Sync {
    /// Appends the radiance of each shot, in order, and counts the rays; each radiance depends on its shot
    /// alone. Fewer than shots if cancelled meanwhile.
    fn shoot(
        &self,
        shots: &[Shot],
        rays: &mut RayCounts,
        cancel: &AtomicBool,
        out: &mut Vec<Radiance>,
    );
}

/// A function of one sample.
impl<F: Fn(&PixelSample, &mut Stream, &mut RayCounts) -> Radiance + Sync> Shoot for F {
    fn shoot(
        &self,
        shots: &[Shot],
        rays: &mut RayCounts,
        cancel: &AtomicBool,
        out: &mut Vec<Radiance>,
    ) {
        for shot in shots {
            if cancel.load(Ordering::Relaxed) {
                return;
            }
            out.push(self(&shot.sample, &mut { shot.stream }, rays));
        }
    }
}

/// How a job is watched and stopped.
#[derive(Clone, Default)]
pub struct Control<'a> {
    /// Set it to stop: the film so far comes back within about the time of one sample.
    pub cancel: Arc<AtomicBool>,
    /// Called after every tile, by one thread at a time.
    pub on_progress: Option<&'a (dyn Fn(&Progress<'_>) + Sync)>,
}

/// How far a job is.
#[derive(Clone, Copy, Debug)]
pub struct Progress<'a> {
    /// The pass that is being made, from 0.
    pub pass: u32,
    /// Passes in all: 2 for adaptive pictures, else 1.
    pub passes: u32,
    /// Pixels done in this pass.
    pub done: u64,
    /// Pixels of this pass.
    pub total: u64,
    /// Rays cast in the job so far.
    pub rays: RayCounts,
    /// The tile that was finished just now.
    pub tile: Region,
    /// The film so far.
    pub film: &'a Film,
}

/// Renders a region of a picture: the same bits for every pool, and for a pixel in every region.
///
/// When cancelled, the film is returned as it is: pixels without samples are black and transparent,
/// and [`Film::finished`] is false.
///
/// # Errors
/// There is not enough memory for the film.
pub fn render(
    settings: &RenderSettings,
    region: Region,
    pool: &ThreadPool,
    shoot: &dyn Shoot,
    control: &Control,
) -> Result<Film, Diagnostic> {
    let adaptive = settings.antialias == Antialias::Adaptive;
    let around = if adaptive { region.grown(settings.size) } else { region };
    let mut state = State {
        film: pool.install(|| Film::new(region))?,
        summaries: if adaptive { pool.install(|| filled(&around))? } else { Vec::new() },
        progress: PassProgress {
            pass: 0,
            passes: 1 + u32::from(adaptive),
            done: 0,
            total: around.area(),
        },
    };
    let shared = Mutex::new(&mut state);
    let samples = 0..settings.samples;
    let complete = work_through(pool, &around.tiles(), control, |tile| {
        let sampled = sample_tile(settings, tile, samples.clone(), None, shoot, control);
        lock(&shared).store(sampled, &around, !adaptive, control);
    });
    if adaptive && complete {
        refine(settings, &around, pool, shoot, control, &mut state);
    }
    Ok(state.film)
}

/// The second pass of adaptive pictures.
fn refine(
    settings: &RenderSettings,
    around: &Region,
    pool: &ThreadPool,
    shoot: &dyn Shoot,
    control: &Control,
    state: &mut State,
) {
    let summaries = std::mem::take(&mut state.summaries);
    let region = state.film.region();
    let chosen = Mutex::new(Vec::new());
    let film = Mutex::new(&mut state.film);
    // Decides for every pixel, and keeps the tiles in which there is something to do.
    let complete = work_through(pool, &region.tiles(), control, |tile| {
        let refined: Vec<bool> = tile
            .pixels()
            .map(|pixel| adaptive::wants_more(settings, around, &summaries, pixel))
            .collect();
        let mut film = lock(&film);
        for ([x, y], refined) in tile.pixels().zip(&refined) {
            if let Some(pixel) = film.pixel_mut(x, y) {
                pixel.finished = !refined;
            }
        }
        let count = refined.iter().filter(|r| **r).count() as u64;
        if count > 0 {
            lock(&chosen).push((tile, count));
        }
    });
    if !complete {
        return;
    }
    let mut chosen = chosen.into_inner().unwrap_or_else(PoisonError::into_inner);
    chosen.sort_by_key(|(tile, _)| (tile.y, tile.x));
    state.progress =
        PassProgress { pass: 1, passes: 2, done: 0, total: chosen.iter().map(|(_, n)| n).sum() };
    let tiles: Vec<Region> = chosen.into_iter().map(|(tile, _)| tile).collect();
    let shared = Mutex::new(state);
    work_through(pool, &tiles, control, |tile| {
        let base: Vec<_> = {
            let state = lock(&shared);
            tile.pixels()
                .map(|[x, y]| state.film.pixel(x, y).copied().unwrap_or_default())
                .collect()
        };
        let own = |[x, y]: [u32; 2]| around.index(x, y).and_then(|i| summaries.get(i)).copied();
        let sampled = refine_tile(settings, tile, base, own, shoot, control);
        lock(&shared).store(sampled, around, true, control);
    });
}

/// Gives the pixels of a tile that are not finished their first share of samples, and the rest to those that are uneven
/// by then; `own` is the summary of a pixel's base samples.
fn refine_tile(
    settings: &RenderSettings,
    tile: Region,
    base: Vec<FilmPixel>,
    own: impl Fn([u32; 2]) -> Option<Summary>,
    shoot: &dyn Shoot,
    control: &Control,
) -> Sampled {
    let share = adaptive::first_share(settings);
    let samples = settings.samples..share;
    let mut sampled = sample_tile(settings, tile, samples, Some(base), shoot, control);
    if share == settings.max_samples {
        return sampled;
    }
    let uneven = |i: usize, place| {
        let later = sampled.summaries.get(i)?;
        Some(own(place)?.with(later).is_uneven(settings.threshold))
    };
    let wanted: Vec<bool> = tile
        .pixels()
        .zip(&sampled.complete)
        .enumerate()
        .map(|(i, (place, complete))| *complete && uneven(i, place) == Some(true))
        .collect();
    let mut rest = sampled.pixels.clone();
    for (pixel, wanted) in rest.iter_mut().zip(&wanted) {
        pixel.finished = !wanted;
    }
    let more = sample_tile(settings, tile, share..settings.max_samples, Some(rest), shoot, control);
    for (i, wanted) in wanted.into_iter().enumerate() {
        if wanted && let Some(pixel) = more.pixels.get(i) {
            sampled.pixels[i] = *pixel;
            // Not where it was cancelled meanwhile.
            sampled.complete[i] = more.complete[i];
        }
    }
    sampled.rays.add(&more.rays);
    sampled.summaries.clear();
    sampled
}

fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What the threads write into.
struct State {
    film: Film,
    /// Of the region and its surroundings, row by row; adaptive pictures only.
    summaries: Vec<Summary>,
    progress: PassProgress,
}

struct PassProgress {
    pass: u32,
    passes: u32,
    done: u64,
    total: u64,
}

impl State {
    fn store(&mut self, tile: Sampled, around: &Region, finished: bool, control: &Control) {
        let Region { x, y, width, height } = tile.region;
        let width = width as usize;
        for row in 0..height as usize {
            let own = row * width..(row + 1) * width;
            let (Some(pixels), Some(complete)) =
                (tile.pixels.get(own.clone()), tile.complete.get(own.clone()))
            else {
                continue;
            };
            self.progress.done += complete.iter().filter(|complete| **complete).count() as u64;
            let summaries = tile.summaries.get(own).unwrap_or_default();
            let at = around.index(x, y + row as u32).unwrap_or(usize::MAX);
            let slots = self.summaries.get_mut(at..).unwrap_or_default();
            for ((slot, summary), complete) in slots.iter_mut().zip(summaries).zip(complete) {
                if *complete {
                    *slot = *summary;
                }
            }
            // Tiles of what is around the film may stick out of it.
            for (column, (pixel, _)) in
                pixels.iter().zip(complete).enumerate().filter(|(_, (_, complete))| **complete)
            {
                if let Some(slot) = self.film.pixel_mut(x + column as u32, y + row as u32) {
                    *slot = *pixel;
                    slot.finished = finished;
                }
            }
        }
        self.film.rays.add(&tile.rays);
        if let Some(report) = control.on_progress {
            let PassProgress { pass, passes, done, total } = self.progress;
            let (rays, film, tile) = (self.film.rays, &self.film, tile.region);
            report(&Progress { pass, passes, done, total, rays, tile, film });
        }
    }
}

#[cfg(test)]
mod tests;
