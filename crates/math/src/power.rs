// SPDX-License-Identifier: MIT OR Apache-2.0
//! Powers of numbers from 0 to 1: the shape of highlights, taken at every lit point. From tables and short
//! polynomials (as in Tang, "Table-driven implementation of the logarithm function in IEEE floating-point
//! arithmetic", ACM TOMS 16(4), 1990), in plain f64 operations, so the same bits everywhere.

use std::f64::consts::LN_2;

/// Pieces of an octave.
const PIECES: usize = 64;

/// For each piece of `[1, 2)` the reciprocal of its middle, and minus that one's binary logarithm.
static LOGARITHMS: [(f64, f64); PIECES] = {
    let mut table = [(0.0, 0.0); PIECES];
    let mut i = 0;
    while i < PIECES {
        let reciprocal = 1.0 / (1.0 + (i as f64 + 0.5) / PIECES as f64);
        // ln c = 2 artanh((c - 1) / (c + 1)) for c = 1 / reciprocal
        let s = (1.0 - reciprocal) / (1.0 + reciprocal);
        let (mut sum, mut k) = (0.0, 39);
        while k > 0 {
            sum = sum * s * s + 1.0 / k as f64;
            k -= 2;
        }
        table[i] = (reciprocal, 2.0 * s * sum / LN_2);
        i += 1;
    }
    table
};

/// `2^(i / 64)`.
static ROOTS: [f64; PIECES] = {
    let mut table = [0.0; PIECES];
    let mut i = 0;
    while i < PIECES {
        let x = i as f64 / PIECES as f64 * LN_2;
        let (mut sum, mut k) = (1.0, 20);
        while k > 0 {
            sum = 1.0 + sum * x / k as f64;
            k -= 1;
        }
        table[i] = sum;
        i += 1;
    }
    table
};

/// Adding this rounds to a whole number, which is then in the low bits.
const ROUND: f64 = 6_755_399_441_055_744.0; // 1.5 x 2^52

/// `x^n` for `x` from 0 to 1 and `n >= 0`, a few times faster than [`crate::pow`]. The result is wrong by at most
/// `(n + l + 10) 1e-15` of itself, where `2^-l` is the result, and 0 where it is below 1e-300; exact for `x` = 0 and 1.
///
/// What is out of range is left to [`crate::pow`].
#[must_use]
pub fn unit_power(x: f64, n: f64) -> f64 {
    if !((f64::MIN_POSITIVE..1.0).contains(&x) && (0.0..=1e9).contains(&n)) {
        return if x == 1.0 && n.is_finite() { 1.0 } else { crate::pow(x, n) };
    }
    in_range(x, n)
}

/// Numbers from 0 to 1, each to a power from 1 to 1e9: the bits of [`unit_power`], but for powers below 1e-300, which are 0.
/// NaN stays.
///
/// To be compiled for wide vectors: see [`crate::wide::Kernel`].
#[inline(always)]
pub fn unit_powers<const N: usize>(x: &[f64; N], n: &[f64; N], out: &mut [f64; N]) {
    for i in 0..N {
        let power = in_range(x[i], n[i]);
        let power = if x[i] < f64::MIN_POSITIVE { 0.0 } else { power };
        out[i] = if x[i] < 1.0 { power } else { x[i] };
    }
}

