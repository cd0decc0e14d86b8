// SPDX-License-Identifier: MIT OR Apache-2.0
//! Where the samples of a pixel lie and how much each counts.

use dioptric_math::random;

use super::Antialias;
use super::stream::{Stream, in_cell};
use crate::filter::Filter;
use crate::setting::render::RenderSettings;

/// One sample of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelSample {
    /// Pixels from the left edge of the full picture; outside the sample's pixel by at most the
    /// filter's radius, and so perhaps outside the picture.
    pub x: f64,
    /// Pixels from the top edge of the full picture.
    pub y: f64,
    /// How much it counts before the weights of the pixel are made to add up to 1: 1, or -1 in a
    /// negative lobe of the filter.
    pub weight: f64,
}

/// Sample `index` of a pixel (column, row) of the full picture, and the numbers for the rest of its
/// way, of which the first two are for the lens. Depends on nothing but the settings and these.
#[inline]
#[must_use]
pub fn pixel_sample(
    settings: &RenderSettings,
    pixel: [u32; 2],
    index: u32,
) -> (PixelSample, Stream) {
    if is_middle(settings) {
        return middle_sample(settings, pixel, index);
    }
    let mut stream = Stream::new(settings.antialias, pixel, index, settings.seed);
    let (offset, weight) = offset(settings, pixel, index, &mut stream);
    let [x, y] = [0, 1].map(|axis| f64::from(pixel[axis]) + offset[axis]);
    (PixelSample { x, y, weight }, stream)
}

/// Whether all samples lie in the middles of their pixels.
pub(crate) fn is_middle(settings: &RenderSettings) -> bool {
    let plain = settings.filter == Filter::Box && settings.filter_radius == 0.5;
    settings.antialias == Antialias::None && plain
}

/// [`pixel_sample`] in the middle of a pixel.
#[inline(always)]
pub(crate) fn middle_sample(
    settings: &RenderSettings,
    pixel: [u32; 2],
    index: u32,
) -> (PixelSample, Stream) {
    let [x, y] = pixel.map(|place| f64::from(place) + 0.5);
    let stream = Stream::new(Antialias::None, pixel, index, settings.seed);
    (PixelSample { x, y, weight: 1.0 }, stream)
}

/// The weights of a pixel's first `count` samples, which add up to 1: the pixel's colour is the sum
/// of its samples' colours, each times its weight.
#[must_use]
pub fn pixel_weights(settings: &RenderSettings, pixel: [u32; 2], count: u32) -> Vec<f64> {
    let weights: Vec<f64> =
        (0..count).map(|index| pixel_sample(settings, pixel, index).0.weight).collect();
    let sum: f64 = weights.iter().sum();
    weights.into_iter().map(|w| w / sum).collect()
}

/// The place of a sample relative to the pixel's top left corner, and its weight.
#[inline(never)]
fn offset(
    settings: &RenderSettings,
    pixel: [u32; 2],
    index: u32,
    stream: &mut Stream,
) -> ([f64; 2], f64) {
    let (filter, radius) = (settings.filter, settings.filter_radius);
    let regular = |u: [f64; 2]| {
        if filter == Filter::Box && radius == 0.5 {
            return (u, 1.0); // exact: 0.2 stays 0.2
        }
        let (offset, weight) = filter.offset(radius, u);
        (offset.map(|o| 0.5 + o), weight)
    };
    match settings.antialias {
        Antialias::None => regular([0.5; 2]),
        Antialias::Grid => {
            let n = settings.samples.max(1);
            regular(in_cell([0.5; 2], index % n, n))
        }
        Antialias::Report => {
            let place = |bit: u32| if index & bit == 0 { 0.2 } else { 0.8 };
            regular([place(1), place(2)])
        }
        Antialias::Jitter => {
            let n = settings.samples.max(1);
            // Which cell a negative sample takes away from the positive ones is left to chance.
            let place = u64::from(pixel[1]) << 32 | u64::from(pixel[0]);
            let turn = random::join(place, settings.seed) % u64::from(n);
            let cell = (u64::from(index) + turn) % u64::from(n);
            let u = in_cell(stream.next_2d(), cell as u32, n);
            let (part, _) = part(filter, index);
            part.offset(filter, radius, u)
        }
        Antialias::Sobol | Antialias::Adaptive => {
            let (part, number) = part(filter, index);
            // Both parts count up in one sequence, the negative one from its end.
            let u = stream.next_2d_at(if part == Part::Negative { !number } else { number });
            part.offset(filter, radius, u)
        }
    }
}

