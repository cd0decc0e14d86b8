// SPDX-License-Identifier: MIT OR Apache-2.0
//! Pictures as their files store them: bytes stay bytes, so that a large picture costs no more memory than its values
//! and no time for changing them into numbers that nobody may ask for.

use crate::buffer::Image;
use crate::error::ImageError;
use crate::transfer::Encoding;

/// Stored values, channel by channel, pixel by pixel, row by row from the top left.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// 8 bits each: `v / 255`.
    Bytes(Vec<u8>),
    /// 16 bits each: `v / 65535`.
    Shorts(Vec<u16>),
    /// The numbers themselves.
    Floats(Vec<f32>),
}

impl Values {
    /// How many there are.
    #[must_use]
    pub fn len(&self) -> usize {
        match self {
            Self::Bytes(v) => v.len(),
            Self::Shorts(v) => v.len(),
            Self::Floats(v) => v.len(),
        }
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// A picture of stored values.
#[derive(Clone, Debug, PartialEq)]
pub struct Stored {
    width: u32,
    height: u32,
    channels: usize,
    /// The values, `width * height * channels` of them.
    values: Values,
    /// What the colour values are.
    pub encoding: Encoding,
}

impl Stored {
    /// A picture of given values. `channels` is 1 (grey), 2 (grey and alpha), 3 (red, green, blue) or 4 (and alpha).
    ///
    /// # Errors
    /// Other numbers of channels, pictures without pixels, and more or fewer values than `width * height * channels`.
    pub fn new(
        width: u32,
        height: u32,
        channels: usize,
        values: Values,
        encoding: Encoding,
    ) -> Result<Self, ImageError> {
        let needed = u128::from(width) * u128::from(height) * channels as u128;
        if !(1..=4).contains(&channels) || needed == 0 || values.len() as u128 != needed {
            return Err(ImageError::invalid(
                format!(
                    "{} values given for a picture of {width} x {height} with {channels} channels",
                    values.len()
                ),
                "give width * height * channels values, of 1 to 4 channels",
            ));
        }
        Ok(Self { width, height, channels, values, encoding })
    }

    /// Pixels in a row.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Values of a pixel: 1 (grey), 2 (grey and alpha), 3 (red, green, blue) or 4 (and alpha).
    #[must_use]
    pub fn channels(&self) -> usize {
        self.channels
    }

    /// The values.
    #[must_use]
    pub fn values(&self) -> &Values {
        &self.values
    }

    /// The values, handed over.
    #[must_use]
    pub fn into_values(self) -> Values {
        self.values
    }

    /// The picture with every value a number.
    ///
    /// # Errors
    /// It is too large for memory.
    pub fn into_image(self) -> Result<Image, ImageError> {
        let pixels = match &self.values {
            Values::Bytes(v) => pixels(v, self.channels, |v| f32::from(v) / 255.0),
            Values::Shorts(v) => pixels(v, self.channels, |v| f32::from(v) / 65535.0),
            Values::Floats(v) => pixels(v, self.channels, |v| v),
        };
        let mut image = Image::from_pixels(self.width, self.height, pixels, self.encoding)?;
        image.has_alpha = self.channels.is_multiple_of(2);
        Ok(image)
    }
}

impl From<Image> for Stored {
    fn from(image: Image) -> Self {
        let (width, height, encoding) = (image.width(), image.height(), image.encoding);
        let (channels, values) = if image.has_alpha {
            (4, image.into_pixels().into_flattened())
        } else {
            (3, image.pixels().iter().flat_map(|&[r, g, b, _]| [r, g, b]).collect())
        };
        Self { width, height, channels, values: Values::Floats(values), encoding }
    }
}

/// Values as pixels: grey in all three colours, alpha 1 where there is none.
fn pixels<T: Copy>(values: &[T], channels: usize, number: impl Fn(T) -> f32) -> Vec<[f32; 4]> {
    let pixel = |p: &[T]| match *p {
        [grey] => [number(grey), number(grey), number(grey), 1.0],
        [grey, alpha] => [number(grey), number(grey), number(grey), number(alpha)],
        [r, g, b] => [number(r), number(g), number(b), 1.0],
        [r, g, b, alpha] => [number(r), number(g), number(b), number(alpha)],
        _ => [0.0; 4],
    };
    values.chunks_exact(channels).map(pixel).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_become_pixels_and_floats_come_back() {
        let stored = |channels, values| Stored::new(1, 1, channels, values, Encoding::Srgb);
        for (channels, values, pixel) in [
            (1, Values::Bytes(vec![51]), [0.2, 0.2, 0.2, 1.0]),
            (2, Values::Bytes(vec![51, 0]), [0.2, 0.2, 0.2, 0.0]),
            (3, Values::Shorts(vec![65535, 0, 13107]), [1.0, 0.0, 0.2, 1.0]),
            (4, Values::Floats(vec![0.5, 7.0, -1.0, 0.25]), [0.5, 7.0, -1.0, 0.25]),
        ] {
            let image = stored(channels, values).unwrap().into_image().unwrap();
            assert_eq!(image.pixels(), [pixel]);
            assert_eq!(image.has_alpha, channels % 2 == 0);
            assert_eq!(Stored::from(image.clone()).into_image().unwrap(), image);
        }
    }

    #[test]
    fn sizes_are_checked() {
        for (w, h, channels, count) in
            [(1, 1, 0, 0), (1, 1, 5, 5), (0, 3, 3, 0), (2, 2, 3, 11), (u32::MAX, u32::MAX, 4, 4)]
        {
            let values = Values::Bytes(vec![0; count]);
            assert!(Stored::new(w, h, channels, values, Encoding::Srgb).is_err());
        }
    }
}
