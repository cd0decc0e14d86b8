// SPDX-License-Identifier: MIT OR Apache-2.0
//! A pixel while its samples come in.

use super::pieces::Pieces;
use super::{FilmPixel, FirstSums, Radiance};

/// Adds up a pixel's samples, pair by pair.
#[derive(Clone, Debug)]
pub struct PixelSum {
    pixel: Pieces<FilmPixel>,
    /// Where it is asked for.
    firsts: Option<Pieces<FirstSums>>,
    finished: bool,
}

impl PixelSum {
    /// Nothing yet; with `layers` what is hit first is added up, too.
    #[must_use]
    pub fn new(layers: bool) -> Self {
        Self { pixel: Pieces::new(), firsts: layers.then(Pieces::new), finished: false }
    }

    /// Begins with sample `first` of a pixel; what it has already are the samples before that.
    pub fn start(&mut self, first: u32, pixel: &FilmPixel, firsts: Option<&FirstSums>) {
        let has = pixel.count();
        self.finished = pixel.is_finished();
        self.pixel.start(first.saturating_sub(has));
        if has > 0 {
            self.pixel.push(has, *pixel);
        }
        if let Some(sums) = &mut self.firsts {
            sums.start(first.saturating_sub(has));
            if has > 0 {
                sums.push(has, firsts.copied().unwrap_or_default());
            }
        }
    }

    /// Adds the next sample.
    #[inline]
    pub fn add(&mut self, weight: f64, radiance: &Radiance) {
        self.pixel.push(1, FilmPixel::of(weight, radiance));
        if let Some(sums) = &mut self.firsts {
            sums.push(1, FirstSums::of(&radiance.first));
        }
    }

    /// The pixel with what was added.
    #[must_use]
    pub fn finish(&self) -> (FilmPixel, FirstSums) {
        let mut pixel = self.pixel.sum().unwrap_or_default();
        pixel.set_finished(self.finished);
        let firsts = self.firsts.as_ref().and_then(Pieces::sum);
        (pixel, firsts.unwrap_or_default())
    }
}
