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
