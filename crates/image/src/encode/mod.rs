// SPDX-License-Identifier: MIT OR Apache-2.0
//! Writing pictures: the same picture and options give the same bytes, always.
//!
//! PNG and JPEG hold the developed picture (a picture that is already encoded is written as it is); EXR and HDR hold
//! linear light (an encoded picture is decoded first). Nothing but what the caller passes goes into a file.

mod exr;
mod hdr;
mod jpeg;
mod png;

use crate::buffer::Layers;
use crate::develop::Develop;
use crate::error::ImageError;
use crate::names;
use std::path::Path;

/// A kind of file that [`encode`] writes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileFormat {
    /// Portable Network Graphics: developed, 8 or 16 bits, alpha, text.
    Png,
    /// JPEG: developed, 8 bits, lossy, no alpha, text in a comment.
    Jpeg,
    /// OpenEXR: linear 32-bit floats, alpha, all layers, text.
    Exr,
    /// Radiance RGBE: linear light of 8 bits and a common exponent, no alpha.
    Hdr,
}

impl FileFormat {
    /// The extensions of file names that [`FileFormat::from_path`] knows.
    pub const EXTENSIONS: [&'static str; 5] = ["png", "jpg", "jpeg", "exr", "hdr"];

    /// The format that a file's name asks for by its extension, in either case.
    ///
    /// # Errors
    /// No extension or another one; the error lists the valid ones and says which is nearest.
    pub fn from_path(path: &Path) -> Result<Self, ImageError> {
        let Some(extension) = path.extension().map(|e| e.to_string_lossy().to_lowercase()) else {
            return Err(ImageError::invalid(
                format!("the picture's name \"{}\" has no extension", path.display()),
                format!("end it with one of: {}", Self::EXTENSIONS.join(", ")),
            ));
        };
        match extension.as_str() {
            "png" => Ok(Self::Png),
            "jpg" | "jpeg" => Ok(Self::Jpeg),
            "exr" => Ok(Self::Exr),
            "hdr" => Ok(Self::Hdr),
            _ => Err(names::unknown("picture format", &extension, &Self::EXTENSIONS)),
        }
    }

    /// Whether files of this kind hold linear light, to which no development is applied.
    #[must_use]
    pub fn is_linear(self) -> bool {
        matches!(self, Self::Exr | Self::Hdr)
    }
}

/// Bits of a channel in a PNG file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Depth {
    /// 8 bits.
    #[default]
    Eight,
    /// 16 bits.
    Sixteen,
}

/// How [`encode`] writes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EncodeOptions {
    /// The development for PNG and JPEG.
    pub develop: Develop,
    /// Bits of a channel for PNG.
    pub depth: Depth,
    /// Quality of JPEG, 1 to 100.
    pub quality: u8,
}

impl Default for EncodeOptions {
    fn default() -> Self {
        Self { develop: Develop::default(), depth: Depth::Eight, quality: 92 }
    }
}

/// The bytes of a file of `format` with the picture, and with its layers and text where the format can hold them.
///
/// # Errors
/// Pictures with a side beyond what the format can say (JPEG: 65535).
pub fn encode(
    layers: &Layers,
    format: FileFormat,
    options: &EncodeOptions,
) -> Result<Vec<u8>, ImageError> {
    match format {
        FileFormat::Png => png::encode(layers, options),
        FileFormat::Jpeg => jpeg::encode(layers, options),
        FileFormat::Exr => exr::encode(layers),
        FileFormat::Hdr => Ok(hdr::encode(&layers.picture)),
    }
}

/// A key as all formats can hold it: printable ASCII, 1 to 79 characters, no space at its ends.
fn plain_key(key: &str) -> String {
    let plain: String =
        key.chars().map(|c| if c.is_ascii_graphic() { c } else { '_' }).take(79).collect();
    if plain.is_empty() { "_".to_owned() } else { plain }
}

#[cfg(test)]
mod tests;
