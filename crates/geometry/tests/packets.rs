// SPDX-License-Identifier: MIT OR Apache-2.0
//! Rays that are cast together find what each finds alone, on every instruction set, to the last bit.

mod common;

use common::specimens::specimens;
use common::{Place, Specimen};
use dioptric_geometry::bvh::Lanes;
use dioptric_geometry::shapes::cylinder::Cylinder;
use dioptric_geometry::shapes::plane::Plane;
use dioptric_geometry::shapes::polygon::Polygon;
use dioptric_geometry::shapes::sphere::Sphere;
use dioptric_geometry::shapes::triangle::Triangle;
use dioptric_geometry::world::{Hit, Passages, Query, Rays};
use dioptric_geometry::{AnyShape, Contacts, Departure, Ray, SurfacePoint, World, WorldBuilder};
use dioptric_math::random::Random;
use dioptric_math::{DAffine3, DMat3, DVec3, cos, normalize, sin};

fn vector(random: &mut Random, size: f64) -> DVec3 {
    DVec3::from_array([0; 3].map(|_| random.uniform(-size, size)))
}

/// Casts the queries one by one and together; returns how many hit something.
fn compare(name: &str, world: &mut World, queries: &[Query]) -> usize {
    let alone: Vec<_> = queries
        .iter()
        .map(|q| world.closest_past(&q.ray, q.t_max, q.departure().as_ref(), q.contacts()))
        .collect();
    let blocked: Vec<_> = queries
        .iter()
        .map(|q| world.occluded_past(&q.ray, q.t_max, q.departure().as_ref(), q.contacts()))
        .collect();
    let (mut hits, mut blockers) = (Vec::new(), Vec::new());
    for lanes in [Lanes::Plain, Lanes::Avx2, Lanes::Avx512] {
        world.use_lanes(lanes);
        world.closest_each(queries, &mut hits);
        world.blocker_each(queries, &mut blockers);
        assert_eq!(hits.len(), queries.len());
        for (i, query) in queries.iter().enumerate() {
            assert_eq!(hits[i], alone[i], "{name} {lanes:?} {i}: {query:?}");
            assert_eq!(blockers[i].is_some(), blocked[i], "{name} {lanes:?} {i}: {query:?}");
        }
        compare_bundles(world, queries, &hits, &blocked);
    }
    alone.iter().flatten().count()
}

/// The same for rays that lie side by side, of which not all are wanted.
fn compare_bundles(world: &World, queries: &[Query], hits: &[Option<Hit>], blocked: &[bool]) {
    let mut rays = Rays::default();
    for query in queries {
        rays.push(query);
    }
    let mut found = Vec::new();
    world.closest_of_rays(&rays, &mut found);
    for (i, hit) in hits.iter().enumerate() {
        assert_eq!(found[i / 16].best(i % 16), *hit, "{i}");
        assert_eq!(rays.bundles()[i / 16].query(i % 16).contacts(), queries[i].contacts());
    }
    let (mut passages, mut all) = (Passages::default(), Vec::new());
    for (at, bundle) in rays.bundles().iter().enumerate() {
        let wanted = [u16::MAX, 0x5a17][at % 2];
        world.hits_of_rays(bundle, wanted, &mut passages);
        for (lane, query) in queries.iter().enumerate().skip(16 * at).take(16) {
            world.hits(&query.ray, query.t_max, query.departure().as_ref(), &mut all);
            if wanted & 1 << (lane % 16) == 0 {
                all.clear();
            }
            assert_eq!(passages.of(lane % 16), all, "{lane}: {query:?}");
        }
    }
    // All, some and few of each sixteen.
    for wanted in [u16::MAX, 0b1010_1010_1010_1010, 0b100_0000_0000_0001] {
        let mut wanted = vec![wanted; rays.bundles().len()];
        if let Some(last) = wanted.last_mut() {
            *last &= ((1_u32 << ((queries.len() - 1) % 16 + 1)) - 1) as u16;
        }
        world.blockers_of_rays(rays.bundles(), &wanted, &mut found);
        for (i, blocked) in blocked.iter().enumerate() {
            let asked = wanted[i / 16] & 1 << (i % 16) != 0;
            assert_eq!(found[i / 16].hit & 1 << (i % 16) != 0, asked && *blocked, "{i}");
        }
    }
}

/// Rays of all sorts: side by side and criss-cross, those that leave what others hit, some that are none.
fn queries(world: &World, random: &mut Random, size: f64) -> Vec<Query> {
    let mut all = Vec::new();
    let plain = |ray, t_max| Query::new(ray, t_max, None, Contacts::CROSSED);
    for i in 0..60 {
        let from = vector(random, 2.0 * size);
        let to = vector(random, 0.7 * size) - from;
        for _ in 0..random.bits() % 20 {
            let spread = if i % 2 == 0 { 0.02 } else { 1.0 };
            let mut direction = to + vector(random, spread * size);
            if i % 7 == 0 {
                direction[i % 3] = 0.0;
            }
            let t_max = if i % 3 == 0 { random.uniform(0.0, 2.0) } else { f64::INFINITY };
            all.push(plain(Ray::new(from, direction * [1e-3, 1.0, 40.0][i % 3]), t_max));
        }
    }
    let mut next = Vec::new();
    for query in &all {
        let Some(hit) = world.closest(&query.ray, query.t_max, None) else { continue };
        let Some(s) = world.surface_point(&query.ray, &hit) else { continue };
        let direction = vector(random, 1.0);
        let ray = Ray { origin: s.point, direction, time: 0.0, error: s.error };
        let outward = direction.dot(s.normal) > 0.0;
        let departure = Some(Departure { from: hit.id, outward });
        let contacts = Contacts { crossed: outward, except: None };
        next.push(Query::new(ray, f64::INFINITY, departure, contacts));
    }
    all.extend(next);
    for wrong in [f64::NAN, f64::INFINITY, 0.0, 1e300, 1e-300] {
        all.push(plain(Ray::new(DVec3::splat(wrong), DVec3::X), f64::INFINITY));
        all.push(plain(Ray::new(DVec3::ZERO, DVec3::splat(wrong)), f64::INFINITY));
        all.push(plain(Ray::new(DVec3::ZERO, DVec3::X), wrong));
        all.push(plain(Ray::new(DVec3::ZERO, DVec3::X), -wrong));
    }
    all
}

