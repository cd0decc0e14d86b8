// SPDX-License-Identifier: MIT OR Apache-2.0
//! Rough panes without thickness: they mirror roughly, and what goes through goes straight on, as the two sides of a
//! thin sheet undo each other's bending.

use dioptric_math::{DVec3, Spectrum};

use super::BsdfSample;
use super::ggx::{Ggx, mirrored, straight_on};
use super::glass::Interface;
use super::mirror::Glint;

/// A rough pane, seen from one direction. What facets mirror onto other facets goes through in the end.
#[derive(Clone, Copy, Debug)]
pub struct Pane {
    interface: Interface,
    ggx: Ggx,
    lambda: f64,
}

impl Pane {
    /// A pane with facets of width `alpha`.
    pub(super) fn new(interface: Interface, alpha: f64, wo: DVec3) -> Self {
        let ggx = Ggx { alpha };
        Self { interface, ggx, lambda: ggx.lambda(wo) }
    }

    #[inline]
    pub(super) fn eval_pdf(&self, wo: DVec3, wi: DVec3) -> (Spectrum, f64) {
        match Glint::new(self.ggx, self.lambda, wo, wi) {
            Some(once) => {
                let f = self.interface.reflected(once.cos) * once.f;
                (self.interface.reflect * f, self.interface.chance(f / once.pdf) * once.pdf)
            }
            None => (Spectrum::ZERO, 0.0),
        }
    }

    #[inline]
    pub(super) fn sample(&self, wo: DVec3, pick: f64, u: [f64; 2]) -> Option<BsdfSample> {
        let it = &self.interface;
        let wi = mirrored(wo, self.ggx.visible_normal(wo, u));
        let once = Glint::new(self.ggx, self.lambda, wo, wi).filter(|once| once.pdf > 0.0);
        let reflected =
            once.as_ref().map_or(0.0, |once| it.reflected(once.cos) * once.f / once.pdf);
        let chance = it.chance(reflected);
        if let Some(once) = once.filter(|_| pick < chance) {
            return Some(BsdfSample {
                wi,
                weight: it.reflect * (reflected / chance),
                pdf: chance * once.pdf,
            });
        }
        let weight = it.transmit * ((1.0 - reflected) / (1.0 - chance));
        (weight != Spectrum::ZERO).then(|| BsdfSample::sharp(straight_on(wo), weight))
    }
}
