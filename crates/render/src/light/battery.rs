// SPDX-License-Identifier: MIT OR Apache-2.0
//! What every light of the registry promises for every point.

use dioptric_math::{DVec3, Spectrum};
use dioptric_scene::{Args, Default, Schema, Type, Value};

use super::{AnyLight, SCHEMAS};
use crate::build::{Builder, ColorReading};
use crate::setting::root::Root;
use crate::setting::testing::{scaled_root, with_args};

/// Lights of a kind: as simple as can be, and with every parameter that has a choice set to each word.
fn lights(schema: &'static Schema, root: &Root) -> Vec<AnyLight> {
    let required = schema.params.iter().filter_map(|param| match (param.ty, param.name) {
        // Edges must not be parallel; everything else may be anything.
        (Type::Direction, "edge_v") => Some((param.name, Value::Vec3([0.0, 0.3, 1.0]))),
        (Type::Direction, _) => Some((param.name, Value::Vec3([0.5, -1.0, 0.25]))),
        (Type::Vec3, _) if param.default == Default::Required => {
            Some((param.name, Value::Vec3([1.0, 2.0, 3.0])))
        }
        _ => None,
    });
    let base: Vec<_> = required.collect();
    let mut all = vec![base.clone()];
    for param in schema.params {
        let values: Vec<Value> = match param.ty {
            Type::Choice(words) => words.iter().map(|&w| Value::Text(w.into())).collect(),
            _ if param.name == "radius" => [1e-9, 1.0, 90.0].map(Value::Number).to_vec(),
            _ if param.name == "angle" => [1e-3, 1.0, 180.0].map(Value::Number).to_vec(),
            _ => continue,
        };
        let known = all.clone();
        for value in values {
            all.extend(known.iter().map(|a| {
                let mut with = a.clone();
                with.push((param.name, value.clone()));
                with
            }));
        }
    }
    all.iter()
        .map(|arguments| {
            let build =
                |args: &Args, builder: &mut Builder| AnyLight::from_args(args, builder, root);
            with_args(schema, arguments, ColorReading::Raw, build)
                .unwrap_or_else(|why| panic!("{}: {}", schema.kind, why.message))
        })
        .collect()
}

#[test]
fn no_light_sends_nonsense_to_any_point() {
    const LAST: f64 = 1.0 - f64::EPSILON / 2.0;
    let center = DVec3::new(1.0, 2.0, 3.0);
    let points = [
        center,
        center + DVec3::splat(1e-16),
        center * (1.0 + 1e-15),
        center + DVec3::X,
        center + DVec3::new(0.0, 0.5, 0.0),
        DVec3::ZERO,
        DVec3::splat(-1e9),
        DVec3::splat(1e300),
        DVec3::splat(f64::MAX),
        DVec3::splat(f64::NAN),
        DVec3::splat(f64::INFINITY),
    ];
    for scale in [1e-6, 1.0, 1e6] {
        let root = scaled_root(scale);
        for schema in SCHEMAS {
            for light in lights(schema, &root) {
                assert!(light.samples() >= 1);
                for point in points {
                    for u in [[0.0, 0.0], [LAST, LAST], [0.5, 0.5], [0.0, LAST], [0.5, 0.0]] {
                        let Some(s) = light.sample(point * scale, u) else { continue };
                        let place = format!("{} at {point} for {u:?}: {s:?}", schema.kind);
                        assert!((s.direction.length() - 1.0).abs() < 1e-12, "{place}");
                        assert!(s.distance >= 0.0, "{place}");
                        assert!(
                            s.arriving.is_finite() && s.arriving.cmpge(Spectrum::ZERO).all(),
                            "{place}"
                        );
                    }
                }
            }
        }
    }
}
