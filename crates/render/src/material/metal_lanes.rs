// SPDX-License-Identifier: MIT OR Apache-2.0
//! From measurements by wavelength to one complex index of refraction for each of red, green and blue.
//!
//! A lane of a picture is no wavelength but the answer of a receptor to all of them. So for each lane that index is
//! looked for which reflects what the lane receives from the metal in daylight: at a right angle exactly, and at 80
//! degrees, where metals differ most in how they whiten. All indices that reflect r at a right angle have
//! `k^2 = (r (n + 1)^2 - (n - 1)^2) / (1 - r)` (Gulbrandsen, "Artist Friendly Metallic Fresnel", JCGT 3(4), 2014,
//! equation 5), and the smaller n is, the earlier the metal whitens.

use dioptric_math::Spectrum;

use super::Conductor;
use super::metal_data::Measured;
use crate::observer::{OBSERVER, to_rgb};

/// Relative spectral power of daylight, illuminant D65, at the same wavelengths (CIE 015:2018, table 5).
const DAYLIGHT: [f64; 16] = [
    82.7549, 93.4318, 104.865, 117.812, 115.923, 109.354, 104.79, 104.405, 100.0, 95.788, 90.0062,
    87.6987, 83.6992, 80.2146, 78.2842, 71.6091,
];

/// The colour of a reflectance by wavelength in daylight, 1 in all lanes where it is 1 everywhere.
fn color_of(mut reflectance: impl FnMut(f64) -> f64) -> Spectrum {
    let (mut seen, mut white) = ([0.0; 3], [0.0; 3]);
    for (i, (observer, power)) in OBSERVER.iter().zip(DAYLIGHT).enumerate() {
        let r = reflectance(400.0 + 20.0 * i as f64);
        for lane in 0..3 {
            white[lane] += observer[lane] * power;
            seen[lane] += observer[lane] * power * r;
        }
    }
    to_rgb(seen) / to_rgb(white)
}

/// The cosine of 80 degrees.
const GRAZING: f64 = 0.173_648_177_666_930_33;

/// What a metal reflects at an angle, as a colour in daylight, and the most that it reflects of any wavelength there.
/// No lane reflects more than that: red of gold lies just outside of what Rec. 709 can show.
fn seen(metal: &Measured, cos: f64) -> Spectrum {
    let mut most: f64 = 0.0;
    let color = color_of(|wavelength| {
        let [n, k] = metal.at(wavelength).map(Spectrum::splat);
        let share = Conductor::lanes(n, k, cos).x;
        most = most.max(share);
        share
    });
    color.clamp(Spectrum::ZERO, Spectrum::splat(most))
}

/// The metal that reflects `normal` at a right angle and, as far as there is one, `grazing` at 80 degrees.
fn fit(normal: f64, grazing: f64) -> [f64; 2] {
    let r = normal.clamp(0.0, 0.999);
    let k = |n: f64| {
        let (more, less) = (n + 1.0, n - 1.0);
        ((r * more * more - less * less) / (1.0 - r)).max(0.0).sqrt()
    };
    let root = r.sqrt();
    let (mut low, mut high) = ((1.0 - r) / (1.0 + r), (1.0 + root) / (1.0 - root));
    for _ in 0..60 {
        let n = 0.5 * (low + high);
        let share = Conductor::lanes(Spectrum::splat(n), Spectrum::splat(k(n)), GRAZING).x;
        if share > grazing { low = n } else { high = n }
    }
    let n = 0.5 * (low + high);
    [n, k(n)]
}

/// A named metal.
pub(super) fn named(name: &str) -> Option<Conductor> {
    let metal = Measured::of(name)?;
    let (normal, grazing) = (seen(metal, 1.0), seen(metal, GRAZING));
    let lanes = [0, 1, 2].map(|lane| fit(normal[lane], grazing[lane]));
    let [n, k] = [0, 1].map(|i| Spectrum::from(lanes.map(|lane| lane[i])));
    Some(Conductor::new(n, k))
}

#[cfg(test)]
mod tests {
    use super::super::metal_data::NAMES;
    use super::*;

    #[test]
    fn white_is_white_and_daylight_has_its_chromaticity() {
        assert_eq!(color_of(|_| 1.0), Spectrum::ONE);
        assert!((color_of(|_| 0.5) - Spectrum::splat(0.5)).length() < 1e-15);
        let mut sum = [0.0; 3];
        for (observer, power) in OBSERVER.iter().zip(DAYLIGHT) {
            (0..3).for_each(|lane| sum[lane] += observer[lane] * power);
        }
        let total: f64 = sum.iter().sum();
        // D65 is (0.3127, 0.3290); steps of 20 nm miss it by little.
        assert!((sum[0] / total - 0.3127).abs() < 2e-3 && (sum[1] / total - 0.3290).abs() < 2e-3);
        // Only long wavelengths are red, only short ones blue.
        let (red, blue) = (color_of(|w| f64::from(w > 590.0)), color_of(|w| f64::from(w < 490.0)));
        assert!(red.x > 0.8 && red.y < 0.2 && red.z.abs() < 0.1, "{red}");
        assert!(blue.z > 0.8 && blue.y < 0.2 && blue.x.abs() < 0.2, "{blue}");
    }

    #[test]
    fn lanes_reflect_what_is_seen_of_the_spectrum_at_every_angle() {
        for name in NAMES {
            let (metal, lanes) = (Measured::of(name).unwrap(), named(name).unwrap());
            assert!((lanes.at(1.0) - seen(metal, 1.0)).abs().max_element() < 1e-9, "{name}");
            for cos in [0.9, 0.7, 0.5, 0.3, GRAZING, 0.1, 0.03] {
                let off = (lanes.at(cos) - seen(metal, cos)).abs().max_element();
                assert!(off < 0.006, "{name} {cos}: {off}");
            }
        }
    }

    #[test]
    fn metals_look_as_they_do() {
        // Worked out by a separate program from the same tables, red of gold but for the largest share.
        for (name, expected) in [
            ("gold", [0.971, 0.7294, 0.3652]),
            ("copper", [0.9294, 0.6230, 0.5222]),
            ("silver", [0.9893, 0.9841, 0.9777]),
            ("aluminium", [0.9072, 0.9157, 0.9222]),
        ] {
            let difference = named(name).unwrap().at(1.0) - Spectrum::from(expected);
            assert!(difference.abs().max_element() < 1e-3, "{name} {difference}");
        }
        // Aluminium dips before it whitens, silver hardly does.
        let [dip, none] = ["aluminium", "silver"].map(|name| {
            let metal = named(name).unwrap();
            metal.at(1.0).y - metal.at(0.15).y
        });
        assert!(dip > 0.01 && none < 0.01, "{dip} {none}");
    }
}
