// SPDX-License-Identifier: MIT OR Apache-2.0
//! Makes the samples that a part misses, block by block.

use std::ops::Range;

use dioptric_scene::Diagnostic;
use rayon::ThreadPool;

use super::Part;
use crate::film::{Film, pieces::blocks_of};
use crate::job::{self, Control, Shoot};
use crate::setting::render::RenderSettings;

/// How far a part is.
#[derive(Clone, Copy, Debug)]
pub struct Progress<'a> {
    /// What is complete.
    pub part: &'a Part,
    /// The samples that are being made.
    pub block: &'a Range<u32>,
    /// How far they are.
    pub job: &'a job::Progress<'a>,
    /// Samples of a pixel that were missing at the beginning, and how many of them have been made before this block.
    pub total: u32,
    /// See `total`.
    pub before: u32,
}

/// What shall be made.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Wanted {
    /// The samples of each pixel.
    pub samples: Range<u32>,
    /// The most samples of a block, a power of two: with few the first picture of all pixels is soon there, and no tile takes
    /// long.
    pub most: u32,
}

/// Makes the samples that a part misses, block by block. True if all are there; false where it was cancelled.
///
/// `watch` is called after every tile, by one thread at a time, and after every block.
///
/// # Errors
/// There is not enough memory.
pub fn render(
    settings: &RenderSettings,
    wanted: &Wanted,
    part: &mut Part,
    pool: &ThreadPool,
    shoot: &dyn Shoot,
    control: &Control,
    watch: &(dyn Fn(&Progress<'_>) + Sync),
) -> Result<bool, Diagnostic> {
    let Wanted { samples: wanted, most } = wanted;
    let most = *most;
    let begun = part.begun.take();
    let missing = part.missing(wanted);
    let total = missing.iter().map(|range| range.len() as u32).sum();
    let mut before = 0;
    // What was begun is gone on with, where its samples are still wanted.
    let first = begun.filter(|(block, _)| {
        missing.iter().any(|range| range.start <= block.start && block.end <= range.end)
    });
    let mut blocks: Vec<Range<u32>> = match &first {
        None => missing.into_iter().flat_map(|range| blocks_of(range, most)).collect(),
        Some((begun, _)) => {
            let around = missing.into_iter().flat_map(|range| {
                let inside = range.start <= begun.start && begun.end <= range.end;
                let parts = if inside {
                    vec![range.start..begun.start, begun.end..range.end]
                } else {
                    vec![range]
                };
                parts.into_iter().flat_map(|range| blocks_of(range, most))
            });
            std::iter::once(begun.clone()).chain(around).collect()
        }
    };
    blocks.dedup();
    let mut first = first.map(|(_, film)| film);
    for block in blocks {
        let film = match first.take() {
            Some(film) => film,
            None => pool.install(|| Film::new(part.region, part.layers))?,
        };
        let show = |job: &job::Progress<'_>| {
            watch(&Progress { part, block: &block, job, total, before });
        };
        let inner = Control {
            layers: part.layers,
            cancel: control.cancel.clone(),
            on_progress: Some(&show),
        };
        let film = job::render_samples(settings, block.clone(), film, pool, shoot, &inner);
        if !film.finished() {
            part.begun = Some((block, film));
            return Ok(false);
        }
        before += block.len() as u32;
        part.insert(block, film);
    }
    Ok(true)
}
