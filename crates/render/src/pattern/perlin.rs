// SPDX-License-Identifier: MIT OR Apache-2.0
//! Gradient noise (Perlin, "Improving Noise", SIGGRAPH 2002) and its sums over octaves (Perlin, "An
//! Image Synthesizer", SIGGRAPH 1985): the material of all cloudy patterns.

use dioptric_math::DVec3;
use dioptric_math::random::Random;
use dioptric_scene::{Args, Default, Diagnostic, Param, Type};

/// The largest |value| of the raw noise, found by maximising over the cell with the best gradient at
/// each corner; a test searches for it again.
const PEAK: f64 = 1.036_353_811_211_802_7;

/// The gradients: the middles of a cube's edges, four of them twice, so that 16 hashes share them.
const GRADIENTS: [DVec3; 16] = {
    const fn g(x: f64, y: f64, z: f64) -> DVec3 {
        DVec3::new(x, y, z)
    }
    [
        g(1.0, 1.0, 0.0),
        g(-1.0, 1.0, 0.0),
        g(1.0, -1.0, 0.0),
        g(-1.0, -1.0, 0.0),
        g(1.0, 0.0, 1.0),
        g(-1.0, 0.0, 1.0),
        g(1.0, 0.0, -1.0),
        g(-1.0, 0.0, -1.0),
        g(0.0, 1.0, 1.0),
        g(0.0, -1.0, 1.0),
        g(0.0, 1.0, -1.0),
        g(0.0, -1.0, -1.0),
        g(1.0, 1.0, 0.0),
        g(-1.0, 1.0, 0.0),
        g(0.0, -1.0, 1.0),
        g(0.0, -1.0, -1.0),
    ]
};

/// Smooth random values over space, 0 at every whole point, repeating after 256 units.
#[derive(Clone, Debug)]
pub(super) struct Perlin {
    /// A shuffled row of all bytes.
    permutation: Box<[u8; 256]>,
}

impl Perlin {
    /// The noise of a seed.
    pub(super) fn new(seed: u64) -> Self {
        let mut permutation = Box::new(std::array::from_fn(|i| i as u8));
        let mut random = Random::new(seed);
        // Fisher and Yates's shuffle.
        for i in (1..256usize).rev() {
            permutation.swap(i, (random.bits() % (i as u64 + 1)) as usize);
        }
        Self { permutation }
    }

    /// The noise of the `seed` argument.
    pub(super) fn from_args(args: &Args) -> Result<Self, Diagnostic> {
        Ok(Self::new(args.integer("seed")? as u64))
    }

    fn hash(&self, key: u8, lane: i64) -> u8 {
        // Wrapping to a byte is the lattice's period of 256, for negative numbers too.
        self.permutation[usize::from(key.wrapping_add(lane as u8))]
    }

    /// A value in `[-1, 1]`; NaN where the point is not finite.
    pub(super) fn noise(&self, p: DVec3) -> f64 {
        let cell = p.floor();
        let f = p - cell;
        // The conversion saturates: points beyond any integer are whole, and their noise is 0.
        let (x, y, z) = (cell.x as i64, cell.y as i64, cell.z as i64);
        let (x1, y1, z1) = (x.wrapping_add(1), y.wrapping_add(1), z.wrapping_add(1));
        let corner = |key: u8, lane: i64, offset: DVec3| {
            let hash = self.hash(key, lane);
            GRADIENTS[usize::from(hash & 15)].dot(f - offset)
        };
        let (a, b) = (self.hash(0, x), self.hash(0, x1));
        let (aa, ab) = (self.hash(a, y), self.hash(a, y1));
        let (ba, bb) = (self.hash(b, y), self.hash(b, y1));
        let (wx, wy, wz) = (fade(f.x), fade(f.y), fade(f.z));
        let floor = lerp(
            lerp(corner(aa, z, DVec3::ZERO), corner(ba, z, DVec3::X), wx),
            lerp(corner(ab, z, DVec3::Y), corner(bb, z, DVec3::new(1.0, 1.0, 0.0)), wx),
            wy,
        );
        let ceiling = lerp(
            lerp(corner(aa, z1, DVec3::Z), corner(ba, z1, DVec3::new(1.0, 0.0, 1.0)), wx),
            lerp(corner(ab, z1, DVec3::new(0.0, 1.0, 1.0)), corner(bb, z1, DVec3::ONE), wx),
            wy,
        );
        lerp(floor, ceiling, wz) * (1.0 / PEAK)
    }
}

