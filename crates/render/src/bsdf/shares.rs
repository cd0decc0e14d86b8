// SPDX-License-Identifier: MIT OR Apache-2.0
//! What is seen through things that are transparent by fixed shares: bent by Snell's law and weighted by a
//! number, not by Fresnel's equations. It is the old ray tracers' recipe, and as there radiance is not changed by
//! going into or out of a denser medium.

use dioptric_math::{DVec3, Spectrum};

use super::BsdfSample;
use super::ggx::{image, straight_on};
use crate::integrator::optics::refract;

/// The way through a surface.
#[derive(Clone, Copy, Debug)]
pub struct Passing {
    /// Index of refraction on the viewer's side over that on the other; 1 for straight on.
    pub(super) eta: f64,
    /// Multiplies what is seen.
    pub(super) weight: Spectrum,
}

impl Passing {
    #[inline]
    pub(super) fn sample(&self, wo: DVec3) -> BsdfSample {
        let through =
            if self.eta == 1.0 { Some(straight_on(wo)) } else { refract(-wo, DVec3::Z, self.eta) };
        // All is reflected, from within or at a thinner medium from without.
        let wi = through.unwrap_or(image(wo));
        BsdfSample::sharp(wi, self.weight)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_bends_by_snell_and_is_mirrored_beyond_the_critical_angle() {
        let weight = Spectrum::splat(0.85);
        let wo = DVec3::new(0.6, 0.0, 0.8);
        let on = Passing { eta: 1.0 / 1.5, weight }.sample(wo);
        assert!((on.wi.x + 0.4).abs() < 1e-12 && on.wi.z < 0.0 && on.weight == weight);
        assert_eq!(Passing { eta: 1.0, weight }.sample(wo).wi, -wo);
        let mirrored = Passing { eta: 2.0, weight }.sample(wo);
        assert_eq!((mirrored.wi, mirrored.weight), (DVec3::new(-0.6, 0.0, 0.8), weight));
    }
}
