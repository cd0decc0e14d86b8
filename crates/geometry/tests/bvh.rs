// SPDX-License-Identifier: MIT OR Apache-2.0
//! The tree of boxes alone: no box that a ray meets is ever left out, whatever the boxes are like.

use dioptric_geometry::Bounds;
use dioptric_geometry::bvh::{BoxRay, Bvh, Count};
use dioptric_math::random::Random;
use dioptric_math::{DVec3, exp2};

fn vector(random: &mut Random, size: f64) -> DVec3 {
    DVec3::from_array([0; 3].map(|_| random.uniform(-size, size)))
}

/// Whether the ray meets the box at `0 <= t <= t_max`, by the plainest slabs.
fn meets(b: &Bounds, origin: DVec3, direction: DVec3, t_max: f64) -> bool {
    let (mut near, mut far) = (0.0, t_max);
    for axis in 0..3 {
        let (o, d) = (origin[axis], direction[axis]);
        if d == 0.0 {
            if o < b.min[axis] || o > b.max[axis] {
                return false;
            }
        } else {
            let (t0, t1) = ((b.min[axis] - o) / d, (b.max[axis] - o) / d);
            near = t0.min(t1).max(near);
            far = t0.max(t1).min(far);
        }
    }
    near <= far
}

/// Builds, checks the order, casts rays; returns the share of boxes that were handed out.
fn check(name: &str, boxes: &[Bounds], size: f64, rays: usize) -> f64 {
    let middle = boxes.iter().fold(Bounds::EMPTY, |a, b| a.union(*b)).center();
    let center = if boxes.is_empty() { DVec3::ZERO } else { middle };
    assert!(boxes.iter().all(|b| Bvh::can_hold(b, center)), "{name}");
    let (bvh, order) = Bvh::build(boxes.iter().copied(), center);
    let mut sorted = order.clone();
    sorted.sort_unstable();
    assert!(sorted.iter().copied().eq(0..boxes.len() as u32), "{name}: no permutation");
    let mut random = Random::new(boxes.len() as u64);
    let (mut handed, mut met) = (0, 0);
    for i in 0..rays {
        let pick = boxes.get(random.bits() as usize % boxes.len().max(1)).copied();
        let pick = pick.unwrap_or(Bounds { min: DVec3::ZERO, max: DVec3::ONE });
        // At a corner, a middle of some box, or anywhere; from a corner, from outside or inside.
        let target = match i % 4 {
            0 => pick.min,
            1 => pick.max,
            2 => pick.center(),
            _ => center + vector(&mut random, size),
        };
        let origin = match i % 3 {
            0 => center + vector(&mut random, 3.0 * size),
            1 => center + vector(&mut random, size),
            _ => pick.min,
        };
        let mut direction = target - origin;
        if i % 5 < 3 {
            direction[i % 5] = if i % 2 == 0 { 0.0 } else { -0.0 };
        }
        let length = [1e-20, 1.0, 1e20][i % 3];
        direction *= length;
        if direction == DVec3::ZERO {
            continue;
        }
        let t_max = if i % 2 == 0 { f64::INFINITY } else { random.uniform(0.0, 1.5) / length };
        let ray = BoxRay::new(origin, direction, &bvh, 0.0);
        let mut seen = vec![false; boxes.len()];
        let mut count = Count::default();
        let end = bvh.visit(&ray, t_max, &mut count, |range, t_max, _| {
            for &item in &order[range] {
                assert!(!std::mem::replace(&mut seen[item as usize], true), "{name}: twice");
            }
            Some(t_max)
        });
        assert_eq!(end, Some(t_max));
        for (b, seen) in boxes.iter().zip(&seen) {
            assert!(
                *seen || !meets(b, origin, direction, t_max),
                "{name}: {b:?} {origin} {direction}"
            );
            met += u32::from(meets(b, origin, direction, t_max));
            handed += u32::from(*seen);
        }
        // Ended by the leaf: at once, and said so.
        let mut leaves = 0;
        let ended = bvh.visit(&ray, t_max, &mut count, |_, _, _| {
            leaves += 1;
            None
        });
        assert_eq!(ended.is_none(), leaves == 1);
    }
    f64::from(handed) / f64::from(met.max(1))
}

fn cube(center: DVec3, half: f64) -> Bounds {
    Bounds { min: center - half, max: center + half }
}

#[test]
fn no_box_is_left_out() {
    let mut random = Random::new(77);
    for n in [0usize, 1, 2, 3, 4, 5, 8, 9, 17, 100, 1000] {
        for (size, away) in
            [(1.0, 0.0), (1e-6, 0.1), (1.0, 1e5), (1e6, 0.0), (1e-35, 0.0), (1e25, 0.0)]
        {
            let away = DVec3::splat(away);
            let boxes: Vec<_> = (0..n)
                .map(|_| cube(away + vector(&mut random, size), size * random.uniform(0.0, 0.1)))
                .collect();
            let rays = if n < 100 { 100 } else { 30 };
            let share = check("soup", &boxes, size, rays);
            // Still a tree: not much more than the boxes that are met.
            assert!(n < 100 || share < 20.0, "{n} boxes of size {size}: {share}");
        }
    }
}

