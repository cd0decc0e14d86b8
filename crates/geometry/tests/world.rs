// SPDX-License-Identifier: MIT OR Apache-2.0
//! Worlds against their slow twin, which asks every object, and the rules for rays that leave
//! something.

mod common;

use common::specimens::specimens;
use common::{MILLION, Place};
use dioptric_geometry::shapes::cuboid::Cuboid;
use dioptric_geometry::shapes::plane::Plane;
use dioptric_geometry::shapes::rectangle::Rectangle;
use dioptric_geometry::shapes::sphere::Sphere;
use dioptric_geometry::{
    AnyShape, Departure, GroupId, Hit, HitId, Leaving, LocalRay, PlacementError, Ray, Transform,
    World, WorldBuilder,
};
use dioptric_math::random::Random;
use dioptric_math::{DAffine3, DMat3, DVec3};

/// An object's id, shape and placement.
type Placed = (u32, AnyShape, DAffine3);

/// A world and the flat list of what is in it.
#[derive(Default)]
struct Twin {
    builder: WorldBuilder,
    top: Vec<Placed>,
    groups: Vec<(GroupId, Vec<Placed>)>,
    instances: Vec<(usize, DAffine3)>,
}

impl Twin {
    fn object(&mut self, shape: AnyShape, placement: DAffine3) {
        let id = self.builder.object(shape.clone(), placement).unwrap();
        self.top.push((id, shape, placement));
    }

    fn group(&mut self, objects: Vec<(AnyShape, DAffine3)>) {
        let group = self.builder.begin_group();
        let members = objects
            .into_iter()
            .map(|(s, p)| (self.builder.object(s.clone(), p).unwrap(), s, p))
            .collect();
        self.builder.end_group();
        self.groups.push((group, members));
    }

    fn instance(&mut self, group: usize, placement: DAffine3) {
        let id = self.builder.instance(self.groups[group].0, placement).unwrap();
        assert_eq!(id as usize, self.instances.len());
        self.instances.push((group, placement));
    }

    /// Every object's nearest hit.
    fn all(&self, ray: &Ray, t_max: f64, departure: Option<&Departure>) -> Vec<Hit> {
        let mut hits = Vec::new();
        let usable = ray.origin.is_finite()
            && ray.direction.is_finite()
            && ray.direction != DVec3::ZERO
            && t_max >= 0.0;
        if !usable {
            return hits;
        }
        let mut ask = |instance: u32, of_instance: DAffine3, (id, shape, placement): &Placed| {
            let mut local = LocalRay {
                origin: ray.origin,
                direction: ray.direction,
                error: ray.error,
                t_max,
                leaving: departure
                    .filter(|d| d.from.instance == instance && d.from.object == *id)
                    .map(|d| Leaving { part: d.from.part, outward: d.outward }),
            };
            for placement in [of_instance, *placement] {
                if placement != DAffine3::IDENTITY {
                    let transform = Transform::new(placement).unwrap();
                    (local.origin, local.error) =
                        transform.point_to_local(local.origin, local.error);
                    local.direction = transform.direction_to_local(local.direction);
                }
            }
            if let Some(root) = shape.intersect(&local) {
                hits.push(Hit { t: root.t, id: HitId { instance, object: *id, part: root.part } });
            }
        };
        for object in &self.top {
            ask(HitId::NO_INSTANCE, DAffine3::IDENTITY, object);
        }
        for (instance, (group, placement)) in self.instances.iter().enumerate() {
            for object in &self.groups[*group].1 {
                ask(instance as u32, *placement, object);
            }
        }
        hits.sort_by(|a, b| a.t.total_cmp(&b.t).then(a.id.cmp(&b.id)));
        hits
    }
}

fn vector(random: &mut Random, size: f64) -> DVec3 {
    DVec3::from_array([0; 3].map(|_| random.uniform(-size, size)))
}

fn ball(random: &mut Random, size: f64, radius: f64) -> AnyShape {
    AnyShape::Sphere(Sphere::new(vector(random, size), random.uniform(0.0, radius) + radius * 1e-3))
}

