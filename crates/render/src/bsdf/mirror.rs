// SPDX-License-Identifier: MIT OR Apache-2.0
//! Mirrors: sharp ones, and rough ones that lose nothing.

use std::f64::consts::FRAC_1_PI;

use dioptric_math::{DVec3, Spectrum};

use super::BsdfSample;
use super::ggx::{Facets, image};
use super::loss::Loss;
use super::often;
use crate::material::Reflectance;

/// A sharp mirror, seen from one direction: one direction goes on, with this weight.
#[derive(Clone, Copy, Debug)]
pub struct Mirror {
    pub(super) weight: Spectrum,
}

impl Mirror {
    #[inline]
    pub(super) fn sample(&self, wo: DVec3) -> BsdfSample {
        BsdfSample::sharp(image(wo), self.weight)
    }
}

/// A rough mirror, seen from one direction: light that one facet mirrors (`F D G2 / (4 cos cos)`; Walter et al.,
/// "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007, equation 20; with the masking and
/// shadowing of facets at the same height, Heitz 2014, equation 99), and what several facets mirror one after
/// the other, which would be lost otherwise (Kulla and Conty, "Revisiting Physically Based Shading at Imageworks",
/// SIGGRAPH 2017 course; the colour of many reflections as by Hill, "A Multi-Faceted Exploration (Part 4)", 2018).
#[derive(Clone, Copy, Debug)]
pub struct RoughMirror {
    facets: Facets,
    loss: Loss,
    reflect: Reflectance,
    /// What several facets mirror: times the loss in the other direction.
    often: Spectrum,
    /// The chance to look for that.
    chance: f64,
}

impl RoughMirror {
    /// A mirror whose facets reflect so much.
    pub(super) fn new(alpha: f64, reflect: Reflectance, wo: DVec3) -> Self {
        let loss = Loss::of_mirror(alpha);
        let (lost, mean) = (loss.at(wo.z), loss.mean());
        let f = reflect.mean();
        let many = f * f * (1.0 - mean) / (Spectrum::ONE - f * mean);
        let once = reflect.at(wo.z).max_element() * (1.0 - lost);
        let often = many.max_element() * lost;
        Self {
            facets: Facets::new(alpha, wo),
            loss,
            reflect,
            often: many * (lost / mean * FRAC_1_PI),
            chance: if often > 0.0 { often / (once + often) } else { 0.0 },
        }
    }

    /// About how much it sends to the viewer of light from everywhere.
    pub(super) fn power(&self, wo: DVec3) -> f64 {
        self.reflect.at(wo.z).max_element()
    }

    #[inline]
    pub(super) fn eval_pdf(&self, wo: DVec3, wi: DVec3) -> (Spectrum, f64) {
        let Some(once) = self.facets.glint(wo, wi) else { return (Spectrum::ZERO, 0.0) };
        let f = self.reflect.at(once.cos) * once.f + self.often * (self.loss.at(wi.z) * wi.z);
        let around = often::density(self.facets.alpha, wi.z);
        (f, (1.0 - self.chance) * once.pdf + self.chance * around)
    }

    #[inline]
    pub(super) fn sample(&self, wo: DVec3, pick: f64, u: [f64; 2]) -> Option<BsdfSample> {
        let wi = if pick < self.chance {
            often::direction(self.facets.alpha, u)?
        } else {
            self.facets.mirrored(wo, u)
        };
        let (f, pdf) = self.eval_pdf(wo, wi);
        (pdf > 0.0).then(|| BsdfSample { wi, weight: f / pdf, pdf })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hardly_rough_mirror_is_a_sharp_one() {
        let wo = DVec3::new(0.6, 0.0, 0.8);
        let normal = Spectrum::new(0.9, 0.5, 0.2);
        let gold = Reflectance::Curve { normal, grazing: Spectrum::ONE };
        let rough = RoughMirror::new(2e-4, gold, wo);
        let sharp = Mirror { weight: gold.at(wo.z) };
        let sample = rough.sample(wo, 0.9, [0.3, 0.4]).unwrap();
        assert!((sample.wi - sharp.sample(wo).wi).length() < 1e-3);
        assert!((sample.weight - sharp.weight).length() < 1e-3, "{}", sample.weight);
    }

    #[test]
    fn many_reflections_make_colours_deeper() {
        let wo = DVec3::Z;
        let gold = Reflectance::constant(Spectrum::new(1.0, 0.5, 0.1));
        let rough = RoughMirror::new(1.0, gold, wo);
        // Far from the mirrored direction hardly anything has been reflected only once.
        let (f, _) = rough.eval_pdf(wo, DVec3::new(0.995, 0.0, (1.0 - 0.995_f64 * 0.995).sqrt()));
        assert!(f.y / f.x < 0.5 && f.z / f.x < 0.1, "{f}");
    }
}
