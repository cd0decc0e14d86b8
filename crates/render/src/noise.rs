// SPDX-License-Identifier: MIT OR Apache-2.0
//! Pictures that are sampled until their error is small enough.
//!
//! The samples are made in passes, each as many as all before. The two halves of a pixel's samples, A of the passes before
//! and B of the last one, are two pictures with independent noise of the same strength: the error of their mean is
//! estimated by half their difference. (For Sobol's points it is less, since the halves complete each other: the estimate is
//! on the safe side.) One pixel's difference says little; the root of the mean square over a block of pixels says
//! enough. Blocks whose error is below the goal get no more samples.
//!
//! A mean that is stopped when it looks good is biased: it stops too often where bright paths have not been found
//! yet. Therefore a pixel's own samples do not decide about it, only those of the other pixels of its block, whose
//! random numbers are others. (They complete each other, [`crate::sampling::screen`], which ties them together by as little
//! as one pixel of many can be: the test with shared numbers measures no bias.) What is left is of second order: a pixel has a part, of one in 255, in whether its
//! neighbours go on, and so in what they say about it later.
//!
//! Differences are measured as a display shows them: see [`shown`].

use std::ops::Range;

use dioptric_math::Spectrum;
use dioptric_scene::Diagnostic;
use rayon::ThreadPool;

use crate::film::{Film, FilmPixel};
use crate::job::{Control, Shoot, render_samples};
use crate::region::Region;
use crate::setting::render::RenderSettings;

/// Side of the blocks of pixels, which lie as in the full picture.
const BLOCK: u32 = 16;

/// Samples of a pixel before the first decision.
const FIRST: u32 = 16;

/// What is to be reached.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goal {
    /// The error, as a share of the way from black to white on a display.
    pub error: f64,
    /// The factor with which light is shown.
    pub exposure: f64,
    /// The most samples of a pixel.
    pub most: u32,
}

/// What was reached.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reached {
    /// Estimated root of the mean squared error over all pixels and channels.
    pub error: f64,
    /// What it is below of, with 95 % confidence: the error's squares of pixels are independent, so that their mean is
    /// nearly normal.
    pub bound: f64,
    /// The error of the worst block of pixels.
    pub worst: f64,
    /// The first pixel of that block.
    pub worst_at: [u32; 2],
    /// Samples of a pixel in the last pass that was made.
    pub samples: u32,
    /// Whether no pixel wants more.
    pub met: bool,
}

/// Renders a region until the error of each block is small enough: the same bits for every pool, and for a pixel in every
/// region. Before each further pass `go_on` is asked, with the number of its samples of all pixels.
///
/// When cancelled, the film is that of the last complete pass; unfinished where there is none.
///
/// # Errors
/// There is not enough memory.
pub fn render(
    settings: &RenderSettings,
    goal: &Goal,
    region: Region,
    pool: &ThreadPool,
    shoot: &dyn Shoot,
    control: &Control,
    go_on: &dyn Fn(u64) -> bool,
) -> Result<(Film, Reached), Diagnostic> {
    let around = aligned(&region, settings.size);
    let pass = |samples: Range<u32>, wanted: &[bool]| {
        let mut film = pool.install(|| Film::new(around, control.layers))?;
        for (pixel, wanted) in film.all_mut().0.iter_mut().zip(wanted) {
            pixel.set_finished(!wanted);
        }
        Ok(render_samples(settings, samples, film, pool, shoot, control))
    };
    let count = around.area() as usize;
    let mut wanted = vec![true; count];
    let mut errors = vec![0.0; count];
    let most = goal.most.max(2);
    let mut samples = FIRST.min(1 << most.ilog2()) / 2;
    let mut film = pass(0..samples, &wanted)?;
    let mut met = false;
    while film.finished() {
        let later = pass(samples..2 * samples, &wanted)?;
        if !later.finished() {
            break;
        }
        let both = film.pixels().iter().zip(later.pixels());
        for ((error, (a, b)), _) in errors.iter_mut().zip(both).zip(&wanted).filter(|(_, w)| **w) {
            *error = squared_error(a, b, goal.exposure);
        }
        film.join(&later);
        samples *= 2;
        wanted = still_wanted(&around, &errors, &wanted, goal.error);
        let pixels = wanted.iter().filter(|wanted| **wanted).count() as u64;
        met = pixels == 0;
        if met || 2 * samples > most || !go_on(pixels * u64::from(samples)) {
            break;
        }
    }
    let reached = reached(&around, &region, &errors, samples, met);
    let film = if around == region { film } else { film.cropped(region)? };
    Ok((film, reached))
}

