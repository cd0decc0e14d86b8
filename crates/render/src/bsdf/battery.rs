// SPDX-License-Identifier: MIT OR Apache-2.0
//! What every way to scatter light promises, for all lobes, widths and directions.

use dioptric_math::random::Random;
use dioptric_math::{DVec3, Spectrum};

use super::testing::{self, Case, cases, directions};
use super::{Bsdf, BsdfSample};
use crate::statistics::sidak;

/// Samples of one pair of surface and direction.
const SAMPLES: u32 = if cfg!(debug_assertions) { 2_000 } else { 20_000 };

/// Calls `check` with samples of every surface from every direction.
fn for_each(mut check: impl FnMut(&Case, &Bsdf, DVec3, &[Option<BsdfSample>])) {
    let mut random = Random::new(5);
    for case in cases() {
        for wo in directions() {
            let bsdf = case.bsdf(wo);
            let samples: Vec<_> = (0..SAMPLES)
                .map(|_| bsdf.sample(wo, random.unit(), [random.unit(), random.unit()]))
                .collect();
            check(&case, &bsdf, wo, &samples);
        }
    }
}

fn near(a: Spectrum, b: Spectrum, tolerance: f64) -> bool {
    (a - b).abs().max_element() <= tolerance * a.abs().max(b.abs()).max_element()
}

#[test]
fn weights_are_what_is_scattered_over_the_density() {
    for_each(|case, bsdf, wo, samples| {
        for s in samples.iter().flatten() {
            let name = &case.name;
            assert!((s.wi.length() - 1.0).abs() < 1e-9, "{name} {wo}: {s:?}");
            assert!(s.weight.is_finite() && s.weight.min_element() >= 0.0, "{name} {wo}: {s:?}");
            if s.is_sharp() {
                continue;
            }
            assert!(!bsdf.is_sharp(), "{name}");
            let (f, pdf) = (bsdf.eval(wo, s.wi), bsdf.pdf(wo, s.wi));
            assert!(s.pdf > 0.0 && (pdf / s.pdf - 1.0).abs() < 1e-4, "{name} {wo}: {s:?} {pdf}");
            assert!(near(f, s.weight * pdf, 1e-4), "{name} {wo}: {s:?} {f}");
        }
    });
}

#[test]
fn light_may_go_the_other_way() {
    for_each(|case, bsdf, wo, samples| {
        if !case.reciprocal {
            return;
        }
        for s in samples.iter().flatten().filter(|s| !s.is_sharp()).take(500) {
            let there = bsdf.eval(wo, s.wi) / s.wi.z.abs();
            // From the other side the surface is turned over, and radiance is squeezed the other way.
            let back = case.seen_from(s.wi);
            let flip = |w: DVec3| if s.wi.z < 0.0 { -w } else { w };
            let factor = if s.wi.z < 0.0 { case.sides.eta * case.sides.eta } else { 1.0 };
            let again = back.eval(flip(s.wi), flip(wo)) / wo.z * factor;
            assert!(near(there, again, 1e-4), "{} {wo} {}: {there} {again}", case.name, s.wi);
        }
    });
}

#[test]
fn nothing_gives_more_than_it_gets_and_what_is_white_gives_all() {
    for_each(|case, _, wo, samples| {
        let n = f64::from(SAMPLES);
        // Energy, not radiance: without the squeeze of refraction.
        let energy = |s: &BsdfSample| {
            let through = s.wi.z < 0.0 && case.squeezes();
            let e = s.weight.max_element();
            if through { e / (case.sides.eta * case.sides.eta) } else { e }
        };
        let all: Vec<f64> = samples.iter().map(|s| s.as_ref().map_or(0.0, energy)).collect();
        let mean = all.iter().sum::<f64>() / n;
        let variance = all.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / (n * n);
        let error = 4.0 * variance.sqrt();
        if let Some(most) = case.most {
            assert!(mean <= most + 0.01 + error, "{} {wo}: {mean} +- {error}", case.name);
        }
        if case.lossless {
            assert!((mean - 1.0).abs() <= 0.01 + error, "{} {wo}: {mean} +- {error}", case.name);
        }
    });
}

#[test]
fn samples_follow_their_density_by_chi_square() {
    // One direction for each surface, in turn.
    let pairs: Vec<_> = cases()
        .into_iter()
        .enumerate()
        .map(|(i, case)| (case, directions()[3 * i % 5]))
        .filter(|(case, wo)| !case.bsdf(*wo).is_sharp())
        .collect();
    let mut random = Random::new(11);
    let threshold = sidak(0.01, pairs.len());
    for (i, (case, wo)) in pairs.iter().enumerate() {
        // A million for some, fewer for the rest: what is wrong for one direction is for others, too.
        let n = match () {
            () if cfg!(debug_assertions) && i % 4 > 0 => continue,
            () if cfg!(debug_assertions) => 4_000,
            () if i % 8 == 0 => 1_000_000,
            () => 50_000,
        };
        let name = format!("{} {wo}", case.name);
        let verdict = testing::judge(&case.bsdf(*wo), *wo, n, &mut random);
        let (sum, found) = (verdict.integral, verdict.found);
        let error = 4.0 * (found * (1.0 - found) / f64::from(n)).sqrt();
        assert!(sum <= 1.01, "{name}: the density's integral is {sum}");
        assert!((sum - found).abs() < 2e-3 + error, "{name}: {sum}, but found {found}");
        let z = verdict.deviations;
        assert!(z < threshold, "{name}: {z} standard deviations");
    }
}

#[test]
fn nothing_breaks_at_the_ends() {
    let numbers = [0.0, 1e-300, 0.5, 1.0 - f64::EPSILON / 2.0];
    let grazing = |z: f64| DVec3::new(0.6, -0.8, z);
    for mut case in cases() {
        for strength in [1.0, 1e-300, 1e9, 1e150] {
            case.finish.diffuse *= strength;
            if let Some(h) = &mut case.finish.highlight {
                h.color *= strength;
                h.exponent = if h.exponent == 177.5 { 1e6 } else { h.exponent };
            }
            for wo in [grazing(0.0), grazing(-1e-17), grazing(1e-12), grazing(1e-6), DVec3::Z] {
                let bsdf = case.bsdf(wo);
                for pick in numbers {
                    for u in numbers.iter().flat_map(|a| numbers.map(|b| [*a, b])) {
                        let Some(s) = bsdf.sample(wo, pick, u) else { continue };
                        let what = format!("{} {wo} {pick} {u:?}: {s:?}", case.name);
                        assert!((s.wi.length() - 1.0).abs() < 1e-6, "{what}");
                        assert!(s.weight.is_finite() && s.weight.min_element() >= 0.0, "{what}");
                        assert!(s.pdf > 0.0 && s.wi.z != 0.0, "{what}");
                    }
                }
                for z in [-1.0, -1e-9, 0.0, 1e-17, 1e-9, 1.0_f64] {
                    let r = (1.0 - z * z).max(0.0).sqrt();
                    for wi in [DVec3::new(r, 0.0, z), DVec3::new(-0.6 * r, 0.8 * r, z), -wo] {
                        let (f, pdf) = bsdf.eval_pdf(wo, wi);
                        let what = format!("{} {wo} {wi}: {f} {pdf}", case.name);
                        assert!(f.is_finite() && f.min_element() >= 0.0, "{what}");
                        assert!(pdf.is_finite() && pdf >= 0.0, "{what}");
                    }
                }
            }
        }
    }
}
