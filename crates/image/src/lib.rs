// SPDX-License-Identifier: MIT OR Apache-2.0
//! Picture buffers, files, tone curves and comparison: all that Dioptric knows of pictures, and nothing of scenes.
//!
//! Bytes come in through [`decode()`], linear light becomes shown values through [`Develop`] alone, and [`encode()`]
//! gives the bytes of a file. Nothing here reads or writes files, prints, or panics on any input.
//!
//! ```
//! use dioptric_image::*;
//!
//! # fn main() -> Result<(), ImageError> {
//! // Linear light, as a renderer makes it, with a layer of depths and a line of text.
//! let light = Image::from_fn(64, 32, Encoding::Raw, |x, y| [x as f32 / 64.0, y as f32 / 32.0, 2.0])?;
//! let mut layers = Layers::from(light);
//! layers.push("depth", LayerData::Scalar(vec![1.0; 64 * 32]))?;
//! layers.metadata.set("Software", "Dioptric");
//!
//! let develop = Develop { exposure: 0.5, tone: Tone::Filmic, encoding: Encoding::Srgb };
//! let png = encode(&layers, FileFormat::Png, &EncodeOptions { develop, ..Default::default() })?;
//! let back = decode(&png, "gradient.png", 1 << 20)?;
//! assert_eq!(compare(&back, &develop.picture(&layers.picture), 0.5 / 255.0)?.share_above, 0.0);
//!
//! let exr = encode(&layers, FileFormat::Exr, &EncodeOptions::default())?;
//! assert_eq!(decode_exr(&exr, 1 << 20)?, layers);
//! # Ok(())
//! # }
//! ```
#![forbid(unsafe_code)]

pub mod buffer;
mod bytes;
pub mod compare;
pub mod decode;
pub mod develop;
pub mod encode;
pub mod error;
pub mod font;
pub mod grid;
pub mod names;
pub mod ramp;
pub mod stored;
pub mod tone;
pub mod transfer;

pub use buffer::{Image, Layer, LayerData, Layers, Metadata};
pub use compare::{Comparison, Flip, compare, flip, side_by_side};
pub use decode::{READABLE, decode, decode_exr, decode_stored};
pub use develop::Develop;
pub use encode::{Depth, EncodeOptions, FileFormat, encode};
pub use error::{ErrorKind, ImageError};
pub use grid::draw_grid;
pub use ramp::false_colour;
pub use stored::{Stored, Values};
pub use tone::Tone;
pub use transfer::{Encoding, srgb_table};
