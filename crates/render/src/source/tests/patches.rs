// SPDX-License-Identifier: MIT OR Apache-2.0
//! Patches: where they are found, compared with the integral of their density.

use std::f64::consts::{PI, TAU};

use dioptric_math::{DAffine3, DVec3, atan2, normalize, orthonormal_basis, sin_cos};

use crate::source::ball::Ball;
use crate::source::faces::{Face, Faces};
use crate::source::patch::{Found, Met, Moved, Patch};
use crate::source::ring::Ring;
use crate::statistics::{Verdict, judge};

/// A surface with coordinates from 0 to 1.
pub(super) struct Chart {
    /// A point, the normal there, and area over coordinates.
    pub at: Box<dyn Fn([f64; 2]) -> (DVec3, DVec3, f64)>,
    pub coordinates: Box<dyn Fn(DVec3) -> [f64; 2]>,
}

pub(super) fn rectangle(corner: DVec3, e: DVec3, f: DVec3) -> (Patch, Chart) {
    let mut faces = Vec::new();
    Face::parallelogram(corner, [e, f], 0, &mut faces);
    let span = e.cross(f);
    let chart = Chart {
        at: Box::new(move |[a, b]| (corner + e * a + f * b, span.normalize(), span.length())),
        coordinates: Box::new(move |p| {
            let (p, s2) = (p - corner, span.length_squared());
            [f.cross(span).dot(p) / s2, span.cross(e).dot(p) / s2]
        }),
    };
    (Patch::Faces(Faces::new(faces, false).unwrap()), chart)
}

fn triangle(corner: DVec3, e: DVec3, f: DVec3) -> (Patch, Chart) {
    let face = Face::triangle(corner, [e, f], 0).unwrap();
    let span = e.cross(f);
    let chart = Chart {
        at: Box::new(move |[s, t]| {
            (corner + e * (s * (1.0 - t)) + f * (s * t), span.normalize(), s * span.length())
        }),
        coordinates: Box::new(move |p| {
            let (p, s2) = (p - corner, span.length_squared());
            let (a, b) = (f.cross(span).dot(p) / s2, span.cross(e).dot(p) / s2);
            [a + b, b / (a + b)]
        }),
    };
    (Patch::Faces(Faces::new(vec![face], false).unwrap()), chart)
}

fn ring(center: DVec3, normal: DVec3, radii: [f64; 2]) -> (Patch, Chart) {
    let (x, y) = orthonormal_basis(normal);
    let [i2, o2] = radii.map(|r| r * r);
    let chart = Chart {
        at: Box::new(move |[a, b]| {
            let (r, (s, c)) = ((i2 + a * (o2 - i2)).sqrt(), sin_cos(TAU * b));
            (center + (x * c + y * s) * r, normal, PI * (o2 - i2))
        }),
        coordinates: Box::new(move |p| {
            let q = p - center;
            let turn = atan2(q.dot(y), q.dot(x)) / TAU;
            [(q.length_squared() - i2) / (o2 - i2), turn - turn.floor()]
        }),
    };
    (Patch::Ring(Ring { center, normal, radii }), chart)
}

/// The part of a sphere that a point outside sees; all of it from inside.
fn ball(center: DVec3, radius: f64, seen_from: DVec3) -> (Patch, Chart) {
    let way = seen_from - center;
    let axis = normalize(way).unwrap_or(DVec3::X);
    let (x, y) = orthonormal_basis(axis);
    let d = way.length();
    // 1 - cos of the farthest normal that is seen.
    let most = if d > radius { 1.0 - radius / d } else { 2.0 };
    let chart = Chart {
        at: Box::new(move |[a, b]| {
            let (h, (s, c)) = (a * most, sin_cos(TAU * b));
            let n = axis * (1.0 - h) + (x * c + y * s) * (h * (2.0 - h)).sqrt();
            (center + n * radius, n, TAU * most * radius * radius)
        }),
        coordinates: Box::new(move |p| {
            let n = (p - center) / radius;
            let turn = atan2(n.dot(y), n.dot(x)) / TAU;
            [0.5 * (n - axis).length_squared() / most, turn - turn.floor()]
        }),
    };
    (Patch::Ball(Ball { center, radius, part: 0 }), chart)
}

pub(super) const BINS: usize = 10;

/// How likely a patch is found at these coordinates from a point, per square of coordinates.
pub(super) fn per_coordinates(patch: &Patch, chart: &Chart, point: DVec3, u: [f64; 2]) -> f64 {
    let (there, normal, area) = (chart.at)(u);
    let way = there - point;
    let met = Met { direction: way.normalize(), distance: way.length(), normal };
    let per_area = met.direction.dot(normal).abs() / way.length_squared();
    patch.density(point, &met) * per_area * area
}

