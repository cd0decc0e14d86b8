// SPDX-License-Identifier: MIT OR Apache-2.0
//! Pictures as patterns use them: stored as small as they were in their file, read one texel at a
//! time, decoded only when asked for as colour.

mod lookup;

use std::sync::OnceLock;

use dioptric_image::transfer::{linear_from_srgb, quantize_8, quantize_16};
use dioptric_image::{Encoding, Image, ImageError, decode};

pub use lookup::{Filter, Lookup, Wrap};

/// The most texels that all pictures of a scene may have together, unless a program says otherwise.
pub const MAX_TEXELS: u64 = 1 << 28;

/// What infinite values of a picture become: the largest number of 16-bit floats, in which such
/// pictures are mostly stored.
const BRIGHTEST: f32 = 65_504.0;

/// The stored values, channel by channel, texel by texel, row by row from the top left.
#[derive(Clone, Debug)]
enum Data {
    Bytes(Box<[u8]>),
    Shorts(Box<[u16]>),
    Floats(Box<[f32]>),
}

/// A picture, at least one texel large.
#[derive(Clone, Debug)]
pub struct Texture {
    width: usize,
    height: usize,
    /// 1 (grey), 3, or 4 with alpha.
    channels: usize,
    data: Data,
    /// Whether the file held linear light, which nothing decodes.
    linear: bool,
}

impl Texture {
    /// Reads the bytes of a picture's file with at most `max_texels`; `name` goes into messages.
    ///
    /// # Errors
    /// The bytes are no picture, the file is damaged, or the picture is too large.
    pub fn from_bytes(bytes: &[u8], name: &str, max_texels: u64) -> Result<Self, ImageError> {
        decode(bytes, name, max_texels).map(|image| Self::from_image(&image))
    }

