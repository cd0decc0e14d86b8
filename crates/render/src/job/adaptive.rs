// SPDX-License-Identifier: MIT OR Apache-2.0
//! Where an adaptive picture needs more samples.
//!
//! Every pixel gets `samples` samples. A pixel is refined where these base samples differ among themselves
//! or from those of one of the four pixels beside it: in colour, in the thing that they hit, or in its
//! normal. The decision uses nothing but the base samples of these five pixels, which are shot outside a
//! crop too: a crop equals the same region of the whole.
//!
//! A pixel beside an edge is refined for its neighbour's sake and may be even itself. Therefore it gets its
//! share of the samples first ([`first_share`]), and the rest, up to `max_samples`, only where the samples that it
//! has by then differ among themselves.
//!
//! Polygons of one surface are one thing: another object is no edge where its own colour and its normal
//! are the same and its depth goes on.
//!
//! Colours are compared as a display would show them: cut off at 0 and 1, then the square root, which
//! is near to sRGB's curve. Light far above white on both sides of an edge makes no difference.

use std::sync::atomic::AtomicBool;

use dioptric_math::DVec3;

use super::{Region, Shoot, Shot};
use crate::film::{FilmPixel, FirstHit, PixelSum, Radiance};
use crate::sampling::{Antialias, pixel_sample};
use crate::setting::render::RenderSettings;
use crate::stats::RayCounts;

/// Cosine of the angle between normals from which on they differ: about 20 degrees.
pub const NORMAL_LIMIT: f64 = 0.94;

/// The step in depth, as a share of it, from which on the next object is not the same surface gone on.
const DEPTH_LIMIT: f32 = 0.02;

/// How many samples of a pixel that is refined are taken before it is asked again: the geometric mean of `samples` and
/// `max_samples`, at least 4.
#[must_use]
pub fn first_share(settings: &RenderSettings) -> u32 {
    let (least, most) = (settings.samples, settings.max_samples);
    let mean = (f64::from(least) * f64::from(most)).sqrt().ceil() as u32;
    mean.max(4).clamp(least.min(most), most)
}

/// What the decision needs to know of a pixel's base samples.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Summary {
    /// The pixel's colour as shown.
    shown: [f32; 3],
    /// Smallest and largest channels of single samples, as shown.
    low: [f32; 3],
    high: [f32; 3],
    thing: Thing,
    /// Whether the pixel's own samples differ in the thing that they hit or its normal.
    uneven: bool,
    count: u32,
}

/// What a sample hits.
#[derive(Clone, Copy, Debug, Default)]
struct Thing {
    object: u32,
    depth: f32,
    normal: [f32; 3],
    albedo: [f32; 3],
}

impl Thing {
    fn of(first: &FirstHit) -> Self {
        Self {
            object: first.object,
            depth: first.depth as f32,
            normal: first.normal.to_array().map(|c| c as f32),
            albedo: first.albedo.to_array().map(|c| c as f32),
        }
    }

    /// Whether the picture of the scene's surfaces has an edge between the two.
    fn differs(&self, other: &Self) -> bool {
        let same = self.object == other.object
            || self.albedo == other.albedo
                && (self.depth - other.depth).abs() <= DEPTH_LIMIT * self.depth.min(other.depth);
        !same || bent(self.normal, other.normal)
    }
}

impl Summary {
    /// Adds the next sample.
    pub fn add(&mut self, radiance: &Radiance) {
        let shown = shown(radiance.color);
        let thing = Thing::of(&radiance.first);
        if self.count == 0 {
            (self.low, self.high, self.thing) = (shown, shown, thing);
        }
        for (axis, value) in shown.into_iter().enumerate() {
            self.low[axis] = self.low[axis].min(value);
            self.high[axis] = self.high[axis].max(value);
        }
        self.uneven |= self.thing.differs(&thing);
        self.count += 1;
    }

    /// Takes the colour of the whole pixel, when all its base samples are there.
    pub fn finish(&mut self, pixel: &FilmPixel) {
        self.shown = shown(pixel.linear());
    }

    /// Whether its samples differ among themselves.
    pub fn is_uneven(&self, threshold: f64) -> bool {
        self.uneven || apart(self.low, self.high, threshold)
    }