/// [`unit_power`] of normal numbers below 1; of others any number.
#[inline(always)]
fn in_range(x: f64, n: f64) -> f64 {
    // x = 2^e m with m in [1, 2), and m = c (1 + r) with |r| <= 2^-7.
    let bits = x.to_bits();
    let e = (bits >> 52) as i32 - 1023;
    let m = f64::from_bits((bits & ((1 << 52) - 1)) | (1023 << 52));
    let (reciprocal, logarithm) = LOGARITHMS[(bits >> 46) as usize % PIECES];
    let r = m * reciprocal - 1.0;
    let r2 = r * r;
    // ln(1 + r) without r^7 / 7 < 2^-51 and what follows.
    let ln = r - r2 * ((0.5 - r * (1.0 / 3.0)) + r2 * ((0.25 - r * 0.2) + r2 * (1.0 / 6.0)));
    let y = n * (f64::from(e) + (logarithm + ln * (1.0 / LN_2)));
    // y = k / 64 + t with |t| <= 1 / 128.
    let rounded = y * PIECES as f64 + ROUND;
    let t = y - (rounded - ROUND) * (1.0 / PIECES as f64);
    let k = rounded.to_bits() as i32;
    let z = t * LN_2;
    let z2 = z * z;
    // e^z without z^6 / 720 < 2^-54 and what follows.
    let exp = 1.0 + (z + z2 * ((0.5 + z * (1.0 / 6.0)) + z2 * (1.0 / 24.0 + z * (1.0 / 120.0))));
    let scale = f64::from_bits(((1023 + (k >> 6)) as u64) << 52);
    let power = scale * ROOTS[k as usize % PIECES] * exp;
    if y < -996.0 { 0.0 } else { power }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;
    use crate::{log2, pow};

    #[test]
    fn powers_are_right_to_their_bound() {
        let mut r = Random::new(31);
        let mut worst = 0.0_f64;
        for i in 0..300_000 {
            let n = pow(10.0, r.uniform(-3.0, 6.0));
            let x = match i % 3 {
                0 => r.unit(),
                1 => 1.0 - pow(10.0, r.uniform(-16.0, 0.0)),
                // So that the result is of any size.
                _ => pow(10.0, r.uniform(-290.0, 0.0) / n),
            };
            let (found, exact) = (unit_power(x, n), pow(x, n));
            let bound = (n - log2(exact).max(-1e3) + 10.0) * 1e-15;
            if exact > 1e-290 {
                worst = worst.max((found - exact).abs() / (bound * exact));
            }
            assert!((found - exact).abs() <= bound * exact + 1e-299, "{x}^{n}: {found} {exact}");
            assert!((0.0..=1.0 + bound).contains(&found));
        }
        println!("at most {worst:.2} of the bound");
    }

    #[test]
    fn edges_are_exact() {
        for n in [0.5, 14.8, 1e5] {
            assert_eq!((unit_power(0.0, n), unit_power(1.0, n)), (0.0, 1.0));
        }
        assert_eq!((unit_power(0.0, 0.0), unit_power(0.3, 0.0)), (1.0, 1.0));
        assert!(unit_power(f64::NAN, 2.5).is_nan());
        let tiny = 5e-324;
        assert_eq!(unit_power(tiny, 0.01), pow(tiny, 0.01));
    }

    #[test]
    fn many_are_what_one_is() {
        let mut random = Random::new(9);
        for round in 0..2000 {
            let mut x: [f64; 16] = std::array::from_fn(|_| random.uniform(0.0, 1.0));
            (x[0], x[1], x[2], x[3]) = (0.0, 1.0, f64::NAN, f64::MIN_POSITIVE);
            x[4] = 1.0 - f64::EPSILON / 2.0;
            let n: [f64; 16] =
                std::array::from_fn(|_| pow(1e9, random.uniform(0.0, 1.0)) * f64::from(round % 2));
            let n = n.map(|n| n.max(1.0));
            let mut out = [0.0; 16];
            crate::wide::wide(Powers(&x, &n, &mut out));
            for i in 0..16 {
                let one = unit_power(x[i], n[i]);
                let same = out[i].to_bits() == one.to_bits() || out[i].is_nan() && one.is_nan();
                assert!(same || one < 1e-300 && out[i] == 0.0, "{} {} {}", x[i], n[i], out[i]);
            }
        }
    }

    struct Powers<'a>(&'a [f64; 16], &'a [f64; 16], &'a mut [f64; 16]);

    impl crate::wide::Kernel for Powers<'_> {
        type Output = ();

        #[inline(always)]
        fn run(self) {
            unit_powers(self.0, self.1, self.2);
        }
    }
}
