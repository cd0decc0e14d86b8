// SPDX-License-Identifier: MIT OR Apache-2.0
//! Specimens without an inside.

use std::f64::consts::PI;

use dioptric_math::{DVec3, cos, sin};
use dioptric_scene::Value;

use super::{At, MILLION, Specimen, TINY, direction_value, v3};

/// Every flat specimen at one place.
pub fn specimens(at: At) -> Vec<Specimen> {
    let mut all = rectangles(at);
    all.extend(discs(at));
    all.extend(triangles(at));
    all.extend(polygons(at));
    all
}

/// A flat thing: height over its plane where `outside <= 0`, else how far it is away.
pub fn flat(height: f64, outside: f64) -> f64 {
    if outside > 1e-9 { height.abs().max(outside) } else { height }
}

fn rectangles(at: At) -> Vec<Specimen> {
    [
        ("rectangle", v3(2.0, 0.0, 0.0), v3(0.0, 1.0, 0.0)),
        ("rectangle, skewed", v3(1.0, 0.5, 0.0), v3(-0.25, 0.5, 1.0)),
        ("rectangle, long", v3(0.0, MILLION, 0.0), v3(1.0, 0.0, 0.0)),
    ]
    .into_iter()
    .map(|(name, u, v)| {
        let corner = v3(-0.5, 0.25, 0.0);
        let n = u.cross(v) / u.cross(v).length();
        let (du, dv) = (v.cross(n), n.cross(u));
        at.make(
            (name, "rectangle"),
            &[("corner", at.point(corner)), ("edge_u", at.vector(u)), ("edge_v", at.vector(v))],
            (u.length().max(v.length()), u.length().min(v.length())),
            None,
            vec![],
            move |p| {
                let (a, b) = ((p - corner).dot(du) / u.dot(du), (p - corner).dot(dv) / v.dot(dv));
                let outside = [a, b].map(|x| (-x).max(x - 1.0));
                flat((p - corner).dot(n), (outside[0] * u.length()).max(outside[1] * v.length()))
            },
        )
    })
    .collect()
}

fn discs(at: At) -> Vec<Specimen> {
    [
        ("disc", DVec3::Y, 0.0),
        ("ring", v3(1.0, -2.0, 0.5), 0.5),
        ("ring, narrow", -DVec3::Z, 0.75 - TINY),
    ]
    .into_iter()
    .map(|(name, n, inner)| {
        let c = v3(0.5, 0.25, -0.125);
        let unit = n / n.length();
        at.make(
            (name, "disc"),
            &[
                ("center", at.point(c)),
                ("normal", direction_value(n)),
                ("radius", at.length(0.75)),
                ("inner_radius", at.length(inner)),
            ],
            (1.5, 0.75 - inner),
            None,
            {
                let out = unit.any_orthonormal_vector() * (0.5 * (0.75 + inner));
                let angles = (0..16).map(|i| 2.0 * PI * f64::from(i) / 16.0);
                angles.map(|a| c + out * cos(a) + unit.cross(out) * sin(a)).collect()
            },
            move |p| {
                let height = (p - c).dot(unit);
                let rho = (p - c - unit * height).length();
                flat(height, (rho - 0.75).max(inner - rho))
            },
        )
    })
    .collect()
}

/// Unit normal of a triangle.
pub fn normal(a: DVec3, b: DVec3, c: DVec3) -> DVec3 {
    let n = (b - a).cross(c - a);
    n / n.length()
}

/// How far a point is outside of a triangle, measured in its plane.
fn outside_triangle(corners: [DVec3; 3], n: DVec3, p: DVec3) -> f64 {
    let edge = |i: usize| {
        let (a, b) = (corners[i], corners[(i + 1) % 3]);
        -n.cross(b - a).dot(p - a) / (b - a).length()
    };
    edge(0).max(edge(1)).max(edge(2))
}

