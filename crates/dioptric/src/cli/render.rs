// SPDX-License-Identifier: MIT OR Apache-2.0
//! `render`: from a scene file to a picture file.

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use dioptric::image::{EncodeOptions, Encoding, FileFormat, Image, Layers, encode, ramp};
use dioptric::render::film::FilmPixel;
use dioptric::render::job::Control;
use dioptric::render::parts::{self, Wanted};
use dioptric::render::region::Region;
use dioptric::render::scene::Scene;
use dioptric::render::{Film, compile, picture};
use dioptric::scene::{Diagnostic, Loader, Sources};
use serde_json::{Value, json};

use super::encode::{FileOptions, Labels};
use super::failure::Failure;
use super::frames::{Frames, frame_name};
use super::long::{HashingLoader, Identity, LongOptions, block_size};
use super::output::Output;
use super::picture_options::PictureOptions;
use super::progress::{Bar, Interrupt};
use super::scene_options::{ReadScene, SceneOptions};
use super::stats::{self, Stats};
use super::terminal::{Terminal, note};
use super::until::{self, Made, UntilOptions, Work};

/// Renders a scene to a picture file.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  dioptric render scenes/space.star\n  \
    dioptric render scene.star -o picture.exr --layers --samples 64\n  \
    dioptric render scene.star --set smooth=False --size 320x240 --stats stats.json\n  \
    dioptric render spin.star --frames 1-25 -o frames/spin_####.png\n  \
    dioptric render scene.star --samples 4096 --checkpoint scene.part --resume")]
pub struct RenderArgs {
    #[command(flatten)]
    scene: SceneOptions,
    /// The picture: .png, .jpg, .exr or .hdr; - for standard output.
    /// Without it, the scene's name with .png in the present folder.
    #[arg(short, long, value_name = "FILE")]
    output: Option<String>,
    /// Draws pixel coordinates over the picture, so that X,Y for why can be read off.
    #[arg(long)]
    grid: bool,
    #[command(flatten)]
    file: FileOptions,
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
    #[command(flatten)]
    until: UntilOptions,
    #[command(flatten)]
    long: LongOptions,
}

/// One picture to be made.
struct Task {
    frame: i32,
    /// Nothing where only a part of the samples is made, to be merged.
    output: Option<Output>,
    sample_map: Option<Output>,
}

