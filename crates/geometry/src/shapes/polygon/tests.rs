// SPDX-License-Identifier: MIT OR Apache-2.0
//! The filtered test answers as the plain one does, for rays that look for trouble.

use dioptric_math::random::Random;
use dioptric_math::{cos, sin};

use super::super::convex::plane_root;
use super::super::outline::testing::{direction, trouble};
use super::*;

/// The test without any filter.
fn plainly(polygon: &Polygon, ray: &LocalRay) -> Option<Root> {
    let height = (ray.origin - polygon.facet.point).dot(polygon.facet.normal);
    let t = plane_root(ray, height, ray.direction.dot(polygon.facet.normal), polygon.facet.error)?;
    if polygon.is_met(ray, t) { root(ray, t, 0) } else { None }
}

/// Corners around the origin at radii that `radius` gives for each, `turns` times around.
fn around_origin(n: usize, turns: f64, mut radius: impl FnMut(usize) -> f64) -> Vec<DVec2> {
    let turn = 2.0 * std::f64::consts::PI * turns / n as f64;
    (0..n).map(|i| DVec2::new(cos(turn * i as f64), sin(turn * i as f64)) * radius(i)).collect()
}

/// Outlines of many kinds, in the unit square or about.
fn outline(kind: u64, r: &mut Random) -> Vec<Vec<DVec2>> {
    let n = 3 + (r.bits() % 6) as usize;
    let square = |s: f64| [(-s, -s), (s, -s), (s, s), (-s, s)].map(|(x, y)| DVec2::new(x, y));
    match kind {
        // Quadrangles, convex or not, and crossed.
        0 => vec![
            square(1.0).map(|p| p + DVec2::new(r.uniform(-0.9, 0.9), r.uniform(-0.9, 0.9))).into(),
        ],
        // Rectangles with a corner in the middle of a side, which may be thin.
        1 => {
            let thin = DVec2::new(1.0, [1.0, 1e-3, 1e-9][(r.bits() % 3) as usize]);
            let [a, b, c, d] = square(1.0).map(|p| p * thin);
            vec![vec![a, a.midpoint(b), b, c, d]]
        }
        // Combs, with edges along the axes.
        9 => {
            let (xs, ys) = ([0.0, 0.0, 0.5, 0.5], [0.0, 1.0, 1.0, 0.0]);
            let tooth = |i: usize| DVec2::new((i / 4) as f64 + xs[i % 4], ys[i % 4]);
            let base = [DVec2::new(n as f64 - 0.5, -0.5), DVec2::new(0.0, -0.5)];
            vec![(0..4 * n).map(tooth).chain(base).collect()]
        }
        2 => vec![around_origin(n, 1.0, |_| 1.0)],
        // Going around twice, and stars that cross themselves.
        3 => vec![around_origin(2 * n, 2.0, |_| 1.0)],
        4 => vec![around_origin(5, 2.0, |_| 1.0)],
        // Gears and worse.
        5 => vec![around_origin(12 * n, 1.0, |i| if i % 4 < 2 { 1.0 } else { 0.8 })],
        6 => vec![around_origin(20 * n, 1.0, |_| r.uniform(0.1, 1.0))],
        7 => vec![around_origin(2000, 1.0, |i| if i % 2 == 0 { 1.0 } else { 0.99 })],
        // Holes, some of which reach out of the outline or cross each other.
        _ => {
            let mut loops = vec![around_origin(3 * n, 1.0, |_| r.uniform(0.7, 1.0))];
            for _ in 0..n {
                let (at, size) =
                    (DVec2::new(r.uniform(-0.8, 0.8), r.uniform(-0.8, 0.8)), r.uniform(0.0, 0.4));
                loops.push(around_origin(n, 1.0, |_| size).into_iter().map(|p| p + at).collect());
            }
            loops
        }
    }
}

/// A polygon in space and its corners.
fn polygon(kind: u64, r: &mut Random) -> Option<(Polygon, Vec<Vec<DVec3>>)> {
    let flat = outline(kind, r);
    let normal = if r.bits().is_multiple_of(4) { DVec3::Z } else { direction(r) };
    let (x, y) = dioptric_math::orthonormal_basis(normal);
    let scale = [1e-6, 1.0, 1e6][(r.bits() % 3) as usize];
    let offset = direction(r) * [0.0, 1.0, 1e5][(r.bits() % 3) as usize];
    // Some as a program writes them to a file.
    let written = r.bits().is_multiple_of(3);
    let place = |p: &DVec2| {
        let p = (offset + x * p.x + y * p.y) * scale;
        if written { p.map(|x| format!("{x:.6e}").parse().unwrap_or(x)) } else { p }
    };
    let rings: Vec<Vec<DVec3>> = flat.iter().map(|ring| ring.iter().map(place).collect()).collect();
    Some((Polygon::new(rings.clone()).ok()?, rings))
}

#[test]
fn filters_change_nothing() {
    let mut r = Random::new(77);
    let (mut hits, mut rays, mut decided) = (0, 0, 0);
    for i in 0..1800 {
        let Some((polygon, rings)) = polygon(i % 10, &mut r) else { continue };
        for _ in 0..300 {
            let ring = &rings[(r.bits() % rings.len() as u64) as usize];
            let ray = trouble(ring, polygon.facet.normal, polygon.facet.error, &mut r);
            let expected = plainly(&polygon, &ray);
            assert_eq!(polygon.intersect(&ray), expected, "{i}: {ray:?}\n{polygon:?}");
            rays += 1;
            hits += usize::from(expected.is_some());
        }
        decided += usize::from(polygon.facet.filter != Filter::None);
    }
    println!("{hits} of {rays} rays hit; {decided} polygons with filters");
    assert!(
        hits * 5 > rays && hits * 2 < rays && rays > 400_000 && decided > 1200,
        "{hits} {rays} {decided}"
    );
}

#[test]
fn every_kind_has_its_filter() {
    let ring = |n| around_origin(n, 1.0, |_| 1.0).iter().map(|p| p.extend(2.0)).collect::<Vec<_>>();
    let of = |rings| Polygon::new(rings).unwrap().facet.filter;
    assert!(matches!(of(vec![ring(4)]), Filter::Four(..)));
    assert!(matches!(of(vec![ring(7)]), Filter::Eight(..)));
    assert!(matches!(of(vec![ring(9)]), Filter::Cells(..)));
    let hole = ring(4).iter().map(|p| DVec3::new(p.x * 0.5, p.y * 0.5, p.z)).collect();
    assert!(matches!(of(vec![ring(4), hole]), Filter::Cells(..)));
    let bow = [(0.0, 0.0), (1.0, 1.0), (1.0, 0.0), (0.0, 1.5)].map(|(x, y)| DVec3::new(x, y, 0.0));
    assert!(matches!(of(vec![bow.to_vec()]), Filter::Cells(..)));
}

#[test]
fn filters_take_little_memory() {
    for n in [9_usize, 16, 40, 144, 1000] {
        let ring = around_origin(n, 1.0, |i| if i % 4 < 2 { 1.0 } else { 0.8 });
        let polygon = Polygon::new([ring.iter().map(|p| p.extend(1.0)).collect()]).unwrap();
        let each = (size_of::<Polygon>() + polygon.memory_bytes()) / (n - 2);
        println!("{n} corners: {each} bytes for each triangle that they could be cut into");
        assert!(each <= if n < 20 { 240 } else { 120 }, "{n} corners: {each}");
    }
}
