// SPDX-License-Identifier: MIT OR Apache-2.0
//! Lambert's surface, and directions in proportion to their cosine.

use std::f64::consts::FRAC_1_PI;

use dioptric_math::{DVec3, Spectrum};

use super::BsdfSample;
use crate::sampling::warp::concentric_disc;

/// The same radiance to all sides (Lambert, "Photometria", 1760): `f = albedo / pi`.
#[derive(Clone, Copy, Debug)]
pub struct Lambert {
    pub(super) albedo: Spectrum,
}

impl Lambert {
    #[inline]
    pub(super) fn eval_pdf(&self, wi: DVec3) -> (Spectrum, f64) {
        let pdf = cosine_pdf(wi.z);
        (self.albedo * pdf, pdf)
    }

    #[inline]
    pub(super) fn sample(&self, u: [f64; 2]) -> Option<BsdfSample> {
        let wi = cosine_direction(u)?;
        Some(BsdfSample { wi, weight: self.albedo, pdf: cosine_pdf(wi.z) })
    }
}

/// A direction above the surface, by the cosine of its angle to z (Malley's method; Pharr, Jakob and Humphreys,
/// "Physically Based Rendering", 4th ed., section A.5.3), or just within it.
#[inline(always)]
pub(crate) fn raised_disc(u: [f64; 2]) -> DVec3 {
    let [x, y] = concentric_disc(u);
    DVec3::new(x, y, (1.0 - x * x - y * y).max(0.0).sqrt())
}

/// The same; `None` for one within the surface.
#[inline]
pub(super) fn cosine_direction(u: [f64; 2]) -> Option<DVec3> {
    let direction = raised_disc(u);
    (direction.z > 0.0).then_some(direction)
}

/// The density of [`cosine_direction`] over solid angles.
#[inline(always)]
pub(crate) fn cosine_pdf(cosine: f64) -> f64 {
    cosine.max(0.0) * FRAC_1_PI
}
