// SPDX-License-Identifier: MIT OR Apache-2.0
//! Rough surfaces made of small mirrors: the GGX distribution of their normals, how they hide each other,
//! and how to pick one that is seen.
//!
//! Walter et al., "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007 (equations 33 and 34);
//! Heitz, "Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs", JCGT 3(2), 2014
//! (equations 72 and 99).

use std::f64::consts::PI;

use dioptric_math::{DVec3, normalize, sin_cos};

/// A surface with a smaller alpha is smooth: nobody could see the difference, and densities stay well within
/// what numbers hold.
pub(super) const SMOOTHEST: f64 = 1e-4;

/// Directions are at least so high over the surface, as far as they are divided by: bumps bend normals until they
/// are just seen, give or take what rounding does.
pub(super) const LOWEST: f64 = 1e-7;

/// The distribution of the normals around z.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ggx {
    /// Its width.
    pub alpha: f64,
}

impl Ggx {
    /// The density of facets with the unit normal `m`: their area per solid angle and unit of the surface.
    #[inline]
    pub fn density(self, m: DVec3) -> f64 {
        if m.z <= 0.0 {
            return 0.0;
        }
        let a2 = self.alpha * self.alpha;
        let k = m.x * m.x + m.y * m.y + a2 * m.z * m.z;
        a2 / (PI * k * k)
    }

    /// Smith's Lambda: facets seen that are hidden, per one that is not.
    #[inline]
    pub fn lambda(self, w: DVec3) -> f64 {
        let height = w.z.abs().max(LOWEST);
        let tan2 = (w.x * w.x + w.y * w.y) / (height * height);
        // Near the normal the difference with 1 would lose all digits.
        let k = self.alpha * self.alpha * tan2;
        if k < 1e-4 { k * (0.25 - k * 0.0625) } else { 0.5 * ((1.0 + k).sqrt() - 1.0) }
    }

    /// The share of the facets turned towards `w` that is not hidden from there.
    #[inline]
    pub fn g1(self, w: DVec3) -> f64 {
        1.0 / (1.0 + self.lambda(w))
    }

    /// The normal of a facet that `wo` (above the surface) sees, for two uniform numbers; its density over
    /// solid angles is `g1(wo) max(0, wo . m) density(m) / wo.z` (Dupuy and Benyoub, "Sampling Visible GGX
    /// Normals with Spherical Caps", HPG 2023, listing 3).
    #[inline]
    pub fn visible_normal(self, wo: DVec3, u: [f64; 2]) -> DVec3 {
        let stretch = DVec3::new(self.alpha, self.alpha, 1.0);
        let v = normalize(wo * stretch).unwrap_or(DVec3::Z);
        let (s, c) = sin_cos(2.0 * PI * u[0]);
        let z = (1.0 - u[1]) * (1.0 + v.z) - v.z;
        let r = (1.0 - z * z).max(0.0).sqrt();
        let m = DVec3::new(r * c, r * s, z) + v;
        normalize(DVec3::new(m.x, m.y, m.z.max(0.0)) * stretch).unwrap_or(DVec3::Z)
    }
}

/// The mirror image of `wo`, above the surface.
#[inline]
pub(super) fn image(wo: DVec3) -> DVec3 {
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