/// A part of the filter, by its sign.
#[derive(Clone, Copy, PartialEq)]
enum Part {
    Positive,
    Negative,
}

impl Part {
    fn offset(self, filter: Filter, radius: f64, u: [f64; 2]) -> ([f64; 2], f64) {
        let (offset, weight) = match self {
            Self::Positive => (filter.positive_offset(radius, u), 1.0),
            Self::Negative => (filter.negative_offset(radius, u), -1.0),
        };
        (offset.map(|o| 0.5 + o), weight)
    }
}

/// The part in which sample `index` lies, and how many samples of this part are before it.
fn part(filter: Filter, index: u32) -> (Part, u32) {
    let before = filter.negatives(index);
    if filter.negatives(index.saturating_add(1)) > before {
        (Part::Negative, before)
    } else {
        (Part::Positive, index - before)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settings(antialias: Antialias, samples: u32) -> RenderSettings {
        RenderSettings { antialias, samples, max_samples: samples, ..RenderSettings::default() }
    }

    fn places(settings: &RenderSettings, pixel: [u32; 2]) -> Vec<[f64; 2]> {
        (0..settings.samples)
            .map(|i| pixel_sample(settings, pixel, i).0)
            .map(|s| [s.x - f64::from(pixel[0]), s.y - f64::from(pixel[1])])
            .collect()
    }

    #[test]
    fn regular_positions_are_exact() {
        assert_eq!(places(&settings(Antialias::None, 1), [0, 0]), [[0.5, 0.5]]);
        assert_eq!(
            places(&settings(Antialias::Report, 4), [0, 0]),
            [[0.2, 0.2], [0.8, 0.2], [0.2, 0.8], [0.8, 0.8]]
        );
        let (sample, _) = pixel_sample(&settings(Antialias::Report, 4), [400, 7], 2);
        assert_eq!((sample.x, sample.y, sample.weight), (400.2, 7.8, 1.0));
        let grid = places(&settings(Antialias::Grid, 16), [800, 600]);
        for (i, place) in (0u32..).zip(grid) {
            let [x, y] = [i % 4, i / 4].map(|k| (f64::from(k) + 0.5) / 4.0);
            assert_eq!(place, [x, y]);
        }
    }

    #[test]
    fn jittered_samples_fall_one_into_each_cell() {
        for pixel in [[0, 0], [3, 1000], [799, 5]] {
            let mut seen = [false; 12];
            for [x, y] in places(&settings(Antialias::Jitter, 12), pixel) {
                seen[(y * 3.0) as usize * 4 + (x * 4.0) as usize] = true;
            }
            assert_eq!(seen, [true; 12]);
        }
    }

    #[test]
    fn sobol_samples_are_nets_and_prefixes_of_each_other() {
        for pixel in [[0, 0], [3, 1000]] {
            let many = places(&settings(Antialias::Sobol, 64), pixel);
            let few = places(&settings(Antialias::Adaptive, 16), pixel);
            assert_eq!(few, many[..16]);
            let mut seen = [false; 64];
            for [x, y] in many {
                seen[(y * 8.0) as usize * 8 + (x * 8.0) as usize] = true;
            }
            assert_eq!(seen, [true; 64]);
        }
    }

    #[test]
    fn seeds_and_pixels_give_other_samples() {
        for mode in [Antialias::Jitter, Antialias::Sobol] {
            let s = settings(mode, 4);
            assert_ne!(places(&s, [1, 2]), places(&s, [2, 1]));
            assert_ne!(
                places(&s, [1, 2]),
                places(&RenderSettings { seed: 9, ..s.clone() }, [1, 2])
            );
        }
    }

    #[test]
    fn places_and_lenses_are_independent() {
        // Sums of products over many pixels: standard deviation of the mean 1 / (12 sqrt n).
        let s = settings(Antialias::Sobol, 1);
        let n = 4000;
        let mut sum = 0.0;
        for x in 0..n {
            let (sample, mut stream) = pixel_sample(&s, [x, 3], 0);
            let u = sample.x - f64::from(x) - 0.5;
            sum += u * (stream.next_2d()[0] - 0.5) + u * (stream.next_1d() - 0.5);
        }
        assert!((sum / f64::from(n)).abs() < 4.0 / (12.0 * 63.0) * 1.5, "{sum}");
    }

    #[test]
    fn samples_of_a_pixel_have_the_moments_of_its_filter() {
        for mode in [Antialias::Sobol, Antialias::Jitter] {
            for filter in Filter::ALL {
                let radius = filter.default_radius();
                let s = RenderSettings { filter, filter_radius: radius, ..settings(mode, 4096) };
                let (mut sum, mut square) = (0.0, 0.0);
                for i in 0..s.samples {
                    let (sample, _) = pixel_sample(&s, [5, 5], i);
                    let x = sample.x - 5.5;
                    assert!(x.abs() <= radius && (sample.y - 5.5).abs() <= radius);
                    sum += sample.weight;
                    square += sample.weight * x * x;
                }
                let exact = |g: &dyn Fn(f64) -> f64| {
                    let x = |i: i32| (f64::from(i) + 0.5) / 1000.0 - 1.0;
                    (0..2000).map(|i| g(x(i)) * filter.eval(x(i))).sum::<f64>()
                };
                let second = exact(&|x| x * x * radius * radius) / exact(&|_| 1.0);
                assert!((square / sum - second).abs() < 0.03 * second, "{mode:?} {filter:?}");
            }
        }
    }

    #[test]
    fn weights_never_add_up_to_nothing() {
        for mode in [Antialias::Grid, Antialias::Jitter, Antialias::Sobol] {
            for samples in 1..200 {
                let s = RenderSettings {
                    filter: Filter::Mitchell,
                    filter_radius: 2.0,
                    ..settings(mode, samples)
                };
                let sum: f64 = (0..samples).map(|i| pixel_sample(&s, [1, 1], i).0.weight).sum();
                assert!(sum >= 0.75 * f64::from(samples), "{mode:?} {samples}: {sum}");
            }
        }
    }

    #[test]
    #[ignore = "a measurement: cargo test --release -p dioptric-render sampling_cost -- --ignored --nocapture"]
    fn sampling_cost() {
        for mode in [Antialias::Grid, Antialias::Jitter, Antialias::Sobol] {
            for filter in Filter::ALL {
                let s = RenderSettings { filter, filter_radius: 1.5, ..settings(mode, 16) };
                // The best of several runs: other work on the machine only makes them slower.
                let mut best = f64::INFINITY;
                for _ in 0..20 {
                    let start = std::time::Instant::now();
                    let (n, mut sum) = (1 << 16, 0.0);
                    for i in 0..n {
                        let (sample, mut stream) = pixel_sample(&s, [i / 16, 7], i % 16);
                        sum += sample.x + stream.next_2d()[0] + stream.next_2d()[1];
                    }
                    std::hint::black_box(sum);
                    best = best.min(start.elapsed().as_nanos() as f64 / f64::from(n));
                }
                println!("{mode:?} {filter:?}: {best:.1} ns a sample");
            }
        }
    }
}
