// SPDX-License-Identifier: MIT OR Apache-2.0
//! Combinations of solids against plain membership of points, faces that coincide, and rays that
//! leave.

use dioptric_geometry::shapes::csg::{CsgError, Intersection, Operand, Operation, Union};
use dioptric_geometry::shapes::{SCHEMAS, cuboid::Cuboid, sphere::Sphere};
use dioptric_geometry::{
    AnyShape, Bounds, GROUP_SCHEMA, Leaving, LocalRay, Shape, TRANSFORM_SCHEMAS,
};
use dioptric_math::random::Random;
use dioptric_math::{DAffine3, DVec3};
use dioptric_scene::args::make_node;
use dioptric_scene::{Args, Description, NodeId, Value};

fn ray(origin: DVec3, direction: DVec3) -> LocalRay {
    LocalRay { origin, direction, error: 0.0, t_max: f64::INFINITY, leaving: None }
}

fn vector(random: &mut Random, size: f64) -> DVec3 {
    DVec3::from_array([0; 3].map(|_| random.uniform(-size, size)))
}

fn ball(center: DVec3, radius: f64) -> Operand {
    Operand::solid(AnyShape::Sphere(Sphere::new(center, radius)))
}

fn brick(min: DVec3, max: DVec3) -> Operand {
    Operand::solid(AnyShape::Cuboid(Box::new(Cuboid::new(min, max))))
}

/// A ray at some point of a box.
fn at_box(random: &mut Random, b: Bounds) -> LocalRay {
    let target = b.center() + b.size() * 0.5 * vector(random, 1.0);
    let origin = vector(random, 2.5);
    ray(origin, target - origin)
}

fn times(crossings: &[dioptric_geometry::Crossing]) -> Vec<f64> {
    crossings.iter().map(|c| c.t).collect()
}

fn crossings(shape: &impl Shape, ray: &LocalRay) -> Vec<dioptric_geometry::Crossing> {
    let mut out = Vec::new();
    shape.crossings(ray, &mut out);
    assert!(out.is_sorted_by(|a, b| a.t <= b.t && a.enters != b.enters), "{out:?}");
    out
}

/// A combination as a question about points.
enum Slow {
    Ball(DVec3, f64),
    Brick(DVec3, DVec3),
    Combination(Operation, Vec<(DAffine3, Slow)>),
}

impl Slow {
    fn random(random: &mut Random, depth: u32) -> (Self, Operand) {
        let center = vector(random, 1.0);
        if depth == 0 || random.bits().is_multiple_of(4) {
            if random.bits().is_multiple_of(2) {
                let r = random.uniform(0.3, 1.2);
                return (Self::Ball(center, r), ball(center, r));
            }
            let half = DVec3::splat(0.2) + vector(random, 0.8).abs();
            return (
                Self::Brick(center - half, center + half),
                brick(center - half, center + half),
            );
        }
        let operation = [Operation::Union, Operation::Intersection, Operation::Difference]
            [random.bits() as usize % 3];
        let (mut slow, mut parts) = (Vec::new(), Vec::new());
        for _ in 0..2 + random.bits() % 3 {
            let (s, part) = Self::random(random, depth - 1);
            let place = if random.bits().is_multiple_of(2) {
                DAffine3::IDENTITY
            } else {
                DAffine3::from_scale(DVec3::new(-0.7, 1.0, 1.3))
                    * DAffine3::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), random.uniform(0.0, 6.0))
                    * DAffine3::from_translation(vector(random, 0.3))
            };
            slow.push((place.inverse(), s));
            parts.push(part.placed(place));
        }
        (Self::Combination(operation, slow), Operand::combination(operation, parts))
    }

    fn holds(&self, p: DVec3) -> bool {
        match self {
            Self::Ball(c, r) => (p - c).length() < *r,
            Self::Brick(min, max) => p.cmpgt(*min).all() && p.cmplt(*max).all(),
            Self::Combination(operation, parts) => {
                let mut answers =
                    parts.iter().map(|(inverse, s)| s.holds(inverse.transform_point3(p)));
                match operation {
                    Operation::Union => answers.any(|a| a),
                    Operation::Intersection => answers.all(|a| a),
                    Operation::Difference => {
                        let first = answers.next().unwrap();
                        first && !answers.any(|a| a)
                    }
                }
            }
        }
    }
}

