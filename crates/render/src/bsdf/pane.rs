// SPDX-License-Identifier: MIT OR Apache-2.0
//! Rough panes without thickness: they mirror roughly, and what goes through goes straight on, as the two sides of a
//! thin sheet undo each other's bending.

use dioptric_math::{DVec3, Spectrum};

use super::BsdfSample;
use super::ggx::{Facets, straight_on};
use super::glass::Interface;

/// A rough pane, seen from one direction. What facets mirror onto other facets goes through in the end.
#[derive(Clone, Copy, Debug)]
pub struct Pane {
    interface: Interface,
    facets: Facets,
}

impl Pane {
    /// A pane with facets of width `alpha`.
    pub(super) fn new(interface: Interface, alpha: f64, wo: DVec3) -> Self {
        Self { interface, facets: Facets::new(alpha, wo) }
    }

    #[inline]
    pub(super) fn eval_pdf(&self, wo: DVec3, wi: DVec3) -> (Spectrum, f64) {
        match self.facets.glint(wo, wi).filter(|once| once.pdf > 0.0) {
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
        let wi = self.facets.mirrored(wo, u);
        let once = self.facets.glint(wo, wi).filter(|once| once.pdf > 0.0);
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

#[cfg(test)]
mod tests {
    use super::super::Sides;
    use super::*;

    #[test]
    fn it_loses_nothing_however_rough_and_bends_nothing() {
        let sides = Sides { eta: 1.0 / 1.5, outside: true, solid: false };
        let interface = Interface::new(&sides, Spectrum::ONE, Spectrum::ONE);
        let wo = DVec3::new(0.8, 0.0, 0.6);
        for alpha in [1e-3, 0.3, 1.0] {
            let pane = Pane::new(interface, alpha, wo);
            for pick in [0.0, 0.05, 0.5] {
                for u in [[0.1, 0.2], [0.6, 0.7], [0.4, 0.95]] {
                    let sample = pane.sample(wo, pick, u).unwrap();
                    assert!((sample.weight - Spectrum::ONE).length() < 1e-9);
                    assert!(!sample.is_sharp() || sample.wi == -wo);
                }
            }
        }
    }
}
