// SPDX-License-Identifier: MIT OR Apache-2.0
//! BMP and TGA, read by crate `image`: any header size, padded rows, palettes, run lengths, both row orders.

use super::check_size;
use crate::error::ImageError;
use crate::stored::{Stored, Values};
use crate::transfer::Encoding;
use image::codecs::bmp::BmpDecoder;
use image::codecs::tga::TgaDecoder;
use image::{DynamicImage, ImageDecoder};
use std::io::Cursor;

pub(super) fn decode_bmp(bytes: &[u8], max_pixels: u64) -> Result<Stored, ImageError> {
    let decoder = BmpDecoder::new(Cursor::new(bytes)).map_err(|e| ImageError::corrupt("BMP", e))?;
    read("BMP", decoder, max_pixels)
}

pub(super) fn decode_tga(bytes: &[u8], max_pixels: u64) -> Result<Stored, ImageError> {
    let decoder = TgaDecoder::new(Cursor::new(bytes)).map_err(|e| ImageError::corrupt("TGA", e))?;
    read("TGA", decoder, max_pixels)
}

fn read(format: &str, decoder: impl ImageDecoder, max_pixels: u64) -> Result<Stored, ImageError> {
    let (width, height) = decoder.dimensions();
    let (width, height) = check_size(width.into(), height.into(), max_pixels)?;
    let alpha = decoder.color_type().has_alpha();
    let picture =
        DynamicImage::from_decoder(decoder).map_err(|e| ImageError::corrupt(format, e))?;
    let (channels, values) = if alpha {
        (4, picture.into_rgba8().into_raw())
    } else {
        (3, picture.into_rgb8().into_raw())
    };
    Stored::new(width, height, channels, Values::Bytes(values), Encoding::Srgb)
}
