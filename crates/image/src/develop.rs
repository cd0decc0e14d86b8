// SPDX-License-Identifier: MIT OR Apache-2.0
//! Developing: from linear light to the values that a display shows, in three steps.
//!
//! light x exposure -> tone curve -> encoding -> 8 or 16 bits. Every step works in `f64` with the
//! deterministic functions of `dioptric-math`, so a pixel has the same bits on every processor.

use crate::buffer::Image;
use crate::bytes::ByteScale;
use crate::tone::Tone;
use crate::transfer::{Encoding, quantize_8, quantize_16};

/// How linear light becomes a shown picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Develop {
    /// The factor that multiplies the light first.
    pub exposure: f64,
    /// The curve into 0..1.
    pub tone: Tone,
    /// The encoding of the result.
    pub encoding: Encoding,
}

impl Default for Develop {
    fn default() -> Self {
        Self { exposure: 1.0, tone: Tone::None, encoding: Encoding::Srgb }
    }
}

impl Develop {
    /// Every step by name with the values after it: `exposure`, `tone`, `encoding`.
    ///
    /// [`Develop::to_u8`] and [`Develop::to_u16`] quantise the last of them and nothing else. All values are
    /// finite: NaN light counts as 0 and infinite light as the largest `f32`.
    #[must_use]
    pub fn steps(&self, linear: [f32; 3]) -> Vec<(&'static str, [f64; 3])> {
        let [exposed, toned, encoded] = self.stages(linear);
        vec![("exposure", exposed), ("tone", toned), ("encoding", encoded)]
    }

    /// The developed values, 0 to 1, before they are quantised.
    #[must_use]
    pub fn apply(&self, linear: [f32; 3]) -> [f64; 3] {
        let [_, _, encoded] = self.stages(linear);
        encoded
    }

    /// The developed 8-bit colour: `floor(255 v + 0.5)`.
    #[must_use]
    pub fn to_u8(&self, linear: [f32; 3]) -> [u8; 3] {
        self.apply(linear).map(quantize_8)
    }

    /// The developed 16-bit colour: `floor(65535 v + 0.5)`.
    #[must_use]
    pub fn to_u16(&self, linear: [f32; 3]) -> [u16; 3] {
        self.apply(linear).map(quantize_16)
    }

    /// The whole picture as a display shows it, to be drawn upon: stored values (tagged sRGB, as a PNG file's are when it
    /// is read) with straight alpha. A picture that is not linear comes back unchanged.
    #[must_use]
    pub fn picture(&self, image: &Image) -> Image {
        let mut shown = image.clone();
        if image.encoding == Encoding::Raw {
            for (pixel, ([r, g, b], alpha)) in
                shown.pixels_mut().iter_mut().zip(developed(image, *self))
            {
                *pixel = [r, g, b, alpha].map(|v| v as f32);
            }
            shown.encoding = Encoding::Srgb;
        }
        shown
    }

    fn stages(&self, linear: [f32; 3]) -> [[f64; 3]; 3] {
        let [exposed, toned] = self.exposed_and_toned(linear);
        [exposed, toned, toned.map(|c| self.encoding.encode(c))]
    }

    fn exposed_and_toned(&self, linear: [f32; 3]) -> [[f64; 3]; 2] {
        let exposed = linear.map(|c| {
            // Through f32's range, so that squares in the curves stay finite in f64.
            let light = f64::from(c) * self.exposure;
            if light.is_nan() { 0.0 } else { light.clamp(f64::from(f32::MIN), f64::from(f32::MAX)) }
        });
        [exposed, self.tone.apply(exposed)]
    }
}

/// The picture as a display shows it: straight alpha, every value 0 to 1 before quantising.
///
/// Light is divided by its alpha before it is developed; a pixel of alpha 0 is black.
pub(crate) fn developed(image: &Image, develop: Develop) -> impl Iterator<Item = ([f64; 3], f64)> {
    let linear = image.encoding == Encoding::Raw;
    straight(image).map(move |(light, alpha)| {
        let stored = light.unwrap_or([0.0; 3]).map(f64::from);
        (if linear { light.map_or(stored, |light| develop.apply(light)) } else { stored }, alpha)
    })
}

/// What [`developed`] gives, quantised to bytes: the same bytes in less time.
pub(crate) fn developed_bytes(
    image: &Image,
    develop: Develop,
) -> impl Iterator<Item = ([u8; 3], u8)> {
    let linear = image.encoding == Encoding::Raw;
    let scale = ByteScale::new(develop.encoding);
    straight(image).map(move |(light, alpha)| {
        let color = match light {
            Some(stored) if !linear => stored.map(|c| quantize_8(f64::from(c))),
            Some(light) => develop.exposed_and_toned(light)[1].map(|c| scale.byte(c)),
            None => [0; 3],
        };
        (color, quantize_8(alpha))
    })
}

