// SPDX-License-Identifier: MIT OR Apache-2.0
//! Watches a picture being made, and stops it: what is there by then is a picture, too.
//!
//!     cargo run --example cancel

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use dioptric::SceneBuilder;
use dioptric::image::{EncodeOptions, FileFormat, encode};
use dioptric::render::job::{Control, Progress};
use dioptric::render::picture;
use dioptric::render::region::Region;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut scene = SceneBuilder::new();
    scene.add("render", &[("size", [320.0, 240.0].into())])?;
    scene.add("camera", &[("eye", [0.0, 0.0, 4.0].into())])?;
    scene.add("light", &[("position", [2.0, 3.0, 4.0].into())])?;
    scene.add("sphere", &[])?;
    let scene = scene.compile()?;

    let cancel = Arc::new(AtomicBool::new(false));
    let stop = cancel.clone();
    // Called after every tile, by one thread at a time.
    let watch = move |progress: &Progress| {
        println!("{} of {} pixels", progress.done, progress.total);
        if 2 * progress.done >= progress.total {
            stop.store(true, Ordering::Relaxed);
        }
    };
    let control = Control { cancel, on_progress: Some(&watch), ..Control::default() };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    let film = picture::render(&scene, Region::full(scene.settings.size), &pool, &control)
        .map_err(|e| e.message)?;

    assert!(!film.finished());
    // Pixels that were not reached are transparent.
    let layers = film.to_layers(true)?;
    let png = encode(&layers, FileFormat::Png, &EncodeOptions::default())?;
    println!("stopped; {} bytes of PNG", png.len());
    Ok(())
}