/// A matrix that rotates, shears and mirrors, not far from singular at times.
fn placement(random: &mut Random, size: f64) -> DAffine3 {
    let columns = [0; 3].map(|_| vector(random, 1.0));
    let m = DMat3::from_cols(columns[0], columns[1], columns[2]);
    let m = if m.determinant().abs() > 1e-3 { m } else { DMat3::IDENTITY };
    DAffine3::from_mat3_translation(m, vector(random, size))
}

/// A ray at something; now and then along an axis, or from inside.
fn ray(random: &mut Random, size: f64) -> Ray {
    let origin = vector(random, 2.0 * size);
    let mut direction = vector(random, size) - origin;
    match random.bits() % 8 {
        0 => direction = DVec3::new(0.0, -0.0, direction.z),
        1 => direction.y = 0.0,
        2 => direction = DVec3::new(-direction.x, 0.0, -0.0),
        _ => {}
    }
    Ray {
        error: if random.bits().is_multiple_of(2) { 0.0 } else { size * 1e-9 },
        ..Ray::new(origin, direction)
    }
}

/// All queries of one ray agree with the twin's.
fn compare(
    twin: &Twin,
    world: &World,
    ray: &Ray,
    t_max: f64,
    departure: Option<&Departure>,
) -> bool {
    let all = twin.all(ray, t_max, departure);
    assert_eq!(world.closest(ray, t_max, departure), all.first().copied(), "{ray:?} {t_max}");
    assert_eq!(world.occluded(ray, t_max, departure), all.first().is_some_and(|h| h.t < t_max));
    for hit in &all {
        let alone = world.closest_of(ray, t_max, departure, hit.id.instance, hit.id.object);
        assert_eq!(alone.as_ref(), Some(hit));
    }
    let mut hits = vec![Hit { t: 7.0, id: HitId { instance: 7, object: 7, part: 7 } }];
    world.hits(ray, t_max, departure, &mut hits);
    assert!(hits.is_sorted_by(|a, b| (a.t, a.id) <= (b.t, b.id)));
    let mut objects: Vec<_> = hits.iter().map(|h| (h.id.instance, h.id.object)).collect();
    objects.sort_unstable();
    objects.dedup();
    let mut expected: Vec<_> = all.iter().map(|h| (h.id.instance, h.id.object)).collect();
    expected.sort_unstable();
    assert_eq!(objects, expected, "{ray:?}");
    !all.is_empty()
}

/// A soup of spheres, ellipsoids and instances about `away`.
fn soup(random: &mut Random, objects: usize, size: f64, away: DVec3) -> (Twin, World) {
    let mut twin = Twin::default();
    let there = DAffine3::from_translation(away);
    for i in 0..objects {
        let radius = size * if i % 16 == 0 { 0.5 } else { 0.1 };
        match random.bits() % 4 {
            0 => twin.object(
                ball(random, 1.0, 0.2),
                there * DAffine3::from_scale(DVec3::splat(size)) * placement(random, 0.8),
            ),
            _ => {
                let center = away + vector(random, size);
                let ball = Sphere::new(center, random.uniform(0.1, 1.0) * radius);
                twin.object(AnyShape::Sphere(ball), DAffine3::IDENTITY);
                if i % 5 == 0 {
                    twin.object(AnyShape::Sphere(ball), DAffine3::IDENTITY); // a tie
                }
            }
        }
    }
    for group in 0..objects.min(3) {
        let members = (0..objects / 8)
            .map(|i| {
                let place = if i % 2 == 0 { DAffine3::IDENTITY } else { placement(random, 0.5) };
                (ball(random, 0.5, 0.1), place)
            })
            .collect();
        twin.group(members);
        twin.instance(group, there * DAffine3::from_scale(DVec3::splat(size)));
        twin.instance(
            group,
            there * DAffine3::from_scale(DVec3::splat(size)) * placement(random, 0.5),
        );
    }
    let world = twin.builder.clone().build();
    (twin, world)
}

