// SPDX-License-Identifier: MIT OR Apache-2.0
//! Rays that start on a surface: what they leave is no hit, what coincides with it is one at 0, and
//! what merely continues it is nothing.

mod common;

use common::{Specimen, direction, every, hit, ray};
use dioptric_geometry::{Leaving, LocalRay};
use dioptric_math::DVec3;

/// Combinations promise nothing about rays that graze them.
fn combined(s: &Specimen) -> bool {
    ["union", "intersection", "difference"].contains(&s.shape.kind())
}

#[test]
fn departing_rays_never_find_what_they_leave() {
    let (mut shapes, mut outward, mut inward, mut again) = (0, 0, 0, 0);
    every(9, |s, r| {
        shapes += 1;
        let mut tried = 0;
        let mut spawned = 0;
        while spawned < 1000 && tried < 1000 {
            tried += 1;
            let Some((root, f)) = hit(s, &s.ray(r)) else { continue };
            for i in 0..40 {
                spawned += 1;
                let mut d = direction(r);
                if i % 4 == 0 && !combined(s) {
                    // Grazing, down to almost nothing.
                    let up = d.dot(f.normal);
                    d += f.normal * (up * 1e-12 - up);
                }
                let up = d.dot(f.normal);
                if up == 0.0 {
                    continue;
                }
                let leaving = Some(Leaving { part: root.part, outward: up > 0.0 });
                let next = LocalRay { error: f.error, leaving, ..ray(f.point, d) };
                let found = hit(s, &next);
                if up > 0.0 {
                    outward += 1;
                } else {
                    inward += 1;
                }
                let where_ = || {
                    format!(
                        "{} {:?} part {} d {d} up {up:e}: {found:?}",
                        s.name, s.place, root.part
                    )
                };
                match found {
                    None => {
                        // A chord shorter than the bound has no far end on shapes that are not convex.
                        let lost = up < -1e-9 || (up < 0.0 && s.shape.is_convex());
                        assert!(!lost || s.inside.is_none(), "never comes out: {}", where_());
                    }
                    Some((far, g)) => {
                        assert!(up < 0.0 || !s.shape.is_convex(), "hit again: {}", where_());
                        let close = (g.point - f.point).length() <= f.error;
                        assert!(up < 0.0 || !close, "within the bound: {}", where_());
                        // The far side is far, but for edges.
                        let h = 1e-3 * s.feature * s.place.scale;
                        let stays = close && up < -1e-2 && h > 1e2 * f.error;
                        assert!(!stays || s.at_edge(f.point, h), "stays: {}", where_());
                        again += usize::from(close);
                        // Where it comes out is on the surface, and the way there is inside.
                        let off = s.distance(g.point).abs();
                        assert!(off <= g.error + s.slack(), "{off:e} {:e}: {}", g.error, where_());
                        let middle = s.distance(next.at(far.t * 0.5));
                        let bound = 4.0 * (f.error + g.error) + s.slack();
                        assert!(
                            s.inside.is_none() || up > 0.0 || middle <= bound,
                            "{middle:e} {bound:e}: {}",
                            where_()
                        );
                    }
                }
            }
        }
    });
    println!(
        "departures: {shapes} shapes, {outward} rays outwards: 0 re-hits on convex ones; {inward} inwards, {again} of which end at an edge within the bound"
    );
}

