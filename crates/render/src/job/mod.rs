// SPDX-License-Identifier: MIT OR Apache-2.0
//! Making a picture: tiles over threads, progress, and a way to stop.
//!
//! A pixel's samples are added in order by one thread, so its bits do not depend on how the work is shared.
//! Samples of neighbouring pixels are shot together: see [`pass`]. Adaptive pictures are made in two passes: all pixels
//! with few samples, then more ([`refine`](mod@refine)) for those that the first pass picked ([`adaptive`]).

pub mod adaptive;
mod borders;
mod pass;
mod refine;

use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use dioptric_scene::Diagnostic;
use rayon::ThreadPool;

pub use adaptive::samples_of_pixel;

use self::pass::{Sampled, sample_tile, work_through};
use self::refine::{Choice, Wanted, choose_within, refine};
use crate::film::{Film, Radiance};
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
    /// Whether the film keeps what the camera rays hit first, for layers.
    pub layers: bool,
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
    /// The tile that was finished just now; in the second pass the rectangle around pixels that were.
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
        film: pool.install(|| Film::new(region, control.layers))?,
        choice: if adaptive { Some(pool.install(|| Choice::new(around))?) } else { None },
        progress: PassProgress {
            pass: 0,
            passes: 1 + u32::from(adaptive),
            done: 0,
            total: around.area(),
        },
    };
    let shared = Mutex::new(&mut state);
    let side = around.tile_side();
    let samples = 0..settings.samples;
    let complete = work_through(pool, &around.tiles(), control, |tile| {
        let all = |_| true;
        let mut sampled = sample_tile(settings, tile, samples.clone(), all, shoot, control);
        let mut wanted = Vec::new();
        if adaptive {
            wanted = choose_within(settings, &tile, side, &mut sampled);
        }
        lock(&shared).store(tile, &sampled, wanted, control);
    });
    if let Some(choice) = state.choice.take().filter(|_| complete) {
        refine(settings, choice, pool, shoot, control, &mut state);
    }
    Ok(state.film)
}

/// Gives all pixels of a film that are not finished these samples, which are the first that they get; they are finished then.
/// When cancelled, pixels that were cut off are left as they were.
#[must_use]
pub fn render_samples(
    settings: &RenderSettings,
    samples: Range<u32>,
    film: Film,
    pool: &ThreadPool,
    shoot: &dyn Shoot,
    control: &Control,
) -> Film {
    let region = film.region();
    let waits = |film: &Film, [x, y]: [u32; 2]| film.pixel(x, y).is_some_and(|p| !p.is_finished());
    let mut tiles = region.tiles();
    tiles.retain(|tile| tile.pixels().any(|place| waits(&film, place)));
    let total = film.pixels().iter().filter(|p| !p.is_finished()).count() as u64;
    let progress = PassProgress { pass: 0, passes: 1, done: 0, total };
    let mut state = State { film, choice: None, progress };
    let shared = Mutex::new(&mut state);
    work_through(pool, &tiles, control, |tile| {
        let waiting: Vec<bool> = {
            let film = &lock(&shared).film;
            tile.pixels().map(|place| waits(film, place)).collect()
        };
        let wanted = |pixel: usize| waiting.get(pixel).copied().unwrap_or(false);
        let sampled = sample_tile(settings, tile, samples.clone(), wanted, shoot, control);
        lock(&shared).store(tile, &sampled, Vec::new(), control);
    });
    state.film
}

/// The samples of a pixel that has `count` of them, stage by stage, as they are added up.
#[must_use]
pub fn stages(settings: &RenderSettings, count: u32) -> Vec<Range<u32>> {
    let ends = match settings.antialias {
        Antialias::Adaptive => [settings.samples, adaptive::first_share(settings), count],
        _ => [count; 3],
    };
    let starts = [0, ends[0], ends[1]];
    let stages = starts.into_iter().zip(ends).map(|(start, end)| start..end.min(count));
    stages.filter(|stage| !stage.is_empty()).collect()
}

fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What the threads write into.
struct State {
    film: Film,
    /// What is to be refined, of adaptive pictures.
    choice: Option<Choice>,
    progress: PassProgress,
}

struct PassProgress {
    pass: u32,
    passes: u32,
    done: u64,
    total: u64,
}

impl State {
    /// Stores the first samples of a tile, and which of its pixels want more.
    fn store(&mut self, region: Region, tile: &Sampled, wanted: Vec<Wanted>, control: &Control) {
        let Region { x, y, width, height } = region;
        for row in 0..height {
            let own = row as usize * width as usize..(row as usize + 1) * width as usize;
            let (Some(pixels), Some(complete)) =
                (tile.pixels.get(own.clone()), tile.complete.get(own.clone()))
            else {
                continue;
            };
            let firsts = tile.firsts.get(own).unwrap_or_default();
            let done = complete.iter().filter(|complete| **complete).count();
            self.progress.done += done as u64;
            if done == pixels.len()
                && let Some((slots, first_slots)) = self.film.row_mut(x, y + row, width)
            {
                slots.copy_from_slice(pixels);
                first_slots.into_iter().flatten().zip(firsts).for_each(|(slot, new)| *slot = *new);
                continue;
            }
            // Tiles of what is around the film may stick out of it, and some pixels may be cut off.
            for (column, (pixel, _)) in
                pixels.iter().zip(complete).enumerate().filter(|(_, (_, complete))| **complete)
            {
                let slots = self.film.slots(x + column as u32, y + row);
                if let Some((slot, first)) = slots {
                    *slot = *pixel;
                    first.into_iter().zip(firsts.get(column)).for_each(|(slot, new)| *slot = *new);
                }
            }
        }
        if let Some(choice) = &mut self.choice {
            choice.note(&region, tile, wanted);
        }
        self.film.rays.add(&tile.rays);
        self.report(region, control);
    }

    /// Tells who watches the job that pixels of `tile` are done.
    fn report(&self, tile: Region, control: &Control) {
        if let Some(report) = control.on_progress {
            let PassProgress { pass, passes, done, total } = self.progress;
            let (rays, film) = (self.film.rays, &self.film);
            report(&Progress { pass, passes, done, total, rays, tile, film });
        }
    }
}

#[cfg(test)]
mod tests;