/// Perlin's fifth-degree curve, whose first and second derivatives are 0 at both ends.
fn fade(t: f64) -> f64 {
    t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
}

fn lerp(a: f64, b: f64, t: f64) -> f64 {
    a + (b - a) * t
}

/// The `octaves` parameter.
pub(super) const OCTAVES: Param = Param::new(
    "octaves",
    Type::Integer { min: 1, max: 16 },
    Default::Number(6.0),
    "How many layers of finer and finer noise are added.",
);

/// The `lacunarity` parameter.
pub(super) const LACUNARITY: Param = Param::new(
    "lacunarity",
    Type::Number { min: 1.0, max: 16.0 },
    Default::Number(2.0),
    "How many times finer each octave is than the one before.",
);

/// The `gain` parameter.
pub(super) const GAIN: Param = Param::new(
    "gain",
    Type::UNIT,
    Default::Number(0.5),
    "How strong each octave is against the one before.",
);

/// Sums of noise over octaves.
#[derive(Clone, Debug)]
pub(super) struct Octaves {
    noise: Perlin,
    count: u32,
    lacunarity: f64,
    gain: f64,
    /// One over the sum of the weights.
    normalise: f64,
}

impl Octaves {
    /// Reads `seed`, `octaves`, `lacunarity` and `gain`.
    pub(super) fn from_args(args: &Args) -> Result<Self, Diagnostic> {
        let count = args.integer("octaves")?.clamp(1, 16) as u32;
        Ok(Self::new(
            Perlin::from_args(args)?,
            count,
            args.number("lacunarity")?,
            args.number("gain")?,
        ))
    }

    /// Two octaves of a seed, the second half as strong.
    pub(super) fn two(seed: u64) -> Self {
        Self::new(Perlin::new(seed), 2, 2.0, 0.5)
    }

    fn new(noise: Perlin, count: u32, lacunarity: f64, gain: f64) -> Self {
        let (mut sum, mut weight) = (0.0, 1.0);
        for _ in 0..count {
            sum += weight;
            weight *= gain;
        }
        Self { noise, count, lacunarity, gain, normalise: 1.0 / sum }
    }

    /// The weighted mean of `shape(noise)` over the octaves.
    fn mean(&self, mut p: DVec3, shape: impl Fn(f64) -> f64) -> f64 {
        let (mut sum, mut weight) = (0.0, 1.0);
        for _ in 0..self.count {
            sum += weight * shape(self.noise.noise(p));
            weight *= self.gain;
            // The shift keeps the zeros of the octaves from falling on the same whole points.
            p = p * self.lacunarity + DVec3::new(17.31, 41.67, 73.19);
        }
        sum * self.normalise
    }

    /// Fractional Brownian motion: a value in `[-1, 1]`.
    pub(super) fn fbm(&self, p: DVec3) -> f64 {
        self.mean(p, |n| n)
    }