/// The stored values or the light of each pixel, with straight alpha; none where linear light has no alpha to divide by.
fn straight(image: &Image) -> impl Iterator<Item = (Option<[f32; 3]>, f64)> {
    let (linear, has_alpha) = (image.encoding == Encoding::Raw, image.has_alpha);
    image.pixels().iter().map(move |&[r, g, b, a]| {
        let color = match (linear && has_alpha, a > 0.0) {
            (false, _) => Some([r, g, b]),
            (true, true) => Some([r / a, g / a, b / a]),
            (true, false) => None,
        };
        (color, if has_alpha { f64::from(a) } else { 1.0 })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn raw_development_is_rounding_alone() {
        let raw = Develop { exposure: 1.0, tone: Tone::None, encoding: Encoding::Raw };
        assert_eq!(raw.to_u8([0.5, 1.5, -1.0]), [128, 255, 0]);
        assert_eq!(raw.to_u16([1.0, 0.25, f32::NAN]), [65535, 16384, 0]);
        assert_eq!(Develop { exposure: 0.8, ..raw }.to_u8([1.0, 0.5, 0.25]), [204, 102, 51]);
    }

    #[test]
    fn extreme_light_gives_finite_steps_and_the_expected_ends() {
        for tone in Tone::ALL {
            for encoding in [Encoding::Srgb, Encoding::Raw, Encoding::Gamma] {
                for exposure in [1.0, 0.0, 1e300, f64::INFINITY, f64::NAN] {
                    let develop = Develop { exposure, tone, encoding };
                    for light in [f32::INFINITY, f32::MAX, f32::NAN, -1.0, f32::NEG_INFINITY, 0.0] {
                        let steps = develop.steps([light; 3]);
                        assert!(steps.iter().all(|(_, v)| v.iter().all(|c| c.is_finite())));
                    }
                }
                let develop = Develop { exposure: 1.0, tone, encoding };
                assert_eq!(develop.to_u8([f32::INFINITY; 3]), [255; 3], "{tone:?} {encoding:?}");
                assert_eq!(develop.to_u8([f32::NAN, -5.0, f32::NEG_INFINITY]), [0; 3]);
            }
        }
    }

    #[test]
    fn steps_end_in_the_written_value() {
        let develop = Develop { exposure: 1.7, tone: Tone::Filmic, encoding: Encoding::Srgb };
        for i in 0..100 {
            let light = [i as f32 * 0.03, 0.2, 1.0 - i as f32 * 0.01];
            let steps = develop.steps(light);
            assert_eq!(
                steps.iter().map(|s| s.0).collect::<Vec<_>>(),
                ["exposure", "tone", "encoding"]
            );
            assert_eq!(steps[2].1.map(|v| (255.0 * v + 0.5).floor() as u8), develop.to_u8(light));
            assert_eq!(steps[0].1[1], 1.7 * f64::from(0.2_f32));
        }
    }

    #[test]
    fn a_developed_picture_has_the_values_of_its_pixels() {
        let develop = Develop { exposure: 2.0, tone: Tone::Reinhard, encoding: Encoding::Raw };
        let light = Image::from_fn(5, 4, Encoding::Raw, |x, y| [x as f32, y as f32, 0.3]).unwrap();
        let shown = develop.picture(&light);
        assert_eq!(shown.encoding, Encoding::Srgb);
        for (shown, &[r, g, b, _]) in shown.pixels().iter().zip(light.pixels()) {
            assert_eq!(shown[..3], develop.apply([r, g, b]).map(|v| v as f32));
        }
        assert_eq!(develop.picture(&shown), shown);
        let clear = Image::new(1, 1, [0.1, 0.2, 0.0, 0.5], Encoding::Raw).unwrap().with_alpha();
        let half =
            Develop { exposure: 1.0, tone: Tone::None, encoding: Encoding::Raw }.picture(&clear);
        assert_eq!(half.get(0, 0), Some([0.2, 0.4, 0.0, 0.5]));
    }

    #[test]
    fn names_round_trip_and_unknown_ones_are_explained() {
        for name in Tone::NAMES {
            assert_eq!(Tone::parse(name).unwrap().name(), name);
        }
        assert_eq!(
            Tone::parse("film").unwrap_err().to_string(),
            "unknown tone curve \"film\" (did you mean \"filmic\"? valid: none, reinhard, filmic, aces, agx, neutral)"
        );
    }
}
