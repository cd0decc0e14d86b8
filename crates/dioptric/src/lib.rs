// SPDX-License-Identifier: MIT OR Apache-2.0
//! Dioptric as a library: build a scene in code or read one from a text, cast rays into it, render
//! it to memory, ask a pixel why it has its colour.
//!
//! This crate only gathers the others under one name. The way of the data is theirs:
//!
//! 1. [`formats`] read a text into a [`scene::Description`] (or a program builds one),
//! 2. [`render`] compiles it into an immutable scene and renders that into a film,
//! 3. [`image`] develops the film's linear light and writes pictures.
//!
//! [`geometry`] is what a ray can hit; [`math`] the deterministic functions below it all. Nothing
//! here prints, ends the process, or uses a thread pool that it was not given. The folder
//! `examples` of this crate has one program a use.

#![forbid(unsafe_code)]

mod builder;

pub use builder::{BuildError, SceneBuilder};
pub use dioptric_denoise as denoise;
pub use dioptric_formats as formats;
pub use dioptric_geometry as geometry;
pub use dioptric_image as image;
pub use dioptric_math as math;
pub use dioptric_meshes as meshes;
pub use dioptric_render as render;
pub use dioptric_scene as scene;

/// The version of this crate, as it is written into the pictures' metadata.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");
