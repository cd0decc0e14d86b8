// SPDX-License-Identifier: MIT OR Apache-2.0
//! A clear coat over a diffuse ground: plastic, varnish, glazed pottery.
//!
//! Light that is not mirrored enters the coat, is scattered below, and leaves it or is thrown back to the ground,
//! again and again, a little more coloured each time: `f = (1 - F(wo)) (1 - F(wi)) / eta^2 . (albedo / pi) /
//! (1 - albedo F_inside)` (Pharr, Jakob and Humphreys call it Saunderson's correction; Wolff, "Diffuse-Reflectance
//! Model for Smooth Dielectric Surfaces", JOSA A 11(11), 1994). A white ground loses nothing.

use std::f64::consts::FRAC_1_PI;

use dioptric_math::{DVec3, Spectrum, ln};

use super::BsdfSample;
use super::diffuse::{cosine_direction, cosine_pdf};
use super::ggx::Facets;
use super::loss::Sheen;
use crate::integrator::optics::fresnel;

/// The index of refraction of a coat that mirrors this much at a right angle: `(1 + r) / (1 - r)` with its
/// square root r.
pub(super) fn index(reflectance: f64) -> f64 {
    let root = reflectance.max(0.0).sqrt().min(0.999);
    (1.0 + root) / (1.0 - root)
}

/// What a coat mirrors of light from one direction.
#[derive(Clone, Copy, Debug)]
pub(super) enum Coat {
    /// By the index of refraction outside over that of the coat.
    Smooth(f64),
    /// Of facets.
    Rough(Sheen),
}

impl Coat {
    /// For a direction with this cosine.
    #[inline]
    pub fn mirrors(&self, cos: f64) -> f64 {
        match self {
            Self::Smooth(eta) => fresnel(cos, *eta),
            Self::Rough(sheen) => sheen.at(cos),
        }
    }

    /// For light from everywhere.
    pub fn mean(&self) -> f64 {
        match self {
            Self::Smooth(eta) => mean_fresnel(1.0 / eta),
            Self::Rough(sheen) => sheen.mean(),
        }
    }
}

/// The diffuse ground under a coat, seen from one direction.
#[derive(Clone, Copy, Debug)]
pub struct Ground {
    /// All of f but the share that enters from the other direction.
    front: Spectrum,
    coat: Coat,
    power: f64,
}

impl Ground {
    /// `albedo` at most 1; `ior` that of the coat over that of what is outside.
    pub(super) fn new(albedo: Spectrum, ior: f64, coat: Coat, wo: DVec3) -> Self {
        let eta = 1.0 / ior;
        // What enters of light from everywhere: as much of it leaves of light from everywhere inside, for each
        // of the ior^2 directions that one becomes.
        let enters = 1.0 - coat.mean();
        let inside = 1.0 - enters * eta * eta;
        let shown = albedo / (Spectrum::ONE - albedo * inside);
        let leaves = 1.0 - coat.mirrors(wo.z);
        Self {
            front: shown * (FRAC_1_PI * leaves * eta * eta),
            coat,
            power: shown.max_element() * leaves * enters * eta * eta,
        }
    }

    /// How much it sends to the viewer of light from everywhere.
    pub(super) fn power(&self) -> f64 {
        self.power
    }

    #[inline]
    pub(super) fn eval_pdf(&self, wi: DVec3) -> (Spectrum, f64) {
        if wi.z <= 0.0 {
            return (Spectrum::ZERO, 0.0);
        }
        (self.front * ((1.0 - self.coat.mirrors(wi.z)) * wi.z), cosine_pdf(wi.z))
    }

    #[inline]
    pub(super) fn sample(&self, u: [f64; 2]) -> Option<BsdfSample> {
        let wi = cosine_direction(u)?;
        let (f, pdf) = self.eval_pdf(wi);
        Some(BsdfSample { wi, weight: f / pdf, pdf })
    }
}

