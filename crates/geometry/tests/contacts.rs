// SPDX-License-Identifier: MIT OR Apache-2.0
//! Things that touch: a disc on the face of a box and on a plane, turned, scaled and moved together. A ray that
//! leaves one of them to the side from which it was reached is free of the others; one that goes on through it
//! meets them at once.

mod common;

use common::direction;
use dioptric_geometry::shapes::{cuboid::Cuboid, disc::Disc, plane::Plane, rectangle::Rectangle};
use dioptric_geometry::{AnyShape, Contacts, Departure, HitId, Ray, World, WorldBuilder};
use dioptric_math::random::Random;
use dioptric_math::{DAffine3, DMat3, DVec3, orthonormal_basis};

/// Anywhere, turned anyhow.
fn placement(r: &mut Random, scale: f64, far: f64) -> DAffine3 {
    let up = direction(r);
    let (t, b) = orthonormal_basis(up);
    DAffine3::from_mat3_translation(
        DMat3::from_cols(t, b, up) * scale,
        direction(r) * (far * scale),
    )
}

/// A disc of radius 1 in the plane z = 0, on one of several walls below it.
fn world(place: DAffine3, wall: usize) -> World {
    let across = [DVec3::X * 8.0, DVec3::Y * 8.0];
    let wall = match wall {
        0 => {
            let (min, max) = (DVec3::new(-3.0, -3.0, -2.0), DVec3::new(3.0, 3.0, 0.0));
            AnyShape::Cuboid(Box::new(Cuboid::new(min, max)))
        }
        1 => AnyShape::Plane(Box::new(Plane::new(DVec3::ZERO, DVec3::Z).unwrap())),
        2 => AnyShape::Plane(Box::new(Plane::new(DVec3::ZERO, DVec3::NEG_Z).unwrap())),
        _ => {
            let corner = DVec3::new(-4.0, -4.0, 0.0);
            AnyShape::Rectangle(Box::new(Rectangle::new(corner, across[0], across[1]).unwrap()))
        }
    };
    let mut world = WorldBuilder::new();
    let disc = AnyShape::Disc(Box::new(Disc::new(DVec3::ZERO, DVec3::Z, 1.0, 0.0).unwrap()));
    world.object(disc, place).unwrap();
    world.object(wall, place).unwrap();
    world.build()
}

#[test]
fn rays_cross_what_touches_only_where_they_go_on() {
    let mut r = Random::new(11);
    let (mut back, mut on) = (0, 0);
    for (scale, far) in [(1.0, 0.0), (1e-6, 0.0), (1e6, 3.0), (1.0, 1e5), (1e-3, 1e4)] {
        for case in 0..400 {
            let place = placement(&mut r, scale, far);
            let up = place.matrix3.z_axis / scale;
            let world = world(place, case % 4);
            let target =
                place.transform_point3(DVec3::new(r.uniform(-0.6, 0.6), r.uniform(-0.6, 0.6), 0.0));
            let from = target + (direction(&mut r) + up * 1.5) * (4.0 * scale);
            let ray = Ray::new(from, (target - from).normalize());
            let hit = world.closest(&ray, f64::INFINITY, None).expect("the disc or the wall");
            let s = world.surface(&ray, &hit).unwrap();
            let other = HitId { object: 1 - hit.id.object, ..hit.id };
            for _ in 0..10 {
                let mut d = direction(&mut r);
                if d.dot(up) < 0.0 {
                    d = -d;
                }
                if d.dot(up) < 1e-6 {
                    continue; // slides along both: no side is its own
                }
                let past = |d: DVec3, contacts: Contacts| {
                    let ray = Ray { error: s.error, ..Ray::new(s.point, d) };
                    let departure = Departure { from: hit.id, outward: d.dot(s.normal) > 0.0 };
                    let found = world.closest_past(&ray, f64::INFINITY, Some(&departure), contacts);
                    let hidden =
                        world.occluded_past(&ray, f64::INFINITY, Some(&departure), contacts);
                    assert_eq!(found.is_some(), hidden);
                    found.map(|h| (h, world.surface(&ray, &h).unwrap()))
                };
                let stays = Contacts { crossed: false, except: None };
                let but = Contacts { crossed: false, except: Some(other) };
                assert_eq!(past(d, stays), None, "{scale} {far} {case}");
                back += 1;
                // Into the wall: what touches is met where the ray begins.
                let (met, at) = past(-d, Contacts::CROSSED).expect("the other one");
                assert_eq!(met.id.object, other.object);
                assert!(
                    met.t * d.dot(at.normal).abs() <= at.error + s.error,
                    "{scale} {far} {case}"
                );
                assert_eq!(past(-d, but).map(|h| h.0), Some(met));
                // Crossed before, it is not met again, unless it is a box that the ray leaves below.
                let again = past(-d, Contacts { crossed: true, except: Some(other) });
                match again {
                    None => assert!(case % 4 != 0 || hit.id.object == 1, "{scale} {far} {case}"),
                    Some((h, s)) => assert!(
                        h.id == met.id && h.t * d.dot(s.normal).abs() > scale
                            || world.shape(h.id.object).unwrap().is_solid(),
                        "{scale} {far} {case}: {h:?}"
                    ),
                }
                on += 1;
            }
        }
    }
    println!("{back} rays that stay and {on} that go on");
}
