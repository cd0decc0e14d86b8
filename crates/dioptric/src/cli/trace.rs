// SPDX-License-Identifier: MIT OR Apache-2.0
//! `trace`: a file of rays in, a file of hits out, and how many rays a second that were.

use std::fs::File;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use dioptric::geometry::mesh::Mesh;
use dioptric::geometry::pool::Spheres;
use dioptric::geometry::shapes::sphere::Sphere;
use dioptric::geometry::world::{Hit, Query, World, WorldBuilder, each};
use dioptric::geometry::{AnyShape, Contacts, HitId, Ray};
use dioptric::math::{DAffine3, DVec3};
use dioptric::meshes::{Format, Limits, Model};
use dioptric::render::{compile, vocabulary};
use dioptric::scene::args::make_node;
use dioptric::scene::{Category, Description, NodeId};
use rayon::prelude::*;

use super::failure::Failure;
use super::output::Output;
use super::scene_options::SceneOptions;
use super::stats::peak_bytes;
use super::terminal::{Terminal, note, print};

/// Casts the rays of a file into a scene, or a mesh (.ply, .obj), and says what they hit and how fast that was.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Rays are 6 little-endian 32-bit floats each: origin, then direction, of any length but 0. The output has for \
    each ray, in the same order and little-endian:\n  \
    by default  1 float: the distance to the nearest hit, in the scene's units; inf where nothing is hit\n  \
    --any       1 float: 1 where anything is hit, else 0\n  \
    --full      36 bytes: float distance; uint32 instance, object, primitive; float u, v; float normal x, y, z\n              \
                (instance is 4294967295 outside of instances; without a hit: inf, three times 4294967295, zeros)\n\n\
    Examples:\n  dioptric trace bunny.ply rays.bin -o hits.bin\n  \
    dioptric trace scenes/space.star rays.bin --any --threads 1 --repeat 9"
)]
pub struct TraceArgs {
    #[command(flatten)]
    scene: SceneOptions,
    /// The rays; - for standard input.
    rays: String,
    /// The hits; - for standard output. Without it they are only timed and counted.
    #[arg(short, long, value_name = "FILE")]
    output: Option<String>,
    /// Only asks whether anything is hit, which is faster.
    #[arg(long, conflicts_with = "full")]
    any: bool,
    /// Writes what was hit, too: object, primitive, uv and normal.
    #[arg(long)]
    full: bool,
    /// Casts rays in packets, which is faster where neighbours go the same way among many objects.
    #[arg(long)]
    batch: bool,
    /// Threads that work; the hits are the same for any number.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    /// Casts all rays so many times, for the median of the times; from 2 on after a round that is not counted.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    repeat: u32,
}

/// Bytes of a ray in the file.
const RAY_BYTES: usize = 24;

/// Reads, builds, casts and writes.
pub fn run(args: &TraceArgs, terminal: &Terminal) -> Result<(), Failure> {
    let output = args.output.as_deref().map(Output::new).transpose()?;
    if args.scene.scene == "-" && args.rays == "-" {
        return Err(Failure::usage(
            "scene and rays cannot both come from standard input",
            "write one of them into a file",
        ));
    }
    let pool = super::picture_options::pool(args.threads)?;
    let bytes = read_rays(&args.rays)?;
    let (rays, _) = bytes.as_chunks::<RAY_BYTES>();
    let started = Instant::now();
    let source = Source::read(&args.scene, terminal)?;
    let read = started.elapsed().as_secs_f64();
    let started = Instant::now();
    let world = pool.install(|| source.build(&args.scene, terminal))?;
    let build = started.elapsed().as_secs_f64();

    let mut answers = vec![0.0_f32; rays.len()];
    let mut rates = Vec::new();
    // The first of several rounds waits for memory that is touched the first time.
    let warm_up = u32::from(args.repeat > 1);
    for round in 0..args.repeat.saturating_add(warm_up) {
        let started = Instant::now();
        pool.install(|| match (args.batch, args.any) {
            (true, is_any) => batches(&world, rays, &mut answers, is_any),
            (false, true) => each(rays, &mut answers, |ray| any(&world, &Line(parse(ray)).0)),
            (false, false) => each(rays, &mut answers, |ray| distance(&world, &Line(parse(ray)).0)),
        });
        let seconds = started.elapsed().as_secs_f64();
        if round >= warm_up {
            rates.push(rays.len() as f64 / seconds.max(1e-9) / 1e6);
        }
    }
    let hits = answers.iter().filter(|&&a| if args.any { a > 0.0 } else { a.is_finite() }).count();
    let memory = peak_bytes().map_or(String::new(), |b| format!(", {} MB", b >> 20));
    let report = format!(
        "read {read:.3} s, build {build:.3} s, objects {}, instances {}{memory}\nrays {}, {hits} hit\n{}\n",
        world.object_count(),
        world.instance_count(),
        rays.len(),
        median_line(rates),
    );
    let to_stdout = output.as_ref().is_some_and(Output::is_stdout);
    if let Some(output) = output {
        let bytes = if args.full {
            let mut records = vec![[0; RECORD_BYTES]; rays.len()];
            pool.install(|| each(rays, &mut records, |ray| record(&world, &parse(ray))));
            records.concat()
        } else {
            answers.iter().flat_map(|a| a.to_le_bytes()).collect()
        };
        output.write(&bytes)?;
    }
    if to_stdout {
        note(&report);
        return Ok(());
    }
    print(report.as_bytes())
}

