// SPDX-License-Identifier: MIT OR Apache-2.0
//! A filter of our own: weighted means over ever wider neighbourhoods, of pixels that see alike surfaces.
//!
//! Edge-avoiding à-trous wavelets (Dammertz, Sewtz, Hanika, Lensch: "Edge-Avoiding À-Trous Wavelet Transform for fast
//! Global Illumination Filtering", HPG 2010) with the weights of SVGF (Schied et al.: "Spatiotemporal Variance-Guided
//! Filtering", HPG 2017, section 4.4, equations 3 to 5), of one picture: the light is divided by the surfaces'
//! own colour, so that textures stay sharp; the variance of the light is estimated from each pixel's surroundings, and
//! passed through the filter. Before that, single pixels far above all around are cut off there. A pixel's result depends on the picture alone: the same bits for any number of threads.

use dioptric_math::exp;
use rayon::prelude::*;

use crate::Picture;

/// Passes; the last one reaches 2 * 2^4 pixels.
const PASSES: usize = 5;

/// The kernel of each pass by distance: a B3 spline.
const KERNEL: [f64; 3] = [3.0 / 8.0, 1.0 / 4.0, 1.0 / 16.0];

/// How many standard deviations of light pixels may differ by.
const LIGHT: f64 = 4.0;

/// So many standard deviations above its surroundings a pixel is a speck.
const SPECK: f64 = 3.0;

/// Below this a surface is black.
const BLACK: f32 = 0.02;

/// How much steeper than nearby a surface may run away.
const DEPTH: f64 = 1.0;

/// Half the side of the surroundings from which variance is estimated.
const REACH: isize = 3;

/// A pixel, prepared.
#[derive(Clone, Copy, Default)]
struct Pixel {
    light: [f64; 3],
    variance: f64,
}

/// What does not change from pass to pass.
#[derive(Clone, Copy, Default)]
struct Guide {
    normal: [f64; 3],
    depth: f64,
    /// The change of depth towards the next pixel.
    slope: f64,
    albedo: [f64; 3],
    /// The channels in which the surface is black; there the light is not divided.
    dark: [bool; 3],
}

/// The picture without its noise.
///
/// The picture must be whole ([`Picture::is_whole`]); one that is not comes back as it is. Works in the thread pool in
/// which it is called.
#[must_use]
pub fn denoise(picture: &Picture<'_>) -> Vec<[f32; 3]> {
    if !picture.is_whole() {
        return picture.color.to_vec();
    }
    let guides = guides(picture);
    let grid = Grid { width: picture.width as isize, height: picture.height as isize, guides };
    let light: Vec<[f64; 3]> = picture
        .color
        .iter()
        .zip(&grid.guides)
        .map(|(color, guide)| divided(color, guide))
        .collect();
    let light: Vec<[f64; 3]> = grid.map(|at| grid.without_speck(at, &light));
    let mut pixels: Vec<Pixel> = grid.map(|at| {
        let light_here = light[grid.index(at)];
        let [mean, variance, weights] = grid.surroundings(at, &light);
        // With the pixel itself: a part of the difference from the others.
        let share = 1.0 / (1.0 + weights);
        let step = luminance(light_here) - mean;
        Pixel { light: light_here, variance: (1.0 - share) * (variance + share * step * step) }
    });
    for pass in 0..PASSES {
        pixels = grid.map(|at| grid.filtered(at, &pixels, 1 << pass));
    }
    let multiplied = |(pixel, guide): (&Pixel, &Guide)| {
        std::array::from_fn(|c| (pixel.light[c] * guide.albedo[c]) as f32)
    };
    pixels.iter().zip(&grid.guides).map(multiplied).collect()
}

fn guides(picture: &Picture<'_>) -> Vec<Guide> {
    let (width, count) = (picture.width, picture.color.len());
    let step = |i: usize, j: usize| {
        let [a, b] = [i, j].map(|i| f64::from(picture.depth[i]));
        if a.is_finite() && b.is_finite() { (a - b).abs() } else { 0.0 }
    };
    let guide = |i: usize| {
        let right = if i % width + 1 < width { i + 1 } else { i };
        let below = if i + width < count { i + width } else { i };
        Guide {
            normal: unit(picture.normal[i]),
            depth: f64::from(picture.depth[i]),
            slope: step(i, right).max(step(i, below)),
            // Black surfaces, and the sky, which has no colour of its own.
            albedo: picture.albedo[i].map(|c| if c > BLACK { f64::from(c) } else { 1.0 }),
            dark: picture.albedo[i].map(|c| c <= BLACK),
        }
    };
    (0..count).map(guide).collect()
}