/// Renders all pictures that were asked for.
pub fn run(args: &RenderArgs, terminal: &Terminal) -> Result<(), Failure> {
    let interrupt = Interrupt::listen();
    // Everything that can be wrong without the scene is found before hours are spent on it.
    let format = args.format()?;
    if args.long.is_used() {
        args.until.without_checkpoint()?;
    }
    let options = compile::Options {
        max_mesh_bytes: args.scene.max_mesh_bytes(),
        ..args.picture.compile_options(args.scene.camera(), args.scene.max_objects())?
    };
    let tasks = args.tasks()?;
    let stats_file = args.stats.as_deref().map(Output::new).transpose()?;
    let denoiser = args.file.denoise.ready()?;
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
        let hashing = HashingLoader::new(&loader);
        let loader: &dyn Loader = if args.long.is_used() { &hashing } else { &loader };
        let (mut scene, warnings) = pool
            .install(|| compile::compile(&description, loader, &options))
            .map_err(|errors| Failure::Scene(errors, description.sources.clone()))?;
        let compiled = started.elapsed().as_secs_f64();
        terminal.complain(&warnings, &description.sources);
        let region = args.picture.region(scene.settings.size)?;
        let settings = stats::settings(&scene.settings, &scene.develop, region);
        let frame = args.frames.map(|_| task.frame);
        let mut labels = Labels::new(settings, scene.develop, &params, frame);

        let name = task.name();
        let started = Instant::now();
        let bar = Bar::new(terminal, &name);
        let film = if args.long.is_used() {
            let identity = Identity::new(
                &description,
                hashing.hash(),
                &scene,
                args.scene.camera(),
                labels.to_json(),
            );
            args.make_part(&scene, region, identity, task, &pool, &bar, &interrupt)
        } else if args.until.is_used() {
            let made = args.until.make(&Work {
                scene: &scene,
                region,
                most: args.picture.max_samples,
                layers: args.file.needs_layers(),
                pool: &pool,
                bar: &bar,
                interrupt: &interrupt,
            });
            bar.finish();
            made.map(|made| {
                scene.settings.samples = made.samples.unwrap_or(scene.settings.samples);
                scene.settings.max_samples = scene.settings.samples;
                labels.settings = stats::settings(&scene.settings, &scene.develop, region);
                args.tell(&name, &made, &mut labels.settings);
                made.film
            })
        } else {
            let show = |progress: &dioptric::render::job::Progress| bar.update(progress);
            let control = Control {
                layers: args.file.needs_layers(),
                cancel: interrupt.flag.clone(),
                on_progress: Some(&show),
            };
            interrupt.busy(true);
            picture::render(&scene, region, &pool, &control).map_err(scene_failure)
        };
        bar.finish();
        let film = film.map_err(|failure| failure.with_sources(&description.sources))?;
        let stats = Stats {
            read,
            compile: compiled,
            render: started.elapsed().as_secs_f64(),
            rays: film.rays,
            samples: film.samples(),
            threads: pool.current_num_threads(),
            settings: labels.settings.clone(),
            finished: film.finished(),
        };
        if let Some(output) = &task.output {
            let unfinished = (!film.finished()).then(|| done(&film, &scene));
            let kind = (format, args.grid);
            let cleaning = (denoiser.as_ref(), &pool);
            let bytes = args.file.encode(&film, &labels, unfinished, kind, cleaning, &name);
            output.write(&bytes?)?;
        }
        if let Some(output) = &task.sample_map {
            output.write(&sample_map(&film, output)?)?;
        }
        interrupt.busy(false);
        stopped = !stats.finished;
        if stopped {
            note(&format!("{name}: unfinished, stopped at {}\n", done(&film, &scene)));
        }
        if !args.quiet {
            note(&format!("{name}: {} x {}, {}\n", region.width, region.height, stats.line()));
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
    let all = scene.settings.samples;
    let is_done = |p: &&FilmPixel| p.is_finished() || p.count() >= all;
    let finished = film.pixels().iter().filter(is_done).count();
    let share = 100.0 * finished as f64 / film.pixels().len().max(1) as f64;
    let mean = film.samples() as f64 / film.pixels().len().max(1) as f64;
    format!("{share:.1} % of the pixels, {mean:.2} of {} samples a pixel", scene.settings.samples)
}

impl RenderArgs {
    fn format(&self) -> Result<FileFormat, Failure> {
        // Samples for merge need no picture that could hold them.
        let none = if self.long.sample_range.is_some() { "none.exr" } else { "default.png" };
        let format = self.file.format(self.output.as_deref().unwrap_or(none))?;
        if self.grid && format.is_linear() {
            let message = "--grid is drawn over a developed picture, not into linear light";
            return Err(Failure::usage(message, "write -o FILE.png"));
        }
        if let Some(map) = self.sample_map.as_deref().filter(|name| *name != "-") {
            FileFormat::from_path(Path::new(map)).map_err(|e| Failure::usage(e.message, e.help))?;
        }
        Ok(format)
    }

    fn tasks(&self) -> Result<Vec<Task>, Failure> {
        let name = self.output.clone().unwrap_or_else(|| format!("{}.png", self.scene.stem()));
        let is_written = self.output.is_some() || self.long.sample_range.is_none();
        let output = |name: &str| is_written.then(|| Output::new(name)).transpose();
        let Some(frames) = self.frames else {
            let sample_map = self.sample_map.as_deref().map(Output::new).transpose()?;
            return Ok(vec![Task { frame: self.scene.frame, output: output(&name)?, sample_map }]);
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
                let output = output(&frame_name(&name, frame))?;
                Ok(Task { frame, output, sample_map: map.transpose()? })
            })
            .collect()
    }

    /// Says what was reached, and notes it among the settings.
    fn tell(&self, name: &str, made: &Made, settings: &mut Value) {
        if let Some((goal, reached)) = &made.reached {
            if !self.quiet || !reached.met {
                note(&format!("{name}: {}\n", until::words(*goal, reached)));
            }
            settings["noise"] = json!(goal);
            settings["samples"] = json!(reached.samples);
        } else if let (Some(samples), false) = (made.samples, self.quiet) {
            note(&format!("{name}: {samples} samples a pixel; again with --samples {samples}\n"));
        }
    }

    /// Makes what a checkpoint lacks, and keeps it there.
    #[allow(clippy::too_many_arguments)]
    fn make_part(
        &self,
        scene: &Scene,
        region: Region,
        identity: Identity,
        task: &Task,
        pool: &rayon::ThreadPool,
        bar: &Bar,
        interrupt: &Interrupt,
    ) -> Result<Film, Failure> {
        let samples = self.long.wanted(&scene.settings)?;
        let animated = self.frames.is_some();
        let (mut part, keeper) =
            self.long.open(identity, task.frame, animated, region, self.file.needs_layers())?;
        let watch = |progress: &parts::Progress<'_>| {
            keeper.watch(progress);
            bar.update_part(progress);
        };
        let control = Control { cancel: interrupt.flag.clone(), ..Control::default() };
        let wanted = Wanted { samples, most: block_size(scene.settings.samples) };
        interrupt.busy(true);
        picture::render_part(scene, &wanted, &mut part, pool, &control, &watch)
            .map_err(scene_failure)?;
        keeper.save(&part, None).map_err(|e| Failure::output(&keeper.name(), &e))?;
        part.film(&wanted.samples).map_err(scene_failure)
    }
}

impl Task {
    /// What is made, for messages.
    fn name(&self) -> String {
        self.output.as_ref().map_or_else(|| "samples".into(), ToString::to_string)
    }
}

fn scene_failure(error: Diagnostic) -> Failure {
    Failure::Scene(vec![error], Sources::default())
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
