// SPDX-License-Identifier: MIT OR Apache-2.0
//! One pass over tiles: threads take the next tile until there is none.

use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::ThreadPool;

use super::adaptive::Summary;
use super::{Control, Region, Shoot, Shot};
use crate::film::{FilmPixel, Radiance};
use crate::sampling::{Antialias, pixel_sample};
use crate::setting::render::RenderSettings;
use crate::stats::RayCounts;

/// The samples of one tile.
pub(super) struct Sampled {
    pub region: Region,
    /// Row by row.
    pub pixels: Vec<FilmPixel>,
    /// Which of them got all their samples; the others were left alone or cut off.
    pub complete: Vec<bool>,
    /// Row by row, of adaptive pictures; else empty.
    pub summaries: Vec<Summary>,
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

/// Samples that are shot together: enough to make packets of rays of all kinds, few enough for what is kept
/// of them to stay in the processor's second cache.
const BATCH: usize = 512;

/// Side of the blocks in which a tile's pixels are taken: rays that are next to each other in a batch should
/// be so in the picture, in both directions.
const BLOCK: u32 = 4;

/// Adds samples to the pixels of a tile: to new ones, or to those of `base` that are not finished.
pub(super) fn sample_tile(
    settings: &RenderSettings,
    tile: Region,
    samples: Range<u32>,
    base: Option<Vec<FilmPixel>>,
    shoot: &dyn Shoot,
    control: &Control,
) -> Sampled {
    let count = tile.area() as usize;
    let mut work = Work {
        shoot,
        control,
        base: base.unwrap_or_else(|| vec![FilmPixel::default(); count]),
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
    for [x, y] in blocks(&tile) {
        let Some(pixel) = tile.index(x, y) else { continue };
        if work.base[pixel].finished {
            continue;
        }
        for index in samples.clone() {
            let (sample, stream) = pixel_sample(settings, [x, y], index);
            work.shots.push(Shot { sample, stream });
            work.pixels_of.push(pixel);
            if work.shots.len() == BATCH && !work.shoot_batch() {
                return work.finish(tile);
            }
        }
    }
    work.shoot_batch();
    work.finish(tile)
}

/// The pixels of a tile, block by block.
fn blocks(tile: &Region) -> Vec<[u32; 2]> {
    let mut pixels = Vec::with_capacity(tile.area() as usize);
    let ends = |start: u32, length: u32| (start + BLOCK).min(length);
    for top in (0..tile.height).step_by(BLOCK as usize) {
        for left in (0..tile.width).step_by(BLOCK as usize) {
            for row in top..ends(top, tile.height) {
                for column in left..ends(left, tile.width) {
                    pixels.push([tile.x + column, tile.y + row]);
                }
            }
        }
    }
    pixels
}

/// A tile being sampled.
struct Work<'a> {
    shoot: &'a dyn Shoot,
    control: &'a Control<'a>,
    /// The pixels with what was added.
    base: Vec<FilmPixel>,
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
        for ((shot, radiance), &pixel) in
            self.shots.iter().zip(&self.radiances).zip(&self.pixels_of)
        {
            self.base[pixel].add(shot.sample.weight, radiance);
            if let Some(summary) = self.summaries.get_mut(pixel) {
                summary.add(radiance);
            }
            self.added[pixel] += 1;
        }
        let complete = self.radiances.len() == self.shots.len();
        self.shots.clear();
        self.pixels_of.clear();
        complete
    }

    /// The pixels that got all their samples.
    fn finish(self, region: Region) -> Sampled {
        let Self { base, wanted, mut summaries, added, rays, .. } = self;
        for (summary, pixel) in summaries.iter_mut().zip(&base) {
            summary.finish(pixel);
        }
        let complete = base.iter().zip(added).map(|(p, n)| n == wanted && !p.finished).collect();
        Sampled { region, pixels: base, complete, summaries, rays }
    }
}
