// SPDX-License-Identifier: MIT OR Apache-2.0
//! `why`: all rays behind a pixel, as text or as JSON.

use std::io::Write;
use std::sync::Arc;

use dioptric::render::region::Region;
use dioptric::render::scene::Scene;
use dioptric::render::{compile, why};

use super::failure::Failure;
use super::frames::Frames;
use super::output::Output;
use super::picture_options::PictureOptions;
use super::scene_options::{ReadScene, SceneOptions};
use super::terminal::Terminal;
use super::why_text;

/// Shows why a pixel has its colour: every ray behind it, with all its terms.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  dioptric why scenes/space.star 400,520\n  \
    dioptric why scenes/space.star 400,520 --depth 1\n  \
    dioptric why scenes/space.star 400,520 --integrator path --sample 3\n  dioptric why scenes/space.star 0,0,80,80 --size 80x80 --json -o pixels.jsonl\n\n\
    All options of render are taken; those that change the picture change the explanation, too. --crop \
    does not: X,Y counts from the top left of the full picture. render --grid draws these coordinates.")]
pub struct WhyArgs {
    #[command(flatten)]
    scene: SceneOptions,
    /// The pixel: column and row from the top left; or X,Y,WIDTH,HEIGHT for all pixels of a part.
    #[arg(value_name = "X,Y", value_parser = place, allow_hyphen_values = true)]
    pixels: [u32; 4],
    /// Writes one JSON object a line for each pixel instead of text (see the manual).
    #[arg(long)]
    json: bool,
    /// Folds rays below this depth to their values; 0 keeps only the camera's.
    #[arg(long, value_name = "N", default_value_t = usize::MAX, hide_default_value = true)]
    depth: usize,
    /// Shows the tree of every sample, not one of each way that the rays take; of paths not the brightest only.
    #[arg(long)]
    all: bool,
    /// Shows this sample alone, counted from 1.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..), conflicts_with = "all")]
    sample: Option<u64>,
    /// Writes to a file.
    #[arg(short, long, value_name = "FILE", default_value = "-", hide_default_value = true)]
    output: String,
    #[command(flatten)]
    picture: PictureOptions,
    #[command(flatten)]
    unused: UnusedOptions,
}

/// Options of `render` that change no pixel: taken, so that a command line of `render` becomes one of
/// `why` by its first word, and not used.
#[derive(Debug, clap::Args)]
struct UnusedOptions {
    #[arg(long, hide = true)]
    to: Option<String>,
    #[arg(long, hide = true)]
    bits: Option<String>,
    #[arg(long, hide = true)]
    quality: Option<u8>,
    #[arg(long, hide = true)]
    grid: bool,
    #[arg(long, hide = true)]
    layers: bool,
    #[arg(long, hide = true)]
    sample_map: Option<String>,
    #[arg(long, hide = true)]
    checkpoint: Option<String>,
    #[arg(long, hide = true)]
    checkpoint_every: Option<String>,
    #[arg(long, hide = true)]
    resume: bool,
    #[arg(long, hide = true)]
    sample_range: Option<String>,
    #[arg(long, hide = true, num_args = 0..=1, require_equals = true)]
    denoise: Option<Option<String>>,
    #[arg(long, hide = true)]
    oidn: Option<String>,
    #[arg(long, hide = true)]
    noise: Option<String>,
    #[arg(long, hide = true)]
    budget: Option<String>,
    #[arg(long, hide = true)]
    stats: Option<String>,
    #[arg(short, long, hide = true)]
    quiet: bool,
    /// The first of these frames is explained.
    #[arg(long, hide = true, value_parser = Frames::parse)]
    frames: Option<Frames>,
}

/// Explains the pixels that were asked for.
pub fn run(args: &WhyArgs, terminal: &Terminal) -> Result<(), Failure> {
    let options = compile::Options {
        max_mesh_bytes: args.scene.max_mesh_bytes(),
        ..args.picture.compile_options(args.scene.camera(), args.scene.max_objects())?
    };
    let output = Output::new(&args.output)?;
    let frame = args.unused.frames.map_or(args.scene.frame, |frames| frames.first);
    let ReadScene { reading, loader } = args.scene.at_frame(frame).read(terminal)?;
    let description = Arc::new(reading.description);
    let (scene, warnings) = compile::compile(&description, &loader, &options)
        .map_err(|errors| Failure::Scene(errors, description.sources.clone()))?;
    terminal.complain(&warnings, &description.sources);
    let region = region(args.pixels, scene.settings.size)?;
    args.picture.region(scene.settings.size)?;
    match &output {
        // A pixel at a time, so that a reader sees the first ones at once and memory stays small.
        Output::Stdout => {
            let mut out = std::io::stdout().lock();
            explain(args, &scene, region, terminal.stdout_color, &mut |text| {
                out.write_all(text).and_then(|()| out.flush()).map_err(|e| Failure::output("-", &e))
            })
        }
        Output::File(_) => {
            let mut all = Vec::new();
            explain(args, &scene, region, false, &mut |text| {
                all.extend_from_slice(text);
                Ok(())
            })?;
            output.write(&all)
        }
    }
}

fn explain(
    args: &WhyArgs,
    scene: &Scene,
    region: Region,
    color: bool,
    write: &mut dyn FnMut(&[u8]) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let show = |linear: [f64; 3]| scene.develop.to_u8(linear.map(|c| c as f32));
    let style = why_text::Style {
        swatch: color.then_some(&show as &dyn Fn([f64; 3]) -> [u8; 3]),
        depth: args.depth,
        all: args.all,
        sample: args.sample.map(|n| n as usize),
    };
    for [x, y] in region.pixels() {
        let Some(pixel) = why::explain(scene, x, y) else { continue };
        if let Some(n) = args.sample.filter(|&n| n > pixel.samples.len() as u64) {
            return Err(Failure::usage(
                format!("there is no sample {n} of pixel {x},{y}"),
                format!("it has {} samples", pixel.samples.len()),
            ));
        }
        let json = serde_json::to_value(&pixel).map_err(|e| Failure::File {
            message: format!("cannot write pixel {x},{y} as JSON: {e}"),
            help: "please report this".into(),
        })?;
        let text = if args.json { format!("{json}\n") } else { why_text::pixel(&json, &style) };
        write(text.as_bytes())?;
    }
    Ok(())
}

fn region([x, y, width, height]: [u32; 4], size: [u32; 2]) -> Result<Region, Failure> {
    Region::crop(size, [x, y, width, height]).map_err(|_| {
        let what = if (width, height) == (1, 1) {
            format!("pixel {x},{y}")
        } else {
            format!("part {x},{y},{width},{height}")
        };
        Failure::usage(
            format!("the {what} is not inside the picture of {} x {} pixels", size[0], size[1]),
            format!("columns go from 0 to {}, rows from 0 to {}", size[0] - 1, size[1] - 1),
        )
    })
}

/// `X,Y` or `X,Y,W,H`.
fn place(text: &str) -> Result<[u32; 4], String> {
    let numbers: Option<Vec<u32>> = text.split(',').map(|t| t.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[x, y]) => Ok([x, y, 1, 1]),
        Some(&[x, y, width, height]) => Ok([x, y, width, height]),
        _ => {
            Err("write X,Y or X,Y,WIDTH,HEIGHT in pixels from the top left, such as 400,300".into())
        }
    }
}
