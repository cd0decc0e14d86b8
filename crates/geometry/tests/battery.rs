// SPDX-License-Identifier: MIT OR Apache-2.0
//! What every shape must hold to, at any size and anywhere (the table of QUALITY: surface points,
//! normals and tangents, watertightness, crossings, departures). Figures with `--nocapture`.

mod common;

use common::specimens::specimens;
use common::{Place, Specimen, direction, every, hit, ray};
use dioptric_geometry::shapes::SCHEMAS;
use dioptric_geometry::{Crossing, Leaving, LocalRay};
use dioptric_math::random::Random;
use dioptric_math::{DVec2, DVec3};

const HERE: Place = Place { scale: 1.0, offset: DVec3::ZERO };

fn crossings(s: &Specimen, ray: &LocalRay) -> Vec<Crossing> {
    let mut out = Vec::new();
    s.shape.crossings(ray, &mut out);
    out
}

#[test]
fn every_registered_shape_has_a_specimen() {
    let all = specimens(HERE);
    for schema in SCHEMAS {
        let found = all.iter().any(|s| s.shape.kind() == schema.kind);
        assert!(found, "add a specimen of {} to tests/common/specimens.rs", schema.kind);
    }
}

#[test]
fn hits_lie_on_the_surface_within_their_bound() {
    let (mut hits, mut rays, mut worst, mut worst_name) = (0, 0, 0.0_f64, "");
    every(2, |s, r| {
        let mut found = 0;
        for _ in 0..200 {
            let ray = s.ray(r);
            rays += 1;
            let Some((root, surface)) = hit(s, &ray) else { continue };
            found += 1;
            let off = s.distance(surface.point).abs();
            assert!(
                off <= surface.error + s.slack(),
                "{} {:?}: {off:e} off, bound {:e}",
                s.name,
                s.place,
                surface.error
            );
            let used = off / (surface.error + s.slack());
            if used > worst {
                (worst, worst_name) = (used, s.name);
            }
            // The root itself is as good as the numbers along the ray.
            let p = ray.at(root.t);
            let along = 16.0 * f64::EPSILON * (ray.origin.length() + (p - ray.origin).length());
            let off = s.distance(p).abs();
            assert!(
                off <= along + s.shape.surface(p, root.part).error + s.slack(),
                "{} {:?}: root {off:e} off, {along:e}",
                s.name,
                s.place
            );
            assert!(s.shape.bounds().min.cmple(surface.point + surface.error).all(), "{}", s.name);
            assert!(s.shape.bounds().max.cmpge(surface.point - surface.error).all(), "{}", s.name);
        }
        assert!(found >= 1, "{} {:?} is never hit", s.name, s.place);
        hits += found;
    });
    println!(
        "surface points: {hits} hits of {rays} rays, at most {worst:.2} of the bound ({worst_name})"
    );
}

#[test]
fn normals_and_tangents_agree_with_finite_differences() {
    let (mut normals, mut tangents, mut worst_n, mut worst_t) = (0, 0, 0.0_f64, 0.0_f64);
    every(1, |s, r| {
        for _ in 0..60 {
            let ray = s.ray(r);
            let Some((root, f)) = hit(s, &ray) else { continue };
            assert!((f.normal.length() - 1.0).abs() < 1e-14, "{}: {}", s.name, f.normal);
            assert!(f.shading_normal.is_finite() && f.uv.is_finite(), "{}", s.name);
            if s.name.split(' ').next() != Some("plane") {
                let unit = f.uv.cmpge(DVec2::ZERO).all() && f.uv.cmple(DVec2::ONE).all();
                assert!(unit, "{}: uv {}", s.name, f.uv);
            }
            let h = 1e-4 * s.feature * s.place.scale;
            // Differences of numbers that are mostly rounding say nothing.
            if s.rounding() > 1e-3 * h {
                continue;
            }
            if !s.at_edge(f.point, h) {
                let gradient = s.gradient(f.point, h);
                let off = (gradient - f.normal).length();
                assert!(off < 2e-2, "{}: normal {} but gradient {gradient}", s.name, f.normal);
                worst_n = worst_n.max(off);
                normals += 1;
            }
            for (tangent, expected) in [(f.dpdu, DVec2::X), (f.dpdv, DVec2::Y)] {
                let across = tangent.dot(f.normal).abs();
                assert!(across <= 1e-9 * tangent.length(), "{}: tangent {tangent}", s.name);
                let d = 2e-4;
                if tangent.length() * d < 1e3 * s.rounding() {
                    continue;
                }
                // Both neighbours must be on the part, on one side of the seam.
                let near = |d: f64| {
                    let p = f.point + tangent * d;
                    let g = s.shape.surface(p, root.part);
                    ((g.point - p).length() < 1e-2 * tangent.length() * d.abs()).then_some(g.uv)
                };
                let (Some(low), Some(high)) = (near(-d), near(d)) else { continue };
                let clamped = [low.x, low.y, high.x, high.y].iter().any(|&x| x == 0.0 || x == 1.0);
                if clamped || (high - low).abs().max_element() > 0.25 {
                    continue;
                }
                let off = ((high - low) / (2.0 * d) - expected).length();
                assert!(
                    off < 2e-2,
                    "{} part {}: uv {} turns by {off} along {expected}",
                    s.name,
                    root.part,
                    f.uv
                );
                worst_t = worst_t.max(off);
                tangents += 1;
            }
            // What is cut out is seen from its other side.
            let turned = s.shape.kind() == "difference";
            assert!(
                turned || f.dpdu.cross(f.dpdv).dot(f.normal) >= 0.0,
                "{}: tangents are left-handed",
                s.name
            );
        }
    });
    println!(
        "finite differences: {normals} normals within {worst_n:.1e}, {tangents} tangents within {worst_t:.1e}"
    );
    assert!(normals > 2000 && tangents > 4000, "{normals} {tangents}");
}

