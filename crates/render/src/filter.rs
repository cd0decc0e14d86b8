// SPDX-License-Identifier: MIT OR Apache-2.0
//! Reconstruction filters, by importance: a pixel's samples are drawn where its filter is large, and
//! count equally (Ernst, Stamminger and Greiner, "Filter Importance Sampling", RT 2006).
//!
//! Nothing is splatted onto neighbours, so a pixel depends on its own samples alone. All filters are
//! products f(x) f(y) of one function of the distance in units of the radius, zero beyond 1.
//!
//! Mitchell's filter has negative lobes, whose samples count -1. Drawn by chance, they could add up
//! to a weight of zero; so the number of a sample decides whether it is one of them, which keeps
//! their share within half a sample of the exact one and the sum of the weights above zero.

use std::sync::LazyLock;

/// A filter's shape.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Filter {
    /// All of a square equally.
    #[default]
    Box,
    /// Falls linearly to zero.
    Tent,
    /// A bell of standard deviation 1/3 of the radius, lowered to be zero at the radius.
    Gaussian,
    /// Mitchell and Netravali, "Reconstruction Filters in Computer Graphics", SIGGRAPH 1988,
    /// equation 8 with B = C = 1/3.
    Mitchell,
    /// The 4-term window of Harris, "On the Use of Windows for Harmonic Analysis with the Discrete
    /// Fourier Transform", Proc. IEEE 66(1), 1978, equation 33 with the first column of its table.
    BlackmanHarris,
}

impl Filter {
    /// The words of the `filter` parameter.
    pub const NAMES: &'static [&'static str] =
        &["box", "tent", "gaussian", "mitchell", "blackman_harris"];

    /// All filters, in the order of their words.
    pub const ALL: [Self; 5] =
        [Self::Box, Self::Tent, Self::Gaussian, Self::Mitchell, Self::BlackmanHarris];

    /// The filter of a word.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|filter| filter.name() == name)
    }

    /// Its word.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Box => "box",
            Self::Tent => "tent",
            Self::Gaussian => "gaussian",
            Self::Mitchell => "mitchell",
            Self::BlackmanHarris => "blackman_harris",
        }
    }

    /// The usual radius in pixels: half its width.
    #[must_use]
    pub const fn default_radius(self) -> f64 {
        match self {
            Self::Box => 0.5,
            Self::Tent => 1.0,
            Self::Gaussian => 1.5,
            Self::Mitchell | Self::BlackmanHarris => 2.0,
        }
    }

    /// The filter's value along one axis at distance `x`, in units of the radius; of no particular
    /// scale.
    #[must_use]
    pub fn eval(self, x: f64) -> f64 {
        let x = x.abs();
        if !(x <= 1.0) {
            return 0.0;
        }
        match self {
            Self::Box => 1.0,
            Self::Tent => 1.0 - x,
            Self::Gaussian => {
                let bell = |x: f64| dioptric_math::exp(-0.5 * (3.0 * x) * (3.0 * x));
                bell(x) - bell(1.0)
            }
            Self::Mitchell => mitchell(2.0 * x),
            Self::BlackmanHarris => {
                let term = |k: f64| dioptric_math::cos(std::f64::consts::PI * k * x);
                0.35875 + 0.48829 * term(1.0) + 0.14128 * term(2.0) + 0.01168 * term(3.0)
            }
        }
    }

    /// Where sample `u` (two numbers in `[0, 1)`) of a regular set lies relative to the pixel's
    /// centre, and its weight: 1, or -1 in a negative lobe. An area of `u` is a share of |f|.
    #[must_use]
    pub fn offset(self, radius: f64, u: [f64; 2]) -> ([f64; 2], f64) {
        if self == Self::Box {
            return (u.map(|u| (2.0 * u - 1.0) * radius), 1.0);
        }
        let shape = self.shape();
        let [x, y] = u.map(|u| {
            let (side, v) = fold(u);
            match shape.lobe_share(v) {
                Part::Main(v) => (side * shape.main.at(v), 1.0),
                Part::Lobe(v) => (side * shape.lobe.at(v), -1.0),
            }
        });
        ([x.0 * radius, y.0 * radius], x.1 * y.1)
    }

    /// How many of a pixel's first `count` samples lie in negative lobes.
    #[must_use]
    pub fn negatives(self, count: u32) -> u32 {
        if self != Self::Mitchell {
            return 0;
        }
        let lobe = self.shape().lobe_area;
        let negative = 2.0 * lobe * (1.0 - lobe); // one axis in a lobe, the other not
        (f64::from(count) * negative + 0.5) as u32
    }

    /// Where a sample lies relative to the pixel's centre, for `u` of the positive part of f(x) f(y).
    #[must_use]
    pub fn positive_offset(self, radius: f64, [u, v]: [f64; 2]) -> [f64; 2] {
        if self != Self::Mitchell {
            return self.offset(radius, [u, v]).0;
        }
        let shape = self.shape();
        let (main, lobe) = (1.0 - shape.lobe_area, shape.lobe_area);
        // A product is positive where both factors are, or where both are negative.
        let both_main = main * main / (main * main + lobe * lobe);
        let (part, u) = pick(u, both_main, &shape.main, &shape.lobe);
        [u, v].map(|u| part.at_signed(u) * radius)
    }

    /// Where a sample lies relative to the pixel's centre, for `u` of the negative part of f(x) f(y).
    #[must_use]
    pub fn negative_offset(self, radius: f64, [u, v]: [f64; 2]) -> [f64; 2] {
        let shape = self.shape();
        let (part_x, u) = pick(u, 0.5, &shape.main, &shape.lobe);
        let part_y = if std::ptr::eq(part_x, &shape.main) { &shape.lobe } else { &shape.main };
        [part_x.at_signed(u) * radius, part_y.at_signed(v) * radius]
    }

    fn shape(self) -> &'static Shape {
        static SHAPES: LazyLock<[Shape; 5]> = LazyLock::new(|| Filter::ALL.map(Shape::new));
        match self {
            Self::Box => &SHAPES[0],
            Self::Tent => &SHAPES[1],
            Self::Gaussian => &SHAPES[2],
            Self::Mitchell => &SHAPES[3],
            Self::BlackmanHarris => &SHAPES[4],
        }
    }
}