#[test]
fn a_world_answers_as_its_slow_twin() {
    let mut random = Random::new(11);
    let mut found = 0;
    for (objects, size, away) in [
        (0, 1.0, 0.0),
        (1, 1.0, 0.0),
        (2, 1.0, 0.0),
        (9, 1.0, 1e5),
        (40, 1e-6, 0.0),
        (40, 1e-6, 1e-1),
        (60, 1e6, 0.0),
        (300, 1.0, 0.0),
        (300, 1.0, 1e5),
        (200, 1e-30, 0.0),
        (200, 1e30, 0.0),
    ] {
        let away = DVec3::new(away, -0.7 * away, 0.3 * away);
        let (twin, world) = soup(&mut random, objects, size, away);
        for i in 0..600 {
            let mut r = ray(&mut random, size);
            r.origin += away;
            let t_max = if i % 3 == 0 { random.uniform(0.0, 1.5) } else { f64::INFINITY };
            found += u32::from(compare(&twin, &world, &r, t_max, None));
            // On from the hit, to both sides, and up to the very t of what is hit.
            let Some(hit) = world.closest(&r, t_max, None) else { continue };
            compare(&twin, &world, &r, hit.t, None);
            let s = world.surface(&r, &hit).unwrap();
            for outward in [true, false] {
                let direction = vector(&mut random, size);
                let to_normal = direction.dot(s.normal) > 0.0;
                let on = Ray {
                    error: s.error,
                    ..Ray::new(s.point, if to_normal == outward { direction } else { -direction })
                };
                let departure = Departure { from: hit.id, outward };
                compare(&twin, &world, &on, f64::INFINITY, Some(&departure));
                compare(&twin, &world, &on, f64::INFINITY, None);
            }
        }
    }
    assert!(found > 1000, "only {found} rays hit");
}

#[test]
fn a_world_of_all_shapes_answers_as_its_slow_twin() {
    let mut random = Random::new(12);
    let mut found = 0;
    for (scale, away) in [(1.0, 0.0), (1.0 / MILLION, 0.0), (MILLION, 0.0), (1.0, 1e5)] {
        let mut twin = Twin::default();
        let here = Place { scale, offset: DVec3::ZERO };
        let kinds = specimens(here).len();
        for i in 0..3 * kinds {
            // One of the size of the scene, others smaller, each with a tree's worth of neighbours.
            let small = Place { scale: scale / f64::from(1 << (i % 4)), offset: DVec3::ZERO };
            let Some(specimen) = specimens(small).into_iter().nth(i % kinds) else { continue };
            let at = DVec3::splat(away) + vector(&mut random, 4.0 * scale);
            let place = DAffine3::from_translation(at) * placement(&mut random, 0.0);
            twin.object(specimen.shape, place);
        }
        let world = twin.builder.clone().build();
        for _ in 0..300 {
            let mut r = ray(&mut random, 4.0 * scale);
            r.origin += DVec3::splat(away);
            found += u32::from(compare(&twin, &world, &r, f64::INFINITY, None));
            let Some(hit) = world.closest(&r, f64::INFINITY, None) else { continue };
            let s = world.surface(&r, &hit).unwrap();
            let direction = vector(&mut random, scale);
            let outward = direction.dot(s.normal) > 0.0;
            let on = Ray { error: s.error, ..Ray::new(s.point, direction) };
            let departure = Departure { from: hit.id, outward };
            compare(&twin, &world, &on, f64::INFINITY, Some(&departure));
        }
    }
    assert!(found > 800, "only {found} rays hit");
}

#[test]
fn rays_and_limits_that_are_no_numbers_hit_nothing() {
    let mut random = Random::new(5);
    let (twin, world) = soup(&mut random, 20, 1.0, DVec3::ZERO);
    let mut hits = Vec::new();
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for axis in 0..3 {
            for in_direction in [false, true] {
                let mut r = ray(&mut random, 1.0);
                if in_direction {
                    r.direction[axis] = bad
                } else {
                    r.origin[axis] = bad
                }
                assert!(!compare(&twin, &world, &r, f64::INFINITY, None));
                let hit =
                    Hit { t: 1.0, id: HitId { instance: HitId::NO_INSTANCE, object: 0, part: 0 } };
                let _ = world.surface(&r, &hit);
            }
        }
    }
    let r = Ray::new(DVec3::new(0.0, 0.0, 9.0), -DVec3::Z);
    for t_max in [f64::NAN, -1.0, f64::NEG_INFINITY] {
        assert!(world.closest(&r, t_max, None).is_none() && !world.occluded(&r, t_max, None));
        world.hits(&r, t_max, None, &mut hits);
        assert!(hits.is_empty());
    }
    assert!(world.closest(&Ray::new(r.origin, DVec3::ZERO), 1.0, None).is_none());
    assert!(world.closest(&Ray { error: f64::NAN, ..r }, 1.0, None).is_none());
    assert!(world.closest_of(&r, 1.0, None, 99, 99).is_none());
    let nowhere = Hit { t: 1.0, id: HitId { instance: 99, object: 99, part: 0 } };
    assert!(world.surface(&r, &nowhere).is_none() && world.shape(99).is_none());
}

