// SPDX-License-Identifier: MIT OR Apache-2.0
//! Meshes that are not as they should be, large: they are built and traced in a moment, and what is found is
//! what a search through all triangles finds.

use std::time::Instant;

use dioptric::geometry::MeshData;
use dioptric::math::DVec3;
use dioptric::math::random::Random;

use super::run::Folder;
use super::trace::{FileRay, trace_mesh};

/// As many triangles as a test may have that runs without optimisation, too.
const MANY: u32 = if cfg!(debug_assertions) { 100_000 } else { 400_000 };

/// Rays from all around to the middle of things.
fn rays(count: usize, from: f64, to: f64) -> Vec<FileRay> {
    let mut random = Random::new(8);
    let mut point = |size: f64| [(); 3].map(|()| random.uniform(-size, size));
    (0..count)
        .map(|_| {
            let (o, p) = (point(from), point(to));
            [o[0], o[1], o[2], p[0] - o[0], p[1] - o[1], p[2] - o[2]].map(|x| x as f32)
        })
        .collect()
}

/// The distance to the nearest triangle (Möller and Trumbore, "Fast, Minimum Storage Ray/Triangle
/// Intersection", 1997), one after the other.
fn brute(mesh: &MeshData, ray: &FileRay) -> f64 {
    let vector = |p: &[f32]| DVec3::new(f64::from(p[0]), f64::from(p[1]), f64::from(p[2]));
    let (origin, direction) = (vector(&ray[..3]), vector(&ray[3..]));
    let mut nearest = f64::INFINITY;
    for corners in &mesh.triangles {
        let [a, b, c] = corners.map(|i| vector(&mesh.positions[i as usize]));
        let (e, f) = (b - a, c - a);
        let p = direction.cross(f);
        let s = origin - a;
        let q = s.cross(e);
        let determinant = e.dot(p);
        let (u, v, t) =
            (s.dot(p) / determinant, direction.dot(q) / determinant, f.dot(q) / determinant);
        if u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t >= 0.0 && t < nearest {
            nearest = t;
        }
    }
    nearest * direction.length()
}

/// Builds and traces, and compares the first `checked` rays with a search through all.
#[track_caller]
fn check(name: &str, mesh: &MeshData, rays: &[FileRay], checked: usize) {
    let folder = Folder::new(name);
    let started = Instant::now();
    let hits = trace_mesh(&folder, mesh, rays, &[]);
    let seconds = started.elapsed().as_secs_f64();
    println!("{name}: {seconds:.2} s");
    // Far above what it takes, far below what anything quadratic would.
    assert!(seconds < 60.0, "{name} took {seconds} s");
    let mut found = 0;
    for (ray, &hit) in rays.iter().zip(&hits).take(checked) {
        let expected = brute(mesh, ray);
        let agree = hit.is_infinite() == expected.is_infinite()
            && (hit.is_infinite() || (f64::from(hit) - expected).abs() <= 1e-5 * expected);
        assert!(agree, "{name}: {ray:?} at {hit}, not {expected}");
        found += usize::from(hit.is_finite());
    }
    let any = trace_mesh(&folder, mesh, rays, &["--any", "--threads", "1"]);
    assert!(any.iter().zip(&hits).all(|(&any, hit)| (any > 0.0) == hit.is_finite()), "{name}");
    assert_eq!(
        found > 0,
        mesh.triangles.iter().any(|t| area(mesh, *t) > 0.0),
        "{name}: {found} hits"
    );
}

fn area(mesh: &MeshData, corners: [u32; 3]) -> f64 {
    let [a, b, c] = corners.map(|i| DVec3::from(mesh.positions[i as usize].map(f64::from)));
    (b - a).cross(c - a).length()
}

/// Small triangles all over a cube.
fn confetti(count: u32, size: f64) -> MeshData {
    let mut random = Random::new(2);
    let mut mesh = MeshData::default();
    for i in 0..count {
        let middle = [(); 3].map(|()| random.uniform(-1.0, 1.0));
        for _ in 0..3 {
            mesh.positions.push(middle.map(|x| (x + random.uniform(-size, size)) as f32));
        }
        mesh.triangles.push([3 * i, 3 * i + 1, 3 * i + 2]);
    }
    mesh
}

#[test]
fn numbers_that_are_none() {
    let mut mesh = confetti(MANY / 4, 0.02);
    for (i, p) in mesh.positions.iter_mut().enumerate() {
        match i % 13 {
            0 => p[i % 3] = f32::NAN,
            1 => p[i % 3] = f32::INFINITY,
            _ => {}
        }
    }
    check("not-a-number", &mesh, &rays(2000, 3.0, 1.0), 20);
    mesh.positions.iter_mut().for_each(|p| p[1] = f32::NAN);
    check("nothing-but-nan", &mesh, &rays(100, 3.0, 1.0), 5);
}

#[test]
fn triangles_without_area() {
    let mut mesh = confetti(MANY, 0.05);
    for (i, t) in mesh.triangles.iter_mut().enumerate() {
        match i % 100 {
            0 => {}
            // Two corners, or all, are one.
            i if i < 50 => t[2] = t[1],
            _ => *t = [t[0]; 3],
        }
    }
    check("no-area", &mesh, &rays(2000, 3.0, 1.0), 10);
    mesh.triangles.retain(|t| t[1] == t[2]);
    check("nothing-with-area", &mesh, &rays(100, 3.0, 1.0), 2);
}

#[test]
fn one_triangle_over_and_over() {
    let mesh = MeshData {
        positions: vec![[-1.0, -1.0, 0.1], [1.0, -1.0, -0.2], [0.0, 1.0, 0.3]],
        triangles: vec![[0, 1, 2]; MANY as usize],
        ..MeshData::default()
    };
    check("duplicates", &mesh, &rays(20, 3.0, 0.5), 8);
}

#[test]
fn boxes_that_are_all_the_same() {
    // Different triangles around one point, each as wide as the others in every direction.
    let mut mesh = MeshData::default();
    let mut random = Random::new(6);
    for i in 0..MANY / 10 {
        let x = random.uniform(-1.0, 1.0) as f32;
        mesh.positions.extend([[-1.0, -1.0, -1.0], [1.0, 1.0, x], [x, -x, 1.0]]);
        mesh.triangles.push([3 * i, 3 * i + 1, 3 * i + 2]);
    }
    check("same-boxes", &mesh, &rays(50, 3.0, 0.7), 20);
}

#[test]
fn one_huge_and_many_tiny() {
    let mut mesh = confetti(MANY / 2, 1e-3);
    let first = mesh.positions.len() as u32;
    mesh.positions.extend([[-1e3, -0.5, -1e3], [1e3, -0.5, -1e3], [0.0, -0.5, 2e3]]);
    mesh.triangles.push([first, first + 1, first + 2]);
    check("huge-and-tiny", &mesh, &rays(5000, 3.0, 1.0), 15);
}

#[test]
fn nothing_at_all() {
    check("empty", &MeshData::default(), &rays(100, 3.0, 1.0), 100);
    let points = MeshData { positions: vec![[0.0; 3]; 5], ..MeshData::default() };
    check("points-alone", &points, &rays(100, 3.0, 1.0), 100);
}