/// Mitchell and Netravali's cubic for `x >= 0`, with B = C = 1/3.
fn mitchell(x: f64) -> f64 {
    if x < 1.0 {
        ((7.0 * x - 12.0) * x * x + 16.0 / 3.0) / 6.0
    } else if x < 2.0 {
        // The second cubic has a double root at 2 and a single one at 8/7.
        (2.0 - x) * (2.0 - x) * (8.0 / 7.0 - x) * (7.0 / 18.0)
    } else {
        0.0
    }
}

/// The side of a number in `[0, 1)` and its distance from the middle, in `[0, 1]`.
fn fold(u: f64) -> (f64, f64) {
    if u < 0.5 { (-1.0, 1.0 - 2.0 * u) } else { (1.0, 2.0 * u - 1.0) }
}

/// Picks the first with probability `share`, else the second, and gives back the rest of `u` as a
/// number in `[0, 1)`.
fn pick<'a>(u: f64, share: f64, first: &'a Quantile, second: &'a Quantile) -> (&'a Quantile, f64) {
    let (part, u) =
        if u < share { (first, u / share) } else { (second, (u - share) / (1.0 - share)) };
    (part, u.min(1.0 - f64::EPSILON))
}

enum Part {
    Main(f64),
    Lobe(f64),
}

/// One filter, ready to be sampled on one side of the centre.
struct Shape {
    main: Quantile,
    lobe: Quantile,
    /// Share of the negative lobe in the area of |f|; 0 for filters without one.
    lobe_area: f64,
}

impl Shape {
    fn new(filter: Filter) -> Self {
        let zero = if filter == Filter::Mitchell { 4.0 / 7.0 } else { 1.0 };
        let (main, main_area) = Quantile::new(0.0, zero, |x| filter.eval(x).max(0.0));
        let (lobe, area) = Quantile::new(zero, 1.0, |x| (-filter.eval(x)).max(0.0));
        Self { main, lobe, lobe_area: area / (main_area + area) }
    }

    fn lobe_share(&self, v: f64) -> Part {
        let main = 1.0 - self.lobe_area;
        if v <= main { Part::Main(v / main) } else { Part::Lobe((v - main) / self.lobe_area) }
    }
}

/// The inverse of a distribution function whose density is linear in each of a few hundred cells.
struct Quantile {
    start: f64,
    step: f64,
    density: Vec<f64>,
    cumulative: Vec<f64>,
    /// The cell in which a share of `i / CELLS` lies: where a search begins.
    first: Vec<u32>,
}

