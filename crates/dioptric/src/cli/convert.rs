// SPDX-License-Identifier: MIT OR Apache-2.0
//! `convert`: a scene in another format, with everything that its program made written out; a picture
//! in another format.

use std::path::Path;

use dioptric::formats::json;
use dioptric::image::{EncodeOptions, FileFormat, Layers, READABLE, encode};

use super::compare::read_picture;
use super::failure::Failure;
use super::output::Output;
use super::scene_options::SceneOptions;
use super::terminal::Terminal;

/// Writes a scene in its expanded form (JSON), or a picture in another format.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  dioptric convert scene.star scene.json\n  dioptric convert picture.exr picture.png"
)]
pub struct ConvertArgs {
    #[command(flatten)]
    scene: SceneOptions,
    /// The new file: .json for a scene; .png, .jpg, .exr or .hdr for a picture; - writes JSON to
    /// standard output.
    output: String,
}

/// Reads, and writes in the format of the output's name.
pub fn run(args: &ConvertArgs, terminal: &Terminal) -> Result<(), Failure> {
    let extension = |name: &str| {
        Path::new(name).extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default()
    };
    if READABLE.contains(&extension(&args.scene.scene).as_str()) {
        return picture(&args.scene.scene, &args.output);
    }
    if args.output != "-" && extension(&args.output) != "json" {
        return Err(Failure::usage(
            format!("scenes are not written as \"{}\"", args.output),
            "end the name with .json, the expanded form of a scene",
        ));
    }
    let output = Output::new(&args.output)?;
    let scene = args.scene.read(terminal)?;
    output.write(json::write(&scene.reading.description).as_bytes())
}

fn picture(input: &str, output: &str) -> Result<(), Failure> {
    let format =
        FileFormat::from_path(Path::new(output)).map_err(|e| Failure::usage(e.message, e.help))?;
    let file = Output::new(output)?;
    let layers = Layers::from(read_picture(input)?);
    let bytes = encode(&layers, format, &EncodeOptions::default())
        .map_err(|e| Failure::image(output, &e))?;
    file.write(&bytes)
}
