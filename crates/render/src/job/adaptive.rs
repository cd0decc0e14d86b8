// SPDX-License-Identifier: MIT OR Apache-2.0
//! Where an adaptive picture needs more samples.
//!
//! Every pixel gets `samples` samples. A pixel is refined, once, to `max_samples`, where these base
//! samples differ among themselves or from those of one of its eight neighbours: in colour, in the
//! object that they hit, or in its normal. The decision uses nothing but the base samples of the 3 x 3
//! neighbourhood, which are shot outside a crop too: a crop equals the same region of the whole.
//!
//! Colours are compared as a display would show them: cut off at 0 and 1, then the square root, which
//! is near to sRGB's curve. Light far above white on both sides of an edge makes no difference.

use std::sync::atomic::AtomicBool;

use dioptric_math::DVec3;

use super::{Region, Shoot, Shot};
use crate::film::{FilmPixel, Radiance};
use crate::sampling::{Antialias, pixel_sample};
use crate::setting::render::RenderSettings;
use crate::stats::RayCounts;

/// Cosine of the angle between normals from which on they differ: about 20 degrees.
pub const NORMAL_LIMIT: f64 = 0.94;

/// What the decision needs to know of a pixel's base samples.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Summary {
    /// The pixel's colour as shown.
    shown: [f32; 3],
    /// Smallest and largest channels of single samples, as shown.
    low: [f32; 3],
    high: [f32; 3],
    normal: [f32; 3],
    object: u32,
    /// Whether the pixel's own samples differ in object or normal.
    uneven: bool,
    count: u32,
}

impl Summary {
    /// Adds the next base sample.
    pub fn add(&mut self, radiance: &Radiance) {
        let shown = shown(radiance.color);
        let normal = radiance.first.normal.to_array().map(|c| c as f32);
        if self.count == 0 {
            (self.low, self.high) = (shown, shown);
            (self.object, self.normal) = (radiance.first.object, normal);
        }
        for (axis, value) in shown.into_iter().enumerate() {
            self.low[axis] = self.low[axis].min(value);
            self.high[axis] = self.high[axis].max(value);
        }
        self.uneven |= radiance.first.object != self.object || bent(self.normal, normal);
        self.count += 1;
    }

    /// Takes the colour of the whole pixel, when all its base samples are there.
    pub fn finish(&mut self, pixel: &FilmPixel) {
        self.shown = shown(pixel.linear());
    }

    fn is_uneven(&self, threshold: f64) -> bool {
        self.uneven || apart(self.low, self.high, threshold)
    }

    fn differs(&self, other: &Self, threshold: f64) -> bool {
        self.object != other.object
            || bent(self.normal, other.normal)
            || apart(self.shown, other.shown, threshold)
    }
}

/// Light as a display would show it, nearly. NaN counts as black.
fn shown(color: DVec3) -> [f32; 3] {
    color.to_array().map(|c| if c > 0.0 { c.min(1.0).sqrt() as f32 } else { 0.0 })
}

fn apart(a: [f32; 3], b: [f32; 3], threshold: f64) -> bool {
    a.iter().zip(b).any(|(a, b)| f64::from((a - b).abs()) > threshold)
}

/// Whether normals differ; nothing and nothing do not.
fn bent(a: [f32; 3], b: [f32; 3]) -> bool {
    let dot: f64 = a.iter().zip(b).map(|(a, b)| f64::from(*a) * f64::from(b)).sum();
    a != b && dot < NORMAL_LIMIT
}

/// Whether a pixel is to be refined; `summaries` are those of `around`, row by row.
pub(super) fn wants_more(
    settings: &RenderSettings,
    around: &Region,
    summaries: &[Summary],
    pixel: [u32; 2],
) -> bool {
    let at = |x, y| around.index(x, y).and_then(|i| summaries.get(i));
    let Some(own) = at(pixel[0], pixel[1]) else { return false };
    let neighbours = Region { x: pixel[0], y: pixel[1], width: 1, height: 1 }.grown(settings.size);
    settings.max_samples > settings.samples
        && (own.is_uneven(settings.threshold)
            || neighbours
                .pixels()
                .filter_map(|[x, y]| at(x, y))
                .any(|other| own.differs(other, settings.threshold)))
}

/// How many samples a pixel of the picture gets. For adaptive pictures this shoots the base samples of
/// its neighbourhood.
#[must_use]
pub fn samples_of_pixel(settings: &RenderSettings, pixel: [u32; 2], shoot: &dyn Shoot) -> u32 {
    if settings.antialias != Antialias::Adaptive {
        return settings.samples;
    }
    let around = Region { x: pixel[0], y: pixel[1], width: 1, height: 1 }.grown(settings.size);
    let summaries: Vec<Summary> = around
        .pixels()
        .map(|place| {
            let (mut film, mut summary) = (FilmPixel::default(), Summary::default());
            let shots: Vec<Shot> = (0..settings.samples)
                .map(|index| pixel_sample(settings, place, index))
                .map(|(sample, stream)| Shot { sample, stream })
                .collect();
            let mut radiances = Vec::new();
            let never = AtomicBool::new(false);
            shoot.shoot(&shots, &mut RayCounts::default(), &never, &mut radiances);
            for (shot, radiance) in shots.iter().zip(&radiances) {
                film.add(shot.sample.weight, radiance);
                summary.add(radiance);
            }
            summary.finish(&film);
            summary
        })
        .collect();
    if wants_more(settings, &around, &summaries, pixel) {
        settings.max_samples
    } else {
        settings.samples
    }
}
