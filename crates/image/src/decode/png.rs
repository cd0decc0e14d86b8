// SPDX-License-Identifier: MIT OR Apache-2.0
//! PNG: 1 to 16 bits, grey, palette, colour, with or without alpha, interlaced or not.

use super::check_size;
use crate::error::ImageError;
use crate::stored::{Stored, Values};
use crate::transfer::Encoding;
use png::{BitDepth, ColorType, Transformations};
use std::io::Cursor;

pub(super) fn decode(bytes: &[u8], max_pixels: u64) -> Result<Stored, ImageError> {
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

    let values = if info.bit_depth == BitDepth::Sixteen {
        Values::Shorts(buffer.as_chunks().0.iter().map(|&pair| u16::from_be_bytes(pair)).collect())
    } else {
        Values::Bytes(buffer)
    };
    let channels = match info.color_type {
        ColorType::Grayscale => 1,
        ColorType::GrayscaleAlpha => 2,
        ColorType::Rgb | ColorType::Indexed => 3,
        ColorType::Rgba => 4,
    };
    Stored::new(width, height, channels, values, Encoding::Srgb)
}
