// SPDX-License-Identifier: MIT OR Apache-2.0
//! `render`: from a scene file to a picture file.

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use dioptric::formats::ParamInfo;
use dioptric::image::{
    Depth, EncodeOptions, Encoding, FileFormat, Image, Layers, draw_grid, encode, ramp,
};
use dioptric::render::job::Control;
use dioptric::render::region::Region;
use dioptric::render::scene::Scene;
use dioptric::render::{Film, compile, picture};
use serde_json::Value;

use super::failure::Failure;
use super::frames::{Frames, frame_name};
use super::output::Output;
use super::picture_options::PictureOptions;
use super::progress::{Bar, Interrupt};
use super::scene_options::{ReadScene, SceneOptions};
use super::stats::{self, Stats};
use super::terminal::{Terminal, note};

/// Renders a scene to a picture file.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  dioptric render scenes/space.star\n  \
    dioptric render scene.star -o picture.exr --layers --samples 64\n  \
    dioptric render scene.star --set smooth=False --size 320x240 --stats stats.json\n  \
    dioptric render spin.star --frames 1-25 -o frames/spin_####.png")]
pub struct RenderArgs {
    #[command(flatten)]
    scene: SceneOptions,
    /// The picture: .png, .jpg, .exr or .hdr; - for standard output.
    /// Without it, the scene's name with .png in the present folder.
    #[arg(short, long, value_name = "FILE")]
    output: Option<String>,
    /// The format of a picture on standard output: png, jpg, exr or hdr.
    #[arg(long, value_name = "FORMAT", default_value = "png")]
    to: String,
    /// Bits of a channel in PNG: 8 or 16.
    #[arg(long, value_name = "N", default_value = "8", value_parser = ["8", "16"])]
    bits: String,
    /// Quality of JPEG.
    #[arg(long, value_name = "Q", default_value_t = 92, value_parser = clap::value_parser!(u8).range(1..=100))]
    quality: u8,
    /// Draws pixel coordinates over the picture, so that X,Y for why can be read off.
    #[arg(long)]
    grid: bool,
    /// Writes depth, normal, albedo, object and samples as further layers; needs .exr.
    #[arg(long)]
    layers: bool,
    /// Writes where the samples went: a picture in false colours, white for the most.
    #[arg(long, value_name = "FILE")]
    sample_map: Option<String>,
    /// Renders an animation, one picture a frame; #### in FILE becomes the number.
    #[arg(long, value_name = "A-B", value_parser = Frames::parse)]
    frames: Option<Frames>,
    /// Writes times, rays, memory and settings as JSON.
    #[arg(long, value_name = "FILE.json")]
    stats: Option<String>,
    /// Says nothing but warnings and errors.
    #[arg(short, long)]
    quiet: bool,
    #[command(flatten)]
    picture: PictureOptions,
}

/// One picture to be made.
struct Task {
    frame: i32,
    output: Output,
    sample_map: Option<Output>,
}

/// Renders all pictures that were asked for.
pub fn run(args: &RenderArgs, terminal: &Terminal) -> Result<(), Failure> {
    let interrupt = Interrupt::listen();
    // Everything that can be wrong without the scene is found before hours are spent on it.
    let format = args.format()?;
    let options = compile::Options {
        max_mesh_bytes: args.scene.max_mesh_bytes(),
        ..args.picture.compile_options(args.scene.camera(), args.scene.max_objects())?
    };
    let tasks = args.tasks()?;
    let stats_file = args.stats.as_deref().map(Output::new).transpose()?;
    let pool = args.picture.pool()?;
    let mut all_stats = Vec::new();
    let mut stopped = false;
    for task in &tasks {
        let scene_options = args.scene.at_frame(task.frame);
        let started = Instant::now();
        let ReadScene { reading, loader } = scene_options.read(terminal)?;
        let read = started.elapsed().as_secs_f64();
        let (description, params) = (Arc::new(reading.description), reading.params);

        let started = Instant::now();
        // In the pool, so that trees are built by all threads.
        let (scene, warnings) = pool
            .install(|| compile::compile(&description, &loader, &options))
            .map_err(|errors| Failure::Scene(errors, description.sources.clone()))?;
        let compiled = started.elapsed().as_secs_f64();
        terminal.complain(&warnings, &description.sources);
        let region = args.picture.region(scene.settings.size)?;

        let started = Instant::now();
        let bar = Bar::new(terminal, &task.output.to_string());
        let show = |progress: &dioptric::render::job::Progress| bar.update(progress);
        let control = Control {
            layers: args.layers,
            cancel: interrupt.flag.clone(),
            on_progress: Some(&show),
        };
        interrupt.busy(true);
        let film = picture::render(&scene, region, &pool, &control);
        bar.finish();
        let film = film.map_err(|e| Failure::Scene(vec![e], description.sources.clone()))?;
        let stats = Stats {
            read,
            compile: compiled,
            render: started.elapsed().as_secs_f64(),
            rays: film.rays,
            samples: film.samples(),
            threads: pool.current_num_threads(),
            settings: stats::settings(&scene.settings, &scene.develop, region),
            finished: film.finished(),
        };
        let bytes = args.encode(&scene, &film, format, &stats.settings, &params, task)?;
        task.output.write(&bytes)?;
        if let Some(output) = &task.sample_map {
            output.write(&sample_map(&film, output)?)?;
        }
        interrupt.busy(false);
        stopped = !stats.finished;
        if stopped {
            note(&format!("{}: unfinished, stopped at {}\n", task.output, done(&film, &scene)));
        }
        if !args.quiet {
            note(&format!(
                "{}: {} x {}, {}\n",
                task.output,
                region.width,
                region.height,
                stats.line()
            ));
        }
        all_stats.push(stats.json());
        if stopped {
            break;
        }
    }
    if let Some(file) = stats_file {
        let json =
            if args.frames.is_some() { Value::Array(all_stats) } else { all_stats.swap_remove(0) };
        file.write(format!("{json:#}\n").as_bytes())?;
    }
    if stopped || interrupt.is_set() { Err(Failure::Interrupted) } else { Ok(()) }
}

