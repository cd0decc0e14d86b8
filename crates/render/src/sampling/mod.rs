// SPDX-License-Identifier: MIT OR Apache-2.0
//! Where samples lie: in pixels, on lenses, on lights. Pure functions of (pixel, sample, seed).

pub mod pixel;
pub mod screen;
pub mod sobol;
pub mod stream;
pub mod warp;

pub use pixel::{PixelSample, pixel_sample, pixel_weights};
pub use stream::Stream;

/// How the samples of a pixel are placed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Antialias {
    /// One sample, at the pixel's centre.
    None,
    /// A regular grid of cells, one sample at the centre of each.
    Grid,
    /// The four positions of the report that the project starts from: 0.2 and 0.8 of the pixel's
    /// width and height.
    Report,
    /// A regular grid of cells, one sample anywhere in each; lenses and lights by random numbers
    /// (Cook, Porter and Carpenter, "Distributed Ray Tracing", SIGGRAPH 1984).
    Jitter,
    /// Sobol's first two dimensions, Owen-scrambled: see [`sobol`]; the points of neighbouring pixels complete each
    /// other: see [`screen`].
    #[default]
    Sobol,
    /// As `Sobol`, and more samples where the picture changes: see [`crate::job::adaptive`].
    Adaptive,
}

impl Antialias {
    /// The words of the `antialias` parameter.
    pub const NAMES: &'static [&'static str] =
        &["none", "grid", "report", "jitter", "sobol", "adaptive"];

    const ALL: [Self; 6] =
        [Self::None, Self::Grid, Self::Report, Self::Jitter, Self::Sobol, Self::Adaptive];

    /// The mode of a word.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|mode| mode.name() == name)
    }

    /// Its word.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Grid => "grid",
            Self::Report => "report",
            Self::Jitter => "jitter",
            Self::Sobol => "sobol",
            Self::Adaptive => "adaptive",
        }
    }

    /// Samples of a pixel where the scene does not say.
    #[must_use]
    pub const fn default_samples(self) -> u32 {
        match self {
            Self::None => 1,
            Self::Grid | Self::Report | Self::Adaptive => 4,
            Self::Jitter | Self::Sobol => 16,
        }
    }
}

/// Columns and rows of the grid of `n` cells that is nearest to a square: `columns * rows == n` and
/// `columns >= rows`. Primes give one row.
#[must_use]
pub fn strata(n: u32) -> (u32, u32) {
    let n = n.max(1);
    let mut rows = f64::from(n).sqrt() as u32;
    while rows > 1 && !n.is_multiple_of(rows) {
        rows -= 1;
    }
    let rows = rows.max(1);
    (n / rows, rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_and_modes_agree() {
        assert_eq!(Antialias::NAMES, Antialias::ALL.map(Antialias::name));
        for name in Antialias::NAMES {
            assert_eq!(Antialias::from_name(name).map(Antialias::name), Some(*name));
        }
        assert_eq!(Antialias::from_name("4x"), None);
    }

    #[test]
    fn grids_have_exactly_n_cells() {
        for n in 1..2000 {
            let (columns, rows) = strata(n);
            assert!(columns * rows == n && columns >= rows, "{n}");
        }
        assert_eq!([4, 9, 12, 256, 7].map(strata), [(2, 2), (3, 3), (4, 3), (16, 16), (7, 1)]);
    }
}
