// SPDX-License-Identifier: MIT OR Apache-2.0
//! One pass over tiles: threads take the next tile until there is none.

use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::ThreadPool;

use super::adaptive::Summary;
use super::{Control, Region, Shoot, Shot};
use crate::film::{FilmPixel, FirstSums, PixelSum, Radiance};
use crate::sampling::pixel::{is_middle, middle_sample};
use crate::sampling::{Antialias, pixel_sample};
use crate::setting::render::RenderSettings;
use crate::stats::RayCounts;

/// The samples of some pixels, in the order in which these were given: of a tile row by row.
pub(super) struct Sampled {
    pub pixels: Vec<FilmPixel>,
    /// What their camera rays hit first, where that is kept; else empty.
    pub firsts: Vec<FirstSums>,
    /// Which of them got all their samples; the others were cut off.
    pub complete: Vec<bool>,
    /// Of what was added here, in adaptive pictures; else empty.
    pub summaries: Vec<Summary>,
    pub rays: RayCounts,
}

/// Runs `work` on every part (a tile, some pixels), in order as far as threads allow; false where it was cancelled.
pub(super) fn work_through<T: Copy + Sync>(
    pool: &ThreadPool,
    parts: &[T],
    control: &Control,
    work: impl Fn(T) + Sync,
) -> bool {
    let next = AtomicUsize::new(0);
    let worker = || {
        while let Some(part) = parts.get(next.fetch_add(1, Ordering::Relaxed)) {
            if is_cancelled(control) {
                return;
            }
            work(*part);
        }
    };
    pool.scope(|scope| {
        for _ in 0..pool.current_num_threads().min(parts.len()) {
            scope.spawn(|_| worker());
        }
    });
    !is_cancelled(control)
}

fn is_cancelled(control: &Control) -> bool {
    control.cancel.load(Ordering::Relaxed)
}

/// Samples that are shot together: enough to make packets of rays of all kinds, few enough for what is kept
/// of them to stay in the processor's second cache.
pub(super) const BATCH: usize = 512;

/// Side of the blocks in which a tile's pixels are taken: rays that are next to each other in a batch should
/// be so in the picture, in both directions.
pub(super) const BLOCK: u32 = 4;

/// Takes the first samples of a tile's pixels, of those that are `wanted` by their numbers in the tile; they are finished
/// then.
pub(super) fn sample_tile(
    settings: &RenderSettings,
    tile: Region,
    samples: Range<u32>,
    wanted: impl Fn(usize) -> bool,
    shoot: &dyn Shoot,
    control: &Control,
) -> Sampled {
    let count = tile.area() as usize;
    let places = blocks(&tile).into_iter().filter(|(pixel, _)| wanted(*pixel));
    let mut new = FilmPixel::default();
    new.set_finished(true);
    let firsts = if control.layers { vec![FirstSums::default(); count] } else { Vec::new() };
    sample(settings, places, (vec![new; count], firsts), samples, shoot, control)
}

/// Adds samples to pixels; `places` are their numbers in `base` and in the picture, in the order of shooting.
pub(super) fn sample(
    settings: &RenderSettings,
    places: impl Iterator<Item = (usize, [u32; 2])>,
    (base, firsts): (Vec<FilmPixel>, Vec<FirstSums>),
    samples: Range<u32>,
    shoot: &dyn Shoot,
    control: &Control,
) -> Sampled {
    let count = base.len();
    let mut work = Work {
        shoot,
        control,
        base,
        firsts,
        sum: PixelSum::new(control.layers),
        first: samples.start,
        wanted: samples.len() as u32,
        shots: Vec::with_capacity(BATCH),
        pixels_of: Vec::with_capacity(BATCH),
        radiances: Vec::with_capacity(BATCH),
        summaries: match settings.antialias {
            Antialias::Adaptive => vec![Summary::default(); count],
            _ => Vec::new(),
        },
        added: vec![0; count],
        rays: RayCounts::default(),
    };
    let middle = is_middle(settings);
    for (pixel, place) in places {
        for index in samples.clone() {
            if middle {
                let (sample, stream) = middle_sample(settings, place, index);
                work.shots.push(Shot { sample, stream });
            } else {
                let (sample, stream) = pixel_sample(settings, place, index);
                work.shots.push(Shot { sample, stream });
            }
            work.pixels_of.push(pixel);
            if work.shots.len() == BATCH && !work.shoot_batch() {
                return work.finish();
            }
        }
    }
    work.shoot_batch();
    work.finish()
}

