// SPDX-License-Identifier: MIT OR Apache-2.0
//! The numbers of one sample, in the order in which they are asked for.
//!
//! Every request is a new dimension. Within a dimension the samples of a pixel share one sequence, so
//! that together they are spread evenly, and neighbouring pixels complete each other (see [`screen`]). Dimensions are
//! independent of each other.

use dioptric_math::random;

use super::{Antialias, screen, sobol, strata};

/// The numbers of one sample of one pixel.
#[derive(Clone, Copy, Debug)]
pub struct Stream {
    kind: Kind,
    /// Of the pixel in its tile.
    place: u16,
    sample: u32,
    /// The key of the tile, or of the pixel of random numbers, and the seed, and [`STEP`] for each dimension before.
    key: u64,
}

/// From dimension to dimension.
const STEP: u64 = 0x9fb2_1c65_1e98_df25;

#[derive(Clone, Copy, Debug)]
enum Kind {
    Sobol,
    Random,
}

impl Stream {
    /// The numbers of sample `sample` of a pixel of the full picture: random for
    /// [`Antialias::Jitter`], Sobol's for all others.
    #[inline(always)]
    #[must_use]
    pub fn new(sampler: Antialias, pixel: [u32; 2], sample: u32, seed: u64) -> Self {
        let (kind, (apart, place)) = match sampler {
            Antialias::Jitter => {
                (Kind::Random, (u64::from(pixel[1]) << 32 | u64::from(pixel[0]), 0))
            }
            _ => (Kind::Sobol, screen::place(pixel)),
        };
        Self { kind, place, key: random::join(random::mix(seed), apart), sample }
    }

    /// The number of the sample that this is the stream of.
    #[must_use]
    pub const fn sample(&self) -> u32 {
        self.sample
    }

    /// One number in `[0, 1)`.
    pub fn next_1d(&mut self) -> f64 {
        self.next_2d()[0]
    }

    /// Two numbers in `[0, 1)`, evenly spread over the square by the pixel's samples together.
    pub fn next_2d(&mut self) -> [f64; 2] {
        let key = self.next_key();
        self.point(key, self.sample, 1)
    }

    /// Leaves out what [`Self::next_2d`] would give.
    pub const fn skip(&mut self) {
        self.key = self.key.wrapping_add(STEP);
    }

    /// This stream after [`Self::skip`] has been called so many times.
    #[must_use]
    pub const fn ahead(&self, times: usize) -> Self {
        Self { key: self.key.wrapping_add(STEP.wrapping_mul(times as u64)), ..*self }
    }

    /// The numbers for the second of two ways that part here; the first goes on with this stream.
    #[must_use]
    pub fn forked(&self) -> Self {
        Self { key: random::mix(!self.key), ..*self }
    }

    /// `n` pairs in `[0, 1)`, evenly spread among themselves (for a light of which one sample of the
    /// pixel takes `n` samples) and, with Sobol's numbers, with those of the pixel's other samples.
    pub fn pairs(&mut self, n: u32) -> impl Iterator<Item = [f64; 2]> + use<> {
        let key = self.next_key();
        let this = *self;
        (0..n).map(move |i| this.point(key, this.sample.wrapping_mul(n).wrapping_add(i), n))
    }

    /// Number `index` of another sequence for the same pixel, not that of the sample's number.
    pub(super) fn next_2d_at(&mut self, index: u32) -> [f64; 2] {
        let key = self.next_key();
        self.point(key, index, 1)
    }

    const fn next_key(&mut self) -> u64 {
        self.skip();
        random::mix(self.key)
    }

    /// Point `index` of a dimension; random points are jittered in groups of `n`.
    fn point(&self, key: u64, index: u32, n: u32) -> [f64; 2] {
        match self.kind {
            Kind::Sobol => sobol::at(index, self.place, key),
            Kind::Random => {
                let first = random::join(key, u64::from(index));
                let u = [random::unit(first), random::unit(random::mix(first))];
                if n == 1 { u } else { in_cell(u, index % n, n) }
            }
        }
    }
}

/// Sobol's numbers of sixteen samples side by side.
#[derive(Clone, Debug)]
pub(crate) struct Streams {
    keys: [u64; LANES],
    places: [u16; LANES],
    samples: [u32; LANES],
}

/// Samples side by side.
const LANES: usize = 16;

impl Streams {
    pub const EMPTY: Self = Self { keys: [0; LANES], places: [0; LANES], samples: [0; LANES] };

    /// Puts a stream of Sobol's numbers into a lane.
    #[inline(always)]
    pub const fn set(&mut self, lane: usize, stream: &Stream) {
        let lane = lane % LANES;
        self.keys[lane] = stream.key;
        self.places[lane] = stream.place;
        self.samples[lane] = stream.sample;
    }

