// SPDX-License-Identifier: MIT OR Apache-2.0
//! Highlights: bright spots where a light is mirrored, by the formulas of Phong and Blinn.

use dioptric_math::{DVec3, Spectrum, normalize, powi, unit_power};

/// The shape of a highlight.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HighlightModel {
    /// `max(0, r . v)^n` with the mirrored light direction r (Phong 1975).
    Phong,
    /// `max(0, n . h)^n` with the half vector h (Blinn 1977).
    Blinn,
}

/// A highlight of a light on a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Highlight {
    /// Which formula.
    pub model: HighlightModel,
    /// Its colour and strength.
    pub color: Spectrum,
    /// Its exponent.
    pub exponent: f64,
    /// Whether it stands for the mirror image of a light on a surface that mirrors: paths find that image by
    /// themselves and do without.
    pub image: bool,
}

/// A highlight that is a smaller share of its light is none: nobody could see what its shadow ray costs.
pub(crate) const FAINTEST: f64 = 1e-9;

impl Highlight {
    /// How strong it is for a normal, the direction to the light and the one to the viewer.
    #[must_use]
    pub fn strength(&self, normal: DVec3, to_light: DVec3, to_viewer: DVec3) -> f64 {
        let base = match self.model {
            // r . v with r = 2 (n . l) n - l, without making r.
            HighlightModel::Phong => {
                2.0 * normal.dot(to_light) * normal.dot(to_viewer) - to_light.dot(to_viewer)
            }
            HighlightModel::Blinn => {
                normalize(to_light + to_viewer).map_or(0.0, |half| half.dot(normal))
            }
        };
        let (base, n) = (base.clamp(0.0, 1.0), self.exponent);
        if base == 0.0 && n > 0.0 {
            return 0.0;
        }
        let strength = match whole(n) {
            Some(n) => powi(base, n),
            None => unit_power(base, n),
        };
        if strength < FAINTEST { 0.0 } else { strength }
    }
}

/// Most exponents are small whole numbers: squaring is even faster than the power of numbers up to 1.
pub(crate) fn whole(n: f64) -> Option<u32> {
    (n.trunc() == n && (0.0..=4096.0).contains(&n)).then_some(n as u32)
}