#[test]
fn every_shape_alone() {
    let mut random = Random::new(5);
    let mut hits = 0;
    for (scale, offset) in [(1.0, 0.0), (common::TINY, 0.0), (common::MILLION, 2.0)] {
        for specimen in specimens(Place { scale, offset: DVec3::splat(offset) }) {
            hits += one(&specimen, &mut random);
        }
    }
    assert!(hits > 10_000, "{hits}");
}

/// A specimen by itself; also its surface points, which must be what its surfaces say.
fn one(specimen: &Specimen, random: &mut Random) -> usize {
    let size = specimen.shape.bounds().size().max_element();
    let size = if size.is_finite() && size > 0.0 { size } else { specimen.place.scale };
    let mut builder = WorldBuilder::new();
    builder.object(specimen.shape.clone(), DAffine3::IDENTITY).unwrap();
    let mut world = builder.build();
    let middle = specimen.shape.bounds().center();
    let middle = if middle.is_finite() { middle } else { DVec3::ZERO };
    let mut queries = queries(&world, random, size);
    for query in &mut queries {
        if query.departure().is_none() {
            query.ray.origin += middle;
        }
    }
    for query in &queries {
        let Some(hit) = world.closest(&query.ray, query.t_max, None) else { continue };
        let (whole, point) =
            (world.surface(&query.ray, &hit), world.surface_point(&query.ray, &hit));
        assert_eq!(whole.map(SurfacePoint::from), point, "{}", specimen.name);
    }
    compare(specimen.name, &mut world, &queries)
}

/// Four to ten corners around a point, almost in a plane.
fn polygon(random: &mut Random, center: DVec3, u: DVec3, corners: usize) -> Polygon {
    let size = u.length();
    let v = normalize(u.cross(vector(random, 1.0))).unwrap() * size;
    let n = normalize(u.cross(v)).unwrap() * size;
    let count = 4 + corners / 4 % 7;
    let corner = |i: usize| {
        let angle = 6.0 * (i as f64 + random.uniform(0.0, 0.8)) / count as f64;
        let (x, y) = (cos(angle), sin(angle));
        center + (u * x + v * y) * random.uniform(0.2, 1.0) + n * random.uniform(-5e-5, 5e-5)
    };
    Polygon::new([(0..count).map(corner).collect()]).unwrap()
}

#[test]
fn crowds_with_transforms_instances_and_planes() {
    for (scale, moved) in [(1.0, 0.0), (1e-6, 0.0), (1e6, 0.0), (1.0, 1e5)] {
        let mut random = Random::new(9);
        let place = |p: DVec3| p * scale + DVec3::splat(moved);
        let mut builder = WorldBuilder::new();
        for i in 0..400_usize {
            let center = place(vector(&mut random, 4.0));
            let length = vector(&mut random, scale);
            let shape = match i % 4 {
                0 => AnyShape::Sphere(Sphere::new(center, scale * random.uniform(0.02, 0.5))),
                1 => {
                    let radius = scale * random.uniform(0.01, 0.2);
                    let cylinder = Cylinder::new(center, length, radius, false).unwrap();
                    AnyShape::Cylinder(Box::new(cylinder))
                }
                2 => {
                    let other = vector(&mut random, scale);
                    let corners = [center, center + length, center + other];
                    AnyShape::Triangle(Box::new(Triangle::new(corners).unwrap()))
                }
                _ => AnyShape::Polygon(Box::new(polygon(&mut random, center, length, i))),
            };
            let turn = DMat3::from_rotation_y(0.3 * (i % 5 / 4) as f64);
            builder.object(shape, DAffine3::from_mat3(turn)).unwrap();
        }
        let floor = Plane::new(place(DVec3::new(0.0, -3.0, 0.0)), DVec3::Y).unwrap();
        builder.object(AnyShape::Plane(Box::new(floor)), DAffine3::IDENTITY).unwrap();
        let group = builder.begin_group();
        builder
            .object(AnyShape::Sphere(Sphere::new(DVec3::ZERO, 0.4 * scale)), DAffine3::IDENTITY)
            .unwrap();
        builder.end_group();
        for _ in 0..20 {
            let at = place(vector(&mut random, 4.0));
            builder.instance(group, DAffine3::from_translation(at)).unwrap();
        }
        let mut world = builder.build();
        let mut queries = queries(&world, &mut random, 4.0 * scale);
        for query in &mut queries {
            if query.departure().is_none() {
                query.ray.origin += DVec3::splat(moved);
            }
        }
        let hits = compare("crowd", &mut world, &queries);
        assert!(hits > 250, "{scale} {moved}: {hits}");
    }
}
