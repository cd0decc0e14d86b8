// SPDX-License-Identifier: MIT OR Apache-2.0
//! The battery's statements once more, in the space of the scene: every specimen under random affine
//! transforms, sheared and mirrored ones among them.

mod common;

use common::specimens::specimens;
use common::{Place, Specimen, direction, places};
use dioptric_geometry::{Departure, Hit, Ray, Surface, World, WorldBuilder};
use dioptric_math::random::Random;
use dioptric_math::{DAffine3, DMat3, DVec3};

/// A matrix that stretches by 1/3 to 3 along one set of directions and turns into another.
fn placement(r: &mut Random) -> DAffine3 {
    let frame = |r: &mut Random| {
        let z = direction(r);
        let x = z.any_orthonormal_vector();
        DMat3::from_cols(x, z.cross(x), z)
    };
    let mut stretch = DVec3::new(r.uniform(0.4, 2.5), r.uniform(0.4, 2.5), r.uniform(0.4, 2.5));
    if r.bits().is_multiple_of(2) {
        stretch.x = -stretch.x;
    }
    let matrix = frame(r) * DMat3::from_diagonal(stretch) * frame(r).transpose();
    DAffine3 { matrix3: matrix, translation: direction(r) * r.uniform(0.0, 3.0) }
}

struct Placed<'a> {
    specimen: &'a Specimen,
    world: World,
    to_world: DAffine3,
    to_local: DAffine3,
}

impl Placed<'_> {
    /// Distance from the surface in the specimen's own space.
    fn distance(&self, p: DVec3) -> f64 {
        self.specimen.distance(self.to_local.transform_point3(p))
    }

    /// What turning a point back adds to its error, there.
    fn rounding(&self, p: DVec3) -> f64 {
        let m = self.to_local.matrix3;
        let size = p.length() + self.to_world.translation.length();
        f64::EPSILON * 16.0 * m.determinant().abs().max(2.5) * size
            + 16.0 * self.specimen.rounding()
    }

    fn ray(&self, r: &mut Random) -> Ray {
        let local = self.specimen.ray(r);
        Ray::new(
            self.to_world.transform_point3(local.origin),
            self.to_world.transform_vector3(local.direction),
        )
    }

    fn hit(&self, ray: &Ray, departure: Option<&Departure>) -> Option<(Hit, Surface)> {
        let hit = self.world.closest(ray, f64::INFINITY, departure)?;
        Some((hit, self.world.surface(ray, &hit).unwrap()))
    }
}

fn every(mut test: impl FnMut(&Placed, &mut Random)) {
    let mut r = Random::new(3);
    for place in places(1, 4) {
        for specimen in specimens(place) {
            let mut to_world = placement(&mut r);
            to_world.translation *= place.scale;
            let mut builder = WorldBuilder::new();
            builder.object(specimen.shape.clone(), to_world).unwrap();
            let to_local = to_world.inverse();
            let placed = Placed { specimen: &specimen, world: builder.build(), to_world, to_local };
            test(&placed, &mut r);
        }
    }
}

#[test]
fn surfaces_are_carried_with_their_bounds_and_normals() {
    let (mut points, mut normals, mut mirrored) = (0, 0, 0);
    every(|p, r| {
        let name = p.specimen.name;
        for _ in 0..60 {
            let ray = p.ray(r);
            let Some((_, f)) = p.hit(&ray, None) else { continue };
            points += 1;
            // The inverse's largest stretch is 2.5.
            let bound = f.error * 2.5 + p.specimen.slack() + p.rounding(f.point);
            let off = p.distance(f.point).abs();
            assert!(off <= bound, "{name}: {off:e} off, bound {bound:e}");
            let h = 1e-4 * p.specimen.feature * p.specimen.place.scale;
            let local = p.to_local.transform_point3(f.point);
            if p.rounding(f.point) > 1e-3 * h || p.specimen.at_edge(local, h) {
                continue;
            }
            let gradient = p.to_local.matrix3.transpose() * p.specimen.gradient(local, h);
            let normal = gradient / gradient.length();
            assert!((normal - f.normal).length() < 2e-2, "{name}: {} but {normal}", f.normal);
            for tangent in [f.dpdu, f.dpdv] {
                assert!(tangent.dot(f.normal).abs() <= 1e-8 * tangent.length(), "{name}");
            }
            normals += 1;
            mirrored += usize::from(p.to_world.matrix3.determinant() < 0.0);
        }
    });
    println!("placed: {points} points, {normals} normals, {mirrored} of them in mirrors");
    assert!(points > 3000 && normals > 2000 && mirrored > 500);
}

