// SPDX-License-Identifier: MIT OR Apache-2.0
//! Diffuse surfaces that are rough in small: plaster, cloth, the moon.
//!
//! Portsmouth, Kutz and Hill, "EON: A Practical Energy-Preserving Rough Diffuse BRDF", JCGT 14(1), 2025: the
//! model of Oren and Nayar with Fujii's improvement, and the light added that goes from facet to facet.

use std::f64::consts::{FRAC_1_PI, PI};

use dioptric_math::{DVec3, Spectrum};

use super::BsdfSample;
use super::diffuse::{cosine_direction, cosine_pdf};

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
    /// The sine of the viewer's angle to the normal.
    sine: f64,
    /// The chance of a direction on the viewer's side: the more grazing, the more goes back there.
    back: f64,
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
        let sine = (wo.x * wo.x + wo.y * wo.y).sqrt();
        Self {
            once: albedo * (FRAC_1_PI * a),
            roughness,
            often: again * (FRAC_1_PI * lost.max(0.0)),
            sine,
            // About the integral of what the model adds there.
            back: 0.5 * roughness * a * sine * (1.0 - 0.58 * wo.z),
        }
    }

    #[inline]
    pub(super) fn eval_pdf(&self, wo: DVec3, wi: DVec3) -> (Spectrum, f64) {
        if wi.z <= 0.0 {
            return (Spectrum::ZERO, 0.0);
        }
        let s = wo.x * wi.x + wo.y * wi.y;
        let flat = if s > 0.0 { s / wo.z.max(wi.z) } else { s };
        let lost = (1.0 - single(wi.z, self.roughness)).max(0.0);
        let f = self.once * (1.0 + self.roughness * flat) + self.often * lost;
        let sines = self.sine * (1.0 - wi.z * wi.z).max(0.0).sqrt();
        let turn = if s > 0.0 && sines > 0.0 { (s / sines).min(1.0) } else { 0.0 };
        (f * wi.z, (1.0 - self.back) * cosine_pdf(wi.z) + self.back * 0.5 * turn)
    }

    #[inline]
    pub(super) fn sample(&self, wo: DVec3, pick: f64, u: [f64; 2]) -> Option<BsdfSample> {
        let wi = if pick < self.back {
            // The azimuth to the viewer's by its cosine, the height uniform.
            let (z, sin) = (1.0 - u[0], 2.0 * u[1] - 1.0);
            let cos = (1.0 - sin * sin).max(0.0).sqrt();
            let r = (1.0 - z * z).max(0.0).sqrt() / self.sine;
            DVec3::new(r * (wo.x * cos - wo.y * sin), r * (wo.y * cos + wo.x * sin), z)
        } else {
            cosine_direction(u)?
        };
        let (f, pdf) = self.eval_pdf(wo, wi);
        (pdf > 0.0).then(|| BsdfSample { wi, weight: f / pdf, pdf })
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_reflection_is_the_model_of_oren_and_nayar_with_fujiis_improvement() {
        // Seen from where the light is, 60 degrees to the side: A (1 + sin^2 / cos) / pi. So dark that what is
        // reflected twice does not count.
        let w = DVec3::new(0.75_f64.sqrt(), 0.0, 0.5);
        let dark = Spectrum::splat(1e-9);
        let surface = Uneven::new(dark, 1.0, w);
        let (f, _) = surface.eval_pdf(w, w);
        let expected = 1e-9 * 0.776_520 * 2.5 / PI * 0.5;
        assert!((f.x / expected - 1.0).abs() < 1e-5, "{f} {expected}");
        // On the other side it is darker: A (1 - sin^2).
        let (f, _) = surface.eval_pdf(w, DVec3::new(-w.x, 0.0, w.z));
        let expected = 1e-9 * 0.776_520 * 0.25 / PI * 0.5;
        assert!((f.x / expected - 1.0).abs() < 1e-5, "{f} {expected}");
    }

    #[test]
    fn colours_get_deeper_from_facet_to_facet_and_nothing_else_at_no_roughness() {
        let w = DVec3::new(0.6, 0.0, 0.8);
        let color = Spectrum::new(1.0, 0.5, 0.1);
        let (smooth, _) = Uneven::new(color, 0.0, w).eval_pdf(w, w);
        assert!((smooth - color * (0.8 * FRAC_1_PI)).length() < 1e-12);
        let (rough, _) = Uneven::new(color, 1.0, w).eval_pdf(w, -w * DVec3::new(1.0, 1.0, -1.0));
        assert!(rough.z / rough.x < 0.1 && rough.y / rough.x < 0.5);
    }
}
