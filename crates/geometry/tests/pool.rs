// SPDX-License-Identifier: MIT OR Apache-2.0
//! Pools against the same things as single shapes.

use dioptric_geometry::bvh::Lanes;
use dioptric_geometry::pool::{Cones, Cylinders, Pool, Pooled, Spheres};
use dioptric_geometry::shapes::{cone::Cone, cylinder::Cylinder, sphere::Sphere};
use dioptric_geometry::{Leaving, LocalRay, Root, Shape};
use dioptric_math::DVec3;
use dioptric_math::random::Random;

fn vector(random: &mut Random, size: f64) -> DVec3 {
    DVec3::from_array([0; 3].map(|_| random.uniform(-size, size)))
}

fn check<S: Pooled>(things: &[S]) {
    let pool = Pool::new(things.to_vec()).unwrap();
    let others = [Lanes::Plain, Lanes::Avx2].map(|lanes| {
        let mut pool = pool.clone();
        pool.use_lanes(lanes);
        pool
    });
    assert_eq!(pool.len(), things.len());
    let mut random = Random::new(21);
    let mut hits = 0;
    for i in 0..2000 {
        let origin = vector(&mut random, 1.5);
        let target = vector(&mut random, 1.0);
        let t_max = if i % 3 == 0 { random.unit() } else { f64::INFINITY };
        let ray = LocalRay { origin, direction: target - origin, error: 0.0, t_max, leaving: None };
        let mut best: Option<Root> = None;
        for (thing, index) in things.iter().zip(0u32..) {
            if let Some(root) = thing.intersect(&ray)
                && best.is_none_or(|b| root.t < b.t)
            {
                best = Some(Root { part: index << S::PART_BITS | root.part, ..root });
            }
        }
        let found = pool.intersect(&ray);
        assert_eq!(found, best);
        assert!(others.iter().all(|pool| pool.intersect(&ray) == found));
        let blocked = found.is_some_and(|root| root.t < t_max);
        assert_eq!(pool.blocks(&ray).is_some(), blocked);
        for pool in others.iter().chain([&pool]) {
            assert_eq!(pool.hides(&ray), blocked);
            let before = LocalRay { t_max: best.map_or(0.0, |root| root.t), ..ray };
            assert!(!pool.hides(&before));
        }
        let Some(root) = found else { continue };
        hits += 1;
        let own = root.part & ((1 << S::PART_BITS) - 1);
        let thing = &things[(root.part >> S::PART_BITS) as usize];
        let surface = pool.surface(ray.at(root.t), root.part);
        assert_eq!(surface, thing.surface(ray.at(root.t), own));
        // Away from it: never the same point again, whatever copies there are.
        let away = if surface.normal.dot(ray.direction) > 0.0 { 1.0 } else { -1.0 };
        let on = LocalRay {
            origin: surface.point,
            direction: surface.normal * away,
            error: surface.error,
            t_max: f64::INFINITY,
            leaving: Some(Leaving { part: root.part, outward: away > 0.0 }),
        };
        let next = pool.intersect(&on);
        assert!(next.is_none_or(|next| next.t > surface.error));
        assert_eq!(pool.hides(&on), next.is_some());
    }
    assert!(things.len() < 100 || hits > 100, "{hits}");
    let nowhere = LocalRay {
        origin: DVec3::splat(f64::NAN),
        direction: DVec3::X,
        error: 0.0,
        t_max: f64::INFINITY,
        leaving: None,
    };
    assert_eq!(pool.intersect(&nowhere), None);
}

#[test]
fn pools_answer_as_their_things_do() {
    let mut random = Random::new(20);
    for count in [0, 1, 2, 5, 8, 9, 100, 500] {
        let mut spheres: Vec<_> = (0..count)
            .map(|_| Sphere::new(vector(&mut random, 1.0), random.uniform(0.001, 0.1)))
            .collect();
        spheres.extend_from_within(..count / 4);
        check(&spheres);
        let ends = |r: &mut Random| (vector(r, 1.0), vector(r, 0.3));
        let cylinders: Vec<_> = (0..count)
            .map(|i| {
                let (base, way) = ends(&mut random);
                Cylinder::new(base, way, random.uniform(0.01, 0.1), i % 2 == 0).unwrap()
            })
            .collect();
        check(&cylinders);
        let cones: Vec<_> = (0..count)
            .map(|i| {
                let (base, way) = ends(&mut random);
                Cone::new(base, way, random.uniform(0.01, 0.1), 0.005, i % 2 == 0).unwrap()
            })
            .collect();
        check(&cones);
    }
}

#[test]
fn what_has_no_place_is_left_out() {
    let wrong = [f64::NAN, f64::INFINITY, 1e300];
    let mut spheres: Vec<_> = wrong.map(|x| Sphere::new(DVec3::splat(x), 1.0)).to_vec();
    spheres.push(Sphere::new(DVec3::ZERO, 1.0));
    let pool = Spheres::new(spheres).unwrap();
    let ray = LocalRay {
        origin: DVec3::Z * 3.0,
        direction: -DVec3::Z,
        error: 0.0,
        t_max: f64::INFINITY,
        leaving: None,
    };
    assert_eq!(pool.intersect(&ray).map(|r| r.part), Some(3));
    assert!(pool.get(0).is_none() && pool.get(3).is_some() && pool.get(4).is_none());
    assert!(Cylinders::new(vec![]).unwrap().is_empty() && Cones::new(vec![]).unwrap().is_empty());
}