#[test]
fn crossings_agree_with_the_membership_of_points() {
    let mut random = Random::new(41);
    let (mut inside, mut outside) = (0, 0);
    for _ in 0..60 {
        let (slow, operand) = Slow::random(&mut random, 3);
        let shape = Union::new(operand).unwrap();
        if shape.bounds().is_empty() {
            continue;
        }
        for _ in 0..40 {
            let r = at_box(&mut random, shape.bounds());
            let found = crossings(&shape, &r);
            let mut first = f64::INFINITY;
            for c in &found {
                let p = r.at(c.t);
                let b = shape.bounds();
                assert!(p.cmpge(b.min - 1e-12).all() && p.cmple(b.max + 1e-12).all());
                // The normal points out of the whole.
                let s = shape.surface(p, c.part);
                assert!(
                    (s.point - p).length() < 1e-12
                        && s.normal.dot(r.direction) * if c.enters { -1.0 } else { 1.0 } > -1e-9
                );
                first = if c.t > 0.0 { first.min(c.t) } else { first };
            }
            for _ in 0..60 {
                let t = random.uniform(-0.5, 2.0);
                if found.iter().any(|c| (c.t - t).abs() < 1e-9) {
                    continue;
                }
                let is_in = found.iter().rfind(|c| c.t < t).is_some_and(|c| c.enters);
                assert_eq!(is_in, slow.holds(r.at(t)), "at {t} of {r:?}: {found:?}");
                if is_in { inside += 1 } else { outside += 1 }
            }
            assert_eq!(shape.intersect(&r).map_or(f64::INFINITY, |root| root.t), first);
        }
    }
    assert!(inside > 10_000 && outside > 10_000, "{inside} {outside}");
}

#[test]
fn a_ray_that_leaves_goes_on_to_the_next_change_of_membership() {
    let mut random = Random::new(7);
    let (mut again, mut checked) = (0, 0);
    for _ in 0..60 {
        let (slow, operand) = Slow::random(&mut random, 3);
        let shape = Union::new(operand).unwrap();
        if shape.bounds().is_empty() {
            continue;
        }
        for _ in 0..60 {
            let r = at_box(&mut random, shape.bounds());
            let Some(root) = shape.intersect(&r) else { continue };
            let s = shape.surface(r.at(root.t), root.part);
            let direction = vector(&mut random, 1.0);
            let outward = direction.dot(s.normal) > 0.0;
            let leaving = Some(Leaving { part: root.part, outward });
            let on = LocalRay { error: s.error, leaving, ..ray(s.point, direction) };
            let next = shape.intersect(&on).map_or(9.0, |root| root.t.min(9.0));
            checked += 1;
            again += u32::from(next < 1e-9);
            // The same side of the surface all the way.
            for k in 1..40 {
                let t = next * f64::from(k) / 40.0;
                if t > 1e-9 && next - t > 1e-9 {
                    assert_eq!(slow.holds(on.at(t)), !outward, "{t} of {next}, {on:?}");
                }
            }
        }
    }
    assert!(checked > 500 && again == 0, "{again} of {checked}");
}

/// At all scales, places and turns: `make` gets the placement.
fn everywhere(mut check: impl FnMut(DAffine3)) {
    let turn = DAffine3::from_axis_angle(DVec3::new(0.48, 0.64, 0.6), 0.7);
    for scale in [1e-6, 1.0, 1e6] {
        for away in [0.0, 1e5 * scale] {
            for turn in [DAffine3::IDENTITY, turn] {
                let there = DAffine3::from_translation(DVec3::new(away, -away, 0.3 * away));
                check(there * DAffine3::from_scale(DVec3::splat(scale)) * turn);
            }
        }
    }
}

#[test]
fn faces_that_coincide_leave_no_slivers() {
    let mut random = Random::new(9);
    everywhere(|place| {
        let placed = |operation, parts: Vec<Operand>| {
            // Each part with its own, different way to the same place: the roundings differ.
            let parts = parts.into_iter().enumerate().map(|(i, p)| {
                let to = DAffine3::from_translation(DVec3::splat(i as f64));
                p.placed(to.inverse()).placed(place * to)
            });
            Union::new(Operand::combination(operation, parts.collect())).unwrap()
        };
        let left = || brick(DVec3::new(-1.0, -1.0, -1.0), DVec3::new(0.0, 1.0, 1.0));
        let right = || brick(DVec3::new(0.0, -1.0, -1.0), DVec3::new(1.0, 1.0, 1.0));
        let middle = || brick(DVec3::new(-0.5, -0.5, -1.0), DVec3::new(0.5, 0.5, 1.0));
        let both = placed(Operation::Union, vec![left(), right()]);
        let none = placed(Operation::Intersection, vec![left(), right()]);
        let tunnel = placed(Operation::Difference, vec![left(), right(), middle()]);
        let nothing = placed(Operation::Difference, vec![left(), left()]);
        let twice = placed(Operation::Union, vec![left(), left()]);
        for _ in 0..200 {
            let at = |random: &mut Random, x: f64| {
                DVec3::new(x, random.uniform(-0.4, 0.4), random.uniform(-0.9, 0.9))
            };
            let (from, to) = (at(&mut random, -3.0), at(&mut random, 3.0));
            let from = place.transform_point3(from);
            let r = ray(from, place.transform_point3(to) - from);
            assert_eq!(crossings(&both, &r).len(), 2, "{place:?}");
            assert_eq!(crossings(&none, &r).len(), 0);
            assert_eq!(crossings(&nothing, &r).len(), 0);
            let walls = crossings(&tunnel, &r);
            assert_eq!(walls.iter().map(|c| c.part >> 8).collect::<Vec<_>>(), [0, 2]);
            // Where two coincide, the first is seen.
            assert!(crossings(&twice, &r).iter().all(|c| c.part >> 8 == 0));
        }
        // Along the tunnel, which is open at both ends: its cut is flush with the faces there.
        for _ in 0..200 {
            let at = |random: &mut Random, z: f64| {
                DVec3::new(random.uniform(-0.45, -0.05), random.uniform(-0.4, 0.4), z)
            };
            let (from, to) = (at(&mut random, 3.0), at(&mut random, -3.0));
            let from = place.transform_point3(from);
            let r = ray(from, place.transform_point3(to) - from);
            let found = crossings(&tunnel, &r);
            assert!(found.iter().all(|c| c.part >> 8 == 2 || c.t > 0.1), "{found:?}");
            assert_eq!(found.len(), 0, "{place:?} {found:?}");
        }
    });
}