/// What rays are cast into, as it was read.
enum Source {
    /// A mesh file.
    Model(Model),
    /// A scene.
    Scene(Box<super::scene_options::ReadScene>),
}

impl Source {
    fn read(options: &SceneOptions, terminal: &Terminal) -> Result<Self, Failure> {
        let name = &options.scene;
        if Format::of_name(name).is_none() {
            return options.read_shapes(terminal).map(Box::new).map(Self::Scene);
        }
        let mut file = File::open(Path::new(name)).map_err(|e| Failure::input(name, &e))?;
        let limits = Limits { bytes: options.max_mesh_bytes() };
        dioptric::meshes::read(name, &mut file, &limits)
            .map(Self::Model)
            .map_err(|e| Failure::File { message: e.to_string(), help: e.help })
    }

    /// Builds the trees, with the threads of the pool that this is called in.
    fn build(self, options: &SceneOptions, terminal: &Terminal) -> Result<World, Failure> {
        let read = match self {
            Self::Model(model) => return Ok(model_world(model)),
            Self::Scene(read) => read,
        };
        let mut description = read.reading.description;
        let has_camera =
            |d: &Description, id: &NodeId| d.node(*id).schema.category == Category::Camera;
        if !description.roots.iter().any(|id| has_camera(&description, id))
            && let Some(schema) = vocabulary().get("camera")
            && let Some(camera) = make_node(schema, &[])
        {
            let camera = description.push(camera);
            description.roots.push(camera);
        }
        let description = Arc::new(description);
        let wanted = compile::Options {
            camera: options.camera().map(Into::into),
            max_objects: options.max_objects(),
            max_mesh_bytes: options.max_mesh_bytes(),
            ..compile::Options::default()
        };
        let (scene, warnings) = compile::compile(&description, &read.loader, &wanted)
            .map_err(|errors| Failure::Scene(errors, description.sources.clone()))?;
        terminal.complain(&warnings, &description.sources);
        Ok(scene.world)
    }
}

/// A mesh alone; points with radii and without faces are spheres.
fn model_world(model: Model) -> World {
    let mut builder = WorldBuilder::new();
    let shape = if model.mesh.triangles.is_empty() && !model.radii.is_empty() {
        let sphere = |(p, &r): (&[f32; 3], &f32)| {
            let radius = if r > 0.0 { f64::from(r) } else { f64::NAN };
            Sphere::new(DVec3::from(p.map(f64::from)), radius)
        };
        let all = model.mesh.positions.par_iter().zip(&model.radii).map(sphere).collect();
        Spheres::new(all).map(|pool| AnyShape::Spheres(Arc::new(pool)))
    } else {
        Some(AnyShape::Mesh(Arc::new(Mesh::new(model.mesh))))
    };
    // A file holds fewer than 2^32 points, and the identity has an inverse.
    if let Some(shape) = shape {
        let _ = builder.object(shape, DAffine3::IDENTITY);
    }
    builder.build()
}

fn read_rays(path: &str) -> Result<Vec<u8>, Failure> {
    let bytes = if path == "-" { super::terminal::read_stdin() } else { std::fs::read(path) };
    let bytes = bytes.map_err(|e| Failure::input(path, &e))?;
    if bytes.len() % RAY_BYTES != 0 {
        return Err(Failure::File {
            message: format!("{path} has {} bytes, which is no whole number of rays", bytes.len()),
            help: "write each ray as 6 little-endian 32-bit floats, 24 bytes".into(),
        });
    }
    Ok(bytes)
}

