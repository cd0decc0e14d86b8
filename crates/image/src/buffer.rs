// SPDX-License-Identifier: MIT OR Apache-2.0
//! Pictures in memory: [`Image`], a picture of pixels, and [`Layers`], a picture with what a
//! renderer knows about it besides its colour.

use crate::error::{ErrorKind, ImageError};
use crate::transfer::Encoding;

/// A picture: `width * height` pixels of red, green, blue, alpha, row by row from the top left.
///
/// Colours are Rec. 709. What the numbers mean is said by `encoding`: linear light, or values
/// encoded for a display, 0 to 1. Where `has_alpha` is false every alpha is 1. Alpha is straight
/// (not multiplied in) in encoded pictures and associated (colour already multiplied by alpha, as
/// light adds up) in linear ones; [`crate::encode()`] and [`crate::decode()`] convert.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    width: u32,
    height: u32,
    pixels: Vec<[f32; 4]>,
    /// Whether alpha carries information.
    pub has_alpha: bool,
    /// What the colour values are.
    pub encoding: Encoding,
}

impl Image {
    /// A picture of one colour.
    ///
    /// # Errors
    /// Where the sides are zero or their product does not fit into memory's numbers.
    pub fn new(
        width: u32,
        height: u32,
        pixel: [f32; 4],
        encoding: Encoding,
    ) -> Result<Self, ImageError> {
        let count = pixel_count(width, height)?;
        Ok(Self { width, height, pixels: vec![pixel; count], has_alpha: false, encoding })
    }

    /// A picture of given pixels, rows from the top.
    ///
    /// # Errors
    /// Where there are not exactly `width * height` of them, or none.
    pub fn from_pixels(
        width: u32,
        height: u32,
        pixels: Vec<[f32; 4]>,
        encoding: Encoding,
    ) -> Result<Self, ImageError> {
        if pixels.len() != pixel_count(width, height)? {
            return Err(ImageError::invalid(
                format!("{} pixels given for a picture of {width} x {height}", pixels.len()),
                "give width * height pixels",
            ));
        }
        Ok(Self { width, height, pixels, has_alpha: false, encoding })
    }

    /// A picture whose pixel (x, y) is `f(x, y)`, without alpha.
    ///
    /// # Errors
    /// As [`Image::new`].
    pub fn from_fn(
        width: u32,
        height: u32,
        encoding: Encoding,
        mut f: impl FnMut(u32, u32) -> [f32; 3],
    ) -> Result<Self, ImageError> {
        let mut image = Self::new(width, height, [0.0, 0.0, 0.0, 1.0], encoding)?;
        for (row, y) in image.pixels.chunks_exact_mut(width as usize).zip(0..) {
            for (pixel, x) in row.iter_mut().zip(0..) {
                let [r, g, b] = f(x, y);
                *pixel = [r, g, b, 1.0];
            }
        }
        Ok(image)
    }

    /// The same picture, its alpha declared meaningful.
    #[must_use]
    pub fn with_alpha(mut self) -> Self {
        self.has_alpha = true;
        self
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

    /// All pixels, row by row from the top left.
    #[must_use]
    pub fn pixels(&self) -> &[[f32; 4]] {
        &self.pixels
    }

    /// All pixels, row by row from the top left, handed over.
    #[must_use]
    pub fn into_pixels(self) -> Vec<[f32; 4]> {
        self.pixels
    }

    /// All pixels, to be changed.
    pub fn pixels_mut(&mut self) -> &mut [[f32; 4]] {
        &mut self.pixels
    }

    /// The rows from the top.
    pub fn rows(&self) -> impl DoubleEndedIterator<Item = &[[f32; 4]]> {
        self.pixels.chunks_exact(self.width.max(1) as usize)
    }

    /// The pixel in column `x` of row `y`, both from the top left, if there is one.
    #[must_use]
    pub fn get(&self, x: u32, y: u32) -> Option<[f32; 4]> {
        self.pixels.get(self.index(x, y)?).copied()
    }

    /// Sets one pixel; outside the picture nothing happens.
    pub fn set(&mut self, x: u32, y: u32, value: [f32; 4]) {
        if let Some(pixel) = self.index(x, y).and_then(|i| self.pixels.get_mut(i)) {
            *pixel = value;
        }
    }

    fn index(&self, x: u32, y: u32) -> Option<usize> {
        (x < self.width && y < self.height).then(|| y as usize * self.width as usize + x as usize)
    }

    /// The same picture in linear light with associated alpha; linear pictures come back unchanged.
    #[must_use]
    pub fn into_linear(mut self) -> Self {
        if self.encoding != Encoding::Raw {
            for [r, g, b, a] in &mut self.pixels {
                for c in [r, g, b] {
                    *c = (self.encoding.decode(f64::from(*c)) * f64::from(*a)) as f32;
                }
            }
            self.encoding = Encoding::Raw;
        }
        self
    }
}

/// `width * height`, where that is more than zero and a buffer of it can be addressed.
fn pixel_count(width: u32, height: u32) -> Result<usize, ImageError> {
    let count = u64::from(width) * u64::from(height);
    if count == 0 {
        return Err(ImageError::invalid(
            format!("a picture of {width} x {height} has no pixels"),
            "both sides must be at least 1",
        ));
    }
    usize::try_from(count)
        .ok()
        .filter(|n| *n <= isize::MAX as usize / size_of::<[f32; 4]>())
        .ok_or_else(|| {
            ImageError::new(
                ErrorKind::TooLarge,
                format!("a picture of {width} x {height} does not fit into memory"),
                "ask for a smaller picture",
            )
        })
}

/// The values of one [`Layer`], row by row from the top left.
#[derive(Clone, Debug, PartialEq)]
pub enum LayerData {
    /// One number a pixel, such as the depth.
    Scalar(Vec<f32>),
    /// A vector a pixel, such as the normal.
    Vector(Vec<[f32; 3]>),
    /// A linear colour a pixel, such as the albedo.
    Color(Vec<[f32; 3]>),
    /// A whole number a pixel, such as the object or the count of samples.
    Id(Vec<u32>),
}

impl LayerData {
    /// How many pixels there are values for.
    #[must_use]
    pub fn len(&self) -> usize {
        match self {
            Self::Scalar(v) => v.len(),
            Self::Vector(v) | Self::Color(v) => v.len(),
            Self::Id(v) => v.len(),
        }
    }

