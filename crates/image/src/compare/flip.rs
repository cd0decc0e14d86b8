// SPDX-License-Identifier: MIT OR Apache-2.0
//! LDR-FLIP: the difference that a person would see who flips between two pictures.
//!
//! Andersson, Nilsson, Akenine-Moeller, Oskarsson, Astroem and Fairchild, "FLIP: A Difference Evaluator for Alternating
//! Images", Proceedings of the ACM on Computer Graphics and Interactive Techniques 3(2), 2020. The sections of
//! that paper are named below. All filters are separable, sums run in a fixed order in `f64`.

use super::check_comparable;
use crate::buffer::Image;
use crate::error::ImageError;
use crate::transfer::Encoding;
use dioptric_math::{DMat3, DVec3, cbrt, exp, pow};
use std::f64::consts::PI;

/// Pixels per degree of view of the paper's desk: a 0.7 m wide display of 3840 pixels seen from 0.7 m.
pub const PIXELS_PER_DEGREE: f64 = 67.0;

/// The perceived difference of two pictures.
#[derive(Clone, Debug, PartialEq)]
pub struct Flip {
    /// The mean over all pixels, 0 (alike) to 1.
    pub mean: f64,
    /// The difference of each pixel, 0 to 1, row by row from the top left.
    pub map: Vec<f32>,
}

/// Compares two pictures seen at `pixels_per_degree` (1 to 1000, [`PIXELS_PER_DEGREE`] at a desk). Alpha is ignored;
/// linear pictures are clamped to 0..1.
///
/// # Errors
/// Pictures of different size or kind, or an angle out of range.
pub fn flip(a: &Image, b: &Image, pixels_per_degree: f64) -> Result<Flip, ImageError> {
    check_comparable(a, b)?;
    if !(1.0..=1000.0).contains(&pixels_per_degree) {
        return Err(ImageError::invalid(
            format!("{pixels_per_degree} pixels per degree is out of range"),
            "give 1 to 1000; 67 is a display on a desk",
        ));
    }
    let [a, b] = [a, b].map(|image| Seen::new(image, pixels_per_degree));
    let largest = pow(hyab(hunt(DVec3::Y), hunt(DVec3::Z)), QC);
    let mut map = Vec::with_capacity(a.colors.len());
    let mut sum = 0.0;
    for i in 0..a.colors.len() {
        let (Some(ca), Some(cb)) = (a.colors.get(i), b.colors.get(i)) else { break };
        let color = redistribute(pow(hyab(*ca, *cb), QC), largest);
        let feature = |f: fn(&Seen) -> &Vec<f64>| match (f(&a).get(i), f(&b).get(i)) {
            (Some(fa), Some(fb)) => (fa - fb).abs(),
            _ => 0.0,
        };
        // Section 4.2, the feature pipeline: the larger change of edges and points.
        let features = feature(|s| &s.edges).max(feature(|s| &s.points));
        let features = pow(features / std::f64::consts::SQRT_2, QF).min(1.0);
        // Section 4.3: what has features is forgiven less.
        let error = pow(color, 1.0 - features);
        sum += error;
        map.push(error as f32);
    }
    Ok(Flip { mean: sum / map.len().max(1) as f64, map })
}

/// Exponents of the colour and of the feature difference (section 4).
const QC: f64 = 0.7;
const QF: f64 = 0.5;

/// What an observer sees of a picture: filtered colours, and the strength of edges and points.
struct Seen {
    /// Hunt-adjusted CIELAB after the eye's filter.
    colors: Vec<DVec3>,
    edges: Vec<f64>,
    points: Vec<f64>,
}

impl Seen {
    fn new(image: &Image, ppd: f64) -> Self {
        let opponent: Vec<DVec3> =
            image.pixels().iter().map(|p| opponent(linear(image.encoding, *p))).collect();
        let size = (image.width() as usize, image.height() as usize);
        let plane = |channel: fn(&DVec3) -> f64| opponent.iter().map(channel).collect::<Vec<f64>>();
        let [y, cx, cz] = [plane(|p| p.x), plane(|p| p.y), plane(|p| p.z)];

        // Section 4.1: contrast sensitivity functions as Gaussians; amplitude and width in degrees.
        let [fy, fx, fz] = [
            eye_filter(&y, size, ppd, &[(1.0, 0.0047)]),
            eye_filter(&cx, size, ppd, &[(1.0, 0.0053)]),
            eye_filter(&cz, size, ppd, &[(34.1, 0.04), (13.5, 0.025)]),
        ];
        let rgb_of_xyz = XYZ_OF_RGB.inverse();
        let colors = fy
            .iter()
            .zip(&fx)
            .zip(&fz)
            .map(|((y, x), z)| hunt(rgb_of_opponent(DVec3::new(*y, *x, *z), &rgb_of_xyz)))
            .collect();

        let luminance: Vec<f64> = y.iter().map(|y| (y + 16.0) / 116.0).collect();
        let (edges, points) = features(&luminance, size, ppd);
        Self { colors, edges, points }
    }
}