    /// Takes in what came after, of the same pixel.
    pub fn with(mut self, later: &Self) -> Self {
        for axis in 0..3 {
            self.low[axis] = self.low[axis].min(later.low[axis]);
            self.high[axis] = self.high[axis].max(later.high[axis]);
        }
        self.uneven |= later.uneven || self.thing.differs(&later.thing);
        self.count += later.count;
        self
    }

    /// Whether there is an edge between two pixels.
    pub fn differs(&self, other: &Self, threshold: f64) -> bool {
        self.thing.differs(&other.thing) || apart(self.shown, other.shown, threshold)
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
    let dot = || a.iter().zip(b).map(|(a, b)| f64::from(*a) * f64::from(b)).sum::<f64>();
    a != b && dot() < NORMAL_LIMIT
}

/// Whether each pixel of a region is to be refined by what the region itself shows; `summaries` are its pixels', row by row.
pub(super) fn wanted_within(
    settings: &RenderSettings,
    region: &Region,
    summaries: &[Summary],
) -> Vec<bool> {
    let threshold = settings.threshold;
    let mut wanted: Vec<bool> = summaries.iter().map(|own| own.is_uneven(threshold)).collect();
    let width = region.width as usize;
    for (row, first) in (0..summaries.len()).step_by(width).enumerate() {
        for i in first..first + width {
            let left = (i > first).then(|| i - 1);
            let above = (row > 0).then(|| i - width);
            for other in [left, above].into_iter().flatten() {
                if summaries[i].differs(&summaries[other], threshold) {
                    (wanted[i], wanted[other]) = (true, true);
                }
            }
        }
    }
    wanted
}

/// Whether a pixel is to be refined for the sake of one of the four beside it, of which `at` knows the summaries.
pub(super) fn unlike_neighbour<'a>(
    settings: &RenderSettings,
    [x, y]: [u32; 2],
    at: impl Fn([u32; 2]) -> Option<&'a Summary>,
) -> bool {
    let Some(own) = at([x, y]) else { return false };
    let differs = |x: Option<u32>, y: Option<u32>| {
        let other = x.zip(y).and_then(|(x, y)| at([x, y]));
        other.is_some_and(|other| own.differs(other, settings.threshold))
    };
    differs(x.checked_sub(1), Some(y))
        || differs(x.checked_add(1), Some(y))
        || differs(Some(x), y.checked_sub(1))
        || differs(Some(x), y.checked_add(1))
}

/// How many samples a pixel of the picture gets. For adaptive pictures this shoots the base samples of
/// its neighbourhood.
#[must_use]
pub fn samples_of_pixel(settings: &RenderSettings, pixel: [u32; 2], shoot: &dyn Shoot) -> u32 {
    if settings.antialias != Antialias::Adaptive {
        return settings.samples;
    }
    let around = Region { x: pixel[0], y: pixel[1], width: 1, height: 1 }.grown(settings.size);
    let summary = |place: [u32; 2], samples: std::ops::Range<u32>| {
        let (mut sum, mut summary) = (PixelSum::new(false), Summary::default());
        sum.start(samples.start, &FilmPixel::default(), None);
        let shots: Vec<Shot> = samples
            .map(|index| pixel_sample(settings, place, index))
            .map(|(sample, stream)| Shot { sample, stream })
            .collect();
        let mut radiances = Vec::new();
        let never = AtomicBool::new(false);
        shoot.shoot(&shots, &mut RayCounts::default(), &never, &mut radiances);
        for (shot, radiance) in shots.iter().zip(&radiances) {
            sum.add(shot.sample.weight, radiance);
            summary.add(radiance);
        }
        summary.finish(&sum.finish().0);
        summary
    };
    let base = 0..settings.samples;
    let summaries: Vec<Summary> =
        around.pixels().map(|place| summary(place, base.clone())).collect();
    let at = |[x, y]: [u32; 2]| around.index(x, y).and_then(|i| summaries.get(i));
    let own = at(pixel).copied().unwrap_or_default();
    if settings.max_samples <= settings.samples
        || !own.is_uneven(settings.threshold) && !unlike_neighbour(settings, pixel, at)
    {
        return settings.samples;
    }
    let share = first_share(settings);
    let own = own.with(&summary(pixel, settings.samples..share));
    if own.is_uneven(settings.threshold) { settings.max_samples } else { share }
}