    /// [`Stream::next_2d`] of each stream after its next `ahead` have been skipped.
    #[inline(always)]
    pub fn ahead(&self, ahead: u64, out: &mut [[f64; LANES]; 2]) {
        let [x, y] = out;
        let step = STEP.wrapping_mul(ahead + 1);
        for i in 0..LANES {
            let key = random::mix(self.keys[i].wrapping_add(step));
            [x[i], y[i]] = sobol::at_of_many(self.samples[i], self.places[i], key);
        }
    }
}

/// A point of the unit square, moved into cell `cell` of the grid of `n` cells.
pub(super) fn in_cell(u: [f64; 2], cell: u32, n: u32) -> [f64; 2] {
    let (columns, rows) = strata(n);
    // The sum can round up to the whole number above.
    let place =
        |u: f64, i: u32, n: u32| ((f64::from(i) + u) / f64::from(n)).min(1.0 - f64::EPSILON);
    [place(u[0], cell % columns, columns), place(u[1], cell / columns, rows)]
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOTH: [Antialias; 2] = [Antialias::Sobol, Antialias::Jitter];

    #[test]
    fn a_stream_is_a_function_of_its_key() {
        for kind in BOTH {
            let take = |pixel, sample, seed| {
                let mut s = Stream::new(kind, pixel, sample, seed);
                (s.next_1d(), s.next_2d(), s.pairs(3).collect::<Vec<_>>(), s.next_1d())
            };
            let base = take([3, 4], 5, 6);
            assert_eq!(base, take([3, 4], 5, 6));
            for other in [take([4, 3], 5, 6), take([3, 4], 6, 6), take([3, 4], 5, 7)] {
                assert!(base.0 != other.0 && base.1 != other.1 && base.2 != other.2);
            }
        }
    }

    #[test]
    fn numbers_are_in_range_even_at_the_ends() {
        for kind in BOTH {
            let mut s = Stream::new(kind, [u32::MAX; 2], u32::MAX, u64::MAX);
            for _ in 0..1000 {
                let all = s.pairs(5).chain([s.next_2d()]).collect::<Vec<_>>();
                assert!(all.iter().flatten().all(|u| (0.0..1.0).contains(u)));
            }
            assert_eq!(s.pairs(0).count(), 0);
        }
    }

    #[test]
    fn dimensions_and_pixels_are_uncorrelated() {
        // Correlation of 4096 independent uniform pairs: standard deviation 1/64.
        let correlation = |pairs: &[[f64; 2]]| {
            let n = pairs.len() as f64;
            12.0 * pairs.iter().map(|[a, b]| (a - 0.5) * (b - 0.5)).sum::<f64>() / n
        };
        for kind in BOTH {
            let streams = |sample| (0..4096).map(move |x| Stream::new(kind, [x, 7], sample, 1));
            let dimensions: Vec<_> = streams(2).map(|mut s| [s.next_1d(), s.next_1d()]).collect();
            // Samples of a pixel share a sequence with those of its tile: one pixel of each tile.
            let apart = |sample| (0..4096).map(move |x| Stream::new(kind, [16 * x, 7], sample, 1));
            let samples: Vec<_> = apart(0)
                .zip(apart(1000))
                .map(|(mut a, mut b)| [a.next_1d(), b.next_1d()])
                .collect();
            for pairs in [dimensions, samples] {
                assert!(correlation(&pairs).abs() < 3.5 / 64.0, "{kind:?}");
            }
            let neighbours: Vec<_> = streams(2)
                .zip(streams(2).skip(1))
                .map(|(mut a, mut b)| [a.next_1d(), b.next_1d()])
                .collect();
            let between = correlation(&neighbours);
            match kind {
                Antialias::Jitter => assert!(between.abs() < 3.5 / 64.0, "{between}"),
                // Every other pair is of one block of four, whose points lie in different quarters.
                _ => assert!((-0.4..-0.15).contains(&between), "{between}"),
            }
        }
    }

    #[test]
    fn pairs_are_stratified_within_a_sample() {
        for kind in BOTH {
            for sample in 0..20 {
                let mut s = Stream::new(kind, [1, 2], sample, 3);
                let mut seen = [false; 16];
                for [x, y] in s.pairs(16) {
                    seen[(y * 4.0) as usize * 4 + (x * 4.0) as usize] = true;
                }
                assert_eq!(seen, [true; 16], "{kind:?}");
            }
        }
    }

    #[test]
    fn sobol_pairs_of_all_samples_are_one_net() {
        let mut seen = [false; 64];
        for sample in 0..16 {
            for [x, y] in Stream::new(Antialias::Sobol, [9, 9], sample, 3).pairs(4) {
                seen[(y * 8.0) as usize * 8 + (x * 8.0) as usize] = true;
            }
        }
        assert_eq!(seen, [true; 64]);
    }
}