/// Linear light of a pixel, clamped to 0..1.
fn linear(encoding: Encoding, [r, g, b, _]: [f32; 4]) -> DVec3 {
    let [r, g, b] = [r, g, b].map(|c| {
        let c = encoding.decode(f64::from(c));
        if c.is_nan() { 0.0 } else { c.clamp(0.0, 1.0) }
    });
    DVec3::new(r, g, b)
}

/// Linear Rec. 709 to CIE XYZ, from the primaries and the white (0.3127, 0.3290) of ITU-R BT.709-6, table 3.
const XYZ_OF_RGB: DMat3 = DMat3::from_cols(
    DVec3::new(0.412_390_799_265_959_5, 0.212_639_005_871_510_4, 0.019_330_818_715_591_85),
    DVec3::new(0.357_584_339_383_878, 0.715_168_678_767_755_9, 0.119_194_779_794_626),
    DVec3::new(0.180_480_788_401_834_3, 0.072_192_315_360_733_71, 0.950_532_152_249_660_6),
);

/// XYZ relative to that of white, so that every white is (1, 1, 1).
fn relative_xyz(rgb: DVec3) -> DVec3 {
    (XYZ_OF_RGB * rgb) / (XYZ_OF_RGB * DVec3::ONE)
}

/// The linear opponent space YCxCz (section 4.1, after Flohr et al. 1993).
fn opponent(rgb: DVec3) -> DVec3 {
    let v = relative_xyz(rgb);
    DVec3::new(116.0 * v.y - 16.0, 500.0 * (v.x - v.y), 200.0 * (v.y - v.z))
}

/// The inverse of [`opponent`], clamped to 0..1.
fn rgb_of_opponent(o: DVec3, rgb_of_xyz: &DMat3) -> DVec3 {
    let y = (o.x + 16.0) / 116.0;
    let relative = DVec3::new(y + o.y / 500.0, y, y - o.z / 200.0);
    let rgb = *rgb_of_xyz * (relative * (XYZ_OF_RGB * DVec3::ONE));
    rgb.clamp(DVec3::ZERO, DVec3::ONE)
}

/// CIELAB (CIE 15:2004, section 8.2.1) with the Hunt effect: chroma counts more where it is bright (section 4.1).
fn hunt(rgb: DVec3) -> DVec3 {
    const DELTA: f64 = 6.0 / 29.0;
    let f = |t: f64| {
        if t > DELTA * DELTA * DELTA { cbrt(t) } else { t / (3.0 * DELTA * DELTA) + 4.0 / 29.0 }
    };
    let v = relative_xyz(rgb);
    let (x, y, z) = (f(v.x), f(v.y), f(v.z));
    let lightness = 116.0 * y - 16.0;
    DVec3::new(lightness, 5.0 * (x - y) * lightness, 2.0 * (y - z) * lightness)
}

/// HyAB distance: city block in lightness, Euclidean in chroma (section 4.1, after Abasi et al. 2020).
fn hyab(a: DVec3, b: DVec3) -> f64 {
    let d = a - b;
    d.x.abs() + (d.y * d.y + d.z * d.z).sqrt()
}

/// Maps colour differences to 0..1 so that the lower 40 % of them take 95 % of the range (section 4.1).
fn redistribute(difference: f64, largest: f64) -> f64 {
    const PC: f64 = 0.4;
    const PT: f64 = 0.95;
    let knee = PC * largest;
    if difference < knee {
        PT / knee * difference
    } else {
        (PT + (difference - knee) / (largest - knee) * (1.0 - PT)).min(1.0)
    }
}

