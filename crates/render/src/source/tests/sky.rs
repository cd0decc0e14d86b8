// SPDX-License-Identifier: MIT OR Apache-2.0
//! The sky: its table finds directions as often as it says, in turned and stretched scenes, too.

use std::f64::consts::{PI, TAU};

use dioptric_math::random::Random;
use dioptric_math::{DVec3, asin, atan2, cbrt, sin_cos};
use dioptric_scene::Value;

use super::irradiance::irradiance;
use super::maker::{Maker, v3};
use crate::scene::Scene;
use crate::source::Sources;
use crate::source::emitter::Emitter;

/// A sky with a small bright spot and a dark half; `placed` turns and stretches the whole scene.
pub(super) fn sunny(placed: bool) -> Scene {
    let mut m = Maker::default();
    let n = Value::Number;
    let bright = m.add(
        "gradient",
        &[
            ("low", n(0.0)),
            ("high", n(3.0)),
            ("start", v3(0.0, -0.2, 0.0)),
            ("end", v3(0.3, 0.9, 0.1)),
        ],
    );
    let dots = m.add(
        "checker",
        &[("even", Value::Node(bright)), ("odd", v3(0.0, 0.1, 0.4)), ("size", n(0.4))],
    );
    m.add("background", &[("color", Value::Node(dots))]);
    if !placed {
        return m.scene();
    }
    let stretch = m.add("scale", &[("by", v3(1.0, 0.5, 1.5))]);
    let turn = m.add("rotate", &[("axis", v3(1.0, 1.0, 0.0)), ("angle", n(40.0))]);
    let list: Vec<Value> = [stretch, turn].map(Value::Node).into();
    m.scene_with(&[("transform", Value::List(list.into()))])
}

const COLUMNS: usize = 16;
const ROWS: usize = 12;

/// The bin of a direction.
fn bin(d: DVec3) -> usize {
    let u = 0.5 + atan2(d.x, d.y) / TAU;
    let v = 0.5 + asin(d.z.clamp(-1.0, 1.0)) / PI;
    let column = ((u * COLUMNS as f64) as usize).min(COLUMNS - 1);
    ((v * ROWS as f64) as usize).min(ROWS - 1) * COLUMNS + column
}

fn densities(sources: &Sources, normal: Option<DVec3>) -> [f64; COLUMNS * ROWS] {
    let mut expected = [0.0; COLUMNS * ROWS];
    let fine = 48;
    for j in 0..ROWS * fine {
        for i in 0..COLUMNS * fine {
            let u = TAU * ((i as f64 + 0.5) / (COLUMNS * fine) as f64 - 0.5);
            let v = PI * ((j as f64 + 0.5) / (ROWS * fine) as f64 - 0.5);
            let ((s, c), (z, level)) = (sin_cos(u), sin_cos(v));
            let d = DVec3::new(s * level, c * level, z);
            let solid_angle = TAU / (COLUMNS * fine) as f64 * PI / (ROWS * fine) as f64 * level;
            expected[j / fine * COLUMNS + i / fine] +=
                sources.density_of_sky(DVec3::ZERO, normal, d) * solid_angle;
        }
    }
    expected
}

#[test]
fn directions_are_found_as_often_as_they_say() {
    for placed in [false, true] {
        let scene = sunny(placed);
        for normal in [None, Some(DVec3::new(0.48, 0.6, 0.64))] {
            let expected = densities(&scene.sources, normal);
            let total: f64 = expected.iter().sum();
            let mut counts = [0_u32; COLUMNS * ROWS];
            let (mut r, n, mut off) = (Random::new(4), 200_000, 0);
            let emitter = scene.sources.choice.emitter(scene.sources.sky.unwrap());
            let Some(Emitter::Sky(sky)) = emitter else { panic!("no sky") };
            for _ in 0..n {
                let (direction, said) = sky.sample(normal, [r.unit(), r.unit()]).unwrap();
                let density = scene.sources.density_of_sky(DVec3::ZERO, normal, direction);
                // Rounding may find the next cell for a direction on an edge.
                off += u32::from((density / said - 1.0).abs() > 1e-9);
                counts[bin(direction)] += 1;
            }
            let (mut chi2, mut k) = (0.0, -1.0);
            for (e, &c) in expected.iter().zip(&counts) {
                let e = e / total * f64::from(n);
                if e > 10.0 {
                    chi2 += (f64::from(c) - e) * (f64::from(c) - e) / e;
                    k += 1.0;
                }
            }
            let spread = 2.0 / (9.0 * k);
            let z = (cbrt(chi2 / k) - (1.0 - spread)) / spread.sqrt();
            println!("{placed} {normal:?}: {total} {z}");
            assert!(off < 5, "{off}");
            assert!((total - 1.0).abs() < 3e-3 && z < 3.5, "{total} {z}");
        }
    }
}

#[test]
fn the_sky_lights_what_it_shows() {
    for placed in [false, true] {
        let scene = sunny(placed);
        for normal in [DVec3::Y, DVec3::new(-0.6, 0.0, 0.8), DVec3::NEG_Y] {
            let [asked, seen, both] = irradiance(&scene, DVec3::ZERO, normal, 40_000, 3);
            for a in [asked, both] {
                let error = (a.error() * a.error() + seen.error() * seen.error()).sqrt();
                let off = (a.value() - seen.value()).abs() / error;
                println!("{} {} {}", a.value(), a.error(), seen.error());
                assert!(off < 4.0, "{off}");
            }
            assert!(both.error() < seen.error());
        }
    }
}
