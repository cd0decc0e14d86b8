// SPDX-License-Identifier: MIT OR Apache-2.0
//! Picture buffers, files, tone curves and comparison: all that Dioptric knows of pictures, and nothing of scenes.
//!
//! Bytes come in through [`decode()`], linear light becomes shown values through [`Develop`] alone, and [`encode()`]
//! gives the bytes of a file. Nothing here reads or writes files, prints, or panics on any input.
#![forbid(unsafe_code)]

pub mod buffer;
pub mod compare;
pub mod decode;
pub mod develop;
pub mod encode;
pub mod error;
pub mod font;
pub mod grid;
pub mod names;
pub mod ramp;
pub mod transfer;

pub use buffer::{Image, Layer, LayerData, Layers, Metadata};
pub use compare::{Comparison, Flip, compare, flip, side_by_side};
pub use decode::{READABLE, decode, decode_exr};
pub use develop::{Develop, Tone};
pub use encode::{Depth, EncodeOptions, FileFormat, encode};
pub use error::{ErrorKind, ImageError};
pub use grid::draw_grid;
pub use ramp::false_colour;
pub use transfer::{Encoding, srgb_table};
