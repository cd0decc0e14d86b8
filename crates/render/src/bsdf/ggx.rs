// SPDX-License-Identifier: MIT OR Apache-2.0
//! Rough surfaces made of small mirrors: the GGX distribution of their normals, how they hide each other,
//! and how to pick one that is seen.
//!
//! Walter et al., "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007 (equations 33 and 34);
//! Heitz, "Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs", JCGT 3(2), 2014
//! (equations 72 and 99). Masking is written by the length `r(w) = |(alpha w.x, alpha w.y, w.z)|`, in which
//! `1 + Lambda(w) = (r(w) + w.z) / (2 w.z)`, so that nothing is divided by the cosine of a grazing direction.

use std::f64::consts::PI;

use dioptric_math::{DVec3, normalize, sin_cos};

/// A surface with a smaller alpha is smooth: nobody could see the difference, and densities stay well within
/// what numbers hold.
pub(super) const SMOOTHEST: f64 = 1e-4;

/// Sharp directions are at least so high above or below the surface: bumps bend normals until they are just seen,
/// give or take what rounding does.
const LOWEST: f64 = 1e-7;

/// Facets with normals around z, as they are seen from one direction above them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Facets {
    /// The width of their distribution.
    pub alpha: f64,
    /// `r(wo)`.
    length: f64,
    /// How much of the lower part of the cap of mirrored directions is above the surface; 1 for all.
    kept: f64,
}

/// What facets that mirror everything send from one direction to another.
pub(super) struct Glint {
    /// `D G2 / (4 cos cos) cos`.
    pub f: f64,
    /// The density with which [`Facets::mirrored`] finds it.
    pub pdf: f64,
    /// The density with which the mirror image at a [`Facets::visible_normal`] is it.
    pub visible_pdf: f64,
    /// The cosine of the angle of incidence on the facet.
    pub cos: f64,
}

impl Facets {
    /// Facets of width `alpha`, seen from `wo`.
    #[inline]
    pub fn new(alpha: f64, wo: DVec3) -> Self {
        // Eto and Tokuyoshi, "Bounded VNDF Sampling for Smith-GGX Reflections", SIGGRAPH Asia 2023 Technical
        // Communications, equation 5.
        let s = 1.0 + (wo.x * wo.x + wo.y * wo.y).sqrt();
        let (a2, s2) = (alpha * alpha, s * s);
        let kept = (1.0 - a2) * s2 / (s2 + a2 * wo.z * wo.z);
        let mut facets = Self { alpha, length: 0.0, kept };
        facets.length = facets.length_of(wo);
        facets
    }

    /// `r(w)`.
    #[inline]
    fn length_of(&self, w: DVec3) -> f64 {
        let a2 = self.alpha * self.alpha;
        (a2 * (w.x * w.x + w.y * w.y) + w.z * w.z).sqrt()
    }

    /// The density of facets with the unit normal `m`: their area per solid angle and unit of the surface.
    #[inline]
    fn density(&self, m: DVec3) -> f64 {
        if m.z <= 0.0 {
            return 0.0;
        }
        let a2 = self.alpha * self.alpha;
        let k = m.x * m.x + m.y * m.y + a2 * m.z * m.z;
        a2 / (PI * k * k)
    }

    /// What is mirrored from `wi`; `None` where that is not above the surface.
    #[inline]
    pub fn glint(&self, wo: DVec3, wi: DVec3) -> Option<Glint> {
        if wi.z <= 0.0 {
            return None;
        }
        let m = normalize(wo + wi)?;
        let d = 0.5 * self.density(m);
        let height = wo.z.max(0.0);
        Some(Glint {
            f: d * wi.z / (self.length * wi.z + height * self.length_of(wi)),
            pdf: d / (self.kept * height + self.length),
            visible_pdf: d / (height + self.length),
            cos: wo.dot(m),
        })
    }

    /// The density of facets with the normal `m` among those that are seen (Heitz 2014, equation 2).
    #[inline]
    pub fn visible_density(&self, wo: DVec3, m: DVec3) -> f64 {
        2.0 * self.density(m) * wo.dot(m).max(0.0) / (wo.z.max(0.0) + self.length)
    }

    /// The share of the facets turned towards `w`, on either side, that is not hidden from there: G1.
    #[inline]
    pub fn shown(&self, w: DVec3) -> f64 {
        let z = w.z.abs();
        2.0 * z / (z + self.length_of(w))
    }

    /// The mirror image of `wo` in a facet, for two uniform numbers. Of facets that would send it below the surface
    /// as few are picked as is easily done.
    #[inline]
    pub fn mirrored(&self, wo: DVec3, u: [f64; 2]) -> DVec3 {
        mirrored(wo, self.normal(wo, self.kept, u))
    }

    /// The normal of a facet that `wo` sees, for two uniform numbers, with the density [`Self::visible_density`].
    #[inline]
    pub fn visible_normal(&self, wo: DVec3, u: [f64; 2]) -> DVec3 {
        self.normal(wo, 1.0, u)
    }

