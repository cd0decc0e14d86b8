// SPDX-License-Identifier: MIT OR Apache-2.0
//! Smooth dielectrics: one direction is reflected, one refracted.

use dioptric_math::{DVec3, Spectrum};

use super::ggx::{image, straight_on};
use super::{BsdfSample, Sides};
use crate::integrator::optics::{fresnel, refract};

/// What both smooth and rough dielectrics are.
///
/// Refraction changes radiance: a cone of light that enters glass gets narrower, and the radiance in it greater
/// by the square of the index (Veach, "Robust Monte Carlo Methods for Light Transport Simulation", 1997, section
/// 5.2). Weights have that factor, so that lights within glass are right; between two points outside of it, all
/// factors together are 1, and Whitted's pictures, which leave them out, agree.
#[derive(Clone, Copy, Debug)]
pub(super) struct Interface {
    /// Index of refraction on the viewer's side over that on the other.
    pub eta: f64,
    /// Whether it is one surface of a solid; a pane is both, and what goes through goes straight on.
    pub solid: bool,
    /// Multiplies what is reflected.
    pub reflect: Spectrum,
    /// Multiplies what goes through.
    pub transmit: Spectrum,
}

impl Interface {
    /// Tints are met on the outside, once.
    pub fn new(sides: &Sides, reflect: Spectrum, transmit: Spectrum) -> Self {
        let tint = |color| if sides.outside { color } else { Spectrum::ONE };
        Self {
            eta: sides.eta,
            solid: sides.solid,
            reflect: tint(reflect),
            transmit: tint(transmit),
        }
    }

    /// The share of light that is reflected, for the cosine of the angle of incidence.
    #[inline]
    pub fn reflected(&self, cos: f64) -> f64 {
        let r = fresnel(cos, self.eta);
        // To and fro between the two faces of a thin pane: r + (1-r)^2 r + (1-r)^2 r^3 + ...
        // (Born and Wolf, "Principles of Optics", 7th ed., section 7.6.1, without interference.)
        if self.solid { r } else { 2.0 * r / (1.0 + r) }
    }

    /// The chance to follow what is reflected where this share is.
    #[inline]
    pub fn chance(&self, reflected: f64) -> f64 {
        let back = reflected * self.reflect.max_element();
        let on = (1.0 - reflected) * self.transmit.max_element();
        if back > 0.0 { back / (back + on) } else { 0.0 }
    }

    /// The largest of its tints: about how much it sends to the viewer of light from everywhere.
    pub fn power(&self) -> f64 {
        self.reflect.max_element().max(self.transmit.max_element())
    }

    /// What radiance is multiplied by where it comes through.
    #[inline]
    pub fn squeezed(&self) -> f64 {
        if self.solid { self.eta * self.eta } else { 1.0 }
    }
}

/// A smooth dielectric.
#[derive(Clone, Copy, Debug)]
pub struct Glass {
    pub(super) interface: Interface,
}

impl Glass {
    #[inline]
    pub(super) fn sample(&self, wo: DVec3, pick: f64) -> Option<BsdfSample> {
        let it = &self.interface;
        let reflected = it.reflected(wo.z);
        let chance = it.chance(reflected);
        if pick < chance {
            return Some(BsdfSample::sharp(image(wo), it.reflect * (reflected / chance)));
        }
        let wi = if it.solid { refract(-wo, DVec3::Z, it.eta)? } else { straight_on(wo) };
        let weight = it.transmit * ((1.0 - reflected) / (1.0 - chance) * it.squeezed());
        (weight != Spectrum::ZERO).then(|| BsdfSample::sharp(wi, weight))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WHITE: [Spectrum; 2] = [Spectrum::ONE; 2];

    fn glass(eta: f64, solid: bool, [reflect, transmit]: [Spectrum; 2]) -> Glass {
        let sides = Sides { eta, outside: eta < 1.0 || !solid, solid };
        Glass { interface: Interface::new(&sides, reflect, transmit) }
    }

    #[test]
    fn fresnel_picks_the_way_and_radiance_is_squeezed() {
        let wo = DVec3::new(0.6, 0.0, 0.8);
        let reflected = fresnel(0.8, 1.0 / 1.5);
        let into = glass(1.0 / 1.5, true, WHITE);
        let back = into.sample(wo, reflected * 0.999).unwrap();
        assert_eq!(back.wi, DVec3::new(-0.6, 0.0, 0.8));
        assert!((back.weight - Spectrum::ONE).length() < 1e-12 && back.is_sharp());
        let on = into.sample(wo, reflected * 1.001).unwrap();
        assert!((on.wi.x + 0.4).abs() < 1e-12 && on.wi.z < 0.0);
        assert!((on.weight - Spectrum::splat(1.0 / 2.25)).length() < 1e-12);
        // Out again: the direction and the radiance that were.
        let out = glass(1.5, true, WHITE).sample(-on.wi, 0.999).unwrap();
        assert!((out.wi + wo).length() < 1e-12);
        assert!((on.weight * out.weight - Spectrum::ONE).length() < 1e-12);
    }

    #[test]
    fn nothing_leaves_beyond_the_critical_angle() {
        let inner = DVec3::new(0.8, 0.0, 0.6);
        for pick in [0.0, 0.5, 0.999_999] {
            let sample = glass(1.5, true, WHITE).sample(inner, pick).unwrap();
            assert_eq!((sample.wi, sample.weight), (DVec3::new(-0.8, 0.0, 0.6), Spectrum::ONE));
        }
    }

    #[test]
    fn tints_are_met_outside_and_what_is_black_is_not_looked_for() {
        let tints = [Spectrum::ZERO, Spectrum::new(0.2, 0.4, 1.0)];
        let wo = DVec3::Z;
        let on = glass(1.0 / 1.5, true, tints).sample(wo, 0.0).unwrap();
        assert!((on.weight - tints[1] * (0.96 / 2.25)).length() < 1e-12 && on.wi.z < 0.0);
        let inside = glass(1.5, true, tints);
        assert_eq!((inside.interface.reflect, inside.interface.transmit), (WHITE[0], WHITE[1]));
        // A pane has two outsides: 2 R / (1 + R) come back, the rest goes straight on.
        let pane = glass(1.0 / 1.5, false, WHITE);
        assert!((pane.interface.reflected(1.0) - 0.08 / 1.04).abs() < 1e-12);
        let on = pane.sample(DVec3::new(0.6, 0.0, 0.8), 0.99).unwrap();
        assert_eq!((on.wi, on.weight), (DVec3::new(-0.6, 0.0, -0.8), Spectrum::ONE));
    }
}
