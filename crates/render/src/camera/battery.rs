// SPDX-License-Identifier: MIT OR Apache-2.0
//! What every camera of the registry promises for every point of the picture.

use dioptric_geometry::world::Bundle;
use dioptric_math::{DAffine3, DVec3};
use dioptric_scene::args::make_node;
use dioptric_scene::{Args, Description, Value};

use super::{AnyCamera, Places, SCHEMAS};
use crate::setting::root::Root;

#[test]
fn rays_are_finite_unit_and_point_ahead_in_the_middle() {
    let arguments =
        [("eye", Value::Vec3([1.0, 2.0, 3.0])), ("look_at", Value::Vec3([-2.0, 1.0, 0.5]))];
    let place = DAffine3::from_rotation_x(1.0);
    let roots = [1e-6, 1.0, 1e6]
        .map(|s| Root::new(DAffine3::from_scale(DVec3::new(-s, s, s)) * place, DVec3::Z).unwrap());
    for schema in SCHEMAS {
        let mut scene = Description::default();
        let id = scene.push(make_node(schema, &arguments).unwrap());
        let args = Args::new(&scene, id);
        for root in &roots {
            for aspect in [1.0 / 16384.0, 0.5, 1.0, 16384.0] {
                let camera = AnyCamera::from_args(&args, root, aspect).unwrap();
                let middle = camera.ray(0.5, 0.5, [0.5; 2]).unwrap();
                let ahead = root.vector(DVec3::new(-3.0, -1.0, -2.5)).normalize();
                assert!((middle.direction - ahead).length() < 1e-9, "{}", schema.kind);
                for i in 0..=8 {
                    for j in 0..=8 {
                        let (x, y) = (f64::from(i) / 8.0, f64::from(j) / 8.0);
                        let Some(ray) = camera.ray(x, y, [0.0, 0.999]) else { continue };
                        assert!(ray.origin.is_finite(), "{}", schema.kind);
                        assert!((ray.direction.length() - 1.0).abs() < 1e-12, "{}", schema.kind);
                    }
                }
                sixteen_at_once(&camera);
            }
        }
    }
}

/// Sixteen rays made at once are those made one by one.
fn sixteen_at_once(camera: &AnyCamera) {
    let mut places = Places::CORNER;
    for i in 0..16 {
        (places.x[i], places.y[i]) = (0.01 + 0.06 * i as f64, 0.99 - 0.3 * (i % 4) as f64);
        places.lens[i] = [0.1 + 0.05 * i as f64, 0.7];
    }
    let mut rays = Bundle::EMPTY;
    let seen = camera.rays(&places, &mut rays);
    for i in 0..16 {
        let alone = camera.ray(places.x[i], places.y[i], places.lens[i]);
        let found = (seen & 1 << i != 0).then(|| rays.ray(i));
        assert_eq!(found, alone);
        assert!(alone.is_none() || rays.t_max[i] == f64::INFINITY);
    }
}
