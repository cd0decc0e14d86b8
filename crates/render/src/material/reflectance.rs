// SPDX-License-Identifier: MIT OR Apache-2.0
//! How much a mirror reflects by the angle at which light meets it.

use dioptric_math::Spectrum;

use crate::integrator::optics::schlick;

/// What a smooth mirror reflects, by the angle of incidence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reflectance {
    /// From one colour to another by Schlick's curve; equal ones for the same at all angles.
    Curve {
        /// At a right angle.
        normal: Spectrum,
        /// At grazing angles.
        grazing: Spectrum,
    },
    /// A metal's, by Fresnel's equations.
    Metal(Conductor),
}

/// A metal by its complex index of refraction `n + ik`, in each lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conductor {
    n: Spectrum,
    k: Spectrum,
    /// The mean of what it reflects of light from everywhere.
    mean: Spectrum,
}

impl Reflectance {
    /// The same at all angles.
    #[must_use]
    pub const fn constant(weight: Spectrum) -> Self {
        Self::Curve { normal: weight, grazing: weight }
    }

    /// The share that is reflected at an angle of incidence with this cosine.
    #[inline]
    #[must_use]
    pub fn at(&self, cos: f64) -> Spectrum {
        match self {
            Self::Curve { normal, grazing } => schlick(*normal, *grazing, cos),
            Self::Metal(metal) => metal.at(cos),
        }
    }

    /// The share that is reflected of light from everywhere: `2 int F(mu) mu dmu`.
    #[inline]
    #[must_use]
    pub fn mean(&self) -> Spectrum {
        match self {
            // 2 int mu (1 - mu)^5 = 1 / 21.
            Self::Curve { normal, grazing } => *normal + (*grazing - *normal) / 21.0,
            Self::Metal(metal) => metal.mean,
        }
    }
}

impl Conductor {
    /// A metal in air; `n` and `k` at least 0.
    #[must_use]
    pub fn new(n: Spectrum, k: Spectrum) -> Self {
        let mut metal = Self { n, k, mean: Spectrum::ZERO };
        // The middles of rings of equal weight: F is smooth but for the last degrees, which weigh little.
        let rings = 64;
        for i in 0..rings {
            metal.mean += metal.at(((f64::from(i) + 0.5) / f64::from(rings)).sqrt());
        }
        metal.mean /= f64::from(rings);
        metal
    }

    /// The index of refraction and the extinction coefficient.
    #[must_use]
    pub const fn constants(&self) -> [Spectrum; 2] {
        [self.n, self.k]
    }

    /// The share of unpolarised light that is reflected at an angle of incidence with this cosine.
    #[inline]
    #[must_use]
    pub fn at(&self, cos: f64) -> Spectrum {
        Self::lanes(self.n, self.k, cos)
    }

