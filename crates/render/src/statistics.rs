// SPDX-License-Identifier: MIT OR Apache-2.0
//! Draws against their density: Pearson's test for every routine that draws something and says how densely.

use std::f64::consts::{PI, TAU};

use dioptric_math::random::Random;
use dioptric_math::{DVec3, atan2, cbrt, exp, orthonormal_basis, pow, sin_cos};

/// Draws of one test.
pub(crate) const DRAWS: u32 = if cfg!(debug_assertions) { 50_000 } else { 1_000_000 };

/// What draws say of their density.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Verdict {
    /// Pearson's statistic as a deviate of the normal distribution: see [`deviations`].
    pub deviations: f64,
    /// The integral of the density.
    pub integral: f64,
    /// The share of the draws that were somewhere.
    pub found: f64,
}

impl Verdict {
    /// Panics where draws of one of so many tests do not follow their density (at 0.01 for all together), or where
    /// this has another integral than the share of draws that were found.
    pub fn check(&self, name: &str, tests: usize) {
        let Self { deviations, integral, found } = *self;
        assert!(deviations < sidak(0.01, tests), "{name}: {self:?}");
        let error = 4.0 * (found * (1.0 - found) / f64::from(DRAWS)).max(0.0).sqrt();
        assert!(integral <= 1.01 && (integral - found).abs() < 4e-3 + error, "{name}: {self:?}");
    }
}

/// Compares draws with a density over coordinates from 0 to 1, in so many classes, each integrated at so many points. Draws
/// that are nowhere are a class of their own.
pub(crate) fn judge(
    classes: [usize; 2],
    fine: [usize; 2],
    density: impl Fn([f64; 2]) -> f64,
    mut draw: impl FnMut(&mut Random) -> Option<[f64; 2]>,
    seed: u64,
) -> Verdict {
    let all = classes[0] * classes[1];
    let mut counts = vec![0.0; all + 1];
    let mut random = Random::new(seed);
    for _ in 0..DRAWS {
        let class = draw(&mut random).map_or(all, |at| {
            let [i, j] = [0, 1].map(|k| ((at[k] * classes[k] as f64) as usize).min(classes[k] - 1));
            i * classes[1] + j
        });
        counts[class] += 1.0;
    }
    let [steps, n] = [[0, 1].map(|k| classes[k] * fine[k]), [0, 1].map(|k| fine[k])];
    let mut shares = vec![0.0; all];
    for i in 0..steps[0] {
        for j in 0..steps[1] {
            let at = [i, j].map(|x| x as f64 + 0.5);
            let share = density([at[0] / steps[0] as f64, at[1] / steps[1] as f64]);
            shares[i / n[0] * classes[1] + j / n[1]] += share / (steps[0] * steps[1]) as f64;
        }
    }
    let integral: f64 = shares.iter().sum();
    shares.push((1.0 - integral).max(0.0));
    let expected: Vec<f64> = shares.iter().map(|share| share * f64::from(DRAWS)).collect();
    let found = 1.0 - counts[all] / f64::from(DRAWS);
    Verdict { deviations: deviations(&expected, &counts), integral, found }
}

/// Pearson's statistic in standard deviations of the normal distribution (Wilson and Hilferty, "The Distribution of
/// Chi-Square", PNAS 17, 1931). Classes that expect few are pooled.
pub(crate) fn deviations(expected: &[f64], counts: &[f64]) -> f64 {
    let (mut chi, mut classes, mut pool) = (0.0, 0.0, (0.0, 0.0));
    let mut order: Vec<usize> = (0..expected.len()).collect();
    order.sort_by(|a, b| expected[*a].total_cmp(&expected[*b]));
    for i in order {
        pool = (pool.0 + expected[i], pool.1 + counts[i]);
        if pool.0 >= 10.0 {
            chi += (pool.1 - pool.0) * (pool.1 - pool.0) / pool.0;
            classes += 1.0;
            pool = (0.0, 0.0);
        }
    }
    // What is left of the pool is expected (almost) nowhere.
    assert!(pool.1 <= pool.0 + 6.0 * (pool.0 + 1.0).sqrt(), "{pool:?}");
    let k = f64::max(classes - 1.0, 1.0);
    let v = 2.0 / (9.0 * k);
    (cbrt(chi / k) - (1.0 - v)) / v.sqrt()
}

