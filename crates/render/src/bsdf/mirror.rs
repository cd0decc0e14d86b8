// SPDX-License-Identifier: MIT OR Apache-2.0
//! Mirrors: sharp ones, and rough ones that lose nothing.

use std::f64::consts::FRAC_1_PI;

use dioptric_math::{DVec3, Spectrum};

use super::BsdfSample;
use super::diffuse::{cosine_direction, cosine_pdf};
use super::ggx::{Ggx, LOWEST, image, mirrored};
use super::loss::Loss;
use crate::integrator::optics::schlick;

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
    ggx: Ggx,
    loss: Loss,
    lambda: f64,
    reflect: Spectrum,
    grazing: Spectrum,
    /// What several facets mirror: times the loss in the other direction.
    often: Spectrum,
    /// The chance to look for that.
    chance: f64,
}

impl RoughMirror {
    /// A mirror whose facets reflect from `reflect` to `grazing` by Schlick's curve.
    pub(super) fn new(alpha: f64, reflect: Spectrum, grazing: Spectrum, wo: DVec3) -> Self {
        let ggx = Ggx { alpha };
        let loss = Loss::of_mirror(alpha);
        let (lost, mean) = (loss.at(wo.z), loss.mean());
        // The mean of Schlick's curve over the hemisphere: 2 int mu (1 - mu)^5 = 1 / 21.
        let f = reflect + (grazing - reflect) / 21.0;
        let many = f * f * (1.0 - mean) / (Spectrum::ONE - f * mean);
        let once = schlick(reflect, grazing, wo.z).max_element() * (1.0 - lost);
        let often = many.max_element() * lost;
        Self {
            ggx,
            loss,
            lambda: ggx.lambda(wo),
            reflect,
            grazing,
            often: many * (lost / mean * FRAC_1_PI),
            chance: if often > 0.0 { often / (once + often) } else { 0.0 },
        }
    }

    /// About how much it sends to the viewer of light from everywhere.
    pub(super) fn power(&self, wo: DVec3) -> f64 {
        schlick(self.reflect, self.grazing, wo.z).max_element()
    }

    #[inline]
    pub(super) fn eval_pdf(&self, wo: DVec3, wi: DVec3) -> (Spectrum, f64) {
        let Some(once) = Glint::new(self.ggx, self.lambda, wo, wi) else {
            return (Spectrum::ZERO, 0.0);
        };
        let f = schlick(self.reflect, self.grazing, once.cos) * once.f
            + self.often * (self.loss.at(wi.z) * wi.z);
        (f, (1.0 - self.chance) * once.pdf + self.chance * cosine_pdf(wi))
    }

    #[inline]
    pub(super) fn sample(&self, wo: DVec3, pick: f64, u: [f64; 2]) -> Option<BsdfSample> {
        let wi = if pick < self.chance {
            cosine_direction(u)?
        } else {
            mirrored(wo, self.ggx.visible_normal(wo, u))
        };
        let (f, pdf) = self.eval_pdf(wo, wi);
        (pdf > 0.0).then(|| BsdfSample { wi, weight: f / pdf, pdf })
    }
}

/// What facets that mirror everything send from `wi` to `wo`.
pub(super) struct Glint {
    /// `D G2 / (4 cos cos) cos`.
    pub f: f64,
    /// The density of the mirror image of `wo` at a visible facet.
    pub pdf: f64,
    /// The cosine of the angle of incidence on the facet.
    pub cos: f64,
}

impl Glint {
    /// `None` where `wi` is not above the surface; `lambda` is that of `wo`.
    #[inline]
    pub fn new(ggx: Ggx, lambda: f64, wo: DVec3, wi: DVec3) -> Option<Self> {
        if wi.z <= 0.0 {
            return None;
        }
        let m = dioptric_math::normalize(wo + wi)?;
        let d = ggx.density(m) / (4.0 * wo.z.max(LOWEST));
        let f = d / (1.0 + lambda + ggx.lambda(wi));
        Some(Self { f, pdf: d / (1.0 + lambda), cos: wo.dot(m) })
    }
}
