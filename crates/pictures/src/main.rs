// SPDX-License-Identifier: MIT OR Apache-2.0
//! Makes the pictures that the scenes show, out of nothing but formulas and fixed seeds.
//!
//! `cargo run --release -p dioptric-pictures` writes them into `scenes/pictures`, or into the folder that is given:
//! the same bytes on every machine. They are part of the project and have its licence.
#![forbid(unsafe_code)]

mod football;
mod night_sky;
mod noise;
mod planet;
#[cfg(test)]
mod tests;

use dioptric_image::{EncodeOptions, FileFormat, Image, ImageError, Layers, encode};
use std::path::PathBuf;
use std::process::ExitCode;

/// A picture: its file's name, its size, and what makes it at any size.
struct Picture {
    name: &'static str,
    size: (u32, u32),
    make: fn(u32, u32) -> Result<Image, ImageError>,
}

const PICTURES: [Picture; 4] = [
    Picture { name: "night-sky.png", size: (2048, 1024), make: night_sky::night_sky },
    Picture { name: "football.png", size: (1024, 1024), make: football::football_asin },
    Picture { name: "football-lonlat.png", size: (2048, 1024), make: football::football_lonlat },
    Picture { name: "planet.png", size: (2048, 1024), make: planet::planet },
];

fn main() -> ExitCode {
    let folder =
        std::env::args_os().nth(1).map_or_else(|| PathBuf::from("scenes/pictures"), PathBuf::from);
    for Picture { name, size: (width, height), make } in PICTURES {
        let path = folder.join(name);
        let bytes =
            make(width, height).and_then(|image| png(image, name)).map_err(|e| e.to_string());
        if let Err(message) =
            bytes.and_then(|bytes| std::fs::write(&path, bytes).map_err(|e| e.to_string()))
        {
            eprintln!("{}: {message}", path.display());
            return ExitCode::FAILURE;
        }
        println!("{}", path.display());
    }
    ExitCode::SUCCESS
}

/// The picture as a PNG file that says where it comes from.
fn png(image: Image, name: &str) -> Result<Vec<u8>, ImageError> {
    let mut layers = Layers::from(image);
    layers.metadata.set("Title", name.trim_end_matches(".png"));
    layers.metadata.set("Software", "dioptric-pictures");
    layers.metadata.set("Copyright", "The Dioptric developers, MIT OR Apache-2.0");
    encode(&layers, FileFormat::Png, &EncodeOptions::default())
}