fn divided(color: &[f32; 3], guide: &Guide) -> [f64; 3] {
    // What is no number would spread.
    std::array::from_fn(|c| {
        let light = f64::from(color[c]) / guide.albedo[c];
        if light.is_finite() { light } else { 0.0 }
    })
}

fn unit(normal: [f32; 3]) -> [f64; 3] {
    let normal = normal.map(f64::from);
    let length = normal.iter().map(|c| c * c).sum::<f64>().sqrt();
    if length > 1e-3 { normal.map(|c| c / length) } else { [0.0; 3] }
}

fn luminance([r, g, b]: [f64; 3]) -> f64 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

/// The pixels' neighbourhoods.
struct Grid {
    width: isize,
    height: isize,
    guides: Vec<Guide>,
}

impl Grid {
    fn index(&self, [x, y]: [isize; 2]) -> usize {
        (y * self.width + x) as usize
    }

    fn map<T: Send>(&self, f: impl Fn([isize; 2]) -> T + Sync) -> Vec<T> {
        let row = |y: isize| (0..self.width).map(|x| f([x, y])).collect::<Vec<T>>();
        let rows: Vec<Vec<T>> = (0..self.height).into_par_iter().map(row).collect();
        rows.into_iter().flatten().collect()
    }

    fn inside(&self, [x, y]: [isize; 2]) -> bool {
        (0..self.width).contains(&x) && (0..self.height).contains(&y)
    }

    /// How much alike the surfaces of two pixels are that lie `distance` pixels apart.
    fn alike(&self, a: usize, b: usize, distance: f64) -> f64 {
        let (a, b) = (&self.guides[a], &self.guides[b]);
        // What reflects none of a colour says nothing of that light.
        if a.dark != b.dark {
            return 0.0;
        }
        let nothing = |g: &Guide| g.normal == [0.0; 3];
        if nothing(a) || nothing(b) {
            return f64::from(nothing(a) && nothing(b));
        }
        let dot: f64 = a.normal.iter().zip(&b.normal).map(|(a, b)| a * b).sum();
        // To the 64th power.
        let mut facing = dot.clamp(0.0, 1.0);
        for _ in 0..6 {
            facing *= facing;
        }
        let step = (a.depth - b.depth).abs();
        let usual = DEPTH * a.slope.max(1e-3 * a.depth) * distance;
        if !step.is_finite() || facing < 1e-6 {
            return 0.0;
        }
        facing * exp(-step / usual.max(1e-12))
    }

    /// Mean and variance of the light of pixels around that see alike surfaces, and how many these are.
    fn surroundings(&self, at: [isize; 2], light: &[[f64; 3]]) -> [f64; 3] {
        let own = self.index(at);
        let [mut sum, mut squares, mut weights] = [0.0; 3];
        for dy in -REACH..=REACH {
            for dx in -REACH..=REACH {
                let place = [at[0] + dx, at[1] + dy];
                if !self.inside(place) || (dx, dy) == (0, 0) {
                    continue;
                }
                let other = self.index(place);
                let distance = ((dx * dx + dy * dy) as f64).sqrt();
                let weight = self.alike(own, other, distance);
                let value = luminance(light[other]);
                sum += weight * value;
                squares += weight * value * value;
                weights += weight;
            }
        }
        if weights < 1e-9 {
            return [luminance(light[own]), 0.0, 0.0];
        }
        let mean = sum / weights;
        [mean, (squares / weights - mean * mean).max(0.0), weights]
    }

    /// A pixel's light, cut off where it is far above all around: a path that rarely happens. Without this such specks stay,
    /// since nothing is like them.
    fn without_speck(&self, at: [isize; 2], light: &[[f64; 3]]) -> [f64; 3] {
        let own = light[self.index(at)];
        let [mean, variance, weights] = self.surroundings(at, light);
        let (most, value) = (mean + SPECK * variance.sqrt(), luminance(own));
        if weights < 4.0 || value <= most { own } else { own.map(|c| c * (most / value)) }
    }

