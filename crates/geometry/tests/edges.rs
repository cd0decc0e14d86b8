// SPDX-License-Identifier: MIT OR Apache-2.0
//! Where things meet: edges that neighbours share, lines that all but miss, points just under a surface.

mod common;

use common::specimens::specimens;
use common::{build, direction, places, ray};
use dioptric_geometry::AnyShape;
use dioptric_math::DVec3;
use dioptric_math::random::Random;
use dioptric_scene::Value;

/// A grid of points in or near a plane, jittered; `lift` moves them out of it.
fn grid(n: usize, lift: f64, r: &mut Random) -> Vec<Vec<DVec3>> {
    (0..=n)
        .map(|i| {
            (0..=n)
                .map(|k| {
                    let mut jitter = |s: f64| r.uniform(-s, s);
                    DVec3::new(i as f64 + jitter(0.3), k as f64 + jitter(0.3), jitter(lift))
                })
                .collect()
        })
        .collect()
}

fn point(p: DVec3) -> Value {
    Value::Vec3(p.into())
}

/// Rays from all around through points on the edges and at the corners of a grid's inner cells.
fn rays_at_edges(grid: &[Vec<DVec3>], far: f64, r: &mut Random) -> Vec<(DVec3, DVec3)> {
    let mut rays = Vec::new();
    let n = grid.len() - 1;
    for i in 1..n {
        for k in 1..n {
            let (a, b, c) = (grid[i][k], grid[i + 1][k], grid[i][k + 1]);
            let x = r.unit();
            for target in [a, a + (b - a) * x, a + (c - a) * x, b + (c - b) * x] {
                let mut d = direction(r);
                d.z = d.z.abs() + 1.0;
                rays.push((target + d * far, -d));
            }
        }
    }
    rays
}

fn count(shapes: &[AnyShape], origin: DVec3, d: DVec3) -> usize {
    shapes.iter().filter(|s| s.intersect(&ray(origin, d)).is_some()).count()
}

#[test]
fn triangles_that_share_edges_leave_no_gap() {
    let mut r = Random::new(21);
    for far in [2.0, 1e5] {
        let g = grid(16, 0.2, &mut r);
        let mut triangles = Vec::new();
        for (row, next) in g.iter().zip(&g[1..]) {
            for k in 0..row.len() - 1 {
                let corners = [(row[k], next[k], row[k + 1]), (next[k], next[k + 1], row[k + 1])];
                triangles.extend(corners.map(|(a, b, c)| {
                    build("triangle", &[("a", point(a)), ("b", point(b)), ("c", point(c))]).unwrap()
                }));
            }
        }
        let rays = rays_at_edges(&g, far, &mut r);
        let missed = rays.iter().filter(|&&(o, d)| count(&triangles, o, d) == 0).count();
        println!(
            "triangles from {far}: {missed} of {} rays at edges and corners missed",
            rays.len()
        );
        assert_eq!(missed, 0);
    }
}

#[test]
fn polygons_that_share_edges_neither_leak_nor_overlap() {
    let mut r = Random::new(22);
    for far in [2.0, 1e5] {
        let g = grid(16, 0.0, &mut r);
        let mut polygons = Vec::new();
        for (row, next) in g.iter().zip(&g[1..]) {
            for k in 0..row.len() - 1 {
                let mut corners = [row[k], next[k], next[k + 1], row[k + 1]].map(point);
                // Whichever way round and wherever begun.
                if r.bits().is_multiple_of(2) {
                    corners.reverse();
                }
                corners.rotate_left((r.bits() % 4) as usize);
                let points = Value::List(corners.into());
                polygons.push(build("polygon", &[("points", points)]).unwrap());
            }
        }
        let rays = rays_at_edges(&g, far, &mut r);
        for &(o, d) in &rays {
            assert_eq!(count(&polygons, o, d), 1, "from {far}: {o} along {d}");
        }
        println!("polygons from {far}: {} rays at edges and corners hit exactly one", rays.len());
    }
}

#[test]
fn lines_through_points_just_inside_go_in_before_and_come_out_after() {
    let (mut lines, mut shallowest) = (0, f64::INFINITY);
    let mut all = Vec::new();
    for (i, place) in places(1, 5).into_iter().enumerate() {
        let mut r = Random::new(40 + i as u64);
        for s in specimens(place).iter().filter(|s| s.inside.is_some()) {
            for _ in 0..100 {
                let line = s.ray(&mut r);
                let Some(root) = s.shape.intersect(&line) else { continue };
                let f = s.shape.surface(line.at(root.t), root.part);
                // From a part of the shape's size down to the errors of point and shape.
                let least = 4.0 * (f.error + s.slack() + s.rounding());
                let most = 1e-2 * s.feature * place.scale;
                if least >= most {
                    continue;
                }
                let depth = if r.bits().is_multiple_of(2) { least } else { r.uniform(least, most) };
                let p = f.point - f.normal * depth;
                if s.distance(p) > -0.5 * depth {
                    continue; // at an edge
                }
                // Along the surface: the line leaves it as slowly as it can.
                let tangent =
                    f.normal.cross(f.normal.any_orthonormal_vector() + direction(&mut r) * 0.5);
                all.clear();
                s.shape.crossings(&ray(p, tangent), &mut all);
                let before = all.iter().filter(|c| c.t < 0.0).count();
                assert!(
                    !before.is_multiple_of(2) && all.len().is_multiple_of(2),
                    "{} {place:?} part {} depth {depth:e} of {:e}: {all:?}",
                    s.name,
                    root.part,
                    s.size * place.scale,
                );
                lines += 1;
                shallowest = shallowest.min(depth / (s.size * place.scale));
            }
        }
    }
    println!(
        "grazing: {lines} tangent lines just under a surface, the shallowest {shallowest:.1e} of its size deep"
    );
}
