// SPDX-License-Identifier: MIT OR Apache-2.0
//! The colours of metals, from their measured optical constants: reflectance by wavelength, seen by the
//! standard observer in daylight.

use dioptric_math::Spectrum;

/// A metal's index of refraction n and extinction coefficient k at [`WAVELENGTHS`].
struct Metal {
    name: &'static str,
    n: [f64; 12],
    k: [f64; 12],
}

/// In nanometres: photon energies of 3.12 to 1.76 eV, where Johnson and Christy measured.
const WAVELENGTHS: [f64; 12] =
    [397.4, 413.3, 430.5, 450.9, 471.4, 495.9, 520.9, 548.6, 582.1, 616.8, 659.5, 704.5];

/// The metals by name. Copper, gold and silver: Johnson and Christy, "Optical Constants of the Noble
/// Metals", Phys. Rev. B 6, 4370 (1972), table I. Chromium, iron, nickel and titanium: Johnson and
/// Christy, "Optical constants of transition metals", Phys. Rev. B 9, 5056 (1974). Aluminium: Rakic,
/// "Algorithm for the determination of intrinsic optical constants of metal films", Appl. Opt. 34, 4755
/// (1995). Brass, 70 % copper and 30 % zinc: Querry, "Optical constants", report CRDC-CR-85034 (1985).
/// The last two are interpolated to the same wavelengths.
#[expect(clippy::approx_constant, reason = "the k of chromium that looks like pi is measured")]
const METALS: [Metal; NAMES.len()] = [
    Metal {
        name: "aluminium",
        n: [0.481, 0.521, 0.572, 0.636, 0.709, 0.798, 0.892, 1.009, 1.169, 1.35, 1.624, 1.958],
        k: [4.803, 5.001, 5.215, 5.465, 5.712, 6.0, 6.291, 6.611, 6.988, 7.371, 7.8, 8.175],
    },
    Metal {
        name: "brass",
        n: [1.452, 1.387, 1.274, 1.085, 0.888, 0.71, 0.599, 0.53, 0.466, 0.45, 0.445, 0.447],
        k: [1.807, 1.791, 1.785, 1.834, 1.969, 2.207, 2.473, 2.751, 3.08, 3.406, 3.774, 4.142],
    },
    Metal {
        name: "chromium",
        n: [2.0, 2.08, 2.19, 2.33, 2.51, 2.75, 2.94, 3.18, 3.22, 3.17, 3.09, 3.05],
        k: [2.83, 2.93, 3.04, 3.14, 3.24, 3.3, 3.33, 3.33, 3.3, 3.3, 3.34, 3.39],
    },
    Metal {
        name: "copper",
        n: [1.32, 1.28, 1.25, 1.24, 1.25, 1.22, 1.18, 1.02, 0.7, 0.3, 0.22, 0.21],
        k: [2.116, 2.207, 2.305, 2.397, 2.483, 2.564, 2.608, 2.577, 2.704, 3.205, 3.747, 4.205],
    },
    Metal {
        name: "gold",
        n: [1.47, 1.46, 1.45, 1.38, 1.31, 1.04, 0.62, 0.43, 0.29, 0.21, 0.14, 0.13],
        k: [1.952, 1.958, 1.948, 1.914, 1.849, 1.833, 2.081, 2.455, 2.863, 3.272, 3.697, 4.103],
    },
    Metal {
        name: "iron",
        n: [2.24, 2.35, 2.48, 2.59, 2.67, 2.74, 2.86, 2.95, 2.94, 2.88, 2.92, 2.86],
        k: [2.58, 2.65, 2.71, 2.77, 2.82, 2.88, 2.91, 2.93, 2.99, 3.05, 3.1, 3.19],
    },
    Metal {
        name: "nickel",
        n: [1.72, 1.7, 1.71, 1.73, 1.78, 1.82, 1.85, 1.92, 1.96, 1.99, 1.99, 2.06],
        k: [2.57, 2.69, 2.82, 2.95, 3.09, 3.25, 3.42, 3.61, 3.8, 4.02, 4.26, 4.5],
    },
    Metal {
        name: "silver",
        n: [0.05, 0.05, 0.04, 0.04, 0.05, 0.05, 0.05, 0.06, 0.05, 0.06, 0.05, 0.04],
        k: [2.07, 2.275, 2.462, 2.657, 2.869, 3.093, 3.324, 3.586, 3.858, 4.152, 4.483, 4.838],
    },
    Metal {
        name: "titanium",
        n: [2.08, 2.14, 2.21, 2.27, 2.32, 2.36, 2.44, 2.54, 2.6, 2.67, 2.76, 2.86],
        k: [2.95, 2.98, 3.01, 3.04, 3.1, 3.19, 3.3, 3.43, 3.58, 3.72, 3.84, 3.96],
    },
];

/// The names, sorted.
pub(super) const NAMES: &[&str] =
    &["aluminium", "brass", "chromium", "copper", "gold", "iron", "nickel", "silver", "titanium"];