impl Quantile {
    const CELLS: usize = 256;

    /// The distribution over `[start, end]` with density in proportion to `f`, and the area under `f`.
    fn new(start: f64, end: f64, f: impl Fn(f64) -> f64) -> (Self, f64) {
        let step = (end - start) / Self::CELLS as f64;
        let values: Vec<f64> = (0..=Self::CELLS).map(|i| f(start + step * i as f64)).collect();
        let mut sum = 0.0;
        let mut cumulative = vec![0.0];
        for pair in values.windows(2) {
            sum += 0.5 * (pair[0] + pair[1]) * step;
            cumulative.push(sum);
        }
        let scale = if sum > 0.0 { 1.0 / sum } else { 0.0 };
        let density = values.iter().map(|v| v * scale).collect();
        cumulative.iter_mut().for_each(|c| *c *= scale);
        let first = (0..=Self::CELLS)
            .map(|i| {
                let share = i as f64 / Self::CELLS as f64;
                cumulative.partition_point(|c| *c <= share).clamp(1, Self::CELLS) as u32 - 1
            })
            .collect();
        (Self { start, step, density, cumulative, first }, sum)
    }

    /// The place below which a share `v` lies.
    fn at(&self, v: f64) -> f64 {
        let guess = ((v * Self::CELLS as f64) as usize).min(Self::CELLS);
        let mut cell = self.first[guess] as usize;
        while cell + 1 < Self::CELLS && self.cumulative[cell + 1] <= v {
            cell += 1;
        }
        let (a, b) = (self.density[cell], self.density[cell + 1]);
        // a t + (b - a) t^2 / 2 = rest, with the stable formula for the root in [0, 1].
        let rest = (v - self.cumulative[cell]) / self.step;
        let root = a + (a * a + 2.0 * (b - a) * rest).max(0.0).sqrt();
        let t = if root > 0.0 { (2.0 * rest / root).min(1.0) } else { 0.0 };
        self.start + self.step * (cell as f64 + t)
    }

