// SPDX-License-Identifier: MIT OR Apache-2.0
//! OpenEXR: one part, rows from the top in blocks of 16, ZIP compression, 32 bits a value.
//!
//! Written here by the published layout ("OpenEXR File Layout", openexr.com) and not by crate `exr`, which keeps
//! attributes in a hash map: their order, and so the file's bytes, would differ from run to run.

use super::plain_key;
use crate::buffer::{LayerData, Layers};
use crate::error::ImageError;

const ROWS_PER_BLOCK: usize = 16;

/// One channel: its name in the file and the bits of a pixel's value.
struct Channel<'a> {
    name: String,
    is_id: bool,
    bits: Box<dyn Fn(usize) -> u32 + 'a>,
}

pub(super) fn encode(layers: &Layers) -> Result<Vec<u8>, ImageError> {
    let picture = layers.picture.clone().into_linear();
    let (width, height) = (picture.width(), picture.height());
    let too_wide = || {
        ImageError::invalid(
            format!("an EXR cannot be {width} x {height}"),
            "write a smaller picture",
        )
    };
    let right = i32::try_from(width - 1).map_err(|_| too_wide())?;
    let bottom = i32::try_from(height - 1).map_err(|_| too_wide())?;

    let pixels = picture.pixels();
    let colors = if picture.has_alpha { &["R", "G", "B", "A"][..] } else { &["R", "G", "B"][..] };
    let mut channels: Vec<Channel> = Vec::new();
    for (component, name) in colors.iter().enumerate() {
        channels.push(float_channel(name, move |i| {
            pixels.get(i).and_then(|p| p.get(component)).copied()
        }));
    }
    for layer in layers.extra() {
        add_layer(&mut channels, &layer.name, &layer.data);
    }
    // The format asks for channels in the order of their names.
    channels.sort_by(|a, b| a.name.cmp(&b.name));

    let mut out = header(layers, &channels, right, bottom);
    let blocks = (height as usize).div_ceil(ROWS_PER_BLOCK);
    let table = out.len();
    out.resize(table + 8 * blocks, 0);
    for block in 0..blocks {
        let offset = (out.len() as u64).to_le_bytes();
        if let Some(entry) = out.get_mut(table + 8 * block..table + 8 * block + 8) {
            entry.copy_from_slice(&offset);
        }
        let first = block * ROWS_PER_BLOCK;
        let last = (first + ROWS_PER_BLOCK).min(height as usize);
        let data = compress(&block_bytes(&channels, width as usize, first..last));
        out.extend((first as i32).to_le_bytes());
        out.extend((data.len() as i32).to_le_bytes());
        out.extend(data);
    }
    Ok(out)
}

fn float_channel<'a>(name: &str, value: impl Fn(usize) -> Option<f32> + 'a) -> Channel<'a> {
    Channel {
        name: name.to_owned(),
        is_id: false,
        bits: Box::new(move |i| value(i).unwrap_or(0.0).to_bits()),
    }
}

fn add_layer<'a>(channels: &mut Vec<Channel<'a>>, name: &str, data: &'a LayerData) {
    let mut triple = |values: &'a [[f32; 3]], parts: [&str; 3]| {
        for (component, part) in parts.iter().enumerate() {
            let value = move |i: usize| values.get(i).and_then(|p| p.get(component)).copied();
            channels.push(float_channel(&format!("{name}.{part}"), value));
        }
    };
    match data {
        LayerData::Vector(values) => triple(values, ["X", "Y", "Z"]),
        LayerData::Color(values) => triple(values, ["R", "G", "B"]),
        LayerData::Scalar(values) => {
            // The format's own name for the depth.
            let name = if name == "depth" { "Z" } else { name };
            channels.push(float_channel(name, |i| values.get(i).copied()));
        }
        LayerData::Id(values) => channels.push(Channel {
            name: name.to_owned(),
            is_id: true,
            bits: Box::new(|i| values.get(i).copied().unwrap_or(0)),
        }),
    }
}

/// Magic number, version and attributes, up to the table of offsets.
fn header(layers: &Layers, channels: &[Channel], right: i32, bottom: i32) -> Vec<u8> {
    let mut list = Vec::new();
    for channel in channels {
        list.extend(channel.name.as_bytes());
        list.push(0);
        list.extend(if channel.is_id { 0_i32 } else { 2 }.to_le_bytes()); // UINT or FLOAT
        list.extend([0; 4]); // not "perceptually linear", three reserved bytes
        list.extend([1_i32, 1].map(i32::to_le_bytes).concat()); // no subsampling
    }
    list.push(0);
    let window = [0, 0, right, bottom].map(i32::to_le_bytes).concat();
    let one = 1.0_f32.to_le_bytes();

    // 0x400: names may be longer than 31 bytes.
    let mut out = [0x0131_2f76_u32.to_le_bytes(), (2_u32 | 0x400).to_le_bytes()].concat();
    attribute(&mut out, "channels", "chlist", &list);
    attribute(&mut out, "compression", "compression", &[3]); // ZIP
    attribute(&mut out, "dataWindow", "box2i", &window);
    attribute(&mut out, "displayWindow", "box2i", &window);
    attribute(&mut out, "lineOrder", "lineOrder", &[0]);
    attribute(&mut out, "pixelAspectRatio", "float", &one);
    attribute(&mut out, "screenWindowCenter", "v2f", &[0; 8]);
    attribute(&mut out, "screenWindowWidth", "float", &one);
    for (key, value) in &layers.metadata.0 {
        // A dot keeps clear of the names that the format gives a meaning of another type.
        let key = plain_key(key);
        let key = if key.contains('.') { key } else { format!("text.{key}") };
        attribute(&mut out, &key, "string", value.as_bytes());
    }
    out.push(0);
    out
}

fn attribute(out: &mut Vec<u8>, name: &str, kind: &str, value: &[u8]) {
    out.extend(name.as_bytes());
    out.push(0);
    out.extend(kind.as_bytes());
    out.push(0);
    out.extend((value.len() as i32).to_le_bytes());
    out.extend(value);
}

/// The values of some rows: row by row, in each the channels in order.
fn block_bytes(channels: &[Channel], width: usize, rows: std::ops::Range<usize>) -> Vec<u8> {
    let mut raw = Vec::with_capacity(rows.len() * width * channels.len() * 4);
    for row in rows {
        for channel in channels {
            raw.extend(
                (row * width..(row + 1) * width).flat_map(|i| (channel.bits)(i).to_le_bytes()),
            );
        }
    }
    raw
}

/// ZIP as OpenEXR has it: bytes of even and odd places apart, differences of neighbours, then zlib; the bytes as they
/// were where that is not shorter.
fn compress(raw: &[u8]) -> Vec<u8> {
    let mut bytes: Vec<u8> =
        raw.iter().step_by(2).chain(raw.iter().skip(1).step_by(2)).copied().collect();
    let mut before = 128_u8; // so that the first byte stays itself: b - 128 + 128
    for byte in &mut bytes {
        let here = *byte;
        *byte = here.wrapping_sub(before).wrapping_add(128);
        before = here;
    }
    let packed = miniz_oxide::deflate::compress_to_vec_zlib(&bytes, 4);
    if packed.len() < raw.len() { packed } else { raw.to_vec() }
}