/// How much of a stopped picture there is.
fn done(film: &Film, scene: &Scene) -> String {
    let finished = film.pixels().iter().filter(|p| p.is_finished()).count();
    let share = 100.0 * finished as f64 / film.pixels().len().max(1) as f64;
    let mean = film.samples() as f64 / film.pixels().len().max(1) as f64;
    format!("{share:.1} % of the pixels, {mean:.2} of {} samples a pixel", scene.settings.samples)
}

impl RenderArgs {
    fn format(&self) -> Result<FileFormat, Failure> {
        let name = match self.output.as_deref() {
            Some("-") => format!("stdout.{}", self.to),
            Some(name) => name.to_string(),
            None => "default.png".into(),
        };
        let format = FileFormat::from_path(Path::new(&name))
            .map_err(|e| Failure::usage(e.message, e.help))?;
        if self.layers && format != FileFormat::Exr {
            return Err(Failure::usage("only .exr files have layers", "write -o FILE.exr"));
        }
        if self.grid && format.is_linear() {
            let message = "--grid is drawn over a developed picture, not into linear light";
            return Err(Failure::usage(message, "write -o FILE.png"));
        }
        if self.bits == "16" && format != FileFormat::Png {
            return Err(Failure::usage(
                "only .png files have 16 bits",
                "write -o FILE.png, or .exr for floats",
            ));
        }
        if let Some(map) = self.sample_map.as_deref().filter(|name| *name != "-") {
            FileFormat::from_path(Path::new(map)).map_err(|e| Failure::usage(e.message, e.help))?;
        }
        Ok(format)
    }

    fn tasks(&self) -> Result<Vec<Task>, Failure> {
        let name = self.output.clone().unwrap_or_else(|| format!("{}.png", self.scene.stem()));
        let Some(frames) = self.frames else {
            let sample_map = self.sample_map.as_deref().map(Output::new).transpose()?;
            return Ok(vec![Task {
                frame: self.scene.frame,
                output: Output::new(&name)?,
                sample_map,
            }]);
        };
        if name == "-" || self.scene.scene == "-" {
            let message = "an animation is not read from or written to a standard stream";
            return Err(Failure::usage(message, "name files, such as -o frame_####.png"));
        }
        frames
            .iter()
            .map(|frame| {
                let map =
                    self.sample_map.as_deref().map(|name| Output::new(&frame_name(name, frame)));
                let output = Output::new(&frame_name(&name, frame))?;
                Ok(Task { frame, output, sample_map: map.transpose()? })
            })
            .collect()
    }

    /// The bytes of the picture's file.
    fn encode(
        &self,
        scene: &Scene,
        film: &Film,
        format: FileFormat,
        settings: &Value,
        params: &[ParamInfo],
        task: &Task,
    ) -> Result<Vec<u8>, Failure> {
        let wrong = |e| Failure::image(&task.output.to_string(), &e);
        // An unfinished picture is transparent where there is nothing yet.
        let mut layers = film.to_layers(!film.finished()).map_err(wrong)?;
        if self.grid {
            let Region { x, y, .. } = film.region();
            layers.picture = scene.develop.picture(&layers.picture);
            draw_grid(&mut layers.picture, x, y, 0);
        }
        let text = &mut layers.metadata;
        text.set("Software", format!("dioptric {}", dioptric::VERSION));
        text.set("Settings", settings.to_string());
        let set: Vec<String> = params
            .iter()
            .filter(|p| p.value != p.default)
            .map(|p| format!("{} = {}", p.name, super::info::written(&p.value)))
            .collect();
        if !set.is_empty() {
            text.set("Params", set.join("; "));
        }
        if self.frames.is_some() {
            text.set("Frame", task.frame.to_string());
        }
        if !film.finished() {
            text.set("Unfinished", format!("stopped at {}", done(film, scene)));
        }
        let depth = if self.bits == "16" { Depth::Sixteen } else { Depth::Eight };
        let options = EncodeOptions { develop: scene.develop, depth, quality: self.quality };
        encode(&layers, format, &options).map_err(wrong)
    }
}

/// Samples of each pixel in false colours, the most of any pixel at the upper end.
fn sample_map(film: &Film, output: &Output) -> Result<Vec<u8>, Failure> {
    let wrong = |e| Failure::image(&output.to_string(), &e);
    let most = film.pixels().iter().map(|p| p.count()).max().unwrap_or(1).max(1);
    let colors = film.pixels().iter().map(|p| {
        let [r, g, b] = ramp::false_colour(f64::from(p.count()) / f64::from(most));
        [r, g, b, 1.0]
    });
    let Region { width, height, .. } = film.region();
    let picture =
        Image::from_pixels(width, height, colors.collect(), Encoding::Srgb).map_err(wrong)?;
    let format = match output {
        Output::Stdout => FileFormat::Png,
        Output::File(path) => {
            FileFormat::from_path(path).map_err(|e| Failure::usage(e.message, e.help))?
        }
    };
    encode(&Layers::from(picture), format, &EncodeOptions::default()).map_err(wrong)
}
