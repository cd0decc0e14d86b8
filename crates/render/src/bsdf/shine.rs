// SPDX-License-Identifier: MIT OR Apache-2.0
//! The highlights of Phong and Blinn as a way to scatter light.
//!
//! `f |cos| = color / pi strength`, so that a sharp light gives just what Whitted's pictures show. It has no
//! cosine: such a highlight is not reciprocal, and one with a small exponent may give more than it gets.

use std::f64::consts::{FRAC_1_PI, PI};

use dioptric_math::{DVec3, Spectrum, normalize, orthonormal_basis, pow, sin_cos};

use super::BsdfSample;
use super::ggx::{image, mirrored};
use crate::material::{Highlight, HighlightModel};

/// A highlight.
#[derive(Clone, Copy, Debug)]
pub struct Shine {
    pub(super) highlight: Highlight,
}

impl Shine {
    /// About how much it sends to the viewer of light from everywhere.
    pub(super) fn power(&self, wo: DVec3) -> f64 {
        let all = 2.0 * self.highlight.color.max_element() / (self.highlight.exponent + 1.0);
        match self.highlight.model {
            HighlightModel::Phong => all,
            // A turn of the half vector turns the light by twice the angle, across by less.
            HighlightModel::Blinn => {
                let n = self.highlight.exponent;
                all * (1.0 + 4.0 * n * wo.z.max(0.0)) / (1.0 + n)
            }
        }
    }

    #[inline]
    pub(super) fn eval_pdf(&self, wo: DVec3, wi: DVec3) -> (Spectrum, f64) {
        if wi.z <= 0.0 {
            return (Spectrum::ZERO, 0.0);
        }
        let strength = self.highlight.strength(DVec3::Z, wi, wo);
        let around = strength * (self.highlight.exponent + 1.0) * (0.5 * FRAC_1_PI);
        let pdf = match self.highlight.model {
            HighlightModel::Phong => around,
            // The solid angle around a half vector h is that around the direction over 4 (wo . h).
            HighlightModel::Blinn => {
                let h = normalize(wo + wi).map_or(0.0, |h| h.dot(wo));
                if h > 0.0 { around / (4.0 * h) } else { 0.0 }
            }
        };
        (self.highlight.color * (strength * FRAC_1_PI), pdf)
    }

    #[inline]
    pub(super) fn sample(&self, wo: DVec3, u: [f64; 2]) -> Option<BsdfSample> {
        let wi = match self.highlight.model {
            // Without an exponent it is everywhere, not only around the mirrored direction.
            HighlightModel::Phong if self.highlight.exponent == 0.0 => around(DVec3::Z, 0.0, u),
            HighlightModel::Phong => around(image(wo), self.highlight.exponent, u),
            HighlightModel::Blinn => {
                let h = around(DVec3::Z, self.highlight.exponent, u);
                if wo.dot(h) <= 0.0 {
                    return None;
                }
                mirrored(wo, h)
            }
        };
        let (f, pdf) = self.eval_pdf(wo, wi);
        (pdf > 0.0).then(|| BsdfSample { wi, weight: f / pdf, pdf })
    }
}

/// A direction around `axis` with the density `(n + 1) / (2 pi) cos^n` (Pharr, Jakob and Humphreys, "Physically
/// Based Rendering", 4th ed., section A.2: inversion).
fn around(axis: DVec3, n: f64, u: [f64; 2]) -> DVec3 {
    let cos = pow(1.0 - u[0], 1.0 / (n + 1.0));
    let r = (1.0 - cos * cos).max(0.0).sqrt();
    let (s, c) = sin_cos(2.0 * PI * u[1]);
    let (t, b) = orthonormal_basis(axis);
    let w = t * (r * c) + b * (r * s) + axis * cos;
    normalize(w).unwrap_or(axis)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sharp_light_gives_what_whitteds_pictures_show() {
        // A sharp light's irradiance is pi times what arrives, so that pi f |cos| is the colour times the strength.
        let color = Spectrum::new(1.0, 0.4, 0.0);
        let wo = DVec3::new(0.6, 0.0, 0.8);
        let wi = DVec3::new(-0.48, 0.6, 0.64);
        let phong: f64 = 0.48 * 0.6 + 0.64 * 0.8;
        let half = normalize(wo + wi).unwrap().z;
        for (model, base) in [(HighlightModel::Phong, phong), (HighlightModel::Blinn, half)] {
            for exponent in [0.0, 1.0, 7.0, 12.5] {
                let highlight = Highlight { model, color, exponent, image: false };
                let (f, _) = Shine { highlight }.eval_pdf(wo, wi);
                let expected = color * pow(base, exponent);
                assert!((f * PI - expected).length() < 1e-12, "{model:?} {exponent}");
                assert_eq!(Shine { highlight }.eval_pdf(wo, -wi), (Spectrum::ZERO, 0.0));
            }
        }
    }
}