/// The blocks in which a region lies.
fn aligned(region: &Region, size: [u32; 2]) -> Region {
    let cut = |start: u32, length: u32, size: u32| {
        let first = start / BLOCK * BLOCK;
        let end = (start + length).next_multiple_of(BLOCK).min(size);
        (first, end - first)
    };
    let (x, width) = cut(region.x, region.width, size[0]);
    let (y, height) = cut(region.y, region.height, size[1]);
    Region { x, y, width, height }
}

/// Light as a display shows it, nearly: the square root, which is near to sRGB's curve, up to white, where it goes on ever
/// more slowly towards 2, so that differences far above white count for little.
#[must_use]
pub fn shown(light: f64) -> f64 {
    // Not NaN's way.
    if light > 1.0 {
        2.0 - 1.0 / light.sqrt()
    } else if light > 0.0 {
        light.sqrt()
    } else {
        0.0
    }
}

/// The estimated square of the error of a pixel's mean, from the two halves of its samples; the mean of its channels.
fn squared_error(a: &FilmPixel, b: &FilmPixel, exposure: f64) -> f64 {
    let [a, b] = [a, b].map(|half: &FilmPixel| (half.linear() * exposure).to_array().map(shown));
    let half = Spectrum::from_array(std::array::from_fn(|c| 0.5 * (a[c] - b[c])));
    half.dot(half) / 3.0
}

/// The pixels of each block, by their numbers in the region.
fn blocks(around: &Region) -> impl Iterator<Item = (Vec<usize>, [u32; 2])> + use<> {
    let around = *around;
    let steps = |length: u32| (0..length).step_by(BLOCK as usize);
    steps(around.height).flat_map(move |top| {
        steps(around.width).map(move |left| {
            let columns = left..(left + BLOCK).min(around.width);
            let rows = top..(top + BLOCK).min(around.height);
            let pixels = rows.flat_map(|row| {
                columns.clone().map(move |column| (row * around.width + column) as usize)
            });
            (pixels.collect(), [around.x + left, around.y + top])
        })
    })
}

/// Which pixels want more samples: those that did, in blocks whose other pixels are not yet good enough.
fn still_wanted(around: &Region, errors: &[f64], wanted: &[bool], goal: f64) -> Vec<bool> {
    let mut more = vec![false; wanted.len()];
    for (pixels, _) in blocks(around) {
        let sum: f64 = pixels.iter().map(|&i| errors[i]).sum();
        let others = pixels.len().saturating_sub(1).max(1) as f64;
        for &i in &pixels {
            // Of a single pixel there are no others.
            let rest = if pixels.len() > 1 { sum - errors[i] } else { sum };
            more[i] = wanted[i] && rest > goal * goal * others;
        }
    }
    more
}