    /// Whether there are no values.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// A named plane of values beside the colour of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// Its name: letters, digits and `_`, unlike all others of the picture.
    pub name: String,
    /// Its values, one a pixel.
    pub data: LayerData,
}

/// Text that a picture's file carries: keys and values in the order in which they were added.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Metadata(pub Vec<(String, String)>);

impl Metadata {
    /// Adds an entry, or changes the entry of the same key in its place.
    pub fn set(&mut self, key: &str, value: impl Into<String>) {
        let value = value.into();
        match self.0.iter_mut().find(|(k, _)| k == key) {
            Some(entry) => entry.1 = value,
            None => self.0.push((key.to_owned(), value)),
        }
    }

    /// The value of a key.
    #[must_use]
    pub fn get(&self, key: &str) -> Option<&str> {
        self.0.iter().find(|(k, _)| k == key).map(|(_, v)| v.as_str())
    }
}

/// A picture with further layers and text: what a renderer hands over and a file holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Layers {
    /// The colour, and alpha where `has_alpha`.
    pub picture: Image,
    /// Depth, normals and the like, in order.
    extra: Vec<Layer>,
    /// The text that goes into the file.
    pub metadata: Metadata,
}

impl From<Image> for Layers {
    fn from(picture: Image) -> Self {
        Self { picture, extra: Vec::new(), metadata: Metadata::default() }
    }
}

impl Layers {
    /// Adds a layer.
    ///
    /// # Errors
    /// Where its name is empty, taken, or not of letters, digits and `_`, or where it has not one value a pixel.
    pub fn push(&mut self, name: &str, data: LayerData) -> Result<(), ImageError> {
        let plain =
            !name.is_empty() && name.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_');
        if !plain || ["R", "G", "B", "A", "Z"].contains(&name) || self.get(name).is_some() {
            return Err(ImageError::invalid(
                format!("\"{name}\" cannot be the name of a layer"),
                "a layer's name is of letters, digits and _, is no other layer's, and not R, G, B, A or Z",
            ));
        }
        if data.len() != self.picture.pixels.len() {
            return Err(ImageError::invalid(
                format!(
                    "layer \"{name}\" has {} values for {} pixels",
                    data.len(),
                    self.picture.pixels.len()
                ),
                "give one value a pixel",
            ));
        }
        self.extra.push(Layer { name: name.to_owned(), data });
        Ok(())
    }

    /// The layers beside the colour, in the order in which they were added.
    #[must_use]
    pub fn extra(&self) -> &[Layer] {
        &self.extra
    }

    /// The values of the layer of a name.
    #[must_use]
    pub fn get(&self, name: &str) -> Option<&LayerData> {
        self.extra.iter().find(|layer| layer.name == name).map(|layer| &layer.data)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_checked() {
        assert!(Image::new(0, 5, [0.0; 4], Encoding::Raw).is_err());
        assert_eq!(
            Image::new(u32::MAX, u32::MAX, [0.0; 4], Encoding::Raw).unwrap_err().kind,
            ErrorKind::TooLarge
        );
        assert!(Image::from_pixels(2, 2, vec![[0.0; 4]; 3], Encoding::Raw).is_err());
    }

    #[test]
    fn pixels_are_found_by_column_and_row() {
        let mut image =
            Image::from_fn(3, 2, Encoding::Raw, |x, y| [x as f32, y as f32, 0.0]).unwrap();
        assert_eq!(image.get(2, 1), Some([2.0, 1.0, 0.0, 1.0]));
        assert_eq!(image.get(3, 0), None);
        assert_eq!(image.get(0, 2), None);
        image.set(1, 1, [9.0; 4]);
        image.set(7, 7, [9.0; 4]);
        assert_eq!(image.rows().nth(1).unwrap()[1], [9.0; 4]);
    }

    #[test]
    fn layers_need_one_value_a_pixel_and_a_name_of_their_own() {
        let mut layers = Layers::from(Image::new(2, 2, [0.0; 4], Encoding::Raw).unwrap());
        layers.push("depth", LayerData::Scalar(vec![1.0; 4])).unwrap();
        for (name, data) in [
            ("depth", LayerData::Id(vec![0; 4])),
            ("a.b", LayerData::Id(vec![0; 4])),
            ("", LayerData::Id(vec![0; 4])),
            ("R", LayerData::Id(vec![0; 4])),
            ("id", LayerData::Id(vec![0; 3])),
        ] {
            assert!(layers.push(name, data).is_err(), "{name}");
        }
        assert_eq!(layers.extra().len(), 1);
        assert_eq!(layers.get("depth"), Some(&LayerData::Scalar(vec![1.0; 4])));
    }

    #[test]
    fn linear_light_has_alpha_multiplied_in() {
        let image = Image::from_pixels(1, 1, vec![[1.0, 0.5, 0.0, 0.5]], Encoding::Srgb)
            .unwrap()
            .with_alpha();
        let [r, g, b, a] = image.into_linear().get(0, 0).unwrap();
        assert_eq!([r, b, a], [0.5, 0.0, 0.5]);
        assert!((g - 0.5 * 0.214_041_14).abs() < 1e-7);
    }
}
