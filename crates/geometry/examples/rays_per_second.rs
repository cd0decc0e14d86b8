// SPDX-License-Identifier: MIT OR Apache-2.0
//! How long a million spheres take to build, how much memory they take, and how many rays a second
//! one thread casts at them: `cargo run --release -p dioptric-geometry --example rays_per_second`.

use std::hint::black_box;
use std::sync::OnceLock;
use std::time::Instant;

use dioptric_geometry::bvh::Count;
use dioptric_geometry::shapes::sphere::Sphere;
use dioptric_geometry::{AnyShape, Departure, Ray, World, WorldBuilder};
use dioptric_math::random::Random;
use dioptric_math::{DAffine3, DVec3};

/// Seconds of the processor that this thread has had, where the system says so (Linux); else seconds
/// since the first call. On a busy machine the former are the ones that mean something.
fn seconds() -> f64 {
    static START: OnceLock<Instant> = OnceLock::new();
    let start = START.get_or_init(Instant::now);
    std::fs::read_to_string("/proc/thread-self/schedstat")
        .ok()
        .and_then(|text| text.split_whitespace().next()?.parse::<f64>().ok())
        .map_or_else(|| start.elapsed().as_secs_f64(), |nanoseconds| nanoseconds * 1e-9)
}

fn vector(random: &mut Random) -> DVec3 {
    DVec3::from_array([0; 3].map(|_| random.uniform(-1.0, 1.0)))
}

fn balls(count: u32, radius: f64) -> World {
    let mut random = Random::new(1);
    let mut builder = WorldBuilder::new();
    for _ in 0..count {
        let ball = Sphere::new(vector(&mut random), random.uniform(0.2, 1.0) * radius);
        if builder.object(AnyShape::Sphere(ball), DAffine3::IDENTITY).is_err() {
            return builder.build();
        }
    }
    let start = seconds();
    let world = builder.build();
    println!(
        "{count} spheres of radius {radius}: built in {:.2} s, {:.0} MB",
        seconds() - start,
        world.memory_bytes() as f64 / 1e6
    );
    world
}

/// Casts the rays and prints how fast.
fn cast(name: &str, world: &World, rays: &[(Ray, Option<Departure>)]) {
    let mut count = Count::default();
    let mut hits = 0u32;
    for (ray, departure) in rays.iter().take(10_000) {
        let hit = world.closest_counted(ray, f64::INFINITY, departure.as_ref(), &mut count);
        hits += u32::from(hit.is_some());
    }
    let time = |query: &dyn Fn(&Ray, Option<&Departure>) -> bool| {
        let start = seconds();
        for (ray, departure) in rays {
            black_box(query(ray, departure.as_ref()));
        }
        rays.len() as f64 / (seconds() - start) * 1e-6
    };
    let closest = time(&|ray, d| world.closest(ray, f64::INFINITY, d).is_some());
    let any = time(&|ray, d| world.occluded(ray, f64::INFINITY, d));
    println!(
        "  {name:<10} closest {closest:.2}, any {any:.2} Mrays/s; {:.0} % hit, {:.1} boxes and {:.1} shapes a ray",
        f64::from(hits) * 1e-2,
        count.boxes as f64 * 1e-4,
        count.shapes as f64 * 1e-4
    );
}

fn main() {
    for (count, radius) in [(100, 0.2), (10_000, 0.04), (1_000_000, 0.01)] {
        let world = balls(count, radius);
        let mut random = Random::new(2);
        // A picture's rays, in order.
        let primary: Vec<_> = (0..1 << 20)
            .map(|i| {
                let (x, y) = (f64::from(i % 1024) / 512.0 - 1.0, f64::from(i / 1024) / 512.0 - 1.0);
                (Ray::new(DVec3::Z * 3.0, DVec3::new(x, y, -2.0)), None)
            })
            .collect();
        cast("primary", &world, &primary);
        // On from where they hit, to all sides: incoherent.
        let bounces: Vec<_> = primary
            .iter()
            .filter_map(|(ray, _)| {
                let hit = world.closest(ray, f64::INFINITY, None)?;
                let s = world.surface(ray, &hit)?;
                let up = vector(&mut random);
                let direction = if up.dot(s.normal) > 0.0 { up } else { -up };
                let ray = Ray { error: s.error, ..Ray::new(s.point, direction) };
                Some((ray, Some(Departure { from: hit.id, outward: true })))
            })
            .collect();
        cast("bounces", &world, &bounces);
        let anywhere: Vec<_> = primary
            .iter()
            .map(|_| (Ray::new(vector(&mut random), vector(&mut random)), None))
            .collect();
        cast("anywhere", &world, &anywhere);
    }
}
