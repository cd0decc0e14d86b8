// SPDX-License-Identifier: MIT OR Apache-2.0
//! Many sources: the choice among them, and that all of them together give what rays see.

use std::f64::consts::{PI, TAU};

use dioptric_math::random::Random;
use dioptric_math::{DVec3, sin_cos};
use dioptric_scene::Value;

use super::irradiance::irradiance;
use super::maker::{Maker, text, v3};
use crate::scene::Scene;

fn list(values: impl IntoIterator<Item = Value>) -> Value {
    Value::List(values.into_iter().collect())
}

/// A ball of triangles with its inside out or not, or a bowl.
fn ball_of_triangles(center: DVec3, radius: f64, closed: bool) -> Vec<(&'static str, Value)> {
    let (rows, columns) = (6, 12);
    let mut points = Vec::new();
    for j in 0..=rows {
        for i in 0..columns {
            let (s, c) = sin_cos(PI * f64::from(j) / f64::from(rows));
            let (t, d) = sin_cos(TAU * f64::from(i) / f64::from(columns));
            points.push(center + DVec3::new(s * d, c, s * t) * radius);
        }
    }
    let mut faces = Vec::new();
    for j in if closed { 0 } else { 2 }..rows {
        for i in 0..columns {
            let at = |j: i32, i: i32| Value::Number(f64::from(j * columns + i % columns));
            faces.push(list([at(j, i), at(j, i + 1), at(j + 1, i + 1)]));
            faces.push(list([at(j, i), at(j + 1, i + 1), at(j + 1, i)]));
        }
    }
    let points = list(points.into_iter().map(|p| Value::Vec3(p.into())));
    vec![("points", points), ("faces", list(faces)), ("smooth", Value::Bool(false))]
}

/// Lamps all over the place, some of each kind.
pub(super) fn crowd() -> Scene {
    let mut m = Maker::default();
    let mut r = Random::new(8);
    let mut place = || DVec3::new(r.uniform(-4.0, 4.0), r.uniform(0.5, 3.0), r.uniform(-4.0, 4.0));
    for i in 0..40 {
        let radius = ("radius", Value::Number(0.05 + 0.002 * f64::from(i)));
        let position = ("position", Value::Vec3(place().into()));
        let intensity = ("intensity", Value::Number(0.1));
        let falloff = ("falloff", text("square"));
        let mut args = vec![position, radius, intensity, falloff];
        if i % 4 == 0 {
            args.push(("look_at", v3(0.0, 0.0, 0.0)));
            args.push(("angle", Value::Number(60.0)));
        }
        m.add(if i % 4 == 0 { "spot" } else { "light" }, &args);
    }
    m.add("light", &[("position", v3(1.0, 9.0, 1.0)), ("radius", Value::Number(0.8))]);
    m.add("background", &[("color", v3(0.1, 0.2, 0.3))]);
    let centers = list((0..30).map(|_| Value::Vec3(place().into())));
    m.glow("spheres", &[("centers", centers), ("radius", Value::Number(0.1))], [2.0, 1.0, 0.0]);
    let lamp = ball_of_triangles(DVec3::new(1.0, 2.0, 1.5), 0.5, true);
    m.glow("mesh", &lamp, [0.5, 1.0, 2.0]);
    let bowl = ball_of_triangles(DVec3::new(-1.5, 2.0, 0.5), 0.7, false);
    m.glow("mesh", &bowl, [1.0, 0.2, 0.2]);
    m.scene()
}

const PLACES: [(DVec3, DVec3); 3] = [
    (DVec3::ZERO, DVec3::Y),
    (DVec3::new(1.2, 1.2, 0.4), DVec3::new(0.0, 0.6, 0.8)),
    (DVec3::new(30.0, 0.0, -10.0), DVec3::new(-0.8, 0.6, 0.0)),
];

#[test]
fn chances_are_those_that_are_said_and_their_sum_is_one() {
    let scene = crowd();
    let choice = &scene.sources.choice;
    let emitters = (0..).take_while(|&e| choice.emitter(e).is_some()).count();
    assert!(emitters > 200);
    for (point, normal) in PLACES {
        for normal in [None, Some(normal)] {
            let chances: Vec<f64> =
                (0..emitters as u32).map(|e| choice.chance(point, normal, e)).collect();
            let sum: f64 = chances.iter().sum();
            println!("{point} {normal:?}: {sum}");
            // A half of the tree may seem to send something of which none of its own does.
            assert!(sum < 1.0 + 1e-9 && sum > 0.95, "{sum}");
            let mut counts = vec![0_u32; emitters];
            let n = 100_000;
            for i in 0..n {
                let pick = (f64::from(i) + 0.5) / f64::from(n);
                let Some((emitter, chance)) = choice.pick(point, normal, pick) else { continue };
                assert!((chance / chances[emitter as usize] - 1.0).abs() < 1e-12);
                counts[emitter as usize] += 1;
            }
            for (emitter, (&count, &chance)) in counts.iter().zip(&chances).enumerate() {
                let expected = chance * f64::from(n);
                let off = (f64::from(count) - expected).abs();
                assert!(off <= 3.0, "{emitter}: {count} {expected}");
            }
        }
    }
}

#[test]
fn a_crowd_of_lamps_gives_what_rays_see() {
    let scene = crowd();
    for (point, normal) in PLACES {
        let [asked, seen, both] = irradiance(&scene, point, normal, 60_000, 21);
        println!("{} {} {}", asked.value(), seen.value(), both.value());
        println!("{} {} {}", asked.error(), seen.error(), both.error());
        for (a, b) in [(asked, seen), (both, seen), (asked, both)] {
            let error = (a.error() * a.error() + b.error() * b.error()).sqrt();
            let off = (a.value() - b.value()).abs() / error;
            assert!(off < 4.0, "{point}: {off}");
        }
        assert!(both.error() < 0.3 * seen.error() && asked.error() < 0.3 * seen.error());
    }
}