#[test]
fn a_ray_through_a_solid_gives_its_entry_and_its_exit() {
    let mut builder = WorldBuilder::new();
    for z in [0.0, -1.0] {
        let center = DVec3::new(0.0, 0.0, z);
        builder.object(AnyShape::Sphere(Sphere::new(center, 1.0)), DAffine3::IDENTITY).unwrap();
    }
    let world = builder.build();
    let ray = Ray::new(DVec3::new(0.0, 0.0, 5.0), DVec3::new(0.0, 0.0, -2.0));
    let mut hits = Vec::new();
    world.hits(&ray, 10.0, None, &mut hits);
    let found: Vec<_> = hits.iter().map(|h| (h.t, h.id.object)).collect();
    assert_eq!(found, [(2.0, 0), (2.5, 1), (3.0, 0), (3.5, 1)]);
    world.hits(&ray, 2.5, None, &mut hits);
    assert_eq!(hits.len(), 2);
    // From the first ball's near side inward: its near crossing is left, its far one stays.
    let from = HitId { instance: HitId::NO_INSTANCE, object: 0, part: 0 };
    let inside = Ray::new(DVec3::Z, -DVec3::Z);
    world.hits(&inside, 10.0, Some(&Departure { from, outward: false }), &mut hits);
    let found: Vec<_> = hits.iter().map(|h| (h.t, h.id.object)).collect();
    assert_eq!(found, [(1.0, 1), (2.0, 0), (3.0, 1)]);
    // Strictly before the limit only.
    assert!(!world.occluded(&ray, 2.0, None) && world.occluded(&ray, 2.0_f64.next_up(), None));
    assert_eq!(world.closest(&ray, 2.0, None).map(|h| h.t), Some(2.0));
}

#[test]
fn mirrored_and_sheared_objects_have_outward_normals() {
    let mut random = Random::new(3);
    for _ in 0..200 {
        let (outer, inner) = (placement(&mut random, 3.0), placement(&mut random, 3.0));
        let mut builder = WorldBuilder::new();
        let group = builder.begin_group();
        builder.object(AnyShape::Sphere(Sphere::new(DVec3::ZERO, 1.0)), inner).unwrap();
        builder.end_group();
        builder.instance(group, outer).unwrap();
        let world = builder.build();
        let center = outer.transform_point3(inner.translation);
        let r = Ray::new(center, vector(&mut random, 1.0));
        let hit = world.closest(&r, f64::INFINITY, None).unwrap();
        let s = world.surface(&r, &hit).unwrap();
        assert!(s.normal.dot(r.direction) > 0.0 && (s.normal.length() - 1.0).abs() < 1e-14);
        assert!(s.normal.dot(s.dpdu).abs() < 1e-9 * s.dpdu.length());
        assert!((s.local_point.length() - 1.0).abs() < 1e-14);
        assert!((s.point - r.at(hit.t)).length() < 1e-12 * (s.point.length() + center.length()));
    }
}