    /// Dupuy and Benyoub, "Sampling Visible GGX Normals with Spherical Caps", HPG 2023, listing 3.
    #[inline]
    fn normal(&self, wo: DVec3, kept: f64, u: [f64; 2]) -> DVec3 {
        let stretch = DVec3::new(self.alpha, self.alpha, 1.0);
        let v = wo * stretch / self.length;
        let (s, c) = sin_cos(2.0 * PI * u[0]);
        let low = kept * v.z;
        let z = (1.0 - u[1]) * (1.0 + low) - low;
        let r = (1.0 - z * z).max(0.0).sqrt();
        let m = DVec3::new(r * c, r * s, z) + v;
        normalize(DVec3::new(m.x, m.y, m.z.max(0.0)) * stretch).unwrap_or(DVec3::Z)
    }
}

/// The mirror image of `wo`, above the surface.
#[inline(always)]
pub(crate) fn image(wo: DVec3) -> DVec3 {
    DVec3::new(-wo.x, -wo.y, wo.z.max(LOWEST))
}

/// The direction straight through, below the surface.
#[inline]
pub(super) fn straight_on(wo: DVec3) -> DVec3 {
    DVec3::new(-wo.x, -wo.y, -wo.z.max(LOWEST))
}

/// `w` mirrored at a facet with the unit normal `m`.
#[inline]
pub(super) fn mirrored(w: DVec3, m: DVec3) -> DVec3 {
    let r = m * (2.0 * w.dot(m)) - w;
    normalize(r).unwrap_or(r)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Directions around z by their cosine and azimuth, with the solid angle of each.
    fn grid() -> impl Iterator<Item = (DVec3, f64)> {
        let n = 300;
        (0..n * n).map(move |i| {
            // Finer near the pole.
            let x = (f64::from(i / n) + 0.5) / f64::from(n);
            let z = 1.0 - x * x;
            let (s, c) = sin_cos(2.0 * PI * (f64::from(i % n) + 0.5) / f64::from(n));
            let r = (1.0 - z * z).sqrt();
            (DVec3::new(r * c, r * s, z), 2.0 * x * 2.0 * PI / f64::from(n * n))
        })
    }

    #[test]
    fn facets_cover_the_surface_and_those_seen_cover_its_view() {
        for alpha in [0.1, 0.4, 1.0] {
            for cos in [1.0_f64, 0.5, 0.05] {
                let wo = DVec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
                let facets = Facets::new(alpha, wo);
                let sum = |f: &dyn Fn(DVec3) -> f64| grid().map(|(m, a)| f(m) * a).sum::<f64>();
                // Heitz 2014, equations 4 and 14; in the distribution of what is seen the latter is 1.
                let covered = sum(&|m| facets.density(m) * m.z);
                let seen = sum(&|m| facets.visible_density(wo, m));
                assert!((covered - 1.0).abs() < 1e-3, "{alpha}: {covered}");
                assert!((seen - 1.0).abs() < 1e-2, "{alpha} {cos}: {seen}");
            }
        }
    }

    #[test]
    fn what_is_mirrored_is_what_walter_and_smith_say() {
        // F = 1: D G2 / (4 cos), with G2 = 1 / (1 + Lambda(wo) + Lambda(wi)) and Lambda from the tangent.
        let (wo, wi) = (DVec3::new(0.6, 0.0, 0.8), DVec3::new(-0.36, 0.48, 0.8));
        for alpha in [0.05, 0.5, 1.0] {
            let glint = Facets::new(alpha, wo).glint(wo, wi).unwrap();
            let m = normalize(wo + wi).unwrap();
            let tan2 = (1.0 - m.z * m.z) / (m.z * m.z);
            let k = alpha * alpha + tan2;
            let d = alpha * alpha / (PI * m.z * m.z * m.z * m.z * k * k);
            let lambda = 0.5 * ((1.0_f64 + alpha * alpha * 0.5625).sqrt() - 1.0);
            let expected = d / (1.0 + 2.0 * lambda) / (4.0 * 0.8);
            assert!((glint.f / expected - 1.0).abs() < 1e-12, "{alpha}");
            let seen = d / (1.0 + lambda) / (4.0 * 0.8);
            assert!((glint.visible_pdf / seen - 1.0).abs() < 1e-12, "{alpha}");
            assert!(glint.pdf >= glint.visible_pdf);
        }
    }

    #[test]
    fn one_facet_mirrors_as_in_another_program() {
        // Mitsuba 3.9.1, `roughconductor` with ggx and material none, eval in single precision; its facets are
        // masked and shadowed independently.
        let at = |z: f64, phi: f64| {
            let (s, c) = sin_cos(phi);
            let r = (1.0 - z * z).sqrt();
            DVec3::new(r * c, r * s, z)
        };
        for (alpha, wo, wi, expected) in [
            (0.2, at(0.8, 0.3), at(0.7, 3.0), 0.627_781_51),
            (0.2, at(0.3, 1.0), at(0.5, -2.0), 1.674_628_02),
            (0.2, at(0.5, 0.2), at(0.4, 3.3), 2.958_253_15),
            (0.5, at(0.8, 0.3), at(0.7, 3.0), 0.288_106_95),
            (0.5, at(0.3, 1.0), at(0.5, -2.0), 0.515_604_62),
        ] {
            let facets = Facets::new(alpha, wo);
            let glint = facets.glint(wo, wi).unwrap();
            let f = glint.visible_pdf * facets.shown(wi);
            assert!((f / expected - 1.0).abs() < 1e-4, "{alpha} {wo}: {f}");
            // At the same height more is seen, but never more than by one of the two.
            assert!(glint.f >= f && glint.f <= glint.visible_pdf);
        }
    }
}
