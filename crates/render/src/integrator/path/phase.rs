// SPDX-License-Identifier: MIT OR Apache-2.0
//! To where a medium scatters light: Henyey and Greenstein's phase function ("Diffuse radiation in the Galaxy",
//! Astrophysical Journal 93, 1941, equation 2).

use std::f64::consts::PI;

use dioptric_math::{DVec3, orthonormal_basis, sin_cos};

/// The phase function with a mean cosine `g`. A path that comes along a unit vector goes on, turned by an angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Phase {
    pub g: f64,
}

impl Phase {
    /// The density over solid angles with which light is turned by an angle of this cosine, which is the share that it
    /// scatters there, too.
    pub fn eval(self, cos: f64) -> f64 {
        let g = self.g;
        let d = (1.0 + g * g - 2.0 * g * cos).max(1e-12);
        (1.0 - g * g) / (4.0 * PI * d * d.sqrt())
    }

    /// A way on and its density, for two numbers in `[0, 1)`.
    pub fn sample(self, along: DVec3, u: [f64; 2]) -> (DVec3, f64) {
        let g = self.g;
        let cos = if g.abs() < 1e-3 {
            // The inverse in powers of g: the formula below takes nearly 1 from 1 and divides by g.
            let x = 2.0 * u[0] - 1.0;
            x + 1.5 * g * (1.0 - x * x)
        } else {
            let s = (1.0 - g * g) / (1.0 - g + 2.0 * g * u[0]);
            (1.0 + g * g - s * s) / (2.0 * g)
        };
        let cos = cos.clamp(-1.0, 1.0);
        let sin = (1.0 - cos * cos).sqrt();
        let (a, b) = sin_cos(2.0 * PI * u[1]);
        let (x, y) = orthonormal_basis(along);
        (along * cos + x * (sin * b) + y * (sin * a), self.eval(cos))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dioptric_math::random::{mix, unit};

    const ALL: [f64; 7] = [-0.999, -0.5, 0.0, 5e-4, 0.3, 0.9, 0.999];

    fn directions(g: f64, n: u64) -> impl Iterator<Item = f64> {
        let along = DVec3::new(0.48, -0.6, 0.64);
        (0..n).map(move |i| {
            let u = [unit(mix(2 * i)), unit(mix(2 * i + 1))];
            let (way, density) = Phase { g }.sample(along, u);
            assert!((way.length() - 1.0).abs() < 1e-9);
            let cos = way.dot(along);
            let said = Phase { g }.eval(cos);
            assert!((density / said - 1.0).abs() < 1e-3, "{g}: {density} {said}");
            cos
        })
    }

    /// QUALITY: chi-square for every sampling routine. 32 classes of equal share: the 99.9 % limit of 31 degrees is 61.1.
    #[test]
    fn directions_are_spread_as_the_function_says() {
        for g in ALL {
            let (n, classes) = (20_000, 32);
            // The share below a cosine, from the integral of the formula.
            let below = |cos: f64| {
                if g.abs() < 1e-2 {
                    let at =
                        |x: f64| 0.5 * x + 0.75 * g * x * x + 0.625 * g * g * (x * x - 1.0) * x;
                    return at(cos) - at(-1.0);
                }
                let d = (1.0 + g * g - 2.0 * g * cos).sqrt();
                (1.0 - g * g) / (2.0 * g) * (1.0 / d - 1.0 / (1.0 + g))
            };
            let mut counts = vec![0.0; classes];
            for cos in directions(g, n) {
                let class = (below(cos) * classes as f64).clamp(0.0, classes as f64 - 1.0);
                counts[class as usize] += 1.0;
            }
            let expected = n as f64 / classes as f64;
            let chi: f64 = counts.iter().map(|c| (c - expected) * (c - expected) / expected).sum();
            assert!(chi < 61.1, "{g}: {chi}");
        }
    }

    #[test]
    fn the_mean_cosine_is_g() {
        for g in ALL {
            let n = 40_000;
            let mean = directions(g, n).sum::<f64>() / n as f64;
            assert!((mean - g).abs() < 4.0 / (n as f64).sqrt(), "{g}: {mean}");
        }
    }

    #[test]
    fn all_of_it_adds_up_to_one() {
        for g in ALL {
            let n = 200_000;
            // Finer towards both ends, where the function is steep: cos = sin of a quarter turn.
            let sum: f64 = (0..n)
                .map(|i| {
                    let (s, c) = sin_cos(PI * ((f64::from(i) + 0.5) / f64::from(n) - 0.5));
                    Phase { g }.eval(s) * c * PI / f64::from(n)
                })
                .sum();
            assert!((2.0 * PI * sum - 1.0).abs() < 1e-3, "{g}: {sum}");
        }
    }
}