/// A ray in one cache line: what is written across the end of one cannot be read on before it is in the cache.
#[repr(align(64))]
struct Line(Ray);

fn parse(ray: &[u8; RAY_BYTES]) -> Ray {
    let (numbers, _) = ray.as_chunks::<4>();
    let at = |i: usize| f64::from(numbers.get(i).map_or(0.0, |b| f32::from_le_bytes(*b)));
    Ray::new(DVec3::new(at(0), at(1), at(2)), DVec3::new(at(3), at(4), at(5)))
}

fn closest(world: &World, ray: &Ray) -> Option<Hit> {
    world.closest(ray, f64::INFINITY, None)
}

/// The distance to the nearest hit in the scene's units.
fn distance(world: &World, ray: &Ray) -> f32 {
    far(ray, closest(world, ray))
}

/// How far a hit is from the ray's origin.
fn far(ray: &Ray, hit: Option<Hit>) -> f32 {
    hit.map_or(f32::INFINITY, |hit| (hit.t * ray.direction.length()) as f32)
}

fn any(world: &World, ray: &Ray) -> f32 {
    if world.occluded(ray, f64::INFINITY, None) { 1.0 } else { 0.0 }
}

/// Rays that go through the world together.
const BATCH: usize = 128;

/// The answers of [`distance`] or [`any`], found for neighbours at once.
fn batches(world: &World, rays: &[[u8; RAY_BYTES]], answers: &mut [f32], is_any: bool) {
    rays.par_chunks(BATCH).zip(answers.par_chunks_mut(BATCH)).for_each(|(rays, answers)| {
        let query =
            |ray: &[u8; RAY_BYTES]| Query::new(parse(ray), f64::INFINITY, None, Contacts::CROSSED);
        let queries: Vec<Query> = rays.iter().map(query).collect();
        if is_any {
            let mut blockers = Vec::with_capacity(rays.len());
            world.blocker_each(&queries, &mut blockers);
            let one = |b: Option<HitId>| if b.is_some() { 1.0 } else { 0.0 };
            answers.iter_mut().zip(blockers).for_each(|(a, b)| *a = one(b));
        } else {
            let mut hits = Vec::with_capacity(rays.len());
            world.closest_each(&queries, &mut hits);
            for ((answer, hit), query) in answers.iter_mut().zip(hits).zip(&queries) {
                *answer = far(&query.ray, hit);
            }
        }
    });
}

/// Bytes that `--full` writes for a ray.
const RECORD_BYTES: usize = 36;

fn record(world: &World, ray: &Ray) -> [u8; RECORD_BYTES] {
    let mut words = [[0xff; 4]; RECORD_BYTES / 4];
    let found = closest(world, ray).and_then(|hit| Some((hit, world.surface(ray, &hit)?)));
    let (distance, surface) = match found {
        None => (f32::INFINITY, [0.0; 5]),
        Some((hit, surface)) => {
            let ids = [hit.id.instance, hit.id.object, hit.id.part];
            for (word, id) in words.iter_mut().skip(1).zip(ids) {
                *word = id.to_le_bytes();
            }
            let (uv, n) = (surface.uv, surface.normal);
            (far(ray, Some(hit)), [uv.x, uv.y, n.x, n.y, n.z])
        }
    };
    words[0] = distance.to_le_bytes();
    for (word, x) in words.iter_mut().skip(4).zip(surface) {
        *word = (x as f32).to_le_bytes();
    }
    let mut bytes = [0; RECORD_BYTES];
    bytes.iter_mut().zip(words.as_flattened()).for_each(|(to, from)| *to = *from);
    bytes
}

/// Rates in millions of rays a second: their median, and between which they lie.
fn median_line(mut rates: Vec<f64>) -> String {
    rates.sort_by(f64::total_cmp);
    let at = |i: usize| rates.get(i).copied().unwrap_or_default();
    let (n, last) = (rates.len(), rates.len().saturating_sub(1));
    let median = f64::midpoint(at(n / 2), at(last / 2));
    format!("median {median:.2} Mrays/s ({:.2} .. {:.2})", at(0), at(last))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_is_in_the_middle() {
        let line = |rates: &[f64]| median_line(rates.to_vec());
        assert_eq!(line(&[3.0, 1.0, 2.0]), "median 2.00 Mrays/s (1.00 .. 3.00)");
        assert_eq!(line(&[4.0, 1.0]), "median 2.50 Mrays/s (1.00 .. 4.00)");
        assert_eq!(line(&[1.5]), "median 1.50 Mrays/s (1.50 .. 1.50)");
    }
}
