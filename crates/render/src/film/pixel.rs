// SPDX-License-Identifier: MIT OR Apache-2.0
//! One pixel of a film: its light, and apart from that what its camera rays hit first.

use dioptric_math::Spectrum;

use super::pieces::Join;
use super::{FirstHit, Radiance};

/// The sums of one pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FilmPixel {
    /// Sum of weight times colour.
    pub color: Spectrum,
    /// Sum of weight times alpha.
    pub alpha: f64,
    /// Sum of weights, which are 1 and -1.
    pub weight: i32,
    /// Samples, and [`FINISHED`].
    state: u32,
}

/// The bit of a pixel that says whether it is finished; the others count samples.
const FINISHED: u32 = 1 << 31;

impl FilmPixel {
    /// One sample.
    #[inline(always)]
    #[must_use]
    pub fn of(weight: f64, radiance: &Radiance) -> Self {
        Self {
            color: radiance.color * weight,
            alpha: radiance.alpha * weight,
            weight: weight as i32,
            state: 1,
        }
    }

    /// A pixel from what a file says of it.
    pub(crate) fn from_parts(color: Spectrum, alpha: f64, weight: i32, count: u32) -> Self {
        Self { color, alpha, weight, state: count & !FINISHED }
    }

    /// Samples; 0 in a pixel that has not been rendered.
    #[must_use]
    pub const fn count(&self) -> u32 {
        self.state & !FINISHED
    }

    /// Whether no more samples will come.
    #[must_use]
    pub const fn is_finished(&self) -> bool {
        self.state & FINISHED != 0
    }

    /// Says whether more samples will come.
    pub(crate) const fn set_finished(&mut self, finished: bool) {
        self.state = if finished { self.state | FINISHED } else { self.state & !FINISHED };
    }

    /// The pixel's light; black where there are no samples.
    #[must_use]
    pub fn linear(&self) -> Spectrum {
        if self.count() == 0 { Spectrum::ZERO } else { self.color / f64::from(self.weight) }
    }

    /// The pixel as it goes into files: light, and how much of it is covered, 0 to 1.
    #[must_use]
    pub fn rgba(&self) -> [f32; 4] {
        if self.count() == 0 {
            return [0.0; 4];
        }
        let [r, g, b] = self.linear().to_array().map(|c| c as f32);
        [r, g, b, (self.alpha / f64::from(self.weight)).clamp(0.0, 1.0) as f32]
    }
}

impl Join for FilmPixel {
    fn join(&mut self, later: &Self) {
        self.color += later.color;
        self.alpha += later.alpha;
        self.weight += later.weight;
        let finished = self.is_finished() && later.is_finished();
        self.state = self.count() + later.count();
        self.set_finished(finished);
    }
}

/// What the camera rays of one pixel hit first: normals and albedo as sums over the samples, those that hit nothing counting
/// as zero; depth and object of the first sample, since a mean of two distances or two names is neither.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstSums {
    normal: [f32; 3],
    albedo: [f32; 3],
    /// Distance of the first sample.
    pub depth: f32,
    /// Object of the first sample.
    pub object: u32,
}

impl Default for FirstSums {
    fn default() -> Self {
        Self { normal: [0.0; 3], albedo: [0.0; 3], depth: f32::INFINITY, object: FirstHit::NOTHING }
    }
}

impl FirstSums {
    /// What one sample hit.
    #[must_use]
    pub fn of(first: &FirstHit) -> Self {
        Self {
            normal: first.normal.to_array().map(|c| c as f32),
            albedo: first.albedo.to_array().map(|c| c as f32),
            depth: first.depth as f32,
            object: first.object,
        }
    }

    /// The mean normal of so many samples.
    #[must_use]
    pub fn normal(&self, count: u32) -> [f32; 3] {
        self.normal.map(|c| c / count.max(1) as f32)
    }

    /// The mean albedo of so many samples.
    #[must_use]
    pub fn albedo(&self, count: u32) -> [f32; 3] {
        self.albedo.map(|c| c / count.max(1) as f32)
    }

    /// Its numbers as bits, for files.
    pub(crate) fn to_bits(self) -> [u32; 8] {
        let ([a, b, c], [d, e, f]) = (self.normal, self.albedo);
        let [a, b, c, d, e, f, g] = [a, b, c, d, e, f, self.depth].map(f32::to_bits);
        [a, b, c, d, e, f, g, self.object]
    }

    /// From such bits.
    pub(crate) fn from_bits([a, b, c, d, e, f, g, object]: [u32; 8]) -> Self {
        let [a, b, c, d, e, f, depth] = [a, b, c, d, e, f, g].map(f32::from_bits);
        Self { normal: [a, b, c], albedo: [d, e, f], depth, object }
    }
}

impl Join for FirstSums {
    fn join(&mut self, later: &Self) {
        for (sum, part) in [(&mut self.normal, &later.normal), (&mut self.albedo, &later.albedo)] {
            for (sum, part) in sum.iter_mut().zip(part) {
                *sum += part;
            }
        }
    }
}
