// SPDX-License-Identifier: MIT OR Apache-2.0
//! Radiance HDR (RGBE), flat or with either kind of run lengths.
//!
//! Ward, "Real Pixels", Graphics Gems II, 1991, II.5, and the file format notes of Radiance. A component is
//! `m * 2^(e - 136)`, so that powers of two are exact; `EXPOSURE` lines are undone.

use super::check_size;
use crate::buffer::Image;
use crate::error::ImageError;
use crate::transfer::Encoding;

type Rgbe = [u8; 4];

pub(super) fn decode(bytes: &[u8], max_pixels: u64) -> Result<Image, ImageError> {
    let mut input = bytes;
    let exposure = read_header(&mut input)?;
    let (width, height, down) = read_resolution(&mut input, max_pixels)?;
    let mut pixels = Vec::new();
    let mut row: Vec<Rgbe> = Vec::new();
    for _ in 0..height {
        row.clear();
        read_row(&mut input, width as usize, &mut row)
            .ok_or_else(|| ImageError::corrupt("HDR", "its rows break off"))?;
        pixels.extend(row.iter().map(|p| light(*p, exposure)));
    }
    if !down {
        let rows: Vec<_> = pixels.chunks_exact(width as usize).rev().flatten().copied().collect();
        pixels = rows;
    }
    Image::from_pixels(width, height, pixels, Encoding::Raw)
}

/// Reads up to the empty line; gives the product of all `EXPOSURE` values.
fn read_header(input: &mut &[u8]) -> Result<f64, ImageError> {
    let mut exposure = 1.0;
    loop {
        let line = read_line(input)
            .ok_or_else(|| ImageError::corrupt("HDR", "its header does not end"))?;
        if line.is_empty() {
            return Ok(exposure);
        }
        if let Some(format) = line.strip_prefix("FORMAT=")
            && format.trim() != "32-bit_rle_rgbe"
        {
            return Err(ImageError::unsupported(
                format!("the HDR file has the pixel format {}", format.trim()),
                "save it as 32-bit_rle_rgbe",
            ));
        }
        if let Some(factor) =
            line.strip_prefix("EXPOSURE=").and_then(|v| v.trim().parse::<f64>().ok())
            && factor.is_finite()
            && factor > 0.0
        {
            exposure *= factor;
        }
    }
}

/// The size and whether rows go down, from a line such as `-Y 512 +X 768`.
fn read_resolution(input: &mut &[u8], max_pixels: u64) -> Result<(u32, u32, bool), ImageError> {
    let line = read_line(input).ok_or_else(|| ImageError::corrupt("HDR", "it has no size"))?;
    let words: Vec<&str> = line.split_ascii_whitespace().collect();
    match words[..] {
        [y @ ("-Y" | "+Y"), height, "+X", width] => {
            let number = |s: &str| {
                s.parse().map_err(|_| ImageError::corrupt("HDR", format!("\"{s}\" is no size")))
            };
            let (width, height) = check_size(number(width)?, number(height)?, max_pixels)?;
            Ok((width, height, y == "-Y"))
        }
        _ => Err(ImageError::unsupported(
            "the HDR file has rows in an order that is not read",
            "save it with rows from the top, \"-Y height +X width\"",
        )),
    }
}

/// The next line without its end; none where the input or a sensible length ends before.
fn read_line(input: &mut &[u8]) -> Option<String> {
    let end = input.iter().take(4096).position(|b| *b == b'\n')?;
    let (line, rest) = input.split_at_checked(end)?;
    *input = rest.get(1..)?;
    Some(String::from_utf8_lossy(line).trim_end_matches('\r').to_owned())
}

/// Reads one row of `width` pixels in whichever form it has.
fn read_row(input: &mut &[u8], width: usize, row: &mut Vec<Rgbe>) -> Option<()> {
    let first = take_pixel(input)?;
    if first[0] == 2 && first[1] == 2 && first[2] < 128 && (8..32768).contains(&width) {
        return (usize::from(u16::from_be_bytes([first[2], first[3]])) == width)
            .then(|| read_planes(input, width, row))
            .flatten();
    }
    // The old form: a pixel (1, 1, 1, n) repeats the one before n times, the next such pixel n * 256 times.
    let (mut pixel, mut shift) = (first, 0);
    loop {
        if let [1, 1, 1, n] = pixel {
            let last = *row.last()?;
            let count = usize::from(n).checked_shl(shift)?;
            if shift > 16 || count > width - row.len() {
                return None;
            }
            row.extend(std::iter::repeat_n(last, count));
            shift += 8;
        } else {
            row.push(pixel);
            shift = 0;
        }
        if row.len() >= width {
            return Some(());
        }
        pixel = take_pixel(input)?;
    }
}

/// The new form: the four components one after the other, each in runs.
fn read_planes(input: &mut &[u8], width: usize, row: &mut Vec<Rgbe>) -> Option<()> {
    row.resize(width, [0; 4]);
    for component in 0..4 {
        let mut cells = row.iter_mut().filter_map(|p| p.get_mut(component));
        let mut left = width;
        while left > 0 {
            let code = usize::from(take(input)?);
            let (count, run) =
                if code > 128 { (code - 128, Some(take(input)?)) } else { (code, None) };
            if count == 0 || count > left {
                return None;
            }
            for cell in cells.by_ref().take(count) {
                *cell = match run {
                    Some(value) => value,
                    None => take(input)?,
                };
            }
            left -= count;
        }
    }
    Some(())
}

fn take(input: &mut &[u8]) -> Option<u8> {
    let (first, rest) = input.split_first()?;
    *input = rest;
    Some(*first)
}

fn take_pixel(input: &mut &[u8]) -> Option<Rgbe> {
    let (first, rest) = input.split_first_chunk::<4>()?;
    *input = rest;
    Some(*first)
}

/// Linear light of a stored pixel.
fn light([r, g, b, e]: Rgbe, exposure: f64) -> [f32; 4] {
    if e == 0 {
        return [0.0, 0.0, 0.0, 1.0];
    }
    // 2^(e - 136), put together from its bits: exact on every processor.
    let scale = f64::from_bits((u64::from(e) + 1023 - 136) << 52) / exposure;
    let [r, g, b] = [r, g, b].map(|m| (f64::from(m) * scale) as f32);
    [r, g, b, 1.0]
}
