// SPDX-License-Identifier: MIT OR Apache-2.0
//! What every sample promises: rays to it do not meet it, its numbers are numbers, its density is that of what rays hit.

use dioptric_geometry::Ray;
use dioptric_math::DVec3;
use dioptric_math::random::Random;
use dioptric_scene::{NodeId, Value};

use super::maker::{Maker, v3};
use crate::scene::Scene;

/// Every kind of surface that is looked for, one a scene, about as large as `scale`, at `offset` of that size.
fn lamps(scale: f64, offset: f64) -> Vec<(&'static str, Scene)> {
    let n = |x: f64| Value::Number(x * scale);
    let v = |x: f64, y: f64, z: f64| {
        v3((x + offset) * scale, (y - offset) * scale, (z + 0.5 * offset) * scale)
    };
    let way = |x: f64, y: f64, z: f64| v3(x * scale, y * scale, z * scale);
    let kinds: Vec<(&str, Vec<(&str, Value)>)> = vec![
        ("sphere", vec![("center", v(0.0, 2.0, 0.0)), ("radius", n(0.7))]),
        ("sphere", vec![("center", v(0.0, 2.0, 0.0)), ("radius", n(1e-5))]),
        ("disc", vec![("center", v(0.0, 2.0, 0.0)), ("radius", n(0.7))]),
        (
            "rectangle",
            vec![
                ("corner", v(-0.5, 2.0, 0.0)),
                ("edge_u", way(1.0, 0.3, 0.1)),
                ("edge_v", way(0.0, 0.4, 0.6)),
            ],
        ),
        (
            "triangle",
            vec![("a", v(0.0, 2.0, 0.0)), ("b", v(1.0, 2.0, 0.2)), ("c", v(0.2, 1.8, 0.7))],
        ),
        ("box", vec![("min", v(-0.5, 1.5, -0.5)), ("max", v(0.5, 2.0, 0.7))]),
        (
            "tetrahedron",
            vec![
                ("a", v(0.0, 2.0, 0.0)),
                ("b", v(1.0, 2.0, 0.2)),
                ("c", v(0.2, 1.8, 0.7)),
                ("d", v(0.3, 1.2, 0.1)),
            ],
        ),
    ];
    let mut all = Vec::new();
    for moved in [false, true] {
        for (kind, args) in &kinds {
            let mut m = Maker::default();
            let mut args = args.clone();
            if moved {
                let stretch = m.add("scale", &[("by", v3(1.0, 0.4, 2.0))]);
                let turn =
                    m.add("rotate", &[("axis", v3(1.0, 1.0, 0.0)), ("angle", Value::Number(40.0))]);
                let list: Vec<Value> = [stretch, turn].map(Value::Node).into();
                args.push(("transform", Value::List(list.into())));
            }
            let _: NodeId = m.glow(kind, &args, [1.0; 3]);
            all.push((*kind, m.scene()));
        }
    }
    all
}

#[test]
fn lamps_do_not_block_themselves() {
    let (mut asked, mut met) = (0, 0);
    for scale in [1e-6, 1.0, 1e6] {
        for offset in [0.0, 300.0] {
            for (kind, scene) in lamps(scale, offset) {
                let mut r = Random::new(3);
                let bounds = scene.world.bounds();
                let size = bounds.size().max_element();
                for _ in 0..800 {
                    // From near to far.
                    let away = DVec3::new(r.unit() - 0.5, r.unit() - 0.5, r.unit() - 0.5);
                    let far = [0.9, 3.0, 1e3][(r.bits() % 3) as usize];
                    let point = bounds.center() + away * (far * size);
                    let u = [r.unit(), r.unit()];
                    let Some(s) = scene.sources.sample(&scene, point, None, r.unit(), u) else {
                        continue;
                    };
                    asked += 1;
                    let ray = Ray::new(point, s.direction);
                    assert!(
                        !scene.world.occluded(&ray, s.distance, None),
                        "{kind} {scale} {offset} {point} {s:?}"
                    );
                    assert!((s.direction.length() - 1.0).abs() < 1e-12);
                    // What the ray hits is what was sampled, but for the very edge.
                    let Some(hit) = scene.world.closest(&ray, f64::INFINITY, None) else {
                        continue;
                    };
                    let surface = scene.world.surface_point(&ray, &hit).unwrap();
                    let slack = s.distance * (1.0 + 1e-5);
                    if hit.t > slack {
                        continue;
                    }
                    met += 1;
                    let density = scene.sources.density_of_hit(
                        &scene,
                        point,
                        None,
                        &hit,
                        &surface,
                        s.direction,
                    );
                    let cos = s.direction.dot(surface.normal).abs();
                    if cos > 1e-3 {
                        // Nothing else fits in between.
                        let room = 1e-7 * (s.distance + size) + 1e-11 * point.abs().max_element();
                        assert!(hit.t - s.distance <= room, "{kind} {scale} {offset} {s:?}");
                        assert!(
                            (density / s.pdf - 1.0).abs() < 1e-6,
                            "{kind} {scale} {offset} {point} {s:?} {hit:?} {density}"
                        );
                    }
                }
            }
        }
    }
    println!("{asked} {met}");
    assert!(met as f64 > 0.95 * asked as f64 && asked > 50_000, "{asked} {met}");
}

#[test]
fn points_on_and_in_lamps_give_numbers() {
    const LAST: f64 = 1.0 - f64::EPSILON / 2.0;
    for scale in [1e-6, 1.0, 1e6] {
        for (kind, scene) in lamps(scale, 0.0) {
            let bounds = scene.world.bounds();
            let corners = bounds.corners();
            let middles = corners.map(|c| (c + bounds.center()) * 0.5);
            let mut points: Vec<DVec3> = corners.into_iter().chain(middles).collect();
            points.extend([bounds.center(), DVec3::ZERO, DVec3::splat(1e300), DVec3::NAN]);
            points.push(DVec3::splat(f64::MAX));
            // On the surface.
            for direction in [DVec3::Y, DVec3::NEG_Y, DVec3::X, DVec3::new(0.6, 0.0, 0.8)] {
                let ray = Ray::new(bounds.center() - direction * (9.0 * scale), direction);
                if let Some(hit) = scene.world.closest(&ray, f64::INFINITY, None) {
                    points.push(scene.world.surface_point(&ray, &hit).unwrap().point);
                }
            }
            for point in points {
                for normal in [None, Some(DVec3::Y), Some(DVec3::NEG_Y)] {
                    for u in [[0.0, 0.0], [LAST, LAST], [0.5, 0.5], [0.0, LAST], [LAST, 0.0]] {
                        let s = scene.sources.sample(&scene, point, normal, u[0], u);
                        let Some(s) = s else { continue };
                        let place = format!("{kind} {scale} at {point} for {u:?}: {s:?}");
                        assert!((s.direction.length() - 1.0).abs() < 1e-12, "{place}");
                        assert!(s.distance >= 0.0 && s.distance.is_finite(), "{place}");
                        assert!(s.value.is_finite() && s.pdf > 0.0, "{place}");
                    }
                    for direction in [DVec3::Y, DVec3::NEG_Y, DVec3::X] {
                        let ray = Ray::new(point, direction);
                        let Some(hit) = scene.world.closest(&ray, f64::INFINITY, None) else {
                            continue;
                        };
                        let surface = scene.world.surface_point(&ray, &hit).unwrap();
                        let density = scene
                            .sources
                            .density_of_hit(&scene, point, normal, &hit, &surface, direction);
                        assert!(density >= 0.0 && density.is_finite(), "{kind} {point} {density}");
                    }
                }
            }
        }
    }
}