#[test]
fn departures_that_rounding_contradicts_go_on() {
    // Rays along the surface, told to go in or out while the numbers say the opposite or nothing.
    let mut rays = 0;
    every(1, |s, r| {
        for _ in 0..50 {
            let Some((root, f)) = hit(s, &s.ray(r)) else { continue };
            if combined(s) || f.dpdu == DVec3::ZERO || f.dpdv == DVec3::ZERO {
                continue;
            }
            let flat = match s.shape.kind() {
                "box" | "tetrahedron" => true,
                kind => ["cylinder", "cone"].contains(&kind) && root.part > 0,
            };
            for tilt in [-1e-16, 0.0, 1e-16] {
                let d = (f.dpdu * r.uniform(-1.0, 1.0) + f.dpdv * r.uniform(-1.0, 1.0))
                    / f.dpdu.length();
                let d = d + f.normal * tilt;
                let inwards = Some(Leaving { part: root.part, outward: false });
                let next = LocalRay { error: f.error, leaving: inwards, ..ray(f.point, d) };
                let found = hit(s, &next);
                rays += 1;
                if s.inside.is_some() && s.shape.is_convex() && d != DVec3::ZERO {
                    let (far, g) =
                        found.unwrap_or_else(|| panic!("{} part {} d {d}", s.name, root.part));
                    assert!(far.part != root.part || !flat, "{} part {}", s.name, root.part);
                    assert!(s.distance(g.point).abs() <= g.error + s.slack(), "{}", s.name);
                }
                let outwards = Some(Leaving { part: root.part, outward: true });
                let found = hit(s, &LocalRay { leaving: outwards, ..next });
                let close = found.is_some_and(|(_, g)| (g.point - f.point).length() <= f.error);
                assert!(
                    !close && (found.is_none() || !s.shape.is_convex()),
                    "{}: {found:?}",
                    s.name
                );
            }
        }
    });
    println!("contradicted departures: {rays} rays");
}

#[test]
fn what_only_extends_a_surface_is_not_the_surface() {
    // On the plane of a face or the line of a side, but beyond the shape, almost along it and away.
    let mut rays = 0;
    every(1, |s, r| {
        for _ in 0..50 {
            let Some((_, f)) = hit(s, &s.ray(r)) else { continue };
            for tangent in [f.dpdu, -f.dpdu, f.dpdv, -f.dpdv] {
                let Some(along) = dioptric_math::normalize(tangent) else { continue };
                let reach = 4.0 * s.size * s.place.scale;
                let start = f.point + along * reach;
                if s.distance(start).abs() < 1e-3 * reach {
                    continue;
                }
                rays += 1;
                for tilt in [0.0, 1e-17, -1e-17, 1e-20] {
                    let away = LocalRay { error: f.error, ..ray(start, along + f.normal * tilt) };
                    let found = s.shape.intersect(&away);
                    assert_eq!(found, None, "{} {:?} from {start}, tilt {tilt}", s.name, s.place);
                }
            }
        }
    });
    println!("extended surfaces: {rays} rays away from them hit nothing");
    assert!(rays > 4000);
}

#[test]
fn a_surface_within_the_error_of_the_origin_is_hit_at_zero() {
    let mut tried = 0;
    every(1, |s, r| {
        for _ in 0..50 {
            let Some((root, f)) = hit(s, &s.ray(r)) else { continue };
            // Just beyond the surface, as another object's coincident surface would have it.
            let d = direction(r);
            let beyond = f.normal * (f.error * 0.5).copysign(d.dot(f.normal));
            let start = LocalRay { error: f.error * 2.0, ..ray(f.point + beyond, d) };
            let found = s.shape.intersect(&start);
            let h = (1e-3 * s.feature * s.place.scale).max(4.0 * f.error);
            if d.dot(f.normal).abs() > 1e-2 && !s.at_edge(f.point, h) {
                tried += 1;
                let near = |t: f64| (start.at(t) - f.point).length() <= h;
                let zero = found.is_some_and(|root| root.t == 0.0 || near(root.t));
                assert!(zero, "{} {:?} part {}: {found:?}", s.name, s.place, root.part);
            }
            // The same surface far behind is not hit.
            let away = LocalRay {
                error: f.error,
                ..ray(f.point + f.normal * s.size * s.place.scale * 4.0, f.normal)
            };
            assert!(!s.shape.is_convex() || s.shape.intersect(&away).is_none(), "{}", s.name);
        }
    });
    println!("coincident surfaces: {tried} hit at 0");
}
