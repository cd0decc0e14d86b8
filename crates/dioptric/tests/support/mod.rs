// SPDX-License-Identifier: MIT OR Apache-2.0
//! What several tests need: a scene from a text, one value of one pixel.

#![allow(dead_code, clippy::disallowed_methods, missing_docs)] // each test uses a part of it

use std::path::PathBuf;
use std::sync::Arc;

use dioptric::formats::{ReadOptions, read, report};
use dioptric::render::compile::{Options, compile};
use dioptric::render::scene::Scene;
use dioptric::render::why::{Pixel, explain};
use dioptric::scene::loader::{FolderLoader, Loader, MemoryLoader};

/// The repository's root.
pub fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Compiles a scene text; panics with the rendered diagnostics where it is wrong.
pub fn scene(text: &str) -> Scene {
    load("test.star", &MemoryLoader::new().with("test.star", text.as_bytes().to_vec()), &[])
}

/// Compiles a scene of the repository's `scenes` folder, with `--set` and overrides of `render`.
pub fn scene_file(name: &str, set: &[(&str, &str)], size: u32) -> Scene {
    let loader = FolderLoader::new(root().join("scenes"));
    let mut options = Options::default();
    options.render.push(("size".into(), dioptric::scene::Value::Vec2([f64::from(size); 2])));
    load_with(name, &loader, set, &options)
}

pub fn load(path: &str, loader: &dyn Loader, set: &[(&str, &str)]) -> Scene {
    load_with(path, loader, set, &Options::default())
}

pub fn load_with(
    path: &str,
    loader: &dyn Loader,
    set: &[(&str, &str)],
    options: &Options,
) -> Scene {
    let read_options = ReadOptions {
        set: set.iter().map(|(k, v)| ((*k).to_string(), (*v).to_string())).collect(),
        ..ReadOptions::default()
    };
    let vocabulary = dioptric::render::vocabulary();
    let reading = read(path, loader, &vocabulary, &read_options)
        .unwrap_or_else(|e| panic!("{}", report::render(&e.diagnostics, &e.sources, false)));
    let description = Arc::new(reading.description);
    compile(&description, loader, options)
        .unwrap_or_else(|e| panic!("{}", report::render(&e, &description.sources, false)))
        .0
}

/// All there is to know of a pixel.
pub fn pixel(scene: &Scene, x: u32, y: u32) -> Pixel {
    explain(scene, x, y).expect("the pixel is in the picture")
}
