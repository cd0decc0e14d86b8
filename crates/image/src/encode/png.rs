// SPDX-License-Identifier: MIT OR Apache-2.0
//! PNG of 8 or 16 bits with the text as `iTXt` chunks in the order of the metadata.

use super::{Depth, EncodeOptions, plain_key};
use crate::buffer::Layers;
use crate::develop::{developed, developed_bytes};
use crate::error::ImageError;
use crate::transfer::{Encoding, quantize_16};
use png::text_metadata::ITXtChunk;
use png::{BitDepth, ColorType, Compression, ScaledFloat, SrgbRenderingIntent};

pub(super) fn encode(layers: &Layers, options: &EncodeOptions) -> Result<Vec<u8>, ImageError> {
    let image = &layers.picture;
    let failed = |e: png::EncodingError| {
        ImageError::invalid(format!("the PNG cannot be written: {e}"), "make it smaller")
    };
    let mut out = Vec::new();
    let mut encoder = png::Encoder::new(&mut out, image.width(), image.height());
    encoder.set_color(if image.has_alpha { ColorType::Rgba } else { ColorType::Rgb });
    encoder.set_depth(match options.depth {
        Depth::Eight => BitDepth::Eight,
        Depth::Sixteen => BitDepth::Sixteen,
    });
    encoder.set_compression(Compression::Balanced);
    // Raw values are meant to be shown as they are, so they get no note on how to decode them.
    let stored =
        if image.encoding == Encoding::Raw { options.develop.encoding } else { image.encoding };
    match stored {
        Encoding::Srgb => encoder.set_source_srgb(SrgbRenderingIntent::RelativeColorimetric),
        Encoding::Gamma => encoder.set_source_gamma(ScaledFloat::from_scaled(45455)),
        Encoding::Raw => {}
    }
    let mut writer = encoder.write_header().map_err(failed)?;
    for (key, value) in &layers.metadata.0 {
        let text: String = value.chars().filter(|c| *c != '\0').collect();
        writer.write_text_chunk(&ITXtChunk::new(plain_key(key), text)).map_err(failed)?;
    }
    let mut data = Vec::new();
    match options.depth {
        Depth::Eight => {
            for (color, alpha) in developed_bytes(image, options.develop) {
                data.extend(color.into_iter().chain(image.has_alpha.then_some(alpha)));
            }
        }
        Depth::Sixteen => {
            for (color, alpha) in developed(image, options.develop) {
                let values = color.into_iter().chain(image.has_alpha.then_some(alpha));
                data.extend(values.flat_map(|value| quantize_16(value).to_be_bytes()));
            }
        }
    }
    writer.write_image_data(&data).map_err(failed)?;
    writer.finish().map_err(failed)?;
    Ok(out)
}