/// Boxes that are entered on the way of rays past a thousand points.
fn tested(boxes: &[Bounds], center: DVec3) -> u64 {
    let (bvh, _) = Bvh::build(boxes.iter().copied(), center);
    let (mut random, mut count) = (Random::new(4), Count::default());
    for _ in 0..1000 {
        let (origin, target) = (vector(&mut random, 2.0), vector(&mut random, 1.0));
        let ray = BoxRay::new(origin, target - origin, &bvh, 0.0);
        bvh.visit(&ray, f64::INFINITY, &mut count, |range, t_max, counter| {
            counter.shapes += range.len() as u64;
            Some(t_max)
        });
    }
    count.boxes + count.shapes
}

#[test]
fn a_huge_box_does_not_make_tiny_ones_larger() {
    let mut random = Random::new(80);
    let mut boxes: Vec<_> = (0..20_000).map(|_| cube(vector(&mut random, 1.0), 1e-3)).collect();
    let without = tested(&boxes, DVec3::ZERO);
    boxes.push(cube(DVec3::ZERO, 1e9));
    let with = tested(&boxes, DVec3::ZERO);
    // Its own box, and a node at the top more.
    assert!(with < without + without / 4 + 20 * 1000, "{without} {with}");
}

#[test]
fn degenerate_boxes_make_a_tree_too() {
    let mut random = Random::new(78);
    let equal = vec![cube(DVec3::ONE, 0.5); 3000];
    check("all equal", &equal, 2.0, 10);
    let points: Vec<_> = (0..500).map(|_| cube(vector(&mut random, 1.0), 0.0)).collect();
    check("points", &points, 1.0, 40);
    let mut uneven = vec![cube(DVec3::ZERO, 1e6)];
    uneven.extend((0..2000).map(|_| cube(vector(&mut random, 1.0), 1e-3)));
    check("one huge, many tiny", &uneven, 1.0, 20);
    let line: Vec<_> = (0..2000).map(|i| cube(DVec3::X * f64::from(i), 0.5)).collect();
    check("a row", &line, 2000.0, 20);
    // Each twice as far as the last: as lopsided as splits can be.
    let doubling: Vec<_> = (0..240)
        .map(|i| cube(DVec3::Y * exp2(f64::from(i - 120)), exp2(f64::from(i - 123))))
        .collect();
    check("doubling", &doubling, 1.0, 60);
    let nested: Vec<_> = (0..240).map(|i| cube(DVec3::ZERO, exp2(f64::from(i - 120)))).collect();
    check("nested", &nested, 1.0, 60);
    let flat: Vec<_> = (0..300)
        .map(|i| {
            let (c, mut half) = (vector(&mut random, 1.0), DVec3::splat(0.2));
            half[i % 3] = 0.0;
            Bounds { min: c - half, max: c + half }
        })
        .collect();
    check("flat", &flat, 1.0, 60);
    for wrong in [
        Bounds::EMPTY,
        Bounds::EVERYTHING,
        cube(DVec3::splat(f64::NAN), 1.0),
        cube(DVec3::ZERO, 1e39),
    ] {
        assert!(!Bvh::can_hold(&wrong, DVec3::ZERO));
    }
}

#[test]
fn a_hundred_thousand_equal_boxes_take_no_quadratic_time() {
    let equal = vec![cube(DVec3::ONE, 0.5); 100_000];
    let (bvh, order) = Bvh::build(equal.iter().copied(), DVec3::ONE);
    assert_eq!(order.len(), equal.len());
    assert!(bvh.memory_bytes() < 100_000 * 32);
    // A ray beside them looks at one node.
    let ray = BoxRay::new(DVec3::ZERO, DVec3::Z, &bvh, 0.0);
    let mut count = Count::default();
    assert_eq!(bvh.visit(&ray, 1.0, &mut count, |_, _, _| None), Some(1.0));
    assert_eq!(count.boxes, 8);
}

#[test]
fn any_number_of_threads_builds_the_same_tree() {
    let mut random = Random::new(79);
    let boxes: Vec<_> = (0..100_000).map(|_| cube(vector(&mut random, 1.0), 0.01)).collect();
    let build = || Bvh::build(boxes.iter().copied(), DVec3::ZERO);
    let alone = build();
    for threads in [1, 2, 7] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let together = pool.install(build);
        assert_eq!(together.1, alone.1);
        assert_eq!(format!("{:?}", together.0), format!("{:?}", alone.0));
    }
}