fn reached(around: &Region, region: &Region, errors: &[f64], samples: u32, met: bool) -> Reached {
    let own = |(place, error): ([u32; 2], &f64)| region.index(place[0], place[1]).map(|_| *error);
    let own: Vec<f64> = around.pixels().zip(errors).filter_map(own).collect();
    let n = own.len().max(1) as f64;
    let mean = own.iter().sum::<f64>() / n;
    let variance = own.iter().map(|e| (e - mean) * (e - mean)).sum::<f64>() / n;
    // 1.645: 95 % of a normal distribution lie below.
    let bound = mean + 1.645 * (variance / n).sqrt();
    let (mut worst, mut worst_at) = (0.0, [region.x, region.y]);
    for (pixels, place) in blocks(around) {
        let mean = pixels.iter().map(|&i| errors[i]).sum::<f64>() / pixels.len().max(1) as f64;
        if mean > worst {
            (worst, worst_at) = (mean, place);
        }
    }
    let [error, bound, worst] = [mean, bound, worst].map(f64::sqrt);
    Reached { error, bound, worst, worst_at, samples, met }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{FirstHit, Radiance};
    use crate::sampling::{Antialias, PixelSample, Stream};
    use crate::stats::RayCounts;

    /// Quiet on the left, noisy on the right; the mean is 0.25 everywhere.
    fn half_noisy(sample: &PixelSample, stream: &mut Stream, rays: &mut RayCounts) -> Radiance {
        rays.camera += 1;
        // Independent numbers, as many bounces use them up.
        let bits = dioptric_math::random::join(stream.next_1d().to_bits(), 5);
        let noise = (bits >> 11) as f64 / (1u64 << 53) as f64;
        let spread = if sample.x < 32.0 { 0.05 } else { 0.5 };
        let value = 0.25 + spread * (noise - 0.5);
        Radiance { color: Spectrum::splat(value), alpha: 1.0, first: FirstHit::NONE }
    }

    fn bright(is_bright: bool, rays: &mut RayCounts) -> Radiance {
        rays.camera += 1;
        let value = if is_bright { 20.0 } else { 0.1 };
        Radiance { color: Spectrum::splat(value), alpha: 1.0, first: FirstHit::NONE }
    }

    /// Bright one time in 200: light that is rarely found, by chance alone.
    fn rare(_: &PixelSample, stream: &mut Stream, rays: &mut RayCounts) -> Radiance {
        let bits = dioptric_math::random::join(stream.next_1d().to_bits(), 5);
        bright(dioptric_math::random::unit(bits) < 0.005, rays)
    }

    /// The same by numbers in which neighbouring pixels complete each other.
    fn shared(_: &PixelSample, stream: &mut Stream, rays: &mut RayCounts) -> Radiance {
        let ([a, b], [c, _]) = (stream.next_2d(), stream.next_2d());
        bright((a - 0.3).abs() < 0.05 && (b - 0.6).abs() < 0.05 && c < 0.5, rays)
    }

    fn make(
        shoot: &dyn Shoot,
        error: f64,
        region: Region,
        threads: usize,
        seed: u64,
    ) -> (Film, Reached) {
        let s = RenderSettings {
            size: [72, 40],
            antialias: Antialias::Sobol,
            seed,
            ..RenderSettings::default()
        };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let goal = Goal { error, exposure: 1.0, most: 4096 };
        render(&s, &goal, region, &pool, shoot, &Control::default(), &|_| true).unwrap()
    }

    #[test]
    fn noisy_parts_get_more_and_the_error_is_what_is_said() {
        let full = Region::full([72, 40]);
        let (film, reached) = make(&half_noisy, 0.02, full, 2, 1);
        println!("{reached:?}");
        assert!(reached.met && reached.error <= 0.02 && reached.bound < 1.1 * reached.error);
        let samples = |x| film.pixel(x, 9).unwrap().count();
        assert!(samples(5) == 16 && samples(50) >= 64, "{} {}", samples(5), samples(50));
        let squares =
            film.pixels().iter().map(|p| (shown(p.linear().x) - 0.5) * (shown(p.linear().x) - 0.5));
        let real = (squares.sum::<f64>() / film.pixels().len() as f64).sqrt();
        println!("real {real:.5}, {reached:?}");
        assert!(real < 1.05 * reached.bound && real > 0.8 * reached.error);
    }

    #[test]
    fn the_same_bits_for_threads_and_crops() {
        let full = Region::full([72, 40]);
        let (whole, reached) = make(&half_noisy, 0.02, full, 1, 1);
        for threads in [2, 7] {
            assert_eq!(make(&half_noisy, 0.02, full, threads, 1), (whole.clone(), reached));
        }
        let crop = Region { x: 25, y: 5, width: 30, height: 35 };
        let (part, _) = make(&half_noisy, 0.02, crop, 2, 1);
        assert!(crop.pixels().all(|[x, y]| part.pixel(x, y) == whole.pixel(x, y)));
    }

    #[test]
    fn stopping_does_not_lose_rare_light() {
        // The mean over all pixels of 40 pictures is 0.1995; stopping pixels by themselves would lose a tenth of it.
        let full = Region::full([72, 40]);
        for (shoot, most) in [(&rare as &dyn Shoot, 0.002), (&shared, 0.002)] {
            let means: Vec<f64> = (0..40)
                .map(|seed| {
                    let (film, reached) = make(shoot, 0.05, full, 2, seed);
                    assert!(reached.samples >= 64);
                    let pixels = film.pixels();
                    pixels.iter().map(|p| p.linear().x).sum::<f64>() / pixels.len() as f64
                })
                .collect();
            let n = means.len() as f64;
            let mean = means.iter().sum::<f64>() / n;
            let variance = means.iter().map(|m| (m - mean) * (m - mean)).sum::<f64>() / (n - 1.0);
            let error = (variance / n).sqrt();
            println!("mean {mean:.5} +- {error:.5}");
            assert!((mean - 0.1995).abs() < 3.5 * error && error < most, "{mean} +- {error}");
        }
    }
}
