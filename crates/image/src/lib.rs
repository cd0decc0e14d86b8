// SPDX-License-Identifier: MIT OR Apache-2.0
//! Picture buffers, files, tone curves and comparison: all that Dioptric knows of pictures, and nothing of scenes.
//!
//! Bytes come in through [`decode()`], linear light becomes shown values through [`Develop`] alone, and [`encode()`]
//! gives the bytes of a file. Nothing here reads or writes files, prints, or panics on any input.
#![forbid(unsafe_code)]

pub mod buffer;
pub mod decode;
pub mod develop;
pub mod encode;
pub mod error;
pub mod names;
pub mod transfer;

pub use buffer::{Image, Layer, LayerData, Layers, Metadata};
pub use decode::{READABLE, decode, decode_exr};
pub use develop::{Develop, Tone};
pub use encode::{Depth, EncodeOptions, FileFormat, encode};
pub use error::{ErrorKind, ImageError};
pub use transfer::{Encoding, srgb_table};
