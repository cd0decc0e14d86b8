// SPDX-License-Identifier: MIT OR Apache-2.0
//! Comparing two pictures: how far apart they are in numbers, and where.

pub mod flip;
mod side_by_side;

pub use flip::{Flip, flip};
pub use side_by_side::side_by_side;

use crate::buffer::Image;
use crate::error::ImageError;
use crate::transfer::Encoding;
use dioptric_math::log10;

/// How far apart two pictures are, over red, green and blue, and alpha where either picture has it.
///
/// The values are compared as the pictures hold them: stored ones from PNG files, light from EXR files. Where only one
/// of two values is a number, or they differ by infinity, they are infinitely far apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Comparison {
    /// Root of the mean squared difference of the channels.
    pub rmse: f64,
    /// Peak signal-to-noise ratio in decibels for a peak of 1: `-20 log10(rmse)`; infinite for equal pictures.
    pub psnr: f64,
    /// The largest difference of a channel.
    pub max_difference: f64,
    /// The pixel with the largest difference, from the top left; the first of several.
    pub worst: (u32, u32),
    /// Pixels in which a channel differs by more than the tolerance, as a share of all, 0 to 1.
    pub share_above: f64,
}

/// Compares two pictures; `tolerance` is the difference of a channel that counts as none. It is taken with 1e-6 to
/// spare, so that 8-bit values that differ by one are within a tolerance of 1/255.
///
/// # Errors
/// Pictures of different size, or one of stored values and one of light.
pub fn compare(a: &Image, b: &Image, tolerance: f64) -> Result<Comparison, ImageError> {
    check_comparable(a, b)?;
    let channels = if a.has_alpha || b.has_alpha { 4 } else { 3 };
    let mut sum = 0.0;
    let mut above = 0_u64;
    let mut max_difference = 0.0;
    let mut worst = 0;
    for (i, (pa, pb)) in a.pixels().iter().zip(b.pixels()).enumerate() {
        let mut largest = 0.0_f64;
        for (va, vb) in pa.iter().zip(pb).take(channels) {
            let d = difference(*va, *vb);
            sum += d * d;
            largest = largest.max(d);
        }
        above += u64::from(largest > tolerance + 1e-6);
        if largest > max_difference {
            (max_difference, worst) = (largest, i);
        }
    }
    let count = a.pixels().len();
    let rmse = (sum / (count as f64 * channels as f64)).sqrt();
    let width = a.width() as usize;
    Ok(Comparison {
        rmse,
        psnr: if rmse == 0.0 { f64::INFINITY } else { -20.0 * log10(rmse) },
        max_difference,
        worst: ((worst % width) as u32, (worst / width) as u32),
        share_above: above as f64 / count as f64,
    })
}

/// Distance of two values; equal ones (two infinities, two NaNs) have none.
fn difference(a: f32, b: f32) -> f64 {
    let d = (f64::from(a) - f64::from(b)).abs();
    if a == b || (a.is_nan() && b.is_nan()) {
        0.0
    } else if d.is_nan() {
        f64::INFINITY
    } else {
        d
    }
}

/// Refuses pictures whose values cannot be set against each other.
fn check_comparable(a: &Image, b: &Image) -> Result<(), ImageError> {
    if (a.width(), a.height()) != (b.width(), b.height()) {
        return Err(ImageError::invalid(
            format!(
                "the pictures differ in size: {} x {} and {} x {}",
                a.width(),
                a.height(),
                b.width(),
                b.height()
            ),
            "render both in the same size",
        ));
    }
    if (a.encoding == Encoding::Raw) != (b.encoding == Encoding::Raw) {
        return Err(ImageError::invalid(
            "one picture holds linear light and the other values for a display",
            "compare two PNG files or two EXR files of the scenes",
        ));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::ErrorKind;

    fn grey(values: &[f32]) -> Image {
        let pixels = values.iter().map(|&v| [v, v, v, 1.0]).collect();
        Image::from_pixels(values.len() as u32, 1, pixels, Encoding::Srgb).unwrap()
    }

    #[test]
    fn equal_pictures_are_zero_apart() {
        let a = grey(&[0.0, 1.0, f32::INFINITY, f32::NAN]);
        let c = compare(&a, &a, 0.0).unwrap();
        assert_eq!(
            (c.rmse, c.psnr, c.max_difference, c.share_above),
            (0.0, f64::INFINITY, 0.0, 0.0)
        );
    }

    #[test]
    fn numbers_agree_with_hand_reckoning() {
        let c = compare(&grey(&[0.0, 0.5, 1.0, 0.25]), &grey(&[0.0, 0.5, 0.5, 0.5]), 0.3).unwrap();
        assert!((c.rmse - (0.3125_f64 / 4.0).sqrt()).abs() < 1e-12);
        assert!((c.psnr - 11.072).abs() < 1e-3);
        assert_eq!((c.max_difference, c.worst, c.share_above), (0.5, (2, 0), 0.25));
    }

    #[test]
    fn one_step_of_eight_bits_is_within_its_tolerance() {
        let all: Vec<f32> = (0..=255_u8).map(|i| f32::from(i) / 255.0).collect();
        let c = compare(&grey(&all[1..]), &grey(&all[..255]), 1.0 / 255.0).unwrap();
        assert_eq!(c.share_above, 0.0);
        assert_eq!(
            compare(&grey(&all[1..]), &grey(&all[..255]), 0.9 / 255.0).unwrap().share_above,
            1.0
        );
    }

    #[test]
    fn a_missing_number_is_infinitely_wrong_and_alpha_counts() {
        let c = compare(&grey(&[f32::NAN, 0.0]), &grey(&[0.0, 0.0]), 1.0).unwrap();
        assert_eq!((c.max_difference, c.share_above), (f64::INFINITY, 0.5));
        let clear = Image::new(1, 1, [1.0, 1.0, 1.0, 0.0], Encoding::Srgb).unwrap().with_alpha();
        assert_eq!(compare(&grey(&[1.0]), &clear, 0.0).unwrap().max_difference, 1.0);
    }

    #[test]
    fn unlike_pictures_are_refused_with_their_sizes() {
        let error = compare(&grey(&[0.0]), &grey(&[0.0, 0.0]), 0.0).unwrap_err();
        assert_eq!(error.kind, ErrorKind::Invalid);
        assert_eq!(error.message, "the pictures differ in size: 1 x 1 and 2 x 1");
        let light = Image::new(1, 1, [0.0; 4], Encoding::Raw).unwrap();
        assert!(compare(&grey(&[0.0]), &light, 0.0).is_err());
    }
}