#[test]
fn instances_equal_their_flattened_copies() {
    let mut random = Random::new(23);
    let balls: Vec<_> = (0..60).map(|_| ball(&mut random, 1.0, 0.3)).collect();
    for moved in [DAffine3::IDENTITY, placement(&mut random, 1.0)] {
        let (mut grouped, mut flat) = (WorldBuilder::new(), WorldBuilder::new());
        let group = grouped.begin_group();
        for ball in &balls {
            grouped.object(ball.clone(), DAffine3::IDENTITY).unwrap();
            flat.object(ball.clone(), moved).unwrap();
        }
        grouped.end_group();
        assert_eq!(grouped.instance(group, moved), Ok(0));
        let (grouped, flat) = (grouped.build(), flat.build());
        assert!((grouped.bounds().size() - flat.bounds().size()).abs().max_element() < 1.5);
        let mut found = 0;
        for _ in 0..2000 {
            let r = ray(&mut random, 1.0);
            let (a, b) = (grouped.closest(&r, 9.0, None), flat.closest(&r, 9.0, None));
            // One transform either way: the same bits even where it is not the identity.
            assert_eq!(a.map(|h| (h.t, h.id.object)), b.map(|h| (h.t, h.id.object)));
            if let (Some(a), Some(b)) = (a, b) {
                assert_eq!((a.id.instance, b.id.instance), (0, HitId::NO_INSTANCE));
                assert_eq!(grouped.surface(&r, &a), flat.surface(&r, &b));
                found += 1;
            }
        }
        assert!(found > 150, "{found}");
    }
}

#[test]
fn placements_that_make_no_sense_are_errors() {
    let mut builder = WorldBuilder::new();
    let unit = || AnyShape::Sphere(Sphere::new(DVec3::ZERO, 1.0));
    let flat = DAffine3::from_scale(DVec3::new(1.0, 0.0, 1.0));
    let far = DAffine3::from_translation(DVec3::new(f64::INFINITY, 0.0, 0.0));
    assert_eq!(builder.object(unit(), flat), Err(PlacementError::NoInverse));
    assert_eq!(builder.object(unit(), far), Err(PlacementError::NoInverse));
    let group = builder.begin_group();
    assert_eq!(builder.object(unit(), DAffine3::IDENTITY), Ok(0));
    assert_eq!(builder.instance(group, DAffine3::IDENTITY), Err(PlacementError::InsideGroup));
    builder.end_group();
    builder.end_group(); // one too many is no matter
    assert_eq!(builder.instance(group, flat), Err(PlacementError::NoInverse));
    assert_eq!(WorldBuilder::new().instance(group, flat), Err(PlacementError::UnknownGroup));
    // A group without an instance is not seen, one with an empty group neither.
    let empty = builder.begin_group();
    builder.end_group();
    assert_eq!(builder.instance(empty, DAffine3::IDENTITY), Ok(0));
    let world = builder.build();
    assert!(world.closest(&Ray::new(DVec3::Z * 5.0, -DVec3::Z), 9.0, None).is_none());
    assert!(world.bounds().is_empty() && world.object_count() == 1 && world.instance_count() == 1);
}

/// The cube of the first scene on the floor that it stands on, both with their bottom and top at
/// y = -20; `numbers` is applied to the numbers of the shapes, `placement` places them.
fn cube_on_floor(scale: f64, away: DVec3, placement: DAffine3, endless: bool) -> World {
    let at = |x: f64, y: f64, z: f64| DVec3::new(x, y, z) * scale + away;
    let cube = Cuboid::new(at(10.0, -20.0, -98.0), at(18.0, -12.0, -90.0));
    let floor = if endless {
        AnyShape::Plane(Box::new(Plane::new(at(3.0, -20.0, 5.0), DVec3::Y).unwrap()))
    } else {
        let (u, v) = (DVec3::X * 120.0 * scale, DVec3::Z * -160.0 * scale);
        AnyShape::Rectangle(Box::new(Rectangle::new(at(-60.0, -20.0, -40.0), u, v).unwrap()))
    };
    let mut builder = WorldBuilder::new();
    assert_eq!(builder.object(AnyShape::Cuboid(Box::new(cube)), placement), Ok(0));
    // The floor gets there by another way: what rounds in the one place does not in the other.
    let group = builder.begin_group();
    let half = DAffine3::from_translation(DVec3::splat(0.3 * scale));
    assert_eq!(builder.object(floor, half), Ok(1));
    builder.end_group();
    assert_eq!(builder.instance(group, placement * half.inverse()), Ok(0));
    builder.build()
}