#[test]
fn a_ray_that_leaves_coincident_faces_hits_none_of_them() {
    let mut random = Random::new(19);
    everywhere(|place| {
        let halves = [-1.0, 0.0].map(|x| {
            let b = brick(DVec3::new(x, -1.0, -1.0), DVec3::new(x + 1.0, 1.0, 1.0));
            b.placed(place)
        });
        let shape = Union::new(Operand::combination(Operation::Union, halves.into())).unwrap();
        for _ in 0..300 {
            // From anywhere on the top, flush over both halves, to all sides.
            let above = DVec3::new(random.uniform(-0.9, 0.9), 2.0, random.uniform(-0.9, 0.9));
            let r = ray(place.transform_point3(above), place.transform_vector3(-DVec3::Y));
            let root = shape.intersect(&r).unwrap();
            let s = shape.surface(r.at(root.t), root.part);
            let direction = place.transform_vector3(vector(&mut random, 1.0));
            let outward = direction.dot(s.normal) > 0.0;
            let leaving = Some(Leaving { part: root.part, outward });
            let on = LocalRay { error: s.error, leaving, ..ray(s.point, direction) };
            let next = shape.intersect(&on);
            if outward {
                assert_eq!(next, None);
            } else {
                assert!(next.is_some_and(|root| root.t > 0.05), "{next:?} {on:?}");
            }
            // From the outside: a surface at the origin within the bound is hit at 0.
            let arriving = LocalRay { leaving: None, error: 2.0 * s.error, ..on };
            let there = shape.intersect(&arriving).unwrap();
            assert!(
                there.t * direction.length() <= 4.0 * s.error + 1e-12 * r.origin.length(),
                "{there:?}"
            );
        }
    });
}

#[test]
fn two_spheres_make_a_lens() {
    let half = |z: f64| ball(DVec3::new(0.0, 0.0, z), 1.0);
    let lens = Intersection::new(Operand::combination(
        Operation::Intersection,
        vec![half(-0.75), half(0.75)],
    ))
    .unwrap();
    assert!(lens.is_convex());
    assert!((lens.bounds().size() - DVec3::new(2.0, 2.0, 0.5)).length() < 1e-12);
    let r = ray(DVec3::new(0.0, 0.0, 5.0), -DVec3::Z);
    assert_eq!(times(&crossings(&lens, &r)), [4.75, 5.25]);
    // Out of a lens nothing is hit again; through it the other side.
    let out = Leaving { part: 0, outward: true };
    let origin = DVec3::new(0.0, 0.0, 0.25);
    assert_eq!(lens.intersect(&LocalRay { leaving: Some(out), ..ray(origin, DVec3::Z) }), None);
    let inwards = Leaving { part: 0, outward: false };
    let through = lens.intersect(&LocalRay { leaving: Some(inwards), ..ray(origin, -DVec3::Z) });
    assert_eq!(through.map(|root| (root.t, root.part)), Some((0.5, 1 << 8)));
}