#[test]
fn departing_rays_never_find_what_they_leave() {
    let (mut outward, mut inward) = (0, 0);
    every(|p, r| {
        let s = p.specimen;
        for _ in 0..40 {
            let Some((hit, f)) = p.hit(&p.ray(r), None) else { continue };
            for _ in 0..20 {
                let d = direction(r);
                let up = d.dot(f.normal);
                let next = Ray { error: f.error, ..Ray::new(f.point, d) };
                let departure = Departure { from: hit.id, outward: up > 0.0 };
                let found = p.hit(&next, Some(&departure));
                if up > 0.0 {
                    outward += 1;
                    assert!(found.is_none() || !s.shape.is_convex(), "{}: {found:?}", s.name);
                    let again = found.is_some_and(|(_, g)| (g.point - f.point).length() <= f.error);
                    assert!(!again, "{}: within the bound", s.name);
                } else if up < -1e-6 {
                    inward += 1;
                    assert!(found.is_some() || s.inside.is_none(), "{} leaks", s.name);
                }
            }
        }
    });
    println!("placed departures: {outward} outwards, {inward} inwards");
}

#[test]
fn placed_solids_are_watertight() {
    let mut rays = 0;
    let mut hits = Vec::new();
    every(|p, r| {
        let Some(inside) = p.specimen.inside.map(|q| p.specimen.place.point(q)) else { return };
        let origin = p.to_world.transform_point3(inside);
        let rims = p.specimen.rims.iter().map(|&q| p.specimen.place.point(q));
        let rims: Vec<DVec3> = rims.map(|q| p.to_world.transform_point3(q) - origin).collect();
        for d in (0..60).map(|_| direction(r)).chain(rims) {
            rays += 1;
            let ray = Ray::new(origin, d);
            assert!(p.hit(&ray, None).is_some(), "{} leaks along {d}", p.specimen.name);
            p.world.hits(&ray, f64::INFINITY, None, &mut hits);
            assert!(!hits.len().is_multiple_of(2), "{} along {d}: {hits:?}", p.specimen.name);
        }
    });
    println!("placed and watertight: {rays} rays");
}

#[test]
fn scenes_of_any_size_and_place_give_the_same_hits() {
    // The same rays in units of the shape: hit or missed alike, at the same t and uv.
    let reference = specimens(Place { scale: 1.0, offset: DVec3::ZERO });
    let (mut same, mut other) = (0, 0);
    for place in places(1, 9) {
        for (s, moved) in reference.iter().zip(specimens(place)) {
            let mut r = Random::new(11);
            for _ in 0..50 {
                let mut ray = s.ray(&mut r);
                // Numbers that the moved ray can hold too.
                let grid = 1.0 / (1u64 << 34) as f64;
                let round = |v: DVec3| (v / grid).round() * grid;
                (ray.origin, ray.direction) = (round(ray.origin), round(ray.direction));
                let mut far = ray;
                far.origin = place.point(ray.origin);
                far.direction = ray.direction * place.scale;
                match (s.shape.intersect(&ray), moved.shape.intersect(&far)) {
                    (None, None) => same += 1,
                    (Some(a), Some(b)) if a.part == b.part && (a.t - b.t).abs() < 1e-5 * s.size => {
                        same += 1;
                    }
                    _ => other += 1,
                }
            }
        }
    }
    println!("sizes and places: {same} hits and misses alike, {other} at edges differ");
    assert!(other * 200 < same, "{same} alike, {other} differ");
}
