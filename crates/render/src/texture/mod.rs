// SPDX-License-Identifier: MIT OR Apache-2.0
//! Pictures as patterns use them: stored as small as they were in their file, read one texel at a
//! time, decoded only when asked for as colour.

mod ahead;
mod lookup;

use std::sync::OnceLock;

use dioptric_image::transfer::linear_from_srgb;
use dioptric_image::{Encoding, ImageError, Stored, Values, decode_stored};

pub use ahead::load_ahead;
pub use lookup::{Filter, Lookup, Wrap};

/// The most texels that all pictures of a scene may have together, unless a program says otherwise.
pub const MAX_TEXELS: u64 = 1 << 28;

/// What infinite values of a picture become: the largest number of 16-bit floats, in which such
/// pictures are mostly stored.
const BRIGHTEST: f32 = 65_504.0;

/// A picture, at least one texel large.
#[derive(Clone, Debug)]
pub struct Texture {
    width: usize,
    height: usize,
    /// 1 (grey), 2 (grey and alpha), 3, or 4 with alpha.
    channels: usize,
    values: Values,
    /// Whether the file held linear light, which nothing decodes.
    linear: bool,
}

impl Texture {
    /// Reads the bytes of a picture's file with at most `max_texels`; `name` goes into messages.
    ///
    /// # Errors
    /// The bytes are no picture, the file is damaged, or the picture is too large.
    pub fn from_bytes(bytes: &[u8], name: &str, max_texels: u64) -> Result<Self, ImageError> {
        decode_stored(bytes, name, max_texels).map(Self::from_stored)
    }

    /// Keeps a picture as small as it was in its file, in one channel where it is grey.
    #[must_use]
    pub fn from_stored(picture: Stored) -> Self {
        let (width, height) = (picture.width() as usize, picture.height() as usize);
        let (channels, linear) = (picture.channels(), picture.encoding == Encoding::Raw);
        let (channels, values) = match picture.into_values() {
            Values::Bytes(v) => smallest(v, channels, Values::Bytes),
            Values::Shorts(v) => smallest(v, channels, Values::Shorts),
            Values::Floats(mut v) => {
                v.iter_mut().for_each(|v| *v = finite(*v));
                smallest(v, channels, Values::Floats)
            }
        };
        Self { width, height, channels, values, linear }
    }

    /// Texels in a row.
    #[must_use]
    pub const fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    #[must_use]
    pub const fn height(&self) -> usize {
        self.height
    }

    /// How many texels there are.
    #[must_use]
    pub const fn texels(&self) -> u64 {
        self.width as u64 * self.height as u64
    }

    /// Memory for the texels.
    #[must_use]
    pub fn bytes(&self) -> usize {
        match &self.values {
            Values::Bytes(v) => v.len(),
            Values::Shorts(v) => v.len() * 2,
            Values::Floats(v) => v.len() * 4,
        }
    }

    /// Red, green, blue and alpha of the texel in column `x` of row `y`, both from the top left and
    /// taken to the picture's edge beyond it. With `as_color` sRGB values are decoded to linear light
    /// and no channel is negative; without it the stored numbers come as they are.
    #[must_use]
    pub fn texel(&self, x: usize, y: usize, as_color: bool) -> [f64; 4] {
        let (x, y) = (x.min(self.width - 1), y.min(self.height - 1));
        let first = (y * self.width + x) * self.channels;
        let (decode, all) = (as_color && !self.linear, first..first + self.channels);
        match &self.values {
            Values::Bytes(v) => {
                let [stored, light] = byte_tables();
                let table = if decode { light } else { stored };
                let color = |b: u8| table[usize::from(b)];
                spread(v.get(all).unwrap_or_default(), color, |b| stored[usize::from(b)])
            }
            Values::Shorts(v) => {
                let stored = |s: u16| f64::from(s) / 65_535.0;
                let color = |s| if decode { linear_from_srgb(stored(s)) } else { stored(s) };
                spread(v.get(all).unwrap_or_default(), color, stored)
            }
            Values::Floats(v) => {
                let color = |stored: f32| {
                    let stored = f64::from(stored);
                    let v = if decode { linear_from_srgb(stored) } else { stored };
                    if as_color { v.max(0.0) } else { v }
                };
                spread(v.get(all).unwrap_or_default(), color, f64::from)
            }
        }
    }
}