/// Chi-square of what is found, class by class of its coordinates.
fn compare(patch: &Patch, chart: &Chart, point: DVec3, seed: u64) -> Verdict {
    let density = |u| per_coordinates(patch, chart, point, u);
    let draw = |u: [f64; 2]| {
        let found = patch.sample(point, u)?;
        let Found { direction, distance, normal, .. } = found;
        let density = patch.density(point, &Met { direction, distance, normal });
        assert!((density / found.density - 1.0).abs() < 1e-6, "{density} {found:?}");
        let at = (chart.coordinates)(point + direction * distance);
        assert!(at.iter().all(|x| *x > -1e-4 && *x < 1.0 + 1e-4), "{at:?} {found:?}");
        Some(at)
    };
    judge([BINS; 2], [400, 24], density, |r| draw([r.unit(), r.unit()]), seed)
}

#[test]
fn patches_are_found_as_often_as_they_say() {
    let v = DVec3::new;
    let (x, z) = (DVec3::X, DVec3::Z);
    let near = v(0.3, 0.7, -0.2);
    let cases: Vec<(&str, (Patch, Chart), DVec3)> = vec![
        ("rectangle", rectangle(v(-1.0, 2.0, -1.0), x * 2.0, z * 3.0), near),
        ("its back", rectangle(v(-1.0, 2.0, -1.0), x * 2.0, z * 3.0), v(5.0, 2.5, 0.0)),
        ("rectangle far off", rectangle(v(-1.0, 2e3, -1.0), x * 2.0, z), near),
        ("rectangle very far off", rectangle(v(-1.0, 2e5, -1.0), x * 2.0, z), near),
        ("long rectangle", rectangle(v(-1.0, 2.0, -1.0), x * 2.0, z * 1e-6), near),
        ("grazing", rectangle(v(2.0, 0.71, -1.0), x * 2.0, z), near),
        ("parallelogram", rectangle(v(-1.0, 2.0, -1.0), v(2.0, 1.0, 0.0), z), near),
        ("triangle", triangle(v(-1.0, 2.0, -1.0), v(2.0, 0.5, 0.0), v(0.3, 0.1, 2.0)), near),
        ("triangle far off", triangle(v(-1.0, 2e4, -1.0), x, v(0.3, 0.1, 2.0)), near),
        ("large triangle", triangle(v(-9.0, 0.9, -9.0), x * 30.0, z * 30.0), near),
        ("thin triangle", triangle(v(-1.0, 2.0, -1.0), x, v(0.3, 1e-7, 1e-6)), near),
        ("disc", ring(v(0.0, 2.0, 0.0), v(0.6, -0.8, 0.0), [0.0, 1.5]), near),
        ("disc from its axis", ring(v(0.0, 2.0, 0.0), v(0.0, 1.0, 0.0), [0.0, 1.5]), DVec3::ZERO),
        ("near disc", ring(v(0.0, 0.7, 0.001), v(0.0, 0.1, 0.995).normalize(), [0.0, 1.5]), near),
        ("next to a disc", ring(v(0.0, 0.7, 0.05), v(0.0, 0.0, 1.0), [0.0, 1.5]), v(0.3, 0.2, 0.0)),
        ("grazing disc", ring(v(3.0, 0.71, 0.0), v(0.0, 1.0, 0.0), [0.0, 1.5]), near),
        ("disc far off", ring(v(0.0, 2e4, 0.0), v(0.6, -0.8, 0.0), [0.0, 1.5]), near),
        ("ring", ring(v(0.0, 2.0, 0.0), v(0.6, -0.8, 0.0), [1.0, 1.5]), near),
        ("ball", ball(v(0.0, 2.0, 0.0), 1.0, near), near),
        ("near ball", ball(v(0.0, 2.0, 0.0), 1.3, near), near),
        ("tiny ball", ball(v(0.0, 2.0, 0.0), 1e-6, near), near),
        ("inside of a ball", ball(v(0.0, 1.0, 0.0), 1.5, near), near),
    ];
    for (i, (name, (patch, chart), point)) in cases.iter().enumerate() {
        compare(patch, chart, *point, 1000 + i as u64).check(name, cases.len());
    }
}

#[test]
fn moved_patches_are_found_as_often_as_they_say() {
    let place = DAffine3::from_scale(DVec3::new(1.0, 0.4, 2.0))
        * DAffine3::from_rotation_x(0.7)
        * DAffine3::from_scale(DVec3::new(1.0, 2.0, 0.5));
    let point = DVec3::new(0.3, 3.0, -2.0);
    let own = place.inverse().transform_point3(point);
    for (i, (patch, chart)) in
        [ball(DVec3::ZERO, 0.6, own), ring(DVec3::ZERO, DVec3::Y, [0.2, 0.7])]
            .into_iter()
            .enumerate()
    {
        let moved = Patch::Moved(Box::new(Moved::new(patch, place)));
        let inverse = place.inverse();
        let normals = inverse.matrix3.transpose();
        let det = place.matrix3.determinant().abs();
        let chart = Chart {
            at: Box::new(move |u| {
                let (p, n, area) = (chart.at)(u);
                let n = normals * n;
                (place.transform_point3(p), n.normalize(), area * det * n.length())
            }),
            coordinates: Box::new(move |p| (chart.coordinates)(inverse.transform_point3(p))),
        };
        compare(&moved, &chart, point, 7 + i as u64).check(["ball", "ring"][i], 2);
    }
}
