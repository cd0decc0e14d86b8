// SPDX-License-Identifier: MIT OR Apache-2.0
//! Angles without branches, so that loops over them can be compiled for wide vectors: Taylor's series near multiples
//! of a small angle.

use std::f64::consts::{FRAC_1_SQRT_2, FRAC_2_PI, FRAC_PI_8, PI};

/// Half a turn over two in two parts: the first has so few digits that small multiples of it are exact.
const QUARTER: [f64; 2] = [f64::from_bits(0x3ff9_21fb_5440_0000), 6.077_100_506_506_192e-11];
/// Added to a number it leaves no digits behind the point.
const ROUND: f64 = 6_755_399_441_055_744.0;

/// `1 / n!` times the sign of the sine's term `n`, from 3 in steps of 2.
const SINE: [f64; 8] = [
    -1.0 / 6.0,
    1.0 / 120.0,
    -1.0 / 5040.0,
    1.0 / 362_880.0,
    -1.0 / 39_916_800.0,
    1.0 / 6_227_020_800.0,
    -1.0 / 1_307_674_368_000.0,
    1.0 / 355_687_428_096_000.0,
];
/// The same of the cosine, from 4 in steps of 2.
const COSINE: [f64; 8] = [
    1.0 / 24.0,
    -1.0 / 720.0,
    1.0 / 40_320.0,
    -1.0 / 3_628_800.0,
    1.0 / 479_001_600.0,
    -1.0 / 87_178_291_200.0,
    1.0 / 20_922_789_888_000.0,
    -1.0 / 6_402_373_705_728_000.0,
];
/// `1 / n` times the sign of the arc tangent's term `n`, from 3 in steps of 2.
const ARC: [f64; 11] = [
    -1.0 / 3.0,
    1.0 / 5.0,
    -1.0 / 7.0,
    1.0 / 9.0,
    -1.0 / 11.0,
    1.0 / 13.0,
    -1.0 / 15.0,
    1.0 / 17.0,
    -1.0 / 19.0,
    1.0 / 21.0,
    -1.0 / 23.0,
];
/// The tangents of 1, 3, 5 and 7 sixteenths of a half turn.
const TANGENTS: [f64; 4] =
    [0.198_912_367_379_658, 0.668_178_637_919_298_9, 1.496_605_762_665_489, 5.027_339_492_125_846];
/// Cosine and sine of an eighth of a half turn.
const EIGHTH: [f64; 2] = [0.923_879_532_511_286_8, 0.382_683_432_365_089_8];

#[inline(always)]
fn series<const N: usize>(terms: &[f64; N], z: f64) -> f64 {
    let mut sum = terms[N - 1];
    let mut k = N - 1;
    while k > 0 {
        k -= 1;
        sum = sum * z + terms[k];
    }
    sum
}

/// Sine and cosine of an angle of at most an eighth of a turn, to within two units of the last place.
#[inline(always)]
#[must_use]
pub fn small_sin_cos(x: f64) -> (f64, f64) {
    let z = x * x;
    (x + x * (z * series(&SINE, z)), 1.0 - (0.5 * z - z * z * series(&COSINE, z)))
}

/// Sine and cosine of an angle of at most a thousand turns, to within 4e-16.
#[inline(always)]
#[must_use]
pub fn turn_sin_cos(x: f64) -> (f64, f64) {
    let rounded = x * FRAC_2_PI + ROUND;
    let (quarters, count) = (rounded.to_bits(), rounded - ROUND);
    let (s, c) = small_sin_cos((x - count * QUARTER[0]) - count * QUARTER[1]);
    let (s, c) = if quarters & 1 == 0 { (s, c) } else { (c, s) };
    let sine = if quarters & 2 == 0 { s } else { -s };
    let cosine = if (quarters + 1) & 2 == 0 { c } else { -c };
    (sine, cosine)
}

/// The angle of the complex number `x + i y` for `y >= 0`, from 0 to half a turn, to within 4e-16; small ones to within
/// as much of themselves. NaN for 0.
#[inline(always)]
#[must_use]
pub fn half_turn_angle(x: f64, y: f64) -> f64 {
    let a = x.abs();
    // Turned back by as many eighths as leave the least.
    let [c1, s1] = EIGHTH;
    let (c, s, turned) = if y > a * TANGENTS[0] { (c1, s1, FRAC_PI_8) } else { (1.0, 0.0, 0.0) };
    let (c, s, turned) = if y > a * TANGENTS[1] {
        (FRAC_1_SQRT_2, FRAC_1_SQRT_2, 2.0 * FRAC_PI_8)
    } else {
        (c, s, turned)
    };
    let (c, s, turned) =
        if y > a * TANGENTS[2] { (s1, c1, 3.0 * FRAC_PI_8) } else { (c, s, turned) };
    let (c, s, turned) =
        if y > a * TANGENTS[3] { (0.0, 1.0, 4.0 * FRAC_PI_8) } else { (c, s, turned) };
    let t = (y * c - a * s) / (a * c + y * s);
    let z = t * t;
    let angle = turned + (t + t * (z * series(&ARC, z)));
    if x < 0.0 { PI - angle } else { angle }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;
    use crate::{atan2, sin_cos};
    use std::f64::consts::FRAC_PI_4;

    #[test]
    fn sines_and_cosines_are_those_of_libm() {
        let mut random = Random::new(1);
        for _ in 0..20_000 {
            let x = random.uniform(-FRAC_PI_4, FRAC_PI_4);
            let ((s, c), (t, d)) = (small_sin_cos(x), sin_cos(x));
            assert!((s - t).abs() <= 2.5e-16 * t.abs() && (c - d).abs() <= 3e-16, "{x}");
            for size in [1.0, 6.3, 6000.0] {
                let x = random.uniform(-size, size);
                let ((s, c), (t, d)) = (turn_sin_cos(x), sin_cos(x));
                assert!((s - t).abs() <= 4e-16 && (c - d).abs() <= 4e-16, "{x}");
            }
        }
        assert_eq!(turn_sin_cos(0.0), (0.0, 1.0));
    }

    #[test]
    fn angles_are_those_of_libm() {
        let mut random = Random::new(2);
        for _ in 0..20_000 {
            let (s, c) = sin_cos(random.uniform(0.0, PI));
            let r = random.uniform(1e-9, 10.0);
            let (own, libm) = (half_turn_angle(c * r, s * r), atan2(s * r, c * r));
            assert!((own - libm).abs() <= 5e-16, "{c} {s}: {own} {libm}");
            let y = random.unit() * 1e-9;
            assert!((half_turn_angle(1.0, y) - atan2(y, 1.0)).abs() <= 3e-16 * y);
        }
        assert_eq!(half_turn_angle(1.0, 0.0), 0.0);
        assert_eq!(half_turn_angle(-1.0, 0.0), PI);
        assert!((half_turn_angle(0.0, 1.0) - 0.5 * PI).abs() < 3e-16);
    }
}