/// A texel's one to four values as red, green, blue and alpha.
fn spread<T: Copy>(texel: &[T], color: impl Fn(T) -> f64, number: impl Fn(T) -> f64) -> [f64; 4] {
    match *texel {
        [r, g, b] => [color(r), color(g), color(b), 1.0],
        [r, g, b, alpha] => [color(r), color(g), color(b), number(alpha)],
        [grey] => {
            let grey = color(grey);
            [grey, grey, grey, 1.0]
        }
        [grey, alpha] => {
            let grey = color(grey);
            [grey, grey, grey, number(alpha)]
        }
        _ => [0.0, 0.0, 0.0, 1.0],
    }
}

/// The channels and values of a picture, with one channel for three where all its texels are grey.
fn smallest<T: Copy + PartialEq>(
    values: Vec<T>,
    channels: usize,
    wrap: impl Fn(Vec<T>) -> Values,
) -> (usize, Values) {
    let grey = |texel: &[T]| matches!(*texel, [r, g, b, ..] if r == g && g == b);
    if channels < 3 || !values.chunks_exact(channels).all(grey) {
        return (channels, wrap(values));
    }
    let kept = values.chunks_exact(channels).flat_map(|texel| &texel[2..]).copied().collect();
    (channels - 2, wrap(kept))
}

/// The value with NaN and infinity replaced.
fn finite(v: f32) -> f32 {
    if v.is_nan() {
        0.0
    } else if v.is_infinite() {
        BRIGHTEST.copysign(v)
    } else {
        v
    }
}

/// The numbers of all bytes: 255ths, and the linear light of these as sRGB values.
fn byte_tables() -> &'static [[f64; 256]; 2] {
    static TABLES: OnceLock<[[f64; 256]; 2]> = OnceLock::new();
    TABLES.get_or_init(|| {
        let stored = std::array::from_fn(|i| i as f64 / 255.0);
        [stored, stored.map(linear_from_srgb)]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A row of texels with as many values each.
    fn row(channels: usize, values: Values, encoding: Encoding) -> Texture {
        let width = (values.len() / channels) as u32;
        Texture::from_stored(Stored::new(width, 1, channels, values, encoding).unwrap())
    }

    #[test]
    fn stored_as_small_as_the_values_allow() {
        let bytes = |channels, v: &[u8]| row(channels, Values::Bytes(v.to_vec()), Encoding::Srgb);
        assert_eq!(bytes(3, &[85, 85, 85, 9, 9, 9]).bytes(), 2);
        assert_eq!(bytes(3, &[85, 85, 85, 9, 9, 8]).bytes(), 6);
        assert_eq!(
            bytes(1, &[85, 9]).texel(1, 0, false),
            [9.0 / 255.0, 9.0 / 255.0, 9.0 / 255.0, 1.0]
        );
        let alpha = bytes(4, &[85; 8]);
        assert_eq!(alpha.bytes(), 4);
        assert_eq!(alpha.texel(1, 0, true)[3], 85.0 / 255.0, "alpha is never decoded");
        assert_eq!(bytes(4, &[85, 0, 0, 51]).texel(0, 0, true)[3], 0.2);
        let shorts = row(3, Values::Shorts(vec![1234, 65_535, 0, 1, 2, 3]), Encoding::Srgb);
        assert_eq!(shorts.bytes(), 12);
        assert_eq!(shorts.texel(0, 0, false), [1234.0 / 65_535.0, 1.0, 0.0, 1.0]);
        assert_eq!(row(3, Values::Floats(vec![0.5, 2.0, 0.0]), Encoding::Raw).bytes(), 12);
    }

    #[test]
    fn every_byte_comes_back_exactly_and_decodes_as_srgb() {
        for i in 0..=255_u8 {
            let texture = row(3, Values::Bytes(vec![i, 255, 0]), Encoding::Srgb);
            let wide = u16::from(i) * 257;
            let shorts = row(3, Values::Shorts(vec![wide, 65_535, 0]), Encoding::Srgb);
            let v = f64::from(i) / 255.0;
            assert_eq!(texture.texel(0, 0, false), [v, 1.0, 0.0, 1.0]);
            assert_eq!(texture.texel(0, 0, true)[0], crate::build::srgb_to_linear(v));
            for as_color in [false, true] {
                assert_eq!(shorts.texel(0, 0, as_color), texture.texel(0, 0, as_color));
            }
        }
    }

    #[test]
    fn linear_pictures_are_not_decoded_and_made_finite() {
        let values = [0.5, -2.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
        let texture = row(1, Values::Floats(values.to_vec()), Encoding::Raw);
        let red = |as_color| [0, 1, 2, 3, 4].map(|x| texture.texel(x, 0, as_color)[0]);
        assert_eq!(red(true), [0.5, 0.0, 0.0, 65_504.0, 0.0]);
        assert_eq!(red(false), [0.5, -2.0, 0.0, 65_504.0, -65_504.0]);
    }
}