    /// The mean of variances right around a pixel: one pixel's own is itself noisy.
    fn smooth_variance(&self, at: [isize; 2], pixels: &[Pixel]) -> f64 {
        let (mut sum, mut weights) = (0.0, 0.0);
        for dy in -1isize..=1 {
            for dx in -1isize..=1 {
                let place = [at[0] + dx, at[1] + dy];
                if self.inside(place) {
                    let weight = [1.0, 0.5, 0.25][(dx.abs() + dy.abs()) as usize];
                    sum += weight * pixels[self.index(place)].variance;
                    weights += weight;
                }
            }
        }
        sum / weights
    }

    fn filtered(&self, at: [isize; 2], pixels: &[Pixel], step: isize) -> Pixel {
        let own = self.index(at);
        let center = luminance(pixels[own].light);
        let spread = LIGHT * self.smooth_variance(at, pixels).sqrt() + 1e-6;
        let (mut light, mut variance, mut weights) = ([0.0; 3], 0.0, 0.0);
        for dy in -2isize..=2 {
            for dx in -2isize..=2 {
                let place = [at[0] + dx * step, at[1] + dy * step];
                if !self.inside(place) {
                    continue;
                }
                let other = self.index(place);
                let pixel = &pixels[other];
                let mut weight = KERNEL[dx.unsigned_abs()] * KERNEL[dy.unsigned_abs()];
                if other != own {
                    let distance = ((dx * dx + dy * dy) as f64).sqrt() * step as f64;
                    weight *= self.alike(own, other, distance);
                    weight *= exp(-(luminance(pixel.light) - center).abs() / spread);
                }
                for (sum, value) in light.iter_mut().zip(pixel.light) {
                    *sum += weight * value;
                }
                variance += weight * weight * pixel.variance;
                weights += weight;
            }
        }
        Pixel { light: light.map(|c| c / weights), variance: variance / (weights * weights) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dioptric_math::random::join;

    #[derive(Default)]
    struct Made {
        color: Vec<[f32; 3]>,
        exact: Vec<[f32; 3]>,
        albedo: Vec<[f32; 3]>,
        normal: Vec<[f32; 3]>,
        depth: Vec<f32>,
    }

    impl Made {
        fn picture(&self) -> Picture<'_> {
            let Self { color, albedo, normal, depth, .. } = self;
            Picture { width: 50, height: 40, color, albedo, normal, depth }
        }
    }

    /// A wall with stripes and a floor, lit evenly, with noise.
    fn noisy() -> Made {
        let mut made = Made::default();
        for y in 0..40u64 {
            for x in 0..50u64 {
                let own: f32 = if x % 10 < 5 { 0.8 } else { 0.3 };
                let light = if y < 20 { 0.9 } else { 0.4 };
                let noise = (join(x, y) >> 40) as f32 / (1u32 << 24) as f32 - 0.5;
                made.albedo.push([own; 3]);
                made.exact.push([own * light; 3]);
                made.color.push([own * (light + 0.6 * noise); 3]);
                made.normal.push(if y < 20 { [0.0, 0.0, 1.0] } else { [0.0, 1.0, 0.0] });
                made.depth.push(5.0);
            }
        }
        made
    }

    fn rmse(a: &[[f32; 3]], b: &[[f32; 3]]) -> f64 {
        let squares = a.iter().zip(b).map(|(a, b)| f64::from(a[0] - b[0]) * f64::from(a[0] - b[0]));
        (squares.sum::<f64>() / a.len() as f64).sqrt()
    }

    #[test]
    fn noise_falls_and_edges_stay() {
        let made = noisy();
        let picture = made.picture();
        let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        let result = one.install(|| denoise(&picture));
        let (before, after) = (rmse(&made.color, &made.exact), rmse(&result, &made.exact));
        println!("{before:.4} to {after:.4}");
        assert!(after < 0.15 * before);
        for threads in [2, 7] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            assert!(pool.install(|| denoise(&picture)) == result);
        }
    }

    #[test]
    fn what_is_no_number_does_not_spread() {
        let mut made = noisy();
        made.color[1020] = [f32::NAN, f32::INFINITY, -1.0];
        // And a speck.
        made.color[640] = [300.0; 3];
        made.depth[1022] = f32::INFINITY;
        let result = denoise(&made.picture());
        assert!(result.iter().flatten().all(|c| c.is_finite()));
        assert!(rmse(&result, &made.exact) < 0.3);
    }
}
