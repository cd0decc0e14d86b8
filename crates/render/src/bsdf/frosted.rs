// SPDX-License-Identifier: MIT OR Apache-2.0
//! Rough dielectrics: frosted glass.
//!
//! Walter et al., "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007, equations 16 to 21, with
//! facets that are seen (Heitz 2018). What is reflected is masked and shadowed by facets of the same height
//! (Heitz 2014, equation 99); for what goes through the two are independent, as with Walter.
//!
//! Light that meets several facets is not lost but leaves to both sides, as with rough mirrors (Kulla
//! and Conty, "Revisiting Physically Based Shading at Imageworks", SIGGRAPH 2017 course).

use std::f64::consts::FRAC_1_PI;

use dioptric_math::{DVec3, Spectrum, normalize};

use super::BsdfSample;
use super::ggx::{Facets, mirrored};
use super::glass::Interface;
use super::loss::Loss;
use super::often;
use crate::integrator::optics::refract;

/// A rough dielectric, seen from one direction.
#[derive(Clone, Copy, Debug)]
pub struct Frosted {
    interface: Interface,
    facets: Facets,
    /// The losses on the viewer's side and on the other.
    loss: [Loss; 2],
    /// What several facets send to either side: times the loss in the other direction.
    often: [f64; 2],
    /// The chance to look for that.
    chance: f64,
    /// The chance that it goes through.
    through: f64,
}

impl Frosted {
    /// A dielectric with facets of width `alpha`.
    pub(super) fn new(interface: Interface, alpha: f64, wo: DVec3) -> Self {
        let eta = interface.eta;
        let loss = [Loss::of_dielectric(alpha, eta), Loss::of_dielectric(alpha, 1.0 / eta)];
        let [near, far] = [loss[0].mean(), loss[1].mean()];
        let lost = loss[0].at(wo.z);
        // Light may go either way only if the shares that go through, over the mean loss on the other side and the
        // square of the index there, are equal: as Fresnel's are but for the losses. Of those the smaller gives way.
        let through = enters(eta) * (far / near).min(1.0);
        let back = interface.reflect.max_element() * (1.0 - through);
        let on = interface.transmit.max_element() * through;
        let most = interface.reflect.max_element().max(interface.transmit.max_element());
        let many = (back + on) * lost;
        let all = many + most * (1.0 - lost);
        Self {
            interface,
            facets: Facets::new(alpha, wo),
            loss,
            often: [
                (1.0 - through) * lost / near * FRAC_1_PI,
                through * lost / far * FRAC_1_PI * interface.squeezed(),
            ],
            chance: if many > 0.0 { many / all } else { 0.0 },
            through: if on > 0.0 { on / (back + on) } else { 0.0 },
        }
    }

    #[inline]
    pub(super) fn eval_pdf(&self, wo: DVec3, wi: DVec3) -> (Spectrum, f64) {
        let it = &self.interface;
        let (f, pdf) = match self.facets.glint(wo, wi) {
            Some(once) => {
                let reflected = it.reflected(once.cos);
                (reflected * once.f, it.chance(reflected) * once.visible_pdf)
            }
            None => self.refracted(wo, wi),
        };
        let side = usize::from(wi.z < 0.0);
        let height = wi.z.abs();
        let tint = if side == 0 { it.reflect } else { it.transmit };
        let often = self.often[side] * self.loss[side].at(height) * height;
        let share = if side == 0 { 1.0 - self.through } else { self.through };
        let around = share * often::density(self.facets.alpha, height);
        (tint * (f + often), (1.0 - self.chance) * pdf + self.chance * around)
    }

    /// What one facet refracts, and its density.
    #[inline]
    fn refracted(&self, wo: DVec3, wi: DVec3) -> (f64, f64) {
        let it = &self.interface;
        let Some(m) = normalize(wo * it.eta + wi).filter(|_| wi.z < 0.0) else { return (0.0, 0.0) };
        let m = if m.z < 0.0 { -m } else { m };
        let (cos_o, cos_i) = (wo.dot(m), wi.dot(m));
        if cos_o <= 0.0 || cos_i >= 0.0 {
            return (0.0, 0.0);
        }
        let reflected = it.reflected(cos_o);
        // Solid angles around the facet's normal, for each around wi (equation 17).
        let k = it.eta * cos_o + cos_i;
        let pdf = self.facets.visible_density(wo, m) * -cos_i / (k * k);
        let f = pdf * self.facets.shown(wi) * (1.0 - reflected) * it.squeezed();
        (f, (1.0 - it.chance(reflected)) * pdf)
    }

