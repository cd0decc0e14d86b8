// SPDX-License-Identifier: MIT OR Apache-2.0
//! Reading pictures from bytes: the format is told by the content, sizes are checked before memory is asked for.
//!
//! Files of 8 and 16 bits give their stored values (`v / 255`, `v / 65535`) tagged
//! [`Encoding::Srgb`](crate::Encoding::Srgb) and not decoded: only the reader of a scene knows whether they are
//! colours or data. Radiance and OpenEXR files give linear light. Profiles and gamma entries in files are not applied.

mod exr;
mod hdr;
mod jpeg;
mod png;
mod raster;

pub use self::exr::decode_exr;

use crate::buffer::Image;
use crate::error::{ErrorKind, ImageError};
use crate::stored::Stored;

/// The extensions of the files that [`decode`] reads.
pub const READABLE: [&str; 7] = ["png", "jpg", "jpeg", "bmp", "tga", "hdr", "exr"];

/// Reads a picture of at most `max_pixels` pixels; needs at most about 64 bytes of memory for each of them.
///
/// # Errors
/// As [`decode_stored`].
pub fn decode(bytes: &[u8], name: &str, max_pixels: u64) -> Result<Image, ImageError> {
    decode_stored(bytes, name, max_pixels)?.into_image()
}

/// Reads a picture of at most `max_pixels` pixels and leaves its values as the file has them.
///
/// `name` is the file's name: it goes into messages, and its extension tells a TGA file, which has no signature.
/// A file's first layer or frame is read.
///
/// # Errors
/// Bytes that are no picture, damaged or truncated files, and pictures above the limit.
pub fn decode_stored(bytes: &[u8], name: &str, max_pixels: u64) -> Result<Stored, ImageError> {
    let picture = if bytes.starts_with(b"\x89PNG\r\n\x1a\n") {
        png::decode(bytes, max_pixels)
    } else if bytes.starts_with(b"\xff\xd8\xff") {
        jpeg::decode(bytes, max_pixels)
    } else if bytes.starts_with(b"BM") {
        raster::decode_bmp(bytes, max_pixels)
    } else if bytes.starts_with(b"#?") {
        hdr::decode(bytes, max_pixels).map(Stored::from)
    } else if bytes.starts_with(&[0x76, 0x2f, 0x31, 0x01]) {
        decode_exr(bytes, max_pixels).map(|layers| layers.picture.into())
    } else if bytes.ends_with(b"TRUEVISION-XFILE.\0") || name.to_ascii_lowercase().ends_with(".tga")
    {
        raster::decode_tga(bytes, max_pixels)
    } else {
        Err(ImageError::unsupported(
            "this is no picture of a known format",
            format!("valid: {}", READABLE.join(", ")),
        ))
    };
    picture.map_err(|e| ImageError { message: format!("{name}: {}", e.message), ..e })
}

/// Refuses a picture above the limit (or of no pixels) before anything is allocated for it.
fn check_size(width: u64, height: u64, max_pixels: u64) -> Result<(u32, u32), ImageError> {
    let pixels = u128::from(width) * u128::from(height);
    if pixels == 0 {
        return Err(ImageError::corrupt("picture", format!("its size is {width} x {height}")));
    }
    match (u32::try_from(width), u32::try_from(height)) {
        (Ok(w), Ok(h)) if pixels <= u128::from(max_pixels) => Ok((w, h)),
        _ => Err(ImageError::new(
            ErrorKind::TooLarge,
            format!(
                "the picture is {width} x {height}, more than the limit of {max_pixels} pixels"
            ),
            "make the picture smaller, or raise the limit",
        )),
    }
}

#[cfg(test)]
mod tests;
