// SPDX-License-Identifier: MIT OR Apache-2.0
//! How long one ray takes to meet one shape, how long a hierarchy takes to build, and how long a search in it takes:
//! `cargo bench -p dioptric-geometry`.
#![allow(missing_docs)] // of what criterion's macros make

use std::f64::consts::PI;
use std::hint::black_box;
use std::sync::Arc;
use std::time::Duration;

use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use dioptric_geometry::shapes::{
    cone::Cone, cuboid::Cuboid, cylinder::Cylinder, disc::Disc, polygon::Polygon,
    rectangle::Rectangle, sphere::Sphere, tetrahedron::Tetrahedron, torus::Torus,
    triangle::Triangle,
};
use dioptric_geometry::{AnyShape, LocalRay, Mesh, MeshData, Ray, Shape, World, WorldBuilder};
use dioptric_math::random::Random;
use dioptric_math::{DAffine3, DVec3, cos, sin};

/// Rays of each benchmark; all are cast in each round.
const RAYS: u32 = 4096;

fn vector(random: &mut Random) -> DVec3 {
    DVec3::from_array([0; 3].map(|_| random.uniform(-1.0, 1.0)))
}

/// Rays from around the unit cube to points in it.
fn rays() -> Vec<Ray> {
    let mut random = Random::new(1);
    (0..RAYS)
        .map(|_| {
            let (from, to) = (vector(&mut random) * 4.0, vector(&mut random));
            Ray::new(from, to - from)
        })
        .collect()
}

/// One ray and one shape, without any hierarchy.
fn shapes(c: &mut Criterion) {
    let rays: Vec<LocalRay> = rays().iter().map(LocalRay::whole).collect();
    let mut group = c.benchmark_group("intersect");
    group.throughput(Throughput::Elements(rays.len() as u64));
    let mut bench = |name: &str, shape: &dyn Shape| {
        group.bench_function(name, |b| {
            b.iter(|| rays.iter().filter(|ray| shape.intersect(black_box(ray)).is_some()).count());
        });
    };
    let (o, x, y, z) = (DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z);
    bench("sphere", &Sphere::new(o, 1.0));
    bench("box", &Cuboid::new(-DVec3::ONE, DVec3::ONE));
    let built: [(&str, Option<Box<dyn Shape>>); 7] = [
        ("cylinder", Cylinder::new(-y, 2.0 * y, 0.8, false).map(|s| Box::new(s) as _)),
        ("cone", Cone::new(-y, 2.0 * y, 0.8, 0.2, false).map(|s| Box::new(s) as _)),
        ("torus", Torus::new(o, y, 0.8, 0.3).map(|s| Box::new(s) as _)),
        ("disc", Disc::new(o, y, 1.0, 0.2).map(|s| Box::new(s) as _)),
        ("rectangle", Rectangle::new(-x - z, 2.0 * x, 2.0 * z).map(|s| Box::new(s) as _)),
        ("triangle", Triangle::new([-x, x, y]).map(|s| Box::new(s) as _)),
        ("tetrahedron", Tetrahedron::new([-x, x, y, z]).map(|s| Box::new(s) as _)),
    ];
    for (name, shape) in &built {
        if let Some(shape) = shape {
            bench(name, &**shape);
        }
    }
    // A square, and a wheel with teeth.
    let ring = |n: u32, tooth: f64| {
        let corner = |i| {
            let turn = 2.0 * PI * f64::from(i) / f64::from(n);
            (x * cos(turn) + y * sin(turn)) * if i % 4 < 2 { 1.0 } else { tooth }
        };
        (0..n).map(corner).collect::<Vec<_>>()
    };
    for (name, ring) in [("polygon of 4", ring(4, 1.0)), ("polygon of 144", ring(144, 0.9))] {
        if let Ok(polygon) = Polygon::new([ring]) {
            bench(name, &polygon);
        }
    }
}

/// A hundred thousand balls in the unit cube, each an object of its own.
fn balls() -> WorldBuilder {
    let mut random = Random::new(2);
    let mut builder = WorldBuilder::new();
    for _ in 0..100_000 {
        let ball = Sphere::new(vector(&mut random), random.uniform(0.004, 0.02));
        // Balls of sane numbers have a place.
        let _ = builder.object(AnyShape::Sphere(ball), DAffine3::IDENTITY);
    }
    builder
}

/// A mesh of a hundred thousand triangles: a square of hills.
fn hills() -> MeshData {
    let n = 224_u32;
    let mut random = Random::new(3);
    let mut data = MeshData::default();
    for j in 0..=n {
        for i in 0..=n {
            let [x, z] = [i, j].map(|k| 2.0 * k as f32 / n as f32 - 1.0);
            data.positions.push([x, random.uniform(0.0, 0.02) as f32 + 0.2 * x * z, z]);
            if i < n && j < n {
                let a = j * (n + 1) + i;
                data.triangles.extend([[a, a + n + 1, a + n + 2], [a, a + n + 2, a + 1]]);
            }
        }
    }
    data
}

fn world_of(mesh: Mesh) -> World {
    let mut builder = WorldBuilder::new();
    let _ = builder.object(AnyShape::Mesh(Arc::new(mesh)), DAffine3::IDENTITY);
    builder.build()
}

fn build(c: &mut Criterion) {
    let mut group = c.benchmark_group("build 100000");
    group.bench_function("spheres", |b| {
        b.iter_batched(balls, WorldBuilder::build, BatchSize::LargeInput);
    });
    group.bench_function("triangles", |b| {
        b.iter_batched(hills, |data| world_of(Mesh::new(data)), BatchSize::LargeInput);
    });
}

fn search(c: &mut Criterion) {
    let rays = rays();
    for (name, world) in [("spheres", balls().build()), ("triangles", world_of(Mesh::new(hills())))]
    {
        let mut group = c.benchmark_group(format!("search 100000 {name}"));
        group.throughput(Throughput::Elements(rays.len() as u64));
        group.bench_function("closest", |b| {
            b.iter(|| {
                rays.iter().filter(|r| world.closest(r, f64::INFINITY, None).is_some()).count()
            });
        });
        group.bench_function("occluded", |b| {
            b.iter(|| rays.iter().filter(|r| world.occluded(r, f64::INFINITY, None)).count());
        });
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .sample_size(20)
        .warm_up_time(Duration::from_millis(200))
        .measurement_time(Duration::from_millis(600));
    targets = shapes, build, search
}
criterion_main!(benches);
