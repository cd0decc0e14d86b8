// SPDX-License-Identifier: MIT OR Apache-2.0
//! One pass over tiles: threads take the next tile until there is none.

use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::ThreadPool;

use super::adaptive::Summary;
use super::{Control, Region, Shoot};
use crate::film::FilmPixel;
use crate::sampling::pixel_sample;
use crate::setting::render::RenderSettings;
use crate::stats::RayCounts;

/// The samples of one tile.
pub(super) struct Sampled {
    pub region: Region,
    /// Row by row; `None` for pixels that were left alone.
    pub pixels: Vec<Option<(FilmPixel, Summary)>>,
    pub rays: RayCounts,
}

/// Runs `work` on every tile, in order as far as threads allow; false where it was cancelled.
pub(super) fn work_through(
    pool: &ThreadPool,
    tiles: &[Region],
    control: &Control,
    work: impl Fn(Region) + Sync,
) -> bool {
    let next = AtomicUsize::new(0);
    let worker = || {
        while let Some(tile) = tiles.get(next.fetch_add(1, Ordering::Relaxed)) {
            if is_cancelled(control) {
                return;
            }
            work(*tile);
        }
    };
    pool.scope(|scope| {
        for _ in 0..pool.current_num_threads().min(tiles.len()) {
            scope.spawn(|_| worker());
        }
    });
    !is_cancelled(control)
}

fn is_cancelled(control: &Control) -> bool {
    control.cancel.load(Ordering::Relaxed)
}

/// Adds samples to the pixels of a tile: to new ones, or to those of `base` that are not finished.
pub(super) fn sample_tile(
    settings: &RenderSettings,
    tile: Region,
    samples: Range<u32>,
    base: Option<Vec<FilmPixel>>,
    shoot: &Shoot,
    control: &Control,
) -> Sampled {
    let mut rays = RayCounts::default();
    let base = base.unwrap_or_else(|| vec![FilmPixel::default(); tile.area() as usize]);
    let pixels = tile
        .pixels()
        .zip(base)
        .map(|(place, pixel)| {
            if pixel.finished {
                return None;
            }
            sample_pixel(settings, place, pixel, samples.clone(), shoot, &mut rays, control)
        })
        .collect();
    Sampled { region: tile, pixels, rays }
}

/// Adds samples to a pixel, in order; `None` where that was cancelled.
fn sample_pixel(
    settings: &RenderSettings,
    place: [u32; 2],
    mut pixel: FilmPixel,
    samples: Range<u32>,
    shoot: &Shoot,
    rays: &mut RayCounts,
    control: &Control,
) -> Option<(FilmPixel, Summary)> {
    let mut summary = Summary::default();
    for index in samples {
        if is_cancelled(control) {
            return None;
        }
        let (sample, mut stream) = pixel_sample(settings, place, index);
        let radiance = shoot(&sample, &mut stream, rays);
        pixel.add(sample.weight, &radiance);
        summary.add(settings, &radiance);
    }
    summary.finish(settings, &pixel);
    Some((pixel, summary))
}