#[test]
fn a_cube_on_a_floor_shows_it_and_shades_it() {
    let mut random = Random::new(5);
    const CUBE: (u32, u32) = (HitId::NO_INSTANCE, 0);
    const FLOOR: (u32, u32) = (0, 1);
    let who = |hit: &Hit| (hit.id.instance, hit.id.object);
    let turn = DAffine3::from_axis_angle(DVec3::new(0.48, 0.64, 0.6), 2.0);
    let quarter = DAffine3::from_axis_angle(DVec3::Z, std::f64::consts::FRAC_PI_2);
    for scale in [1e-6, 1e-3, 1.0, 1e3, 1e6] {
        for away in [0.0, 1e5 * scale] {
            for (placement, endless) in [
                (DAffine3::IDENTITY, false),
                (DAffine3::IDENTITY, true),
                (turn, false),
                (turn, true),
                (quarter, true),
                (DAffine3::from_scale(DVec3::new(-2.0, 0.5, 1.0)) * turn, true),
                (DAffine3::from_translation(DVec3::splat(-away)) * turn, false),
            ] {
                let away = DVec3::new(away, -0.9 * away, 0.7 * away);
                let world = cube_on_floor(scale, away, placement, endless);
                let place = |p: DVec3| placement.transform_point3(p * scale + away);
                for _ in 0..40 {
                    // From the top of the cube down to its bottom: the exit is the cube's own.
                    let on = |random: &mut Random, y: f64| {
                        DVec3::new(random.uniform(10.1, 17.9), y, random.uniform(-97.9, -90.1))
                    };
                    let (above, below) =
                        (place(on(&mut random, -5.0)), place(on(&mut random, -19.9)));
                    let from_above = Ray::new(above, below - above);
                    let top = world.closest(&from_above, f64::INFINITY, None).unwrap();
                    assert_eq!(who(&top), CUBE);
                    let s = world.surface(&from_above, &top).unwrap();
                    let inward = Departure { from: top.id, outward: false };
                    let inside = Ray {
                        error: s.error,
                        ..Ray::new(s.point, place(on(&mut random, -20.0)) - s.point)
                    };
                    let bottom = world.closest_of(&inside, 9.0, Some(&inward), CUBE.0, 0).unwrap();
                    assert!((bottom.t - 1.0).abs() < 1e-9, "{bottom:?}");
                    // Out of it and down: the floor, at once.
                    let s = world.surface(&inside, &bottom).unwrap();
                    let out = Departure { from: bottom.id, outward: true };
                    let mut direction = vector(&mut random, scale);
                    direction *= direction.dot(s.normal).signum();
                    let down = Ray { error: s.error, ..Ray::new(s.point, direction) };
                    let floor = world.closest(&down, f64::INFINITY, Some(&out)).unwrap();
                    assert_eq!(who(&floor), FLOOR, "{scale} {away} {placement:?}");
                    let f = world.surface(&down, &floor).unwrap();
                    let across = floor.t * direction.dot(s.normal);
                    assert!(across <= s.error + f.error, "{across} {} {}", s.error, f.error);
                    let mut hits = Vec::new();
                    world.hits(&down, f64::INFINITY, Some(&out), &mut hits);
                    assert_eq!(hits, [floor]);
                    // From the floor upwards: the cube, at once; so the floor is in shadow there.
                    let out = Departure { from: floor.id, outward: true };
                    let mut direction = vector(&mut random, scale);
                    direction *= direction.dot(f.normal).signum();
                    let up = Ray { error: f.error, ..Ray::new(f.point, direction) };
                    let cube = world.closest(&up, f64::INFINITY, Some(&out)).unwrap();
                    assert_eq!((who(&cube), cube.id.part), (CUBE, bottom.id.part));
                    assert!(cube.t * direction.dot(f.normal) <= s.error + f.error);
                    assert!(world.occluded(&up, 1e-3, Some(&out)));
                    world.hits(&up, f64::INFINITY, Some(&out), &mut hits);
                    assert_eq!(hits.iter().map(who).collect::<Vec<_>>(), [CUBE, CUBE]);
                }
            }
        }
    }
}