/// The normal deviate that the largest of `tests` exceeds with this chance (Sidak's correction).
pub(crate) fn sidak(chance: f64, tests: usize) -> f64 {
    let each = 1.0 - pow(1.0 - chance, 1.0 / tests as f64);
    let tail = |z: f64| {
        let n = 2000;
        let h = 10.0 / f64::from(n);
        let density = |i: i32| {
            let x = z + (f64::from(i) + 0.5) * h;
            exp(-0.5 * x * x) / (2.0 * PI).sqrt()
        };
        (0..n).map(|i| density(i) * h).sum::<f64>()
    };
    let (mut low, mut high) = (0.0, 10.0);
    for _ in 0..40 {
        let mid = 0.5 * (low + high);
        if tail(mid) > each { low = mid } else { high = mid }
    }
    high
}

/// Coordinates of directions around an axis: 1 - cos of the way from it, as a share of the largest, and the azimuth.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Around {
    pub axis: DVec3,
    /// 1 - cos of the widest: 2 is all round.
    pub most: f64,
}

impl Around {
    /// A direction, and solid angle over coordinates.
    pub fn at(&self, [a, b]: [f64; 2]) -> (DVec3, f64) {
        let (x, y) = orthonormal_basis(self.axis);
        let (h, (s, c)) = (a * self.most, sin_cos(TAU * b));
        let r = (h * (2.0 - h)).max(0.0).sqrt();
        (self.axis * (1.0 - h) + (x * c + y * s) * r, TAU * self.most)
    }

    pub fn coordinates(&self, direction: DVec3) -> Option<[f64; 2]> {
        let (x, y) = orthonormal_basis(self.axis);
        let h = 0.5 * (direction - self.axis).length_squared() / self.most;
        let turn = atan2(direction.dot(y), direction.dot(x)) / TAU;
        (h <= 1.0 + 1e-9).then(|| [h, turn - turn.floor()])
    }

    /// Compares directions with their density over solid angles.
    pub fn judge(
        &self,
        fine: usize,
        density: impl Fn(DVec3) -> f64,
        mut draw: impl FnMut(&mut Random) -> Option<DVec3>,
        seed: u64,
    ) -> Verdict {
        let over = |u| {
            let (direction, angle) = self.at(u);
            density(direction) * angle
        };
        judge([12, 12], [fine; 2], over, |r| draw(r).and_then(|d| self.coordinates(d)), seed)
    }
}

/// Compares places on a line from 0 on with their density; `scale` is about half way.
pub(crate) fn judge_line(
    scale: f64,
    density: impl Fn(f64) -> f64,
    mut draw: impl FnMut(&mut Random) -> Option<f64>,
    seed: u64,
) -> Verdict {
    let over = |[a, _]: [f64; 2]| {
        let rest = 1.0 - a;
        density(scale * a / rest) * scale / (rest * rest)
    };
    let place = |t: f64| (t < f64::INFINITY).then(|| [t / (t + scale), 0.5]);
    judge([64, 1], [2000, 1], over, |r| draw(r).and_then(place), seed)
}

#[test]
fn statistics_know_their_own() {
    // 0.01 of 1, and of 100 tests: tables of the normal distribution.
    assert!((sidak(0.01, 1) - 2.326_35).abs() < 1e-3);
    let uniform = |r: &mut Random| Some([r.unit(), r.unit()]);
    let even = judge([8, 8], [1, 1], |_| 1.0, uniform, 1);
    even.check("even", 1);
    // One in a hundred more on one half is found.
    let tilted = judge([8, 8], [1, 1], |[a, _]| if a < 0.5 { 1.01 } else { 0.99 }, uniform, 1);
    assert!(tilted.deviations > if cfg!(debug_assertions) { -1.0 } else { 4.0 });
}
