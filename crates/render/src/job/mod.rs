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
        film: pool.install(|| Film::new(region))?,
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
        let mut sampled = sample_tile(settings, tile, samples.clone(), shoot, control);
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
        let width = width as usize;
        for row in 0..height as usize {
            let own = row * width..(row + 1) * width;
            let (Some(pixels), Some(complete)) =
                (tile.pixels.get(own.clone()), tile.complete.get(own))
            else {
                continue;
            };
            self.progress.done += complete.iter().filter(|complete| **complete).count() as u64;
            // Tiles of what is around the film may stick out of it.
            for (column, (pixel, _)) in
                pixels.iter().zip(complete).enumerate().filter(|(_, (_, complete))| **complete)
            {
                if let Some(slot) = self.film.pixel_mut(x + column as u32, y + row as u32) {
                    *slot = *pixel;
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