    /// As [`Self::at`], with half of the numbers on each side of the centre.
    fn at_signed(&self, u: f64) -> f64 {
        let (side, v) = fold(u);
        side * self.at(v)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Integral of g f over one axis, by the midpoint rule.
    fn integral(filter: Filter, g: impl Fn(f64) -> f64) -> f64 {
        let n = 20_000;
        let x = |i| (f64::from(i) + 0.5) / f64::from(n) * 2.0 - 1.0;
        (0..n).map(|i| g(x(i)) * filter.eval(x(i))).sum::<f64>() * 2.0 / f64::from(n)
    }

    const POINTS: u32 = 1 << 17;

    fn points() -> impl Iterator<Item = [f64; 2]> {
        (0..POINTS).map(|i| crate::sampling::sobol::pair(i, 0x1234_5678_9abc_def0))
    }

    #[test]
    fn words_and_filters_agree() {
        assert_eq!(Filter::NAMES, Filter::ALL.map(Filter::name));
        for name in Filter::NAMES {
            assert_eq!(Filter::from_name(name).map(Filter::name), Some(*name));
        }
    }

    #[test]
    fn mitchell_has_its_published_values() {
        // Equation 8 at B = C = 1/3: 8/9 in the middle, 1/18 one pixel away, smooth at 1 and 2.
        assert!((Filter::Mitchell.eval(0.0) - 8.0 / 9.0).abs() < 1e-15);
        assert!((Filter::Mitchell.eval(0.5) - 1.0 / 18.0).abs() < 1e-15);
        assert!((Filter::Mitchell.eval(0.5 - 1e-9) - 1.0 / 18.0).abs() < 1e-8);
        // Sums of its integer shifts are 1 everywhere: flat areas stay flat.
        for i in 0..10 {
            let x = f64::from(i) * 0.1;
            let sum: f64 = (-2..=2).map(|k| Filter::Mitchell.eval((x + f64::from(k)) / 2.0)).sum();
            assert!((sum - 1.0).abs() < 1e-14);
        }
    }

    /// Means of x^2 and x^2 y^2 under f(x) f(y), and how much of the first its lobes cancel.
    fn moments(filter: Filter) -> ([f64; 2], f64) {
        let area = integral(filter, |_| 1.0);
        let second = integral(filter, |x| x * x) / area;
        let absolute = integral(filter, |x| x * x * filter.eval(x).signum()) / area;
        ([second, second * second], absolute / second)
    }

    #[test]
    fn regular_samples_have_the_moments_of_the_filter() {
        for filter in Filter::ALL {
            let ([second, fourth], cancelled) = moments(filter);
            let mut sums = [0.0; 4];
            for u in points() {
                let ([x, y], w) = filter.offset(1.0, u);
                assert!(x.abs() <= 1.0 && y.abs() <= 1.0, "{filter:?}");
                assert!(filter.eval(x) * filter.eval(y) * w > -1e-9, "{filter:?}: {x}, {y}");
                for (sum, m) in sums.iter_mut().zip([1.0, x, x * x, x * x * y * y]) {
                    *sum += w * m;
                }
            }
            let [_, x, xx, xxyy] = sums.map(|sum| sum / sums[0]);
            let tolerance = 1e-3 * cancelled;
            assert!(x.abs() < 1e-4, "{filter:?}");
            assert!((xx / second - 1.0).abs() < tolerance, "{filter:?}: {xx} for {second}");
            assert!(
                (xxyy / fourth - 1.0).abs() < 2.0 * tolerance,
                "{filter:?}: {xxyy} for {fourth}"
            );
        }
    }

    #[test]
    fn split_samples_have_the_moments_of_the_filter() {
        for filter in Filter::ALL {
            let (exact, cancelled) = moments(filter);
            let share = f64::from(filter.negatives(1_000_000)) * 1e-6;
            let means = |offset: &dyn Fn([f64; 2]) -> [f64; 2]| {
                let places = || points().map(offset);
                let second: f64 = places().map(|[x, _]| x * x).sum();
                let fourth: f64 = places().map(|[x, y]| x * x * y * y).sum();
                [second, fourth].map(|sum| sum / f64::from(POINTS))
            };
            let positive = means(&|u| filter.positive_offset(1.0, u));
            let negative =
                if share > 0.0 { means(&|u| filter.negative_offset(1.0, u)) } else { [0.0; 2] };
            for i in 0..2 {
                let got = ((1.0 - share) * positive[i] - share * negative[i]) / (1.0 - 2.0 * share);
                let tolerance = 1e-3 * cancelled * (1.0 + i as f64);
                assert!((got / exact[i] - 1.0).abs() < tolerance, "{filter:?}: {got} {}", exact[i]);
            }
        }
    }

    #[test]
    fn samples_follow_the_filter_by_chi_square() {
        // 20 bins a side of |f|; 19 degrees of freedom: above 43.8 in 0.1 % of the cases.
        for filter in Filter::ALL {
            let n = 40_000;
            let mut bins = [0.0; 20];
            for key in 0..n {
                let u = crate::sampling::sobol::pair(0, dioptric_math::random::mix(key));
                let ([x, _], _) = filter.offset(1.0, u);
                bins[((x + 1.0) * 10.0).clamp(0.0, 19.0) as usize] += 1.0;
            }
            let expected = |bin: usize| {
                let cell = |k: usize| (bin as f64 + (k as f64 + 0.5) / 100.0) / 10.0 - 1.0;
                (0..100).map(|k| filter.eval(cell(k)).abs()).sum::<f64>()
            };
            let total: f64 = (0..20).map(expected).sum();
            let chi2: f64 = (0..20)
                .map(|bin| (expected(bin) / total * n as f64, bins[bin]))
                .map(|(e, got)| if e > 5.0 { (got - e) * (got - e) / e } else { 0.0 })
                .sum();
            assert!(chi2 < 43.8, "{filter:?}: {chi2}");
        }
    }

    #[test]
    fn negative_samples_are_counted_to_within_half() {
        // p = share of the lobe of |f| on an axis; 2 p (1 - p) of the samples are negative.
        let lobe = 7.0 / 18.0 * (6.0_f64 / 7.0 * (6.0 / 7.0) * (6.0 / 7.0) * (6.0 / 7.0)) / 12.0;
        let p = lobe / (0.5 + 2.0 * lobe);
        for count in 0..5000 {
            let n = f64::from(Filter::Mitchell.negatives(count));
            assert!((n - f64::from(count) * 2.0 * p * (1.0 - p)).abs() < 0.51, "{count}: {n}");
            assert_eq!(Filter::Gaussian.negatives(count), 0);
        }
        assert_eq!(Filter::Mitchell.negatives(4), 0);
    }
}