fn triangles(at: At) -> Vec<Specimen> {
    let skew = [v3(-0.5, 0.25, 0.0), v3(1.0, 0.0, 0.5), v3(0.25, 1.5, -0.25)];
    let needle = [v3(0.0, 0.0, 0.0), v3(MILLION, 0.0, 0.0), v3(0.0, 0.0, 1.0)];
    let up = |c: [DVec3; 3]| normal(c[0], c[1], c[2]);
    let bent = Value::List(
        [v3(0.5, 0.25, 1.0), v3(1.0, 0.0, 0.5), v3(0.0, 1.0, 0.5)].map(direction_value).into(),
    );
    let uvs = Value::List([[0.0, 0.25], [0.75, 0.0], [0.5, 1.0]].map(Value::Vec2).into());
    [
        ("triangle", skew, vec![], 1.0),
        ("triangle, smooth", skew, vec![("normals", bent), ("uvs", uvs)], 1.0),
        ("triangle, needle", needle, vec![], 1.0),
    ]
    .into_iter()
    .map(|(name, c, mut args, feature)| {
        args.extend([("a", at.point(c[0])), ("b", at.point(c[1])), ("c", at.point(c[2]))]);
        let n = up(c);
        let size = (c[1] - c[0]).length().max(1.5);
        at.make((name, "triangle"), &args, (size, feature), None, vec![], move |p| {
            flat((p - c[0]).dot(n), outside_triangle(c, n, p))
        })
    })
    .collect()
}

fn polygons(at: At) -> Vec<Specimen> {
    let square = vec![v3(-1.0, 0.0, 0.5), v3(1.0, 0.0, 0.5), v3(1.0, 1.0, 0.5), v3(-1.0, 1.0, 0.5)];
    // Concave, in a plane that leans; (x, y) of the drawing is base + x u + y v.
    let drawn = |xy: &[(f64, f64)]| -> Vec<DVec3> {
        let (u, v) = (v3(1.0, 0.0, 0.5), v3(0.0, 1.0, 0.25));
        xy.iter().map(|&(x, y)| v3(0.25, -0.5, 0.0) + u * x + v * y).collect()
    };
    let arrow = drawn(&[(-1.0, 0.0), (1.0, 0.0), (1.0, 2.0), (0.0, 0.5), (-1.0, 2.0)]);
    let hole = drawn(&[(-0.5, 0.125), (0.0, 0.25), (0.5, 0.125)]);
    let star: Vec<DVec3> = (0..144)
        .map(|i| {
            let a = 2.0 * PI * f64::from(i) / 144.0;
            let r = if i % 2 == 0 { 1.0 } else { 0.75 };
            (v3(cos(a) * r, 0.0, sin(a) * r) * 1024.0).round() / 1024.0
        })
        .collect();
    [
        ("polygon, square", square, vec![]),
        ("polygon, concave with a hole", arrow, vec![hole]),
        ("polygon, gear", star, vec![]),
    ]
    .into_iter()
    .map(|(name, outline, holes)| {
        let n = normal(outline[0], outline[1], outline[2]);
        let holes_value = Value::List(holes.iter().map(|h| at.points(h)).collect());
        // Twice the area by signed triangles tells which side is up.
        let area: f64 = (1..outline.len() - 1)
            .map(|i| (outline[i] - outline[0]).cross(outline[i + 1] - outline[0]).dot(n))
            .sum();
        let n = n * area.signum();
        let loops: Vec<Vec<DVec3>> = std::iter::once(outline.clone()).chain(holes).collect();
        let middle = outline[0];
        at.make(
            (name, "polygon"),
            &[("points", at.points(&outline)), ("holes", holes_value)],
            (2.5, 0.0625),
            None,
            vec![],
            move |p| {
                let height = (p - middle).dot(n);
                let q = p - n * height;
                flat(height, if winds_around(&loops, n, q) { -1.0 } else { 1.0 })
            },
        )
    })
    .collect()
}

/// Whether a point of the plane is inside an odd number of loops: by the angles that the edges subtend.
fn winds_around(loops: &[Vec<DVec3>], n: DVec3, q: DVec3) -> bool {
    let turns = loops.iter().map(|l| {
        let angle: f64 = (0..l.len())
            .map(|i| {
                let (a, b) = (l[i] - q, l[(i + 1) % l.len()] - q);
                dioptric_math::atan2(a.cross(b).dot(n), a.dot(b))
            })
            .sum();
        i64::from(angle.abs() > PI)
    });
    turns.sum::<i64>() % 2 == 1
}
