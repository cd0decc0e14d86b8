// SPDX-License-Identifier: MIT OR Apache-2.0
//! OpenEXR by crate `exr`: the first part of a file with all its channels, in 16 or 32 bits.

use super::check_size;
use crate::buffer::{Image, LayerData, Layers};
use crate::error::{ErrorKind, ImageError};
use crate::transfer::Encoding;
use exr::meta::MetaData;
use exr::meta::attribute::AttributeValue;
use exr::prelude::{FlatSamples, ReadChannels, ReadLayers, read};
use std::collections::BTreeMap;
use std::io::Cursor;

/// Channels by name; a `BTreeMap`, so that the order does not depend on the file's.
type Channels = BTreeMap<String, FlatSamples>;

/// Reads an OpenEXR file with its layers and its text.
///
/// The colour is the channels R, G, B (or one prefix's, such as `ViewLayer.Combined.R`) or Y, alpha is A. Triples
/// `name.X`, `name.Y`, `name.Z` and `name.R`, `name.G`, `name.B` become vectors and colours, `Z` becomes the layer
/// `depth`, whole numbers become ids, and every other channel a scalar layer. Text comes in the order of its keys.
///
/// # Errors
/// As [`crate::decode()`]; and files without a colour.
pub fn decode_exr(bytes: &[u8], max_pixels: u64) -> Result<Layers, ImageError> {
    let broken = |e: exr::error::Error| ImageError::corrupt("EXR", e);
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(broken)?;
    let header =
        meta.headers.first().ok_or_else(|| ImageError::corrupt("EXR", "it has no parts"))?;
    if header.deep {
        return Err(ImageError::unsupported("deep EXR files are not read", "flatten the picture"));
    }
    let size = header.layer_size;
    let (width, height) = check_size(size.width() as u64, size.height() as u64, max_pixels)?;
    let samples = u128::from(width) * u128::from(height) * header.channels.list.len() as u128;
    if samples > u128::from(max_pixels) * 16 {
        return Err(ImageError::new(
            ErrorKind::TooLarge,
            format!(
                "the EXR file's {} channels exceed the limit of memory",
                header.channels.list.len()
            ),
            "save fewer channels or a smaller picture, or raise the limit",
        ));
    }

    let file = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))
        .map_err(broken)?;
    let pixels = width as usize * height as usize;
    let mut channels: Channels = file
        .layer_data
        .channel_data
        .list
        .into_iter()
        .filter(|c| c.sample_data.len() == pixels)
        .map(|c| (c.name.to_string(), c.sample_data))
        .collect();
    let mut layers = Layers::from(take_color(&mut channels, width, height)?);
    add_layers(&mut layers, channels)?;

    let texts: BTreeMap<String, String> = file
        .attributes
        .other
        .iter()
        .chain(&file.layer_data.attributes.other)
        .filter_map(|(key, value)| match value {
            AttributeValue::Text(text) => {
                // The format's text is UTF-8; the crate shows it as Latin-1.
                Some((key.to_string(), String::from_utf8_lossy(text.as_slice()).into_owned()))
            }
            _ => None,
        })
        .collect();
    for (key, value) in texts {
        layers.metadata.set(key.strip_prefix("text.").unwrap_or(&key), value);
    }
    Ok(layers)
}

/// Takes the colour and alpha out of the channels.
fn take_color(channels: &mut Channels, width: u32, height: u32) -> Result<Image, ImageError> {
    let complete = |prefix: &str| {
        ["R", "G", "B"].iter().all(|c| channels.contains_key(&format!("{prefix}{c}")))
    };
    let prefix = std::iter::once(String::new())
        .chain(channels.keys().filter_map(|name| name.strip_suffix('R').map(str::to_owned)))
        .find(|prefix| complete(prefix));
    let (names, alpha) = match &prefix {
        Some(p) => ([format!("{p}R"), format!("{p}G"), format!("{p}B")], format!("{p}A")),
        None if channels.contains_key("Y") => (["Y"; 3].map(str::to_owned), "A".to_owned()),
        None => {
            let list: Vec<&str> = channels.keys().take(20).map(String::as_str).collect();
            return Err(ImageError::unsupported(
                format!("the EXR file has no colour, its channels are: {}", list.join(", ")),
                "save the channels R, G and B, or Y",
            ));
        }
    };
    let alpha = channels.remove(&alpha);
    let mut image = Image::new(width, height, [0.0, 0.0, 0.0, 1.0], Encoding::Raw)?;
    image.has_alpha = alpha.is_some();
    for (i, samples) in names.iter().map(|n| channels.get(n)).chain([alpha.as_ref()]).enumerate() {
        let values = samples.into_iter().flat_map(FlatSamples::values_as_f32);
        for (cell, value) in image.pixels_mut().iter_mut().filter_map(|p| p.get_mut(i)).zip(values)
        {
            *cell = value;
        }
    }
    for name in names {
        channels.remove(&name);
    }
    Ok(image)
}

/// Turns the channels that are left into layers.
fn add_layers(layers: &mut Layers, mut channels: Channels) -> Result<(), ImageError> {
    while let Some(name) = channels.keys().next().cloned() {
        let Some(samples) = channels.remove(&name) else { break };
        let (data, name) = match take_triple(&mut channels, &name, &samples) {
            Some((data, base)) => (data, base),
            None => match samples {
                FlatSamples::U32(ids) => (LayerData::Id(ids), name.as_str()),
                floats => {
                    let base = if name == "Z" { "depth" } else { name.as_str() };
                    (LayerData::Scalar(floats.values_as_f32().collect()), base)
                }
            },
        };
        layers.push(&free_name(layers, name), data)?;
    }
    Ok(())
}

/// The layer that `name` and its two companions make, with the name before the dot. `name` is the first of its triple
/// in the alphabet: `.B` for colours and `.X` for vectors.
fn take_triple<'a>(
    channels: &mut Channels,
    name: &'a str,
    samples: &FlatSamples,
) -> Option<(LayerData, &'a str)> {
    let (base, order, color) = match name.rsplit_once('.')? {
        (base, "X") => (base, ["Y", "Z"], false),
        (base, "B") => (base, ["G", "R"], true),
        _ => return None,
    };
    let [second, third] = order.map(|c| format!("{base}.{c}"));
    if !channels.contains_key(&third) {
        return None;
    }
    let second = channels.remove(&second)?;
    let third = channels.remove(&third)?;
    let triples = samples
        .values_as_f32()
        .zip(second.values_as_f32())
        .zip(third.values_as_f32())
        .map(|((a, b), c)| if color { [c, b, a] } else { [a, b, c] })
        .collect();
    Some((if color { LayerData::Color(triples) } else { LayerData::Vector(triples) }, base))
}

/// A name that [`Layers::push`] accepts: foreign characters become `_`, a number tells equal ones apart.
fn free_name(layers: &Layers, name: &str) -> String {
    let mut plain: String =
        name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    if plain.is_empty() || ["R", "G", "B", "A", "Z"].contains(&plain.as_str()) {
        plain.push('_');
    }
    (1..)
        .map(|n| if n == 1 { plain.clone() } else { format!("{plain}_{n}") })
        .find(|candidate| layers.get(candidate).is_none())
        .unwrap_or(plain)
}