/// Filters with a sum of Gaussians, each `a sqrt(pi / b) exp(-pi^2 r^2 / b)` for r in degrees, normalised together.
fn eye_filter(plane: &[f64], size: (usize, usize), ppd: f64, gaussians: &[(f64, f64)]) -> Vec<f64> {
    // Three standard deviations of the widest Gaussian of all channels.
    let radius = (3.0 * (0.04 / (2.0 * PI * PI)).sqrt() * ppd).ceil() as usize;
    let mut sum = vec![0.0; plane.len()];
    let mut total = 0.0;
    for &(a, b) in gaussians {
        let kernel: Vec<f64> =
            offsets(radius).map(|x| exp(-PI * PI * (x / ppd) * (x / ppd) / b)).collect();
        let amplitude = a * (PI / b).sqrt();
        let mass: f64 = kernel.iter().sum();
        total += amplitude * mass * mass;
        let blurred = convolve(plane, size, &kernel, &kernel);
        for (cell, value) in sum.iter_mut().zip(blurred) {
            *cell += amplitude * value;
        }
    }
    for cell in &mut sum {
        *cell /= total;
    }
    sum
}

/// Strength of edges and points of the luminance: first and second derivatives of a Gaussian as wide as the eye's
/// receptive fields, 0.082 degrees (section 4.2).
fn features(luminance: &[f64], size: (usize, usize), ppd: f64) -> (Vec<f64>, Vec<f64>) {
    let sd = 0.5 * 0.082 * ppd;
    let radius = (3.0 * sd).ceil() as usize;
    let gauss = |x: f64| exp(-x * x / (2.0 * sd * sd));
    let blur = balance(offsets(radius).map(gauss).collect());
    let edge = balance(offsets(radius).map(|x| -x * gauss(x)).collect());
    let point = balance(offsets(radius).map(|x| (x * x / (sd * sd) - 1.0) * gauss(x)).collect());
    let strength = |kernel: &[f64]| -> Vec<f64> {
        let across = convolve(luminance, size, kernel, &blur);
        let down = convolve(luminance, size, &blur, kernel);
        across.iter().zip(down).map(|(x, y)| (x * x + y * y).sqrt()).collect()
    };
    (strength(&edge), strength(&point))
}

/// Scales the positive weights to sum 1 and the negative ones to sum -1.
fn balance(mut kernel: Vec<f64>) -> Vec<f64> {
    let positive: f64 = kernel.iter().filter(|w| **w > 0.0).sum();
    let negative: f64 = -kernel.iter().filter(|w| **w < 0.0).sum::<f64>();
    for weight in &mut kernel {
        *weight /= if *weight > 0.0 { positive } else { negative.max(f64::MIN_POSITIVE) };
    }
    kernel
}

/// -radius, ..., radius.
fn offsets(radius: usize) -> impl Iterator<Item = f64> {
    (0..=2 * radius).map(move |i| i as f64 - radius as f64)
}