    #[inline]
    pub(super) fn sample(&self, wo: DVec3, pick: f64, u: [f64; 2]) -> Option<BsdfSample> {
        let wi = if pick < self.chance {
            let wi = often::direction(self.facets.alpha, u)?;
            if pick < self.chance * self.through { -wi } else { wi }
        } else {
            let m = self.facets.visible_normal(wo, u);
            let chance = self.interface.chance(self.interface.reflected(wo.dot(m)));
            let back = pick - self.chance < chance * (1.0 - self.chance);
            let wi = if back { mirrored(wo, m) } else { refract(-wo, m, self.interface.eta)? };
            // A facet may send light to the wrong side of the surface.
            if (wi.z > 0.0) != back || wi.z == 0.0 {
                return None;
            }
            wi
        };
        let (f, pdf) = self.eval_pdf(wo, wi);
        (pdf > 0.0).then(|| BsdfSample { wi, weight: f / pdf, pdf })
    }
}

/// About the share of light from everywhere that goes through a smooth dielectric (Kulla and Conty's fit for the
/// denser side; for the other what enters must be what leaves, by the square of the index).
fn enters(eta: f64) -> f64 {
    let n = eta.max(1.0 / eta);
    let enters = 1.0 - (n - 1.0) / (4.085_67 + 1.000_71 * n);
    if eta < 1.0 { enters } else { enters / (n * n) }
}

#[cfg(test)]
mod tests {
    use super::super::Sides;
    use super::super::glass::Glass;
    use super::*;

    #[test]
    fn hardly_frosted_glass_is_clear() {
        let wo = DVec3::new(0.6, 0.0, 0.8);
        for eta in [1.0 / 1.5, 1.5] {
            let sides = Sides { eta, outside: eta < 1.0, solid: true };
            let interface = Interface::new(&sides, Spectrum::ONE, Spectrum::ONE);
            let rough = Frosted::new(interface, 2e-4, wo);
            for pick in [0.03, 0.3, 0.9] {
                let clear = Glass { interface }.sample(wo, pick).unwrap();
                let frosted = rough.sample(wo, pick, [0.3, 0.4]).unwrap();
                assert!((clear.wi - frosted.wi).length() < 2e-3, "{eta} {pick}");
                assert!((clear.weight - frosted.weight).length() < 5e-3, "{eta} {pick}");
            }
        }
    }

    #[test]
    fn one_facet_refracts_as_in_another_program() {
        // Mitsuba 3.9.1, `roughdielectric` with ggx, int_ior 1.5, ext_ior 1, eval in single precision.
        let at = |z: f64, phi: f64| {
            let (s, c) = dioptric_math::sin_cos(phi);
            let r = (1.0 - z * z).sqrt();
            DVec3::new(r * c, r * s, z)
        };
        let sides = Sides { eta: 1.0 / 1.5, outside: true, solid: true };
        let interface = Interface::new(&sides, Spectrum::ONE, Spectrum::ONE);
        for (alpha, wo, wi, expected) in [
            (0.2, at(0.9, 0.0), at(-0.8, 3.1), 0.068_217_84),
            (0.2, at(0.4, 0.0), at(-0.7, 2.9), 0.628_022_02),
            (0.5, at(0.9, 0.0), at(-0.8, 3.1), 0.347_356_68),
            (0.5, at(0.4, 0.0), at(-0.7, 2.9), 0.856_281_10),
        ] {
            let (f, _) = Frosted::new(interface, alpha, wo).refracted(wo, wi);
            assert!((f / expected - 1.0).abs() < 1e-4, "{alpha} {wo}: {f}");
        }
    }

    #[test]
    fn what_goes_through_by_many_facets_may_come_back() {
        // The condition under which both ways are alike: share over the loss there and the square of the index.
        for (alpha, n) in [(0.1, 1.1), (0.5, 1.5), (1.0, 2.4)] {
            let share = |eta: f64| {
                let sides = Sides { eta, outside: eta < 1.0, solid: true };
                let interface = Interface::new(&sides, Spectrum::ONE, Spectrum::ONE);
                Frosted::new(interface, alpha, DVec3::Z).through
            };
            let mean = |eta| Loss::of_dielectric(alpha, eta).mean();
            let (inwards, outwards) = (share(1.0 / n), share(n));
            let (there, back) = (inwards / (mean(n) * n * n), outwards / mean(1.0 / n));
            assert!((there / back - 1.0).abs() < 1e-9, "{alpha} {n}");
            assert!((0.0..=1.0).contains(&inwards) && (0.0..=1.0).contains(&outwards));
        }
    }
}
