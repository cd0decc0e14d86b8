// SPDX-License-Identifier: MIT OR Apache-2.0
//! Maps from the unit square to other domains that keep areas in proportion.

use std::f64::consts::FRAC_PI_4;

use dioptric_math::small_sin_cos;

/// A point of the unit disc, uniform for uniform `u` (Shirley and Chiu, "A Low Distortion Map Between
/// Disk and Square", Journal of Graphics Tools 2(3), 1997). Without branches, for loops over many.
#[inline(always)]
#[must_use]
pub fn concentric_disc(u: [f64; 2]) -> [f64; 2] {
    let (x, y) = (2.0 * u[0] - 1.0, 2.0 * u[1] - 1.0);
    let wide = x.abs() > y.abs();
    let (r, side) = if wide { (x, y) } else { (y, x) };
    // The middle is no angle.
    let whole = if r == 0.0 { 1.0 } else { r };
    let (s, c) = small_sin_cos(FRAC_PI_4 * (side / whole));
    let (c, s) = if wide { (c, s) } else { (s, c) };
    [r * c, r * s]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn disc_is_covered_uniformly() {
        let n = 200;
        let (mut inner, mut total) = (0, 0);
        for i in 0..n {
            for j in 0..n {
                let [x, y] = concentric_disc([
                    (f64::from(i) + 0.5) / f64::from(n),
                    (f64::from(j) + 0.5) / f64::from(n),
                ]);
                let r2 = x * x + y * y;
                assert!(r2 <= 1.0 + 1e-12);
                total += 1;
                inner += i32::from(r2 < 0.25);
            }
        }
        assert!((f64::from(inner) / f64::from(total) - 0.25).abs() < 5e-3);
    }

    #[test]
    fn no_place_of_the_disc_is_found_more_often_than_others() {
        let draw = |u| {
            let [x, y] = concentric_disc(u);
            [x * x + y * y, dioptric_math::atan2(y, x) / std::f64::consts::TAU + 0.5]
        };
        let verdict = crate::statistics::judge(
            [16, 24],
            [1, 1],
            |_| 1.0,
            |r| Some(draw([r.unit(), r.unit()])),
            9,
        );
        verdict.check("disc", 1);
    }
}