/// Convolves rows with `across` and columns with `down`; the border's pixels go on outside.
fn convolve(
    plane: &[f64],
    (width, height): (usize, usize),
    across: &[f64],
    down: &[f64],
) -> Vec<f64> {
    let radius = across.len() / 2;
    let clamped = |i: usize, k: usize, n: usize| (i + k).saturating_sub(radius).min(n - 1);
    let mut rows = Vec::with_capacity(plane.len());
    for row in plane.chunks_exact(width) {
        rows.extend((0..width).map(|x| {
            across
                .iter()
                .enumerate()
                .map(|(k, w)| w * row.get(clamped(x, k, width)).unwrap_or(&0.0))
                .sum::<f64>()
        }));
    }
    let mut out = vec![0.0; plane.len()];
    for (y, target) in out.chunks_exact_mut(width).enumerate() {
        for (k, weight) in down.iter().enumerate() {
            let source = rows.chunks_exact(width).nth(clamped(y, k, height));
            for (cell, value) in target.iter_mut().zip(source.into_iter().flatten()) {
                *cell += weight * value;
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(f: impl FnMut(u32, u32) -> [f32; 3]) -> Image {
        Image::from_fn(48, 32, Encoding::Srgb, f).unwrap()
    }

    /// Smooth colours, and the same with a square, a line and coarse noise in it, in whole 8-bit steps.
    fn pair() -> [Image; 2] {
        let smooth = |x: u32, y: u32| [(x * 5) % 256, (y * 7) % 256, (x * 3 + y * 2) % 256];
        let a = picture(|x, y| smooth(x, y).map(|v| v as f32 / 255.0));
        let b = picture(|x, y| {
            let noise = (x * 37 + y * 101) % 17;
            let [r, g, b] = smooth(x, y);
            let v = match (x, y) {
                (10..=17, 8..=15) => [255, 255, 255],
                (30, _) => [0, 0, 0],
                _ => [(r + noise).min(255), g, b.saturating_sub(noise)],
            };
            v.map(|v| v as f32 / 255.0)
        });
        [a, b]
    }

    #[test]
    fn equal_pictures_have_no_difference_and_order_does_not_matter() {
        let [a, b] = pair();
        let same = flip(&a, &a, PIXELS_PER_DEGREE).unwrap();
        assert_eq!(same.mean, 0.0);
        assert!(same.map.iter().all(|e| *e == 0.0));
        assert_eq!(flip(&a, &b, 67.0).unwrap(), flip(&b, &a, 67.0).unwrap());
    }

    #[test]
    fn black_and_white_are_nearly_as_far_apart_as_can_be() {
        let mean = flip(&picture(|_, _| [0.0; 3]), &picture(|_, _| [1.0; 3]), 67.0).unwrap().mean;
        assert!(mean > 0.95 && mean < 1.0, "{mean}");
        // Green against blue is the largest difference of all, by definition 1.
        let mean = flip(&picture(|_, _| [0.0, 1.0, 0.0]), &picture(|_, _| [0.0, 0.0, 1.0]), 67.0)
            .unwrap()
            .mean;
        assert!((mean - 1.0).abs() < 1e-9, "{mean}");
    }

    #[test]
    fn the_largest_difference_lies_where_the_pictures_differ() {
        let [a, mut b] = [picture(|_, _| [0.5; 3]), picture(|_, _| [0.5; 3])];
        b.set(20, 10, [1.0; 4]);
        let result = flip(&a, &b, 67.0).unwrap();
        let worst = result.map.iter().enumerate().max_by(|x, y| x.1.total_cmp(y.1)).unwrap().0;
        assert_eq!((worst % 48, worst / 48), (20, 10));
        assert!(result.map[0] < 1e-4);
    }

    #[test]
    fn linear_pictures_are_seen_like_their_encoded_twins() {
        let [a, b] = pair();
        let expected = flip(&a, &b, 67.0).unwrap().mean;
        let mean = flip(&a.into_linear(), &b.into_linear(), 67.0).unwrap().mean;
        assert!((mean - expected).abs() < 1e-5);
    }

    /// The reference numbers are those of the authors' own program, PyPI flip-evaluator 1.7, on the same pictures: the mean,
    /// and the map at five pixels.
    #[test]
    fn values_are_those_of_the_authors_program() {
        let [a, b] = pair();
        let reference: [(f64, f64, [f32; 5]); 3] = [
            (67.0, 0.247_215, [0.029_906, 0.988_060, 0.378_163, 0.192_351, 0.158_490]),
            (30.0, 0.222_361, [0.015_471, 0.975_966, 0.768_624, 0.178_785, 0.124_510]),
            (100.0, 0.264_906, [0.039_504, 0.986_342, 0.269_027, 0.192_947, 0.181_888]),
        ];
        for (ppd, mean, values) in reference {
            let result = flip(&a, &b, ppd).unwrap();
            assert!((result.mean - mean).abs() < 2e-4, "{} {mean}", result.mean);
            for ((x, y), value) in
                [(0, 0), (12, 10), (30, 5), (47, 31), (24, 20)].into_iter().zip(values)
            {
                let ours = result.map[y * 48 + x];
                assert!((ours - value).abs() < 5e-4, "({x},{y}) at {ppd}: {ours} {value}");
            }
        }
        let white = flip(&picture(|_, _| [0.0; 3]), &picture(|_, _| [1.0; 3]), 67.0).unwrap().mean;
        assert!((white - 0.967_399).abs() < 2e-4, "{white}");
    }

    #[test]
    fn bad_angles_are_refused() {
        let [a, b] = pair();
        for ppd in [0.0, -1.0, f64::NAN, 1e9] {
            assert!(flip(&a, &b, ppd).is_err(), "{ppd}");
        }
    }
}
