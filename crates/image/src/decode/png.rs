// SPDX-License-Identifier: MIT OR Apache-2.0
//! PNG: 1 to 16 bits, grey, palette, colour, with or without alpha, interlaced or not.

use super::check_size;
use crate::buffer::Image;
use crate::error::ImageError;
use crate::transfer::Encoding;
use png::{BitDepth, ColorType, Transformations};
use std::io::Cursor;

pub(super) fn decode(bytes: &[u8], max_pixels: u64) -> Result<Image, ImageError> {
    let broken = |e: png::DecodingError| ImageError::corrupt("PNG", e);
    let mut decoder = png::Decoder::new(Cursor::new(bytes));
    // Palettes and small depths become 8 bits, transparent colours become alpha, 16 bits stay.
    decoder.set_transformations(Transformations::EXPAND);
    decoder.set_ignore_text_chunk(true);
    decoder.set_ignore_iccp_chunk(true);
    let mut reader = decoder.read_info().map_err(broken)?;
    let (width, height) =
        check_size(reader.info().width.into(), reader.info().height.into(), max_pixels)?;
    let size = reader
        .output_buffer_size()
        .ok_or_else(|| ImageError::corrupt("PNG", "its size does not fit into memory"))?;
    let mut buffer = vec![0; size];
    let info = reader.next_frame(&mut buffer).map_err(broken)?;
    // A file that breaks off after its last row lacks only checks, but it is no complete file.
    reader.finish().map_err(broken)?;

    let bytes_per_sample = if info.bit_depth == BitDepth::Sixteen { 2 } else { 1 };
    let sample = |s: &[u8]| match *s {
        [hi, lo] => f32::from(u16::from_be_bytes([hi, lo])) / 65535.0,
        [v] => f32::from(v) / 255.0,
        _ => 0.0,
    };
    let (channels, alpha) = match info.color_type {
        ColorType::Grayscale => (1, false),
        ColorType::GrayscaleAlpha => (2, true),
        ColorType::Rgba => (4, true),
        ColorType::Rgb | ColorType::Indexed => (3, false),
    };
    let pixels = buffer
        .chunks_exact(channels * bytes_per_sample)
        .map(|pixel| {
            let mut samples = pixel.chunks_exact(bytes_per_sample).map(sample);
            let mut next = || samples.next().unwrap_or(1.0);
            if channels <= 2 {
                let grey = next();
                [grey, grey, grey, next()]
            } else {
                [next(), next(), next(), next()]
            }
        })
        .collect();
    let mut image = Image::from_pixels(width, height, pixels, Encoding::Srgb)?;
    image.has_alpha = alpha;
    Ok(image)
}