#[test]
fn solids_are_watertight_from_inside() {
    let (mut rays, mut at_rims) = (0, 0);
    every(4, |s, r| {
        let Some(inside) = s.inside.map(|p| s.place.point(p)) else {
            assert!(!s.shape.is_solid() || s.shape.kind() == "plane", "{}", s.name);
            return;
        };
        assert!(s.shape.is_solid() && s.distance(inside) < 0.0, "{}", s.name);
        let random: Vec<DVec3> = (0..100).map(|_| direction(r)).collect();
        let rims = s.rims.iter().map(|&p| s.place.point(p) - inside);
        at_rims += rims.len();
        for d in random.into_iter().chain(rims) {
            rays += 1;
            let ray = ray(inside, d);
            assert!(s.shape.intersect(&ray).is_some(), "{} {:?} leaks along {d}", s.name, s.place);
            let all = crossings(s, &ray);
            let ahead = all.iter().filter(|c| c.t > 0.0).count();
            assert!(
                !ahead.is_multiple_of(2) && all.len().is_multiple_of(2),
                "{} {:?} along {d}: {all:?}",
                s.name,
                s.place
            );
            assert!(!s.shape.is_convex() || all.len() == 2, "{}: {all:?}", s.name);
        }
    });
    println!("watertight: {rays} rays from inside, {at_rims} of them at edges, 0 misses");
}

#[test]
fn crossings_alternate_and_agree_with_dense_sampling() {
    let (mut lines, mut samples) = (0, 0);
    every(1, |s, r| {
        for _ in 0..60 {
            let ray = s.ray(r);
            let all = crossings(s, &ray);
            lines += 1;
            if !s.shape.is_solid() {
                assert!(all.is_empty(), "{}", s.name);
                continue;
            }
            assert!(all.is_sorted_by(|a, b| a.t <= b.t), "{}: {all:?}", s.name);
            let half_space = s.shape.kind() == "plane";
            let first_enters = all.first().is_none_or(|c| c.enters);
            assert!(
                half_space || (first_enters && all.len().is_multiple_of(2)),
                "{}: {all:?}",
                s.name
            );
            assert!(all.windows(2).all(|w| w[0].enters != w[1].enters), "{}: {all:?}", s.name);
            let ahead = all.iter().find(|c| c.t > 0.0).map(|c| (c.t, c.part));
            let found = s.shape.intersect(&ray).map(|root| (root.t, root.part));
            assert_eq!(found, ahead, "{} {:?}", s.name, s.place);
            // Inside or outside at many points of the line, by the plain description.
            let reach = 6.0 * s.size * s.place.scale / ray.direction.length();
            for i in -20..200 {
                let t = reach * f64::from(i) / 200.0;
                let distance = s.distance(ray.at(t));
                if distance.abs() < 1e3 * (s.rounding() + s.slack()) {
                    continue;
                }
                let before = all.iter().rfind(|c| c.t <= t);
                let inside = match before {
                    Some(c) => c.enters,
                    None => half_space && all.first().is_some_and(|c| !c.enters),
                };
                if half_space && all.is_empty() {
                    continue;
                }
                assert_eq!(inside, distance < 0.0, "{} {:?} at {t}: {all:?}", s.name, s.place);
                samples += 1;
            }
        }
    });
    println!("crossings: {lines} lines alternate, {samples} samples agree");
}

#[test]
fn rays_that_are_no_rays_hit_nothing() {
    let wild = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 0.0];
    for s in specimens(HERE) {
        for bad in wild {
            for axis in 0..3 {
                let inside = s.inside.unwrap_or(DVec3::ZERO);
                let mut origin = inside;
                let mut d = DVec3::new(0.5, -0.25, 1.0);
                if bad == 0.0 {
                    d = DVec3::ZERO;
                } else if axis == 0 {
                    origin[1] = bad;
                } else {
                    d[axis] = bad;
                }
                for leaving in [
                    None,
                    Some(Leaving { part: 0, outward: false }),
                    Some(Leaving { part: 99, outward: true }),
                ] {
                    let ray = LocalRay { leaving, error: 1.0, ..ray(origin, d) };
                    assert_eq!(s.shape.intersect(&ray), None, "{} {origin} {d}", s.name);
                    let all = crossings(&s, &ray);
                    assert!(all.is_empty(), "{} {origin} {d}: {all:?}", s.name);
                }
            }
            let f = s.shape.surface(DVec3::splat(bad), 0);
            assert!(bad != 0.0 || f.normal.is_finite(), "{}", s.name);
        }
        // The limit holds.
        let mut r = Random::new(5);
        for _ in 0..50 {
            let mut ray = s.ray(&mut r);
            if let Some(root) = s.shape.intersect(&ray) {
                ray.t_max = root.t;
                assert_eq!(s.shape.intersect(&ray), Some(root), "{}", s.name);
                ray.t_max = root.t * 0.999;
                assert_eq!(s.shape.intersect(&ray), None, "{}", s.name);
            }
        }
    }
}
