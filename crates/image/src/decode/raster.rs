// SPDX-License-Identifier: MIT OR Apache-2.0
//! BMP and TGA, read by crate `image`: any header size, padded rows, palettes, run lengths, both row orders.

use super::check_size;
use crate::buffer::Image;
use crate::error::ImageError;
use crate::transfer::Encoding;
use image::codecs::bmp::BmpDecoder;
use image::codecs::tga::TgaDecoder;
use image::{DynamicImage, ImageDecoder};
use std::io::Cursor;

pub(super) fn decode_bmp(bytes: &[u8], max_pixels: u64) -> Result<Image, ImageError> {
    let decoder = BmpDecoder::new(Cursor::new(bytes)).map_err(|e| ImageError::corrupt("BMP", e))?;
    read("BMP", decoder, max_pixels)
}

pub(super) fn decode_tga(bytes: &[u8], max_pixels: u64) -> Result<Image, ImageError> {
    let decoder = TgaDecoder::new(Cursor::new(bytes)).map_err(|e| ImageError::corrupt("TGA", e))?;
    read("TGA", decoder, max_pixels)
}

fn read(format: &str, decoder: impl ImageDecoder, max_pixels: u64) -> Result<Image, ImageError> {
    let (width, height) = decoder.dimensions();
    let (width, height) = check_size(width.into(), height.into(), max_pixels)?;
    let alpha = decoder.color_type().has_alpha();
    let pixels = DynamicImage::from_decoder(decoder)
        .map_err(|e| ImageError::corrupt(format, e))?
        .into_rgba8()
        .pixels()
        .map(|p| p.0.map(|c| f32::from(c) / 255.0))
        .collect();
    let mut image = Image::from_pixels(width, height, pixels, Encoding::Srgb)?;
    image.has_alpha = alpha;
    Ok(image)
}
