// SPDX-License-Identifier: MIT OR Apache-2.0
//! How many rays a second one thread casts at a mesh or at spheres, from files of plain little-endian numbers:
//! `cargo run --release -p dioptric-geometry --example mesh_rays -- FOLDER NAME...` reads `NAME.v` (corners, three
//! f32 each; spheres, four), `NAME.t` (three u32 for each triangle), `NAME.p` and `NAME.b` (rays: origin and
//! direction, six f32) and, to compare, `NAME.pe` and `NAME.be` (distances, f32). THREADS build, each measurement is the
//! best of REPEAT, and each ray is cast TIMES in a row: from 20 on what is left is work, hardly any waiting for memory.

use std::hint::black_box;
use std::path::Path;
use std::sync::{Arc, OnceLock};
use std::time::Instant;

use dioptric_geometry::pool::Spheres;
use dioptric_geometry::shapes::sphere::Sphere;
use dioptric_geometry::{AnyShape, Mesh, MeshData, Ray, World, WorldBuilder};
use dioptric_math::{DAffine3, DVec3};

fn words<const N: usize, T>(path: &Path, read: impl Fn([u8; 4]) -> T + Copy) -> Vec<[T; N]> {
    let bytes = std::fs::read(path).unwrap_or_default();
    let (words, _) = bytes.as_chunks::<4>();
    words
        .chunks_exact(N)
        .filter_map(|c| <[T; N]>::try_from(c.iter().map(|w| read(*w)).collect::<Vec<_>>()).ok())
        .collect()
}

fn world(shape: AnyShape) -> World {
    let mut builder = WorldBuilder::new();
    builder.object(shape, DAffine3::IDENTITY).expect("one object");
    builder.build()
}

/// Seconds of the processor that this thread has had, where the system says so (Linux); else seconds
/// since the first call. On a busy machine the former are the ones that mean something, though they go in steps of some
/// milliseconds; WALL asks for the latter.
fn seconds() -> f64 {
    static START: OnceLock<Instant> = OnceLock::new();
    let start = START.get_or_init(Instant::now);
    let text = if std::env::var("WALL").is_ok() { "" } else { "/proc/thread-self/schedstat" };
    std::fs::read_to_string(text)
        .ok()
        .and_then(|text| text.split_whitespace().next()?.parse::<f64>().ok())
        .map_or_else(|| start.elapsed().as_secs_f64(), |nanoseconds| nanoseconds * 1e-9)
}

/// The same of all threads together.
fn all_seconds() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let ticks = |i: usize| stat.split_whitespace().nth(i).and_then(|t| t.parse::<f64>().ok());
    (ticks(13).unwrap_or(0.0) + ticks(14).unwrap_or(0.0)) * 0.01
}

fn best(repeat: usize, mut run: impl FnMut()) -> f64 {
    (0..repeat)
        .map(|_| {
            let start = seconds();
            run();
            seconds() - start
        })
        .fold(f64::INFINITY, f64::min)
}

fn main() {
    let mut args = std::env::args().skip(1);
    let folder = args.next().unwrap_or_else(|| ".".into());
    let threads = std::env::var("THREADS").ok().and_then(|t| t.parse().ok()).unwrap_or(1);
    let times = std::env::var("TIMES").ok().and_then(|t| t.parse().ok()).unwrap_or(1);
    let repeat = std::env::var("REPEAT").ok().and_then(|t| t.parse().ok()).unwrap_or(5);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    for name in args {
        let path = |end: &str| Path::new(&folder).join(format!("{name}.{end}"));
        let triangles = words::<3, u32>(&path("t"), u32::from_le_bytes);
        let (mut bytes, mut world_of, mut count) = (0, None, 0);
        let build = if triangles.is_empty() {
            let balls = words::<4, f32>(&path("v"), f32::from_le_bytes);
            let balls: Vec<_> = balls
                .iter()
                .map(|b| b.map(f64::from))
                .map(|[x, y, z, r]| Sphere::new(DVec3::new(x, y, z), r))
                .collect();
            best(3, || {
                let balls = balls.clone();
                let spheres = pool.install(|| Spheres::new(balls)).expect("few");
                count = spheres.len();
                let shape = AnyShape::Spheres(Arc::new(spheres));
                bytes = shape.memory_bytes();
                world_of = Some(world(shape));
            })
        } else {
            let positions = words::<3, f32>(&path("v"), f32::from_le_bytes);
            let data = MeshData { positions, triangles, ..MeshData::default() };
            let mut fastest = f64::INFINITY;
            for _ in 0..3 {
                drop(world_of.take());
                let data = data.clone();
                let (start, cpu) = (Instant::now(), all_seconds());
                let mesh = pool.install(|| Mesh::new(data));
                fastest = fastest.min(start.elapsed().as_secs_f64());
                println!("{name}: {:.2} s of all processors", all_seconds() - cpu);
                count = mesh.triangle_count();
                let shape = AnyShape::Mesh(Arc::new(mesh));
                bytes = shape.memory_bytes();
                world_of = Some(world(shape));
            }
            fastest
        };
        let Some(world) = world_of else { continue };
        println!(
            "{name} build {build:.3} s, {:.1} bytes each of {count}",
            bytes as f64 / count as f64
        );
        if repeat == 0 {
            continue;
        }
        for (kind, label) in [("p", "primary"), ("b", "bounce")] {
            let rays = words::<6, f32>(&path(kind), f32::from_le_bytes);
            let expected = words::<1, f32>(&path(&format!("{kind}e")), f32::from_le_bytes);
            let ray = |r: &[f32; 6]| {
                let [a, b, c, d, e, f] = r.map(f64::from);
                Ray::new(DVec3::new(a, b, c), DVec3::new(d, e, f))
            };
            let closest = best(if std::env::var("FAR").is_ok() { 0 } else { repeat }, || {
                for r in rays.iter().flat_map(|r| std::iter::repeat_n(r, times)) {
                    black_box(world.closest(&ray(r), f64::INFINITY, None));
                }
            });
            let far = best(if std::env::var("FAR").is_ok() { 100 } else { repeat }, || {
                for r in &rays {
                    let ray = ray(&[100.0, 100.0, 100.0, r[3].abs(), r[4].abs(), r[5].abs()]);
                    black_box(world.closest(&ray, f64::INFINITY, None));
                }
            });
            println!("  {:.1} ns a ray that meets nothing", far * 1e9 / rays.len() as f64);
            if std::env::var("FAR").is_ok() {
                continue;
            }
            let any = best(repeat, || {
                for r in rays.iter().flat_map(|r| std::iter::repeat_n(r, times)) {
                    black_box(world.occluded(&ray(r), f64::INFINITY, None));
                }
            });
            let (mut hits, mut wrong) = (0, 0);
            for (r, [expected]) in rays.iter().zip(&expected) {
                let found = world.closest(&ray(r), f64::INFINITY, None);
                hits += usize::from(found.is_some());
                assert_eq!(found.is_some(), world.occluded(&ray(r), f64::INFINITY, None));
                let t = found.map_or(f64::INFINITY, |hit| hit.t);
                let e = f64::from(*expected);
                wrong += usize::from(t != e && !((t - e).abs() <= 1e-4 * e));
            }
            let m = (times * rays.len()) as f64 * 1e-6;
            println!(
                "  {label:<8} closest {:6.2} any {:6.2} Mrays/s  {} rays {:.1}% hit, {wrong} differ",
                m / closest,
                m / any,
                rays.len(),
                100.0 * hits as f64 / rays.len() as f64
            );
        }
    }
}
