// SPDX-License-Identifier: MIT OR Apache-2.0
//! The clear sky and the sun in it.
//!
//! Preetham, Shirley and Smits, "A Practical Analytic Model for Daylight", SIGGRAPH 1999: the luminance and chromaticity
//! of the sky (appendix A.2), and what the air leaves of the sun's light (appendix A.1; the spectrum above the air is
//! that of Thekaekara, "Extraterrestrial Solar Spectrum", NASA 1974, as in ASTM E490-73a). Water vapour and mixed gases, which
//! absorb beyond 690 nm, are left out.

use std::f64::consts::PI;

use dioptric_math::{DVec3, Spectrum, acos, cos, exp, pow, tan};

use crate::observer::{OBSERVER, WAVELENGTHS, to_rgb};

/// The illuminance that is 1: a white surface that gets so many lux is white.
const LUX: f64 = 1e5;

/// Lumens per watt at 555 nm.
const LUMENS: f64 = 683.0;

/// Above the air, in W / (m^2 nm), and the absorption of ozone in 1/cm, at the observer's wavelengths.
const SUN: [f64; 16] = [
    1.429, 1.747, 1.810, 2.066, 2.074, 1.942, 1.833, 1.783, 1.695, 1.715, 1.666, 1.602, 1.544,
    1.486, 1.427, 1.369,
];
const OZONE: [f64; 16] = [
    0.0, 0.0, 0.002, 0.006, 0.014, 0.03, 0.048, 0.075, 0.103, 0.12, 0.125, 0.105, 0.079, 0.067,
    0.036, 0.023,
];

/// Five numbers of Perez's formula, each `a T + b`, for Y, x and y (table 2).
const PEREZ: [[[f64; 2]; 5]; 3] = [
    [[0.1787, -1.4630], [-0.3554, 0.4275], [-0.0227, 5.3251], [0.1206, -2.5771], [-0.0670, 0.3703]],
    [
        [-0.0193, -0.2592],
        [-0.0665, 0.0008],
        [-0.0004, 0.2125],
        [-0.0641, -0.8989],
        [-0.0033, 0.0452],
    ],
    [
        [-0.0167, -0.2608],
        [-0.0950, 0.0092],
        [-0.0079, 0.2102],
        [-0.0441, -1.6537],
        [-0.0109, 0.0529],
    ],
];

/// The chromaticity at the zenith: rows by the square of T, T and 1, columns by powers of the sun's angle from 3 to 0.
const ZENITH: [[[f64; 4]; 3]; 2] = [
    [
        [0.001_66, -0.003_75, 0.002_09, 0.0],
        [-0.029_03, 0.063_77, -0.032_02, 0.003_94],
        [0.116_93, -0.211_96, 0.060_52, 0.258_86],
    ],
    [
        [0.002_75, -0.006_10, 0.003_17, 0.0],
        [-0.042_14, 0.089_70, -0.041_53, 0.005_16],
        [0.153_46, -0.267_56, 0.066_70, 0.266_88],
    ],
];

/// A sky with the sun at one place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Daylight {
    turbidity: f64,
    /// Unit vector to the sun, and its angle from the zenith in radians.
    sun: DVec3,
    angle: f64,
    up: DVec3,
    /// Y in cd/m^2, x and y at the zenith, each over Perez's formula there; the formula's numbers.
    zenith: [f64; 3],
    perez: [[f64; 5]; 3],
}

impl Daylight {
    /// `sun` and `up` are unit vectors, the sun above the horizon.
    pub fn new(sun: DVec3, up: DVec3, turbidity: f64) -> Self {
        let (t, angle) = (turbidity, acos(sun.dot(up).clamp(-1.0, 1.0)));
        let perez = PEREZ.map(|rows| rows.map(|[a, b]| a * t + b));
        let chi = (4.0 / 9.0 - t / 120.0) * (PI - 2.0 * angle);
        let luminance = 1e3 * ((4.0453 * t - 4.9710) * tan(chi) - 0.2155 * t + 2.4192);
        let chromaticity = |rows: &[[f64; 4]; 3]| {
            let [a, b, c] = rows.map(|r| ((r[0] * angle + r[1]) * angle + r[2]) * angle + r[3]);
            (a * t + b) * t + c
        };
        let at_zenith = [luminance.max(0.0), chromaticity(&ZENITH[0]), chromaticity(&ZENITH[1])];
        let mut zenith = [0.0; 3];
        for i in 0..3 {
            zenith[i] = at_zenith[i] / formula(&perez[i], 1.0, angle);
        }
        Self { turbidity, sun, angle, up, zenith, perez }
    }

    /// What is seen in the direction of a unit vector; below the horizon what is seen on it.
    pub fn sky(&self, direction: DVec3) -> Spectrum {
        let cosine = direction.dot(self.up).clamp(0.0, 1.0);
        let angle = acos(direction.dot(self.sun).clamp(-1.0, 1.0));
        let at = |i: usize| self.zenith[i] * formula(&self.perez[i], cosine, angle);
        let (luminance, x, y) = (at(0).max(0.0), at(1), at(2));
        let xyz = [x / y * luminance, luminance, (1.0 - x - y) / y * luminance];
        (to_rgb(xyz) * (PI / LUX)).max(Spectrum::ZERO)
    }

