// SPDX-License-Identifier: MIT OR Apache-2.0
//! What a surface is made of that has layers: fuzz over a clear coat over metal, glass or a dull ground.

use dioptric_math::Spectrum;

use super::Reflectance;
use crate::bsdf::FuzzShare;
use crate::integrator::optics::fresnel;

/// The index of refraction of clear coats.
pub const COAT_IOR: f64 = 1.5;

/// A surface in layers; all shares from 0 to 1. The colour of what is below is [`super::Finish::base`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layers {
    /// Index of refraction of what is no metal.
    pub ior: f64,
    /// Multiplies what that mirrors at a right angle.
    pub specular: f64,
    /// The share that is metal.
    pub metallic: f64,
    /// The GGX alpha of metal and of what is none.
    pub alpha: f64,
    /// The share of what is no metal that is clear.
    pub transmission: f64,
    /// How much of a coat there is.
    pub coat: f64,
    /// The coat's alpha.
    pub coat_alpha: f64,
    /// The colour of fuzz; black for none.
    pub sheen: Spectrum,
    /// The square root of the fuzz's alpha.
    pub sheen_roughness: f64,
}

impl Layers {
    /// A dull surface with its own reflection, and nothing else: for tests.
    #[cfg(test)]
    pub const PLAIN: Self = Self {
        ior: 1.5,
        specular: 1.0,
        metallic: 0.0,
        alpha: 0.0,
        transmission: 0.0,
        coat: 0.0,
        coat_alpha: 0.0,
        sheen: Spectrum::ZERO,
        sheen_roughness: 0.3,
    };

    /// The share that lets light through.
    #[must_use]
    pub fn clear(&self) -> f64 {
        (1.0 - self.metallic) * self.transmission
    }

    /// The share that is dull below.
    #[must_use]
    pub fn dull(&self) -> f64 {
        (1.0 - self.metallic) * (1.0 - self.transmission)
    }

    /// The index of refraction that mirrors what `specular` says.
    #[must_use]
    pub fn mirror_ior(&self) -> f64 {
        let root = (self.ior - 1.0) / (self.ior + 1.0);
        let mirrored = (root * root * self.specular).sqrt().min(0.999);
        (1.0 + mirrored) / (1.0 - mirrored)
    }

    /// What the metal reflects.
    #[must_use]
    pub const fn metal(color: Spectrum) -> Reflectance {
        Reflectance::Curve { normal: color, grazing: Spectrum::ONE }
    }

    /// What Whitted's mirrored ray is multiplied by at an angle with this cosine: the coat's share, and that of what is
    /// below.
    #[must_use]
    pub fn mirrors(&self, color: Spectrum, cos: f64) -> Spectrum {
        let coat = self.coat * fresnel(cos, 1.0 / COAT_IOR);
        let dull = fresnel(cos, 1.0 / self.mirror_ior());
        let clear = fresnel(cos, 1.0 / self.ior);
        let other = self.dull() * dull + self.clear() * clear;
        let below = Self::metal(color).at(cos) * self.metallic + other;
        Spectrum::splat(coat) + below * (1.0 - coat)
    }

    /// The alpha of Whitted's one mirrored ray: that of the coat where it is most of what mirrors.
    #[must_use]
    pub fn mirror_alpha(&self) -> f64 {
        if self.coat * (1.0 - self.metallic) > 0.5 { self.coat_alpha } else { self.alpha }
    }

    /// A dull colour with its fuzz, from all sides alike: what Whitted's pictures show of it.
    #[must_use]
    pub fn fuzzy(&self, color: Spectrum) -> Spectrum {
        let mean = FuzzShare::new(self.sheen_roughness).mean();
        color * (1.0 - mean * self.sheen.max_element()) + self.sheen * mean
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLAIN: Layers = Layers::PLAIN;

    #[test]
    fn shares_mirror_what_each_does() {
        let color = Spectrum::new(0.9, 0.6, 0.3);
        assert!((PLAIN.mirrors(color, 1.0) - Spectrum::splat(0.04)).length() < 1e-12);
        let metal = Layers { metallic: 1.0, ..PLAIN };
        assert!((metal.mirrors(color, 1.0) - color).length() < 1e-12);
        let coated = Layers { coat: 1.0, ..metal };
        let expected = Spectrum::splat(0.04) + color * 0.96;
        assert!((coated.mirrors(color, 1.0) - expected).length() < 1e-12);
        let none = Layers { specular: 0.0, ..PLAIN };
        assert_eq!(none.mirrors(color, 0.4), Spectrum::ZERO);
        for layers in [PLAIN, metal, coated] {
            assert!((layers.mirrors(color, 0.0) - Spectrum::ONE).length() < 1e-12);
            assert_eq!(layers.fuzzy(color), color);
        }
        assert!((PLAIN.mirror_ior() - 1.5).abs() < 1e-12);
    }
}
