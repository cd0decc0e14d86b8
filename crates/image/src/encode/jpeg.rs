// SPDX-License-Identifier: MIT OR Apache-2.0
//! JPEG by crate `image`, with the text as a comment segment of lines `key: value`.

use super::{EncodeOptions, plain_key};
use crate::buffer::Layers;
use crate::develop::developed;
use crate::error::ImageError;
use crate::transfer::quantize_8;
use image::ExtendedColorType;
use image::codecs::jpeg::JpegEncoder;

pub(super) fn encode(layers: &Layers, options: &EncodeOptions) -> Result<Vec<u8>, ImageError> {
    let picture = &layers.picture;
    let (width, height) = (picture.width(), picture.height());
    if width.max(height) > u32::from(u16::MAX) {
        return Err(ImageError::invalid(
            format!("a JPEG cannot be {width} x {height}: its sides are at most 65535"),
            "write a PNG, or a smaller picture",
        ));
    }
    // JPEG has no alpha: what shines through is shown on black, which associated light already is.
    let data: Vec<u8> = developed(picture, options.develop)
        .flat_map(|(color, alpha)| color.map(|c| quantize_8(c * alpha.clamp(0.0, 1.0))))
        .collect();
    let mut out = Vec::new();
    JpegEncoder::new_with_quality(&mut out, options.quality.clamp(1, 100))
        .encode(&data, width, height, ExtendedColorType::Rgb8)
        .map_err(|e| {
            ImageError::invalid(format!("the JPEG cannot be written: {e}"), "write a PNG")
        })?;

    let comment: String = layers
        .metadata
        .0
        .iter()
        .map(|(key, value)| format!("{}: {value}\n", plain_key(key)))
        .collect();
    // Comments go behind the start marker (2 bytes) and the JFIF segment, whose length follows its own marker.
    let jfif = out.get(4..6).map_or(0, |n| n.iter().fold(0, |sum, b| sum * 256 + usize::from(*b)));
    let place = (4 + jfif).min(out.len());
    let segments: Vec<u8> = comment.as_bytes().chunks(65533).flat_map(comment_segment).collect();
    out.splice(place..place, segments);
    Ok(out)
}

/// A comment segment (marker FF FE) of at most 65533 bytes.
fn comment_segment(text: &[u8]) -> Vec<u8> {
    let length = u16::try_from(text.len() + 2).unwrap_or(u16::MAX);
    [&[0xff, 0xfe], &length.to_be_bytes()[..], text].concat()
}
