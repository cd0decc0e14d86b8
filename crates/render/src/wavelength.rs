// SPDX-License-Identifier: MIT OR Apache-2.0
//! Light of one wavelength, for glass that bends each by its own angle.
//!
//! A path carries red, green and blue until it meets such glass. Then it picks one wavelength and goes on with that alone,
//! each lane multiplied by how much of it has that wavelength, over the density of the choice: in the mean, and so wherever
//! it does not matter where the wavelength goes, by 1.
//!
//! How much of a lane has which wavelength is what a display must show for it: the colour matching functions of
//! CIE 1931 (by the formulas of Wyman, Sloan and Shirley, "Simple Analytic Approximations to the CIE XYZ Color Matching
//! Functions", JCGT 2(2), 2013, section 2.2) as linear sRGB. Where a pure colour lies outside of what sRGB can show, a lane
//! would be negative there: it is cut off at 0, and each lane made to have the integral 1 again.

use std::sync::LazyLock;

use dioptric_math::{Spectrum, exp};

/// From where to where, in nanometres, in steps of 1.
const FIRST: f64 = 390.0;
const COUNT: usize = 320;

/// What each lane has of each wavelength.
static LANES: LazyLock<Lanes> = LazyLock::new(Lanes::new);

/// Densities over wavelengths, the same within each nanometre, and their sums up to each.
struct Lanes {
    density: Vec<[f64; 3]>,
    below: [Vec<f64>; 3],
}

/// How far from a hint, in nanometres, and how often.
const NEAR: f64 = 15.0;
const HINTED: f64 = 0.6;

/// A wavelength for a path that carries `throughput`, in micrometres, and what multiplies its lanes; `u` is uniform in
/// `[0, 1)`. With a `hint` (not 0) it is often one near that, and counts by how often it is picked then.
#[must_use]
pub fn pick(throughput: Spectrum, hint: f64, u: f64) -> (f64, Spectrum) {
    let hinted = if hint > 0.0 { HINTED } else { 0.0 };
    let hint = hint * 1e3;
    let carried = throughput.max(Spectrum::ZERO);
    let sum = carried.x + carried.y + carried.z;
    let chances = if sum > 0.0 { (carried / sum).to_array() } else { [1.0 / 3.0; 3] };
    let lanes = &*LANES;
    let weigh = |nm: f64| {
        let place = ((nm - FIRST) as usize).min(COUNT - 1);
        let inside = nm >= FIRST && nm < FIRST + COUNT as f64;
        let density = if inside { lanes.density[place] } else { [0.0; 3] };
        let own: f64 = chances.iter().zip(density).map(|(chance, d)| chance * d).sum();
        let near = if (nm - hint).abs() <= NEAR { hinted / (2.0 * NEAR) } else { 0.0 };
        let all = (1.0 - hinted) * own + near;
        if all > 0.0 { Spectrum::from(density) / all } else { Spectrum::ZERO }
    };
    if u < hinted {
        let nm = hint + NEAR * (2.0 * (u / hinted) - 1.0);
        return (nm * 1e-3, weigh(nm));
    }
    let (mut lane, mut rest) = (0, (u - hinted) / (1.0 - hinted));
    while lane < 2 && rest >= chances[lane] {
        rest -= chances[lane];
        lane += 1;
    }
    let rest =
        if chances[lane] > 0.0 { (rest / chances[lane]).min(1.0 - f64::EPSILON) } else { 0.0 };
    let below = &lanes.below[lane];
    let place = below.partition_point(|&sum| sum <= rest).clamp(1, COUNT) - 1;
    let within = (rest - below[place]) / lanes.density[place][lane].max(f64::MIN_POSITIVE);
    let nm = FIRST + place as f64 + within.clamp(0.0, 1.0 - 1e-9);
    (nm * 1e-3, weigh(nm))
}

impl Lanes {
    fn new() -> Self {
        let mut density: Vec<[f64; 3]> =
            (0..COUNT).map(|i| srgb(FIRST + 0.5 + i as f64).map(|x| x.max(0.0))).collect();
        let below = [0, 1, 2].map(|lane| {
            let whole: f64 = density.iter().map(|d| d[lane]).sum();
            let mut sum = 0.0;
            let mut below = vec![0.0];
            for d in &mut density {
                d[lane] /= whole;
                sum += d[lane];
                below.push(sum);
            }
            below
        });
        Self { density, below }
    }
}

/// Linear sRGB of light of one wavelength in nanometres, by the colour matching functions.
fn srgb(nm: f64) -> [f64; 3] {
    let lobe = |height: f64, middle: f64, left: f64, right: f64| {
        let x = (nm - middle) / if nm < middle { left } else { right };
        height * exp(-0.5 * x * x)
    };
    let x = lobe(1.056, 599.8, 37.9, 31.0) + lobe(0.362, 442.0, 16.0, 26.7)
        - lobe(0.065, 501.1, 20.4, 26.2);
    let y = lobe(0.821, 568.8, 46.9, 40.5) + lobe(0.286, 530.9, 16.3, 31.1);
    let z = lobe(1.217, 437.0, 11.8, 36.0) + lobe(0.681, 459.0, 26.0, 13.8);
    // IEC 61966-2-1.
    [
        3.240_969_9 * x - 1.537_383_2 * y - 0.498_610_8 * z,
        -0.969_243_6 * x + 1.875_967_5 * y + 0.041_555_1 * z,
        0.055_630_1 * x - 0.203_977_0 * y + 1.056_971_5 * z,
    ]
}