/// What a rough coat mirrors, seen from one direction, by Fresnel's equations. Light that meets another facet goes
/// down to the ground with what is not mirrored.
#[derive(Clone, Copy, Debug)]
pub struct Glaze {
    facets: Facets,
    eta: f64,
}

impl Glaze {
    /// A coat of facets of width `alpha`.
    pub(super) fn new(alpha: f64, ior: f64, wo: DVec3) -> Self {
        Self { facets: Facets::new(alpha, wo), eta: 1.0 / ior }
    }

    #[inline]
    pub(super) fn eval_pdf(&self, wo: DVec3, wi: DVec3) -> (Spectrum, f64) {
        match self.facets.glint(wo, wi) {
            Some(once) => (Spectrum::splat(fresnel(once.cos, self.eta) * once.f), once.pdf),
            None => (Spectrum::ZERO, 0.0),
        }
    }

    #[inline]
    pub(super) fn sample(&self, wo: DVec3, u: [f64; 2]) -> Option<BsdfSample> {
        let wi = self.facets.mirrored(wo, u);
        let (f, pdf) = self.eval_pdf(wo, wi);
        (pdf > 0.0).then(|| BsdfSample { wi, weight: f / pdf, pdf })
    }
}

/// What a smooth dielectric mirrors of light from everywhere, `2 int F(mu) mu dmu`, for its index over that
/// outside, at least 1 (Walsh 1926, as quoted by Duntley, "The Optical Properties of Diffusing Materials",
/// JOSA 32(2), 1942).
pub(super) fn mean_fresnel(n: f64) -> f64 {
    if n < 1.0 + 1e-6 {
        return 0.0;
    }
    let n2 = n * n;
    let n4 = n2 * n2;
    0.5 + (n - 1.0) * (3.0 * n + 1.0) / (6.0 * (n + 1.0) * (n + 1.0))
        + n2 * (n2 - 1.0) * (n2 - 1.0) / ((n2 + 1.0) * (n2 + 1.0) * (n2 + 1.0))
            * ln((n - 1.0) / (n + 1.0))
        - 2.0 * n2 * n * (n2 + 2.0 * n - 1.0) / ((n2 + 1.0) * (n4 - 1.0))
        + 8.0 * n4 * (n4 + 1.0) / ((n2 + 1.0) * (n4 - 1.0) * (n4 - 1.0)) * ln(n)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_of_fresnels_curve() {
        let n = 20_000;
        for ior in [1.0, 1.000_01, 1.01, 1.33, 1.5, 2.4, 10.0] {
            let mu = |i: i32| (f64::from(i) + 0.5) / f64::from(n);
            let sum: f64 =
                (0..n).map(|i| 2.0 * mu(i) * fresnel(mu(i), 1.0 / ior) / f64::from(n)).sum();
            assert!((mean_fresnel(ior) - sum).abs() < 1e-5, "{ior}: {sum}");
        }
        assert!((index(0.04) - 1.5).abs() < 1e-12);
    }

    #[test]
    fn a_smooth_coat_is_that_of_another_program() {
        // Mitsuba 3.9.1, `plastic` with int_ior 1.5, ext_ior 1, nonlinear, eval in single precision.
        let albedo = Spectrum::new(0.1, 0.5, 0.9);
        for (o, i, expected) in [
            (0.8, 0.7, [0.009_556_53, 0.064_041_20, 0.174_726_59]),
            (0.3, 0.5, [0.005_428_13, 0.036_375_55, 0.099_245_12]),
            (0.5, 0.4, [0.004_754_96, 0.031_864_40, 0.086_937_13]),
        ] {
            let at = |z: f64| DVec3::new((1.0 - z * z).sqrt(), 0.0, z);
            let ground = Ground::new(albedo, 1.5, Coat::Smooth(1.0 / 1.5), at(o));
            let (f, _) = ground.eval_pdf(at(i));
            let error = (f / Spectrum::from(expected) - Spectrum::ONE).abs().max_element();
            assert!(error < 1e-3, "{o} {i}: {f}");
        }
    }
}