#[test]
fn the_half_space_behind_a_plane_cuts() {
    let plane = dioptric_geometry::shapes::plane::Plane::new(DVec3::ZERO, DVec3::Y).unwrap();
    let below = || Operand::solid(AnyShape::Plane(Box::new(plane)));
    let bowl = Union::new(Operand::combination(
        Operation::Intersection,
        vec![ball(DVec3::ZERO, 1.0), below()],
    ));
    let dome = Union::new(Operand::combination(
        Operation::Difference,
        vec![ball(DVec3::ZERO, 1.0), below()],
    ));
    let (bowl, dome) = (bowl.unwrap(), dome.unwrap());
    let down = ray(DVec3::Y * 3.0, -DVec3::Y);
    assert_eq!(times(&crossings(&bowl, &down)), [3.0, 4.0]);
    assert_eq!(times(&crossings(&dome, &down)), [2.0, 3.0]);
    // Parallel to the plane, above and below it: never crossed, yet in or out.
    let along = |y: f64| ray(DVec3::new(-3.0, y, 0.0), DVec3::X);
    assert_eq!((crossings(&bowl, &along(0.5)).len(), crossings(&bowl, &along(-0.5)).len()), (0, 2));
    assert_eq!((crossings(&dome, &along(0.5)).len(), crossings(&dome, &along(-0.5)).len()), (2, 0));
}

/// A node with these arguments.
fn node(scene: &mut Description, kind: &str, args: &[(&str, Value)]) -> NodeId {
    let all = SCHEMAS.iter().chain(TRANSFORM_SCHEMAS).copied().chain([&GROUP_SCHEMA]);
    let schema = all.into_iter().find(|s| s.kind == kind).unwrap();
    scene.push(make_node(schema, args).unwrap())
}

fn list(nodes: &[NodeId]) -> Value {
    Value::List(nodes.iter().map(|id| Value::Node(*id)).collect())
}

#[test]
fn a_die_is_read_with_its_pips_in_a_group() {
    let mut scene = Description::default();
    let cube = node(&mut scene, "box", &[]);
    let round = node(&mut scene, "sphere", &[("radius", Value::Number(1.4))]);
    let body = node(&mut scene, "intersection", &[("shapes", list(&[cube, round]))]);
    let pip = node(&mut scene, "sphere", &[("radius", Value::Number(0.2))]);
    let up = node(&mut scene, "translate", &[("by", Value::Vec3([0.0, 0.0, 1.0]))]);
    let other = node(
        &mut scene,
        "sphere",
        &[("radius", Value::Number(0.1)), ("center", Value::Vec3([0.0, 1.0, 0.0]))],
    );
    let front =
        node(&mut scene, "group", &[("shapes", list(&[pip])), ("transform", Value::Node(up))]);
    let die = node(
        &mut scene,
        "difference",
        &[("shape", Value::Node(body)), ("minus", list(&[front, other]))],
    );
    let shape = AnyShape::from_args(&Args::new(&scene, die)).unwrap().unwrap();
    assert_eq!(shape.csg_leaf_nodes(), [cube, round, pip, other]);
    assert!(shape.is_solid() && !shape.is_convex());
    let r = ray(DVec3::new(0.0, 0.0, 5.0), -DVec3::Z);
    let hit = shape.intersect(&r).unwrap();
    assert_eq!((hit.t, hit.part >> 8), (4.2, 2));
    assert_eq!(shape.csg_path(hit.part), [pip, front, die]);
    assert_eq!(shape.csg_path(0), [cube, body, die]);
    // The pip's wall seen from the air in it.
    let s = shape.surface(r.at(hit.t), hit.part);
    assert!((s.normal - DVec3::Z).length() < 1e-15);
    let beside = ray(DVec3::new(0.5, 0.5, 5.0), -DVec3::Z);
    assert_eq!(shape.intersect(&beside).map(|h| (h.t, h.part >> 8)), Some((4.0, 0)));
    let corner = ray(DVec3::splat(5.0), -DVec3::ONE);
    assert_eq!(shape.intersect(&corner).map(|h| h.part >> 8), Some(1));
}

#[test]
fn parts_without_an_inside_are_errors() {
    let mut scene = Description::default();
    let ball = node(&mut scene, "sphere", &[]);
    let disc = node(&mut scene, "disc", &[]);
    let wrong = node(&mut scene, "union", &[("shapes", list(&[ball, disc]))]);
    let empty = node(&mut scene, "intersection", &[("shapes", list(&[]))]);
    let mut deep = ball;
    for _ in 0..300 {
        deep = node(&mut scene, "union", &[("shapes", list(&[deep]))]);
    }
    let mut many = ball;
    for _ in 0..40 {
        many = node(&mut scene, "union", &[("shapes", list(&[many, many]))]);
    }
    for (id, message) in [
        (wrong, "this disc is not closed: it has no inside that could be combined"),
        (empty, "there is no shape to combine"),
        (deep, "combinations more than 200 levels deep"),
        (many, "more than 65536 solids in one combination"),
    ] {
        let e = AnyShape::from_args(&Args::new(&scene, id)).unwrap_err();
        assert_eq!(e.message, message);
        assert!(e.help.is_some());
    }
    let none = Union::new(Operand::combination(Operation::Union, Vec::new())).unwrap_err();
    assert_eq!(none, CsgError::Empty);
}