/// How an index of refraction depends on the wavelength: Cauchy's formula `a + b / wavelength^2`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cauchy {
    a: f64,
    b: f64,
}

/// Fraunhofer's lines d, F and C, in micrometres.
const LINES: [f64; 3] = [0.587_561_8, 0.486_132_7, 0.656_272_5];

impl Cauchy {
    /// Of glass with the index `ior` at the line d and Abbe's number `(n_d - 1) / (n_F - n_C)`.
    #[must_use]
    pub fn new(ior: f64, abbe: f64) -> Self {
        let [d, f, c] = LINES.map(|line| 1.0 / (line * line));
        let b = (ior - 1.0) / (abbe * (f - c));
        Self { a: ior - b * d, b }
    }

    /// The index for a wavelength in micrometres.
    #[must_use]
    pub fn ior(&self, wavelength: f64) -> f64 {
        (self.a + self.b / (wavelength * wavelength)).max(0.05)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lanes_keep_their_light() {
        for throughput in [Spectrum::ONE, Spectrum::new(0.1, 0.0, 2.0), Spectrum::X, Spectrum::ZERO]
        {
            let n = 100_000;
            let mut sum = Spectrum::ZERO;
            let mut last = 0.0;
            for i in 0..n {
                let (wavelength, weight) =
                    pick(throughput, 0.0, (f64::from(i) + 0.5) / f64::from(n));
                assert!((0.39..=0.71).contains(&wavelength) && weight.min_element() >= 0.0);
                if throughput == Spectrum::X {
                    assert!(wavelength >= last, "one lane is picked in order");
                    last = wavelength;
                }
                sum += weight / f64::from(n);
            }
            for (lane, carried) in throughput.to_array().into_iter().enumerate() {
                if carried > 0.0 || throughput == Spectrum::ZERO {
                    assert!((sum[lane] - 1.0).abs() < 1e-3, "{throughput}: {sum}");
                }
            }
        }
    }

    #[test]
    fn wavelengths_are_picked_as_often_as_they_count() {
        for (i, hint) in [0.0, 0.45, 0.7].into_iter().enumerate() {
            let throughput = Spectrum::new(0.9, 0.3, 0.5);
            let chances = (throughput / 1.7).to_array();
            let span = COUNT as f64 + 2.0 * NEAR;
            let nm = |a: f64| FIRST - NEAR + a * span;
            // What multiplies a lane is what the lane has of the wavelength over the density of the choice.
            let verdict = crate::statistics::judge(
                [70, 1],
                [500, 1],
                |[a, _]| {
                    let place = (nm(a) - FIRST) as usize;
                    let inside = nm(a) >= FIRST && place < COUNT;
                    let lanes = if inside { LANES.density[place] } else { [0.0; 3] };
                    let own: f64 = (0..3).map(|lane| chances[lane] * lanes[lane]).sum();
                    let hinted = if hint > 0.0 { HINTED } else { 0.0 };
                    let near = (nm(a) - 1e3 * hint).abs() <= NEAR;
                    let near = if near { hinted / (2.0 * NEAR) } else { 0.0 };
                    ((1.0 - hinted) * own + near) * span
                },
                |r| {
                    let (wavelength, weight) = pick(throughput, hint, r.unit());
                    assert!(weight.is_finite());
                    Some([(wavelength * 1e3 - nm(0.0)) / span, 0.5])
                },
                3 + i as u64,
            );
            verdict.check(&format!("hint {hint}"), 3);
        }
    }

    #[test]
    fn hints_change_no_mean() {
        for hint in [0.39, 0.45, 0.58, 0.7] {
            let n = 100_000;
            let (mut sum, mut near) = (Spectrum::ZERO, 0);
            for i in 0..n {
                let u = (f64::from(i) + 0.5) / f64::from(n);
                let (wavelength, weight) = pick(Spectrum::ONE, hint, u);
                sum += weight / f64::from(n);
                near += i32::from((wavelength - hint).abs() <= 0.015);
            }
            assert!((sum - Spectrum::ONE).length() < 2e-3, "{hint}: {sum}");
            assert!(near > n / 2);
        }
    }

    #[test]
    fn colours_are_where_they_should_be() {
        let brightest = |nm: f64| {
            let i = (nm - FIRST) as usize;
            let d = LANES.density[i];
            (0..3).max_by(|&a, &b| d[a].total_cmp(&d[b])).unwrap()
        };
        assert_eq!([450.0, 530.0, 620.0].map(brightest), [2, 1, 0]);
        // Violet has some red again, as the eye has it.
        assert!(LANES.density[30][0] > 0.0 && LANES.density[110][0] == 0.0);
    }

    #[test]
    fn indices_are_those_of_the_catalogue() {
        // Schott's catalogue of BK7: n_F = 1.52238, n_C = 1.51432.
        let bk7 = Cauchy::new(1.5168, 64.17);
        let [d, f, c] = LINES.map(|line| bk7.ior(line));
        assert!((d - 1.5168).abs() < 1e-12);
        assert!(((d - 1.0) / (f - c) - 64.17).abs() < 1e-9);
        assert!((f - 1.52238).abs() < 2e-4 && (c - 1.51432).abs() < 2e-4, "{f} {c}");
    }
}