/// The pixels of a tile, block by block: their numbers in the tile, and where they are.
pub(super) fn blocks(tile: &Region) -> Vec<(usize, [u32; 2])> {
    let mut pixels = Vec::with_capacity(tile.area() as usize);
    let ends = |start: u32, length: u32| (start + BLOCK).min(length);
    for top in (0..tile.height).step_by(BLOCK as usize) {
        for left in (0..tile.width).step_by(BLOCK as usize) {
            for row in top..ends(top, tile.height) {
                for column in left..ends(left, tile.width) {
                    let number = row as usize * tile.width as usize + column as usize;
                    pixels.push((number, [tile.x + column, tile.y + row]));
                }
            }
        }
    }
    pixels
}

/// Pixels being sampled.
struct Work<'a> {
    shoot: &'a dyn Shoot,
    control: &'a Control<'a>,
    /// The pixels with what was added.
    base: Vec<FilmPixel>,
    firsts: Vec<FirstSums>,
    /// The pixel that is being added up: all samples of one come before those of the next.
    sum: PixelSum,
    /// The first sample that each pixel gets.
    first: u32,
    /// How many samples each pixel gets.
    wanted: u32,
    shots: Vec<Shot>,
    /// Which pixel each shot belongs to.
    pixels_of: Vec<usize>,
    radiances: Vec<Radiance>,
    summaries: Vec<Summary>,
    /// How many samples each pixel got.
    added: Vec<u32>,
    rays: RayCounts,
}

impl Work<'_> {
    /// Shoots what has been collected; false where that was cancelled.
    fn shoot_batch(&mut self) -> bool {
        self.radiances.clear();
        if !is_cancelled(self.control) {
            let cancel = &self.control.cancel;
            self.shoot.shoot(&self.shots, &mut self.rays, cancel, &mut self.radiances);
        }
        let only = self.wanted == 1 && self.firsts.is_empty() && self.summaries.is_empty();
        for ((shot, radiance), &pixel) in
            self.shots.iter().zip(&self.radiances).zip(&self.pixels_of)
        {
            let base = &mut self.base[pixel];
            if only && base.count() == 0 {
                // What it comes to, without a sum.
                let finished = base.is_finished();
                *base = FilmPixel::of(shot.sample.weight, radiance);
                base.set_finished(finished);
                self.added[pixel] = 1;
                continue;
            }
            if self.added[pixel] == 0 {
                self.sum.start(self.first, &self.base[pixel], self.firsts.get(pixel));
            }
            self.sum.add(shot.sample.weight, radiance);
            if let Some(summary) = self.summaries.get_mut(pixel) {
                summary.add(radiance);
            }
            self.added[pixel] += 1;
            if self.added[pixel] == self.wanted {
                let (sum, firsts) = self.sum.finish();
                self.base[pixel] = sum;
                if let Some(slot) = self.firsts.get_mut(pixel) {
                    *slot = firsts;
                }
            }
        }
        let complete = self.radiances.len() == self.shots.len();
        self.shots.clear();
        self.pixels_of.clear();
        complete
    }

    /// The pixels that got all their samples.
    fn finish(self) -> Sampled {
        let Self { base, firsts, wanted, mut summaries, added, rays, .. } = self;
        for (summary, pixel) in summaries.iter_mut().zip(&base) {
            summary.finish(pixel);
        }
        let complete = added.into_iter().map(|n| n == wanted).collect();
        Sampled { pixels: base, firsts, complete, summaries, rays }
    }
}