    /// What arrives from the sun on a surface that faces it.
    pub fn sun(&self) -> Spectrum {
        let degrees = self.angle.to_degrees().min(93.0);
        // The way through the air, in multiples of that from the zenith.
        let air = 1.0 / (cos(self.angle).max(0.0) + 0.15 * pow(93.885 - degrees, -1.253));
        let haze = 0.046_08 * self.turbidity - 0.045_86;
        let mut xyz = [0.0; 3];
        for (i, observer) in OBSERVER.iter().enumerate() {
            let micrometres = WAVELENGTHS[i] * 1e-3;
            let scattered =
                0.008_735 * pow(micrometres, -4.08) + haze.max(0.0) * pow(micrometres, -1.3);
            let left = SUN[i] * exp(-(scattered + 0.35 * OZONE[i]) * air);
            // Steps of 20 nm.
            (0..3).for_each(|lane| xyz[lane] += 20.0 * LUMENS * observer[lane] * left);
        }
        (to_rgb(xyz) * (1.0 / LUX)).max(Spectrum::ZERO)
    }

    /// What arrives from the whole sky and the sun on the ground.
    pub fn on_the_ground(&self) -> Spectrum {
        let (x, y) = dioptric_math::orthonormal_basis(self.up);
        let (rings, sides) = (16, 32);
        let mut sum = Spectrum::ZERO;
        for i in 0..rings {
            let sine2 = (f64::from(i) + 0.5) / f64::from(rings);
            for j in 0..sides {
                let (s, c) = dioptric_math::sin_cos(2.0 * PI * f64::from(j) / f64::from(sides));
                let aside = (x * c + y * s) * sine2.sqrt();
                sum += self.sky(aside + self.up * (1.0 - sine2).sqrt());
            }
        }
        sum / f64::from(rings * sides) + self.sun() * cos(self.angle).max(0.0)
    }
}

/// Perez's formula (equation 3), for the cosine of the angle from the zenith and the angle to the sun.
fn formula(&[a, b, c, d, e]: &[f64; 5], cosine: f64, to_sun: f64) -> f64 {
    let cos = cos(to_sun);
    (1.0 + a * exp(b / cosine.max(1e-3))) * (1.0 + c * exp(d * to_sun) + e * cos * cos)
}

#[cfg(test)]
mod tests {
    use super::*;
    use dioptric_math::{luminance, sin};

    fn at(degrees: f64, turbidity: f64) -> Daylight {
        let a = degrees.to_radians();
        Daylight::new(DVec3::new(sin(a), cos(a), 0.0), DVec3::Y, turbidity)
    }

    #[test]
    fn the_zenith_is_as_bright_as_the_paper_s_formula_says() {
        // T 2, sun 60 degrees from the zenith: chi = (4/9 - 1/60) pi / 3 = 0.447968; (3.1196 tan chi + 1.9882) kcd/m^2.
        let expected = 3.1196 * tan(0.447_968) + 1.9882;
        let sky = luminance(at(60.0, 2.0).sky(DVec3::Y)) * LUX / PI * 1e-3;
        assert!((sky - expected).abs() < 1e-3, "{sky} {expected}");
    }

    #[test]
    fn the_sun_outshines_the_sky_and_reddens() {
        // Clear air, sun overhead: some 100 to 120 klx arrive; low in the haze little and red.
        let [high, low] = [at(5.0, 2.5), at(85.0, 4.0)].map(|d| d.sun());
        assert!((0.9..1.3).contains(&luminance(high)), "{high}");
        assert!(luminance(low) < 0.2 && low.x > 2.0 * low.y && low.y > 2.0 * low.z, "{low}");
        // The sky is blue away from the sun, brighter towards it, and gives less than the sun does.
        let day = at(45.0, 3.0);
        let away = day.sky(DVec3::new(-0.6, 0.8, 0.0));
        assert!(away.z > 1.3 * away.x, "{away}");
        let near = day.sky(DVec3::new(0.6, 0.8, 0.0));
        assert!(luminance(near) > 2.0 * luminance(away));
        let all = luminance(day.on_the_ground());
        let direct = luminance(day.sun()) * cos(PI / 4.0);
        assert!((0.1..0.7).contains(&((all - direct) / direct)), "{all} {direct}");
    }

    #[test]
    fn everything_is_a_number_at_every_hour_and_in_every_air() {
        for turbidity in [1.7, 2.0, 3.0, 6.0, 10.0] {
            for degrees in [0.0, 30.0, 60.0, 85.0, 89.9] {
                let day = at(degrees, turbidity);
                for direction in [DVec3::Y, DVec3::X, DVec3::NEG_X, DVec3::NEG_Y, DVec3::Z] {
                    let sky = day.sky(direction);
                    assert!(sky.is_finite() && sky.min_element() >= 0.0, "{turbidity} {degrees}");
                }
                assert!(day.sun().is_finite() && day.on_the_ground().is_finite());
            }
        }
    }
}
