// SPDX-License-Identifier: MIT OR Apache-2.0
//! What every material of the registry promises, whatever its patterns give.

use dioptric_math::{DVec2, DVec3, Spectrum};
use dioptric_scene::args::make_node;
use dioptric_scene::schema::MATERIAL_COMMON;
use dioptric_scene::{Category, Default, Description, Schema, Type, Value};

use super::{Dressed, Finish, Material, Optics, SCHEMAS};
use crate::build::ColorReading;
use crate::pattern::PatternPoint;
use crate::setting::testing::with_node;

/// Points on a surface and points that no surface has.
fn points() -> Vec<PatternPoint> {
    [0.0, -0.0, 0.3, -7.5, 1e-300, 1e300, f64::INFINITY, f64::NEG_INFINITY, f64::NAN]
        .into_iter()
        .map(|x| {
            let p = DVec3::new(x, 0.2, -x);
            PatternPoint {
                object: p,
                world: p,
                uv: DVec2::new(x, 0.5),
                object_normal: DVec3::Z,
                world_normal: DVec3::Z,
                lot: 0.5,
            }
        })
        .collect()
}

/// Values for all pattern parameters of a material: none, constants, and a pattern that leaves [0, 1].
enum Fill {
    Nothing,
    Smallest,
    TooBright,
}

fn material(schema: &'static Schema, fill: &Fill) -> Dressed {
    let mut scene = Description::default();
    let pattern = |kind: &str| *crate::pattern::SCHEMAS.iter().find(|s| s.kind == kind).unwrap();
    let cells = [("even", Value::Vec3([9.0, 0.0, 2.0])), ("odd", Value::Vec3([0.0, 5.0, 1e9]))];
    let bright = scene.push(make_node(pattern("checker"), &cells).unwrap());
    let dull = scene.push(make_node(super::matte::Matte::SCHEMA, &[]).unwrap());
    let mut arguments = Vec::new();
    for param in schema.params.iter().chain(MATERIAL_COMMON) {
        let value = match (param.ty, fill) {
            (Type::Node(Category::Material), _) => Value::Node(dull),
            (Type::ColorPattern | Type::NumberPattern { .. }, Fill::TooBright) => {
                Value::Node(bright)
            }
            // One colour is no map.
            (Type::ColorPattern, Fill::Smallest) if param.name == "normal_map" => continue,
            (Type::ColorPattern, Fill::Smallest) => Value::Number(0.0),
            (Type::NumberPattern { min, .. } | Type::Number { min, .. }, Fill::Smallest) => {
                Value::Number(min.max(0.0))
            }
            (Type::NumberPattern { .. }, Fill::Nothing) if param.default == Default::Required => {
                Value::Number(0.0)
            }
            _ if schema.kind == "metal" && param.name == "color" => Value::Number(0.5),
            _ => continue,
        };
        arguments.push((param.name, value));
    }
    let id = scene.push(make_node(schema, &arguments).unwrap());
    with_node(&scene, id, ColorReading::Raw, Dressed::from_args)
        .unwrap_or_else(|why| panic!("{}: {}", schema.kind, why.message))
}

fn within(c: Spectrum, low: f64, high: f64) -> bool {
    c.to_array().iter().all(|x| (low..=high).contains(x))
}

fn check(finish: &Finish) -> Result<(), String> {
    let ok = |fine: bool, what: &str| if fine { Ok(()) } else { Err(what.to_string()) };
    let light = |c: Spectrum| within(c, 0.0, f64::MAX);
    ok(light(finish.ambient) && light(finish.diffuse), "ambient or diffuse")?;
    ok(light(finish.emission) && light(finish.base), "emission or base")?;
    ok(within(finish.shadow_pass, 0.0, 1.0), "shadow_pass")?;
    if let Some(h) = &finish.highlight {
        ok(light(h.color) && (0.0..=f64::MAX).contains(&h.exponent), "highlight")?;
    }
    let unit = |x: f64| (0.0..=1.0).contains(&x);
    match finish.optics {
        Optics::Opaque => Ok(()),
        Optics::Mirror { reflect, roughness, covers } => {
            let all = [0.0, 0.3, 1.0].map(|cos| reflect.at(cos));
            let shares = all.into_iter().chain([reflect.mean()]).all(|w| within(w, 0.0, 1.0));
            ok(shares && unit(roughness), "mirror")?;
            ok(!covers || within(finish.diffuse, 0.0, 1.0), "a coat over more than everything")
        }
        Optics::Shares { own, ior, tint, absorption } => {
            ok(unit(own) && ior > 0.0 && within(tint, 0.0, 1.0) && light(absorption), "shares")
        }
        Optics::Layered(l) => {
            let shares = [l.metallic, l.transmission, l.coat, l.alpha, l.coat_alpha];
            ok(shares.into_iter().all(unit) && within(l.sheen, 0.0, 1.0), "layers")?;
            ok(within(finish.base, 0.0, 1.0) && l.ior >= 1.0 && unit(l.specular), "base of layers")
        }
        Optics::Dielectric { ior, reflect, transmit, absorption, roughness } => {
            ok(ior > 0.0 && unit(roughness) && light(absorption), "dielectric")?;
            ok(within(reflect, 0.0, 1.0) && within(transmit, 0.0, 1.0), "tint of a dielectric")
        }
    }
}

#[test]
fn no_material_makes_light_or_nonsense_of_any_pattern_at_any_point() {
    for schema in SCHEMAS {
        for fill in [Fill::Nothing, Fill::Smallest, Fill::TooBright] {
            let material = material(schema, &fill);
            for point in points() {
                let finish = material.finish(&point);
                assert_eq!(check(&finish), Ok(()), "{}: {finish:?}", schema.kind);
            }
        }
    }
}

#[test]
fn pages_say_what_a_material_is_and_show_it() {
    for schema in SCHEMAS {
        assert!(schema.example.contains(schema.kind), "{}", schema.kind);
        assert!(schema.doc.ends_with('.') || schema.doc.ends_with("n.l)`."), "{}", schema.kind);
    }
}
