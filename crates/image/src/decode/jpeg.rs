// SPDX-License-Identifier: MIT OR Apache-2.0
//! JPEG: baseline and progressive, grey, colour, and four inks converted to colour.

use super::check_size;
use crate::error::ImageError;
use crate::stored::{Stored, Values};
use crate::transfer::Encoding;
use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

pub(super) fn decode(bytes: &[u8], max_pixels: u64) -> Result<Stored, ImageError> {
    if !is_complete(bytes) {
        return Err(ImageError::corrupt("JPEG", "it breaks off before its end marker"));
    }
    // Without `unsafe` there are no SIMD paths, whose rounding could differ between processors.
    let options = DecoderOptions::default()
        .set_use_unsafe(false)
        .set_strict_mode(false)
        .set_max_width(usize::from(u16::MAX))
        .set_max_height(usize::from(u16::MAX))
        .jpeg_set_out_colorspace(ColorSpace::RGB);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    decoder.decode_headers().map_err(|e| ImageError::corrupt("JPEG", e))?;
    let info = decoder.info().ok_or_else(|| ImageError::corrupt("JPEG", "it has no header"))?;
    let (width, height) = check_size(info.width.into(), info.height.into(), max_pixels)?;
    let buffer = decoder.decode().map_err(|e| ImageError::corrupt("JPEG", e))?;
    Stored::new(width, height, 3, Values::Bytes(buffer), Encoding::Srgb)
}

/// Whether the file's segments and scans lead to its end marker. The decoder would fill what is missing with grey.
fn is_complete(bytes: &[u8]) -> bool {
    let mut rest = bytes;
    loop {
        // To the next marker: FF and a byte that is neither stuffing (00), nor a restart (D0 to D7), nor fill (FF).
        let marker = rest
            .windows(2)
            .position(|w| matches!(*w, [0xff, m] if !matches!(m, 0 | 0xd0..=0xd7 | 0xff)));
        let Some((marker, after)) =
            marker.and_then(|at| rest.get(at + 1..)).and_then(<[u8]>::split_first)
        else {
            return false;
        };
        rest = match marker {
            0xd9 => return true,
            0xd8 | 0x01 => after,
            // All others are followed by their length, which counts itself.
            _ => {
                let length = after.first_chunk().map_or(0, |n| usize::from(u16::from_be_bytes(*n)));
                match after.get(length.max(2)..) {
                    Some(rest) => rest,
                    None => return false,
                }
            }
        };
    }
}