/// The CIE 1931 standard observer's colour-matching functions x, y and z from 400 to 700 nm in steps of
/// 20 (CIE 015:2018, table 6).
const OBSERVER: [[f64; 3]; 16] = [
    [0.01431, 0.000396, 0.06785],
    [0.13438, 0.004, 0.6456],
    [0.34828, 0.023, 1.74706],
    [0.2908, 0.06, 1.6692],
    [0.09564, 0.13902, 0.81295],
    [0.0049, 0.323, 0.272],
    [0.06327, 0.71, 0.07825],
    [0.2904, 0.954, 0.0203],
    [0.5945, 0.995, 0.0039],
    [0.9163, 0.87, 0.00165],
    [1.0622, 0.631, 0.0008],
    [0.85445, 0.381, 0.00019],
    [0.4479, 0.175, 2e-05],
    [0.1649, 0.061, 0.0],
    [0.04677, 0.017, 0.0],
    [0.011359, 0.004102, 0.0],
];

/// Relative spectral power of daylight, illuminant D65, at the same wavelengths (CIE 015:2018, table 5).
const DAYLIGHT: [f64; 16] = [
    82.7549, 93.4318, 104.865, 117.812, 115.923, 109.354, 104.79, 104.405, 100.0, 95.788, 90.0062,
    87.6987, 83.6992, 80.2146, 78.2842, 71.6091,
];

/// From XYZ to linear Rec. 709 (IEC 61966-2-1:1999).
const TO_RGB: [[f64; 3]; 3] = [
    [3.2404542, -1.5371385, -0.4985314],
    [-0.9692660, 1.8760108, 0.0415560],
    [0.0556434, -0.2040259, 1.0572252],
];

/// Reflectance in air at a right angle: `((n - 1)^2 + k^2) / ((n + 1)^2 + k^2)` (Born and Wolf,
/// "Principles of Optics", 7th ed., section 14.2).
fn reflectance(n: f64, k: f64) -> f64 {
    ((n - 1.0) * (n - 1.0) + k * k) / ((n + 1.0) * (n + 1.0) + k * k)
}

/// The value at a wavelength, linearly between the table's.
fn at(values: &[f64; 12], wavelength: f64) -> f64 {
    let i = WAVELENGTHS.partition_point(|&w| w <= wavelength).clamp(1, 11);
    let share = (wavelength - WAVELENGTHS[i - 1]) / (WAVELENGTHS[i] - WAVELENGTHS[i - 1]);
    values[i - 1] + (values[i] - values[i - 1]) * share
}

/// The colour of a reflectance by wavelength in daylight, 1 in all lanes where it is 1 everywhere.
fn color_of(reflectance: impl Fn(f64) -> f64) -> Spectrum {
    let (mut seen, mut white) = ([0.0; 3], [0.0; 3]);
    for (i, (observer, power)) in OBSERVER.iter().zip(DAYLIGHT).enumerate() {
        let r = reflectance(400.0 + 20.0 * i as f64);
        for lane in 0..3 {
            white[lane] += observer[lane] * power;
            seen[lane] += observer[lane] * power * r;
        }
    }
    let rgb = |xyz: [f64; 3]| {
        Spectrum::from(TO_RGB.map(|row| row[0] * xyz[0] + row[1] * xyz[1] + row[2] * xyz[2]))
    };
    rgb(seen) / rgb(white)
}

/// The colour of a named metal at a right angle, each lane cut off at 1: red of gold lies just outside
/// of what Rec. 709 can show.
pub(super) fn named(name: &str) -> Option<Spectrum> {
    let metal = METALS.iter().find(|m| m.name == name)?;
    let by_wavelength = |w| reflectance(at(&metal.n, w), at(&metal.k, w));
    Some(color_of(by_wavelength).clamp(Spectrum::ZERO, Spectrum::ONE))
}

#[cfg(test)]
mod tests {
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
    fn values_are_interpolated_between_the_table_s() {
        let gold = METALS.iter().find(|m| m.name == "gold").unwrap();
        assert_eq!(at(&gold.k, 548.6), 2.455);
        assert!((at(&gold.n, 0.5 * (548.6 + 582.1)) - 0.36).abs() < 1e-12);
        // ((0.43 - 1)^2 + 2.455^2) / ((0.43 + 1)^2 + 2.455^2) = 6.351925 / 8.071925
        assert!((reflectance(0.43, 2.455) - 6.351_925 / 8.071_925).abs() < 1e-12);
        assert_eq!(reflectance(1.0, 0.0), 0.0);
    }

    #[test]
    fn metals_look_as_they_do() {
        assert!(NAMES.is_sorted() && NAMES.iter().zip(&METALS).all(|(n, m)| *n == m.name));
        for name in NAMES {
            let color = named(name).unwrap();
            assert!(color.min_element() > 0.3 && color.max_element() <= 1.0, "{name} {color}");
        }
        // Worked out by a separate program from the same tables.
        for (name, expected) in [
            ("gold", [1.0, 0.7294, 0.3652]),
            ("copper", [0.9294, 0.6230, 0.5222]),
            ("silver", [0.9893, 0.9841, 0.9777]),
            ("aluminium", [0.9072, 0.9157, 0.9222]),
        ] {
            let difference = named(name).unwrap() - Spectrum::from(expected);
            assert!(difference.abs().max_element() < 2e-4, "{name} {}", named(name).unwrap());
        }
    }
}