    /// Keeps a picture as small as its values allow: as bytes where all of them are 255ths, as
    /// shorts where they are 65535ths, in one channel where it is grey.
    #[must_use]
    pub fn from_image(image: &Image) -> Self {
        let is_grey = image.pixels().iter().all(|[r, g, b, _]| r == g && g == b);
        let channels = match (image.has_alpha, is_grey) {
            (true, _) => 4,
            (false, true) => 1,
            (false, false) => 3,
        };
        let values = || image.pixels().iter().flat_map(|pixel| &pixel[..channels]).copied();
        let linear = image.encoding == Encoding::Raw;
        let byte = |v: f32| quantize_8(f64::from(v));
        let short = |v: f32| quantize_16(f64::from(v));
        let data = if !linear && values().all(|v| f32::from(byte(v)) / 255.0 == v) {
            Data::Bytes(values().map(byte).collect())
        } else if !linear && values().all(|v| f32::from(short(v)) / 65_535.0 == v) {
            Data::Shorts(values().map(short).collect())
        } else {
            Data::Floats(values().map(finite).collect())
        };
        let (width, height) = (image.width() as usize, image.height() as usize);
        Self { width, height, channels, data, linear }
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

    /// Memory for the texels.
    #[must_use]
    pub fn bytes(&self) -> usize {
        match &self.data {
            Data::Bytes(v) => v.len(),
            Data::Shorts(v) => v.len() * 2,
            Data::Floats(v) => v.len() * 4,
        }
    }

    /// Red, green, blue and alpha of the texel in column `x` of row `y`, both from the top left and
    /// taken to the picture's edge beyond it. With `as_color` sRGB values are decoded to linear light
    /// and no channel is negative; without it the stored numbers come as they are.
    #[must_use]
    pub fn texel(&self, x: usize, y: usize, as_color: bool) -> [f64; 4] {
        let (x, y) = (x.min(self.width - 1), y.min(self.height - 1));
        let first = (y * self.width + x) * self.channels;
        let value = |channel: usize, decode: bool| match &self.data {
            Data::Bytes(v) => {
                let stored = v.get(first + channel).copied().unwrap_or(0);
                if decode { byte_table()[usize::from(stored)] } else { f64::from(stored) / 255.0 }
            }
            Data::Shorts(v) => {
                let stored = v.get(first + channel).copied().unwrap_or(0);
                let stored = f64::from(stored) / 65_535.0;
                if decode { linear_from_srgb(stored) } else { stored }
            }
            Data::Floats(v) => {
                let stored = f64::from(v.get(first + channel).copied().unwrap_or(0.0));
                if decode { linear_from_srgb(stored) } else { stored }
            }
        };
        let color = |channel: usize| {
            let v = value(channel, as_color && !self.linear);
            if as_color { v.max(0.0) } else { v }
        };
        match self.channels {
            1 => {
                let grey = color(0);
                [grey, grey, grey, 1.0]
            }
            3 => [color(0), color(1), color(2), 1.0],
            _ => [color(0), color(1), color(2), value(3, false)],
        }
    }
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

/// The linear light of all bytes.
fn byte_table() -> &'static [f64; 256] {
    static TABLE: OnceLock<[f64; 256]> = OnceLock::new();
    TABLE.get_or_init(|| std::array::from_fn(|i| linear_from_srgb(i as f64 / 255.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stored(values: &[f32], encoding: Encoding) -> Texture {
        let pixels = values.iter().map(|&v| [v, v * 0.5, 0.0, 1.0]).collect();
        let image = Image::from_pixels(values.len() as u32, 1, pixels, encoding).unwrap();
        Texture::from_image(&image)
    }

    #[test]
    fn stored_as_small_as_the_values_allow() {
        let third = f32::from(85_u8) / 255.0;
        let grey = Image::from_pixels(2, 1, vec![[third, third, third, 1.0]; 2], Encoding::Srgb);
        assert_eq!(Texture::from_image(&grey.unwrap()).bytes(), 2);
        let bytes = Image::from_pixels(2, 1, vec![[third, 1.0, 0.0, 1.0]; 2], Encoding::Srgb);
        assert_eq!(Texture::from_image(&bytes.unwrap()).bytes(), 6);
        let short = f32::from(1234_u16) / 65_535.0;
        let shorts = Image::from_pixels(2, 1, vec![[short, 1.0, 0.0, 1.0]; 2], Encoding::Srgb);
        let shorts = Texture::from_image(&shorts.unwrap());
        assert_eq!(shorts.bytes(), 12);
        assert_eq!(shorts.texel(0, 0, false), [1234.0 / 65_535.0, 1.0, 0.0, 1.0]);
        let alpha = Image::from_pixels(2, 1, vec![[third, third, third, third]; 2], Encoding::Srgb);
        let alpha = Texture::from_image(&alpha.unwrap().with_alpha());
        assert_eq!(alpha.bytes(), 8);
        assert_eq!(alpha.texel(1, 0, true)[3], 85.0 / 255.0, "alpha is never decoded");
        assert_eq!(stored(&[0.5, 2.0], Encoding::Raw).bytes(), 24);
    }

    #[test]
    fn every_byte_comes_back_exactly_and_decodes_as_srgb() {
        for i in 0..=255_u8 {
            let pixel = [f32::from(i) / 255.0, 1.0, 0.0, 1.0];
            let image = Image::from_pixels(1, 1, vec![pixel], Encoding::Srgb).unwrap();
            let texture = Texture::from_image(&image);
            let v = f64::from(i) / 255.0;
            assert_eq!(texture.texel(0, 0, false)[0], v);
            assert_eq!(texture.texel(0, 0, true)[0], crate::build::srgb_to_linear(v));
        }
    }

    #[test]
    fn linear_pictures_are_not_decoded_and_made_finite() {
        let values = [0.5, -2.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
        let texture = stored(&values, Encoding::Raw);
        let red = |as_color| [0, 1, 2, 3, 4].map(|x| texture.texel(x, 0, as_color)[0]);
        assert_eq!(red(true), [0.5, 0.0, 0.0, 65_504.0, 0.0]);
        assert_eq!(red(false), [0.5, -2.0, 0.0, 65_504.0, -65_504.0]);
    }
}