    /// Fresnel's equations for unpolarised light (Born and Wolf, "Principles of Optics", 7th ed., section 14.4.1),
    /// written without complex numbers.
    #[inline]
    pub(super) fn lanes(n: Spectrum, k: Spectrum, cos: f64) -> Spectrum {
        let cos = cos.clamp(0.0, 1.0);
        let cos2 = cos * cos;
        let sin2 = 1.0 - cos2;
        let lane = |n: f64, k: f64| {
            let (n2, k2) = (n * n, k * k);
            let real = n2 - k2 - sin2;
            // a^2 + b^2 and a of (a + ib)^2 = (n + ik)^2 - sin^2.
            let square = (real * real + 4.0 * n2 * k2).sqrt();
            let a = (0.5 * (square + real)).max(0.0).sqrt();
            let (sum, twice) = (square + cos2, 2.0 * a * cos);
            let s = (sum - twice) / (sum + twice);
            let (sum, twice) = (cos2 * square + sin2 * sin2, twice * sin2);
            // Both are 0 only where nothing is reflected or refracted: an index of 1 at grazing angles.
            let p = if sum + twice > 0.0 { s * ((sum - twice) / (sum + twice)) } else { s };
            (0.5 * (s + p)).clamp(0.0, 1.0)
        };
        let share = Spectrum::new(lane(n.x, k.x), lane(n.y, k.y), lane(n.z, k.z));
        if share.is_nan() { Spectrum::ONE } else { share }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrator::optics::fresnel;

    fn metal(n: f64, k: f64) -> Conductor {
        Conductor::new(Spectrum::splat(n), Spectrum::splat(k))
    }

    /// Fresnel's equations in complex numbers, as they stand in the books.
    fn by_complex_numbers(n: f64, k: f64, cos: f64) -> f64 {
        type C = (f64, f64);
        let mul = |a: C, b: C| (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0);
        let add = |a: C, b: C| (a.0 + b.0, a.1 + b.1);
        let neg = |a: C| (-a.0, -a.1);
        let len2 = |a: C| a.0 * a.0 + a.1 * a.1;
        let root = |a: C| {
            let r = len2(a).sqrt();
            ((0.5 * (r + a.0)).sqrt(), (0.5 * (r - a.0)).sqrt().copysign(a.1))
        };
        let index = (n, k);
        let square = mul(index, index);
        // n cos(theta_t), and n^2 cos(theta_i).
        let inner = root(add(square, (cos * cos - 1.0, 0.0)));
        let outer = mul(square, (cos, 0.0));
        let s = len2(add((cos, 0.0), neg(inner))) / len2(add((cos, 0.0), inner));
        let p = len2(add(outer, neg(inner))) / len2(add(outer, inner));
        0.5 * (s + p)
    }

    #[test]
    fn it_is_fresnels_equations() {
        for (n, k) in [(0.2, 3.4), (1.3, 7.0), (2.9, 3.0), (0.05, 4.0), (1.5, 0.0), (0.6, 0.1)] {
            for cos in [1.0, 0.9, 0.5, 0.2, 0.05, 1e-3] {
                let (ours, theirs) = (metal(n, k).at(cos).x, by_complex_numbers(n, k, cos));
                assert!((ours - theirs).abs() < 1e-12, "{n} {k} {cos}: {ours} {theirs}");
            }
            assert!((metal(n, k).at(0.0).x - 1.0).abs() < 1e-12);
        }
        // Without extinction it is glass.
        for cos in [1.0, 0.7, 0.3] {
            assert!((metal(1.5, 0.0).at(cos).x - fresnel(cos, 1.0 / 1.5)).abs() < 1e-12);
        }
        assert_eq!(metal(1.0, 0.0).at(0.5).x, 0.0);
    }

    #[test]
    fn the_mean_is_that_over_the_hemisphere() {
        let steps = 20_000;
        for (n, k) in [(0.2, 3.4), (2.9, 3.0), (1.5, 0.0), (0.05, 4.0)] {
            let metal = metal(n, k);
            let mu = |i: i32| (f64::from(i) + 0.5) / f64::from(steps);
            let sum: f64 =
                (0..steps).map(|i| 2.0 * mu(i) * metal.at(mu(i)).x / f64::from(steps)).sum();
            let mean = Reflectance::Metal(metal).mean().x;
            assert!((mean - sum).abs() < 1e-3, "{n} {k}: {mean} {sum}");
        }
        let curve = Reflectance::Curve { normal: Spectrum::splat(0.2), grazing: Spectrum::ONE };
        let sum: f64 = (0..steps)
            .map(|i| (f64::from(i) + 0.5) / f64::from(steps))
            .map(|mu| 2.0 * mu * curve.at(mu).x / f64::from(steps))
            .sum();
        assert!((curve.mean().x - sum).abs() < 1e-6);
    }

    #[test]
    fn nonsense_reflects_at_most_everything() {
        for (n, k) in [(0.0, 0.0), (1e200, 1e200), (0.0, 1e300), (1e300, 0.0)] {
            for cos in [0.0, 0.5, 1.0] {
                let share = metal(n, k).at(cos).x;
                assert!((0.0..=1.0).contains(&share), "{n} {k} {cos}: {share}");
            }
        }
    }
}