    /// Perlin's turbulence, the sum of the absolute values: a value in `[0, 1]`, small on sharp creases.
    pub(super) fn turbulence(&self, p: DVec3) -> f64 {
        self.mean(p, f64::abs)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(seed: u64, count: usize, reach: f64) -> impl Iterator<Item = DVec3> {
        let mut r = Random::new(seed);
        (0..count).map(move |_| {
            DVec3::new(r.uniform(-reach, reach), r.uniform(-reach, reach), r.uniform(-reach, reach))
        })
    }

    #[test]
    fn the_peak_is_the_largest_possible_value() {
        // At every corner the best of the gradients: the sum of the two largest distances.
        let largest = |p: DVec3| {
            let mut sum = 0.0;
            for i in 0..8 {
                let c = DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2));
                let d = (p - c).abs();
                let weight = |t: f64, c: f64| if c == 1.0 { fade(t) } else { 1.0 - fade(t) };
                let w = weight(p.x, c.x) * weight(p.y, c.y) * weight(p.z, c.z);
                sum += w * (d.x + d.y + d.z - d.min_element());
            }
            sum
        };
        let mut best = (0.0, DVec3::ZERO);
        let mut step = 0.05;
        let mut grid: Vec<f64> = (0..=20).map(|i| f64::from(i) * step).collect();
        for &x in &grid {
            for &y in &grid {
                for &z in &grid {
                    let p = DVec3::new(x, y, z);
                    if largest(p) > best.0 {
                        best = (largest(p), p);
                    }
                }
            }
        }
        grid = vec![-1.0, 0.0, 1.0];
        while step > 1e-9 {
            let from = best.1;
            for &x in &grid {
                for &y in &grid {
                    for &z in &grid {
                        let p = from + DVec3::new(x, y, z) * step;
                        if largest(p) > best.0 {
                            best = (largest(p), p);
                        }
                    }
                }
            }
            if best.1 == from {
                step *= 0.5;
            }
        }
        assert!((best.0 - PEAK).abs() < 1e-12, "{best:?}");
    }

    #[test]
    fn zero_at_whole_points_and_within_one_elsewhere() {
        let noise = Perlin::new(9);
        let (mut low, mut high, mut sum) = (0.0_f64, 0.0_f64, 0.0);
        for p in points(1, 100_000, 300.0) {
            assert_eq!(noise.noise(p.floor()), 0.0);
            let n = noise.noise(p);
            (low, high, sum) = (low.min(n), high.max(n), sum + n);
        }
        assert!((-1.0..-0.75).contains(&low) && (0.75..=1.0).contains(&high), "{low} {high}");
        assert!((sum / 1e5).abs() < 0.005, "the mean is {}", sum / 1e5);
    }

    #[test]
    fn continuous_with_its_slope_across_cells() {
        let noise = Perlin::new(2);
        let h = 1e-6;
        for p in points(4, 500, 20.0) {
            let edge = DVec3::new(p.x.round(), p.y, p.z);
            let at = |d: f64| noise.noise(edge + DVec3::new(d, 0.0, 0.0));
            assert!((at(h) - at(-h)).abs() < 1e-5, "{edge}");
            assert!(((at(h) - at(0.0)) - (at(0.0) - at(-h))).abs() / h < 1e-4, "{edge}");
        }
    }

    #[test]
    fn all_directions_are_alike() {
        // The mean squared change over a tenth of a cell along the axes and along diagonals.
        let noise = Perlin::new(3);
        let change = |d: DVec3| {
            let d = d * (0.1 / d.length());
            let sum: f64 = points(6, 40_000, 100.0)
                .map(|p| {
                    let change = noise.noise(p + d) - noise.noise(p);
                    change * change
                })
                .sum();
            sum / 40_000.0
        };
        let (x, y, z) = (change(DVec3::X), change(DVec3::Y), change(DVec3::Z));
        let diagonal = change(DVec3::ONE);
        for other in [y, z, diagonal] {
            assert!((other / x - 1.0).abs() < 0.15, "{x} {y} {z} {diagonal}");
        }
    }

    #[test]
    fn seeds_differ_and_repeat() {
        let (a, b, c) = (Perlin::new(1), Perlin::new(1), Perlin::new(2));
        let p = DVec3::new(0.3, 4.7, -2.2);
        assert_eq!(a.noise(p), b.noise(p));
        let different = points(5, 100, 50.0).filter(|p| a.noise(*p) != c.noise(*p)).count();
        assert!(different > 90, "{different}");
        let mut sorted = *a.permutation;
        sorted.sort_unstable();
        assert!(sorted.iter().enumerate().all(|(i, &v)| i == usize::from(v)));
    }

    #[test]
    fn the_lattice_has_a_period_and_no_edge() {
        let noise = Perlin::new(5);
        let p = DVec3::new(0.25, 0.5, 0.75);
        assert_eq!(noise.noise(p), noise.noise(p + 256.0));
        assert_eq!(noise.noise(p), noise.noise(p - 256.0));
        assert_eq!(noise.noise(DVec3::splat(1e18)), 0.0);
        assert_eq!(noise.noise(DVec3::splat(-1e300)), 0.0);
        assert!(noise.noise(DVec3::splat(f64::INFINITY)).is_nan());
        assert!(noise.noise(DVec3::splat(f64::NAN)).is_nan());
    }

    #[test]
    fn octaves_stay_in_range_and_add_detail() {
        let of = |count| Octaves::new(Perlin::new(7), count, 2.0, 0.5);
        let (one, six) = (of(1), of(6));
        let roughness = |o: &Octaves| -> f64 {
            points(8, 2000, 50.0).map(|p| (o.fbm(p + 0.001) - o.fbm(p)).abs()).sum()
        };
        assert!(roughness(&six) > 1.1 * roughness(&one));
        for p in points(9, 5000, 50.0) {
            assert_eq!(one.fbm(p), one.noise.noise(p));
            assert!(six.fbm(p).abs() <= 1.0 && (0.0..=1.0).contains(&six.turbulence(p)));
            assert!(six.turbulence(p) >= six.fbm(p).abs() - 1e-15);
        }
    }
}
