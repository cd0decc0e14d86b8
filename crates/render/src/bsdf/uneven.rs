// SPDX-License-Identifier: MIT OR Apache-2.0
//! Diffuse surfaces that are rough in small: plaster, cloth, the moon.
//!
//! Portsmouth, Kutz and Hill, "EON: A Practical Energy-Preserving Rough Diffuse BRDF", JCGT 14(1), 2025: the
//! model of Oren and Nayar with Fujii's improvement, and the light added that goes from facet to facet.

use std::f64::consts::{FRAC_1_PI, PI};

use dioptric_math::{DVec3, Spectrum};

use super::BsdfSample;
use super::diffuse::{cosine_direction, cosine_pdf, uniform_direction};

/// `1/2 - 2 / (3 pi)`, of the coefficient A.
const FACTOR_A: f64 = 0.5 - 2.0 / (3.0 * PI);
/// `2/3 - 28 / (15 pi)`, of the mean albedo.
const FACTOR_MEAN: f64 = 2.0 / 3.0 - 28.0 / (15.0 * PI);

/// A rough diffuse surface, seen from one direction.
#[derive(Clone, Copy, Debug)]
pub struct Uneven {
    /// The facets' albedo over pi, times the coefficient A.
    once: Spectrum,
    roughness: f64,
    /// What goes from facet to facet: times `1 - albedo` of the other direction.
    often: Spectrum,
    /// The chance of a direction that is uniform, not by the cosine: at grazing angles much goes back there.
    uniform: f64,
}

impl Uneven {
    /// A surface of facets with this albedo; `roughness` from 0 (Lambert's) to 1.
    pub(super) fn new(albedo: Spectrum, roughness: f64, wo: DVec3) -> Self {
        let a = 1.0 / (1.0 + FACTOR_A * roughness);
        let mean = a * (1.0 + FACTOR_MEAN * roughness);
        // Facets of any colour that give more than they get have no finite sum.
        let facets = albedo.min(Spectrum::ONE);
        let again = facets * facets * mean / (Spectrum::ONE - facets * (1.0 - mean));
        let lost = (1.0 - single(wo.z, roughness)) / (1.0 - mean).max(1e-12);
        Self {
            once: albedo * (FRAC_1_PI * a),
            roughness,
            often: again * (FRAC_1_PI * lost.max(0.0)),
            uniform: 0.5 * roughness * (1.0 - wo.z),
        }
    }

    #[inline]
    pub(super) fn eval_pdf(&self, wo: DVec3, wi: DVec3) -> (Spectrum, f64) {
        if wi.z <= 0.0 {
            return (Spectrum::ZERO, 0.0);
        }
        let s = wo.dot(wi) - wo.z * wi.z;
        let s = if s > 0.0 { s / wo.z.max(wi.z) } else { s };
        let lost = (1.0 - single(wi.z, self.roughness)).max(0.0);
        let f = self.once * (1.0 + self.roughness * s) + self.often * lost;
        let pdf = (1.0 - self.uniform) * cosine_pdf(wi) + self.uniform * (0.5 * FRAC_1_PI);
        (f * wi.z, pdf)
    }

    #[inline]
    pub(super) fn sample(&self, wo: DVec3, pick: f64, u: [f64; 2]) -> Option<BsdfSample> {
        let wi = if pick < self.uniform { uniform_direction(u) } else { cosine_direction(u) }?;
        let (f, pdf) = self.eval_pdf(wo, wi);
        Some(BsdfSample { wi, weight: f / pdf, pdf })
    }
}

/// The share of light that white facets send away after one reflection, for the cosine of its direction
/// (equation 16's exact form: the approximate one would not conserve energy to the last digit).
fn single(mu: f64, roughness: f64) -> f64 {
    let a = 1.0 / (1.0 + FACTOR_A * roughness);
    let mu = mu.clamp(1e-9, 1.0);
    let si = (1.0 - mu * mu).max(0.0).sqrt();
    let g = si * (dioptric_math::acos(mu) - si * mu)
        + (2.0 / 3.0) * ((si / mu) * (1.0 - si * si * si) - si);
    a * (1.0 + roughness * FRAC_1_PI * g)
}
