// SPDX-License-Identifier: MIT OR Apache-2.0
//! The list of specimens, and those that are solid.

use std::f64::consts::PI;

use dioptric_geometry::AnyShape;
use dioptric_math::{DVec3, cos, sin};
use dioptric_scene::Value;

use super::flat::{self, flat, normal};
use super::{At, MILLION, Place, Specimen, TINY, build_of, direction_value, v3};

/// Every specimen at one place.
pub fn specimens(place: Place) -> Vec<Specimen> {
    let at = At(place);
    let mut all = Vec::new();
    all.extend(spheres(at));
    all.extend(planes(at));
    all.extend(boxes(at));
    all.extend(frusta(at));
    all.extend(tetrahedra(at));
    all.extend(tori(at));
    all.extend(combinations(at));
    all.extend(flat::specimens(at));
    all
}

fn spheres(at: At) -> Vec<Specimen> {
    let c = v3(0.25, -0.5, 0.125);
    vec![
        at.make(
            ("sphere", "sphere"),
            &[("center", at.point(c)), ("radius", at.length(0.75))],
            (1.5, 0.75),
            Some(v3(0.5, -0.25, 0.0)),
            (0..=32)
                .map(|i| {
                    c + v3(0.0, cos(PI * f64::from(i) / 32.0), -sin(PI * f64::from(i) / 32.0))
                        * 0.75
                })
                .collect(),
            move |p| (p - c).length() - 0.75,
        ),
    ]
}

fn planes(at: At) -> Vec<Specimen> {
    let q = v3(0.25, 0.5, -0.125);
    [("plane y", DVec3::Y), ("plane -x", -DVec3::X), ("plane oblique", v3(3.0, -2.0, 0.5))]
        .into_iter()
        .map(|(name, n)| {
            at.make(
                (name, "plane"),
                &[("point", at.point(q)), ("normal", direction_value(n))],
                (4.0, 1.0),
                None,
                vec![],
                move |p| (p - q).dot(n) / n.length(),
            )
        })
        .collect()
}

fn boxes(at: At) -> Vec<Specimen> {
    [
        ("box", v3(-1.0, 0.0, -0.5), v3(1.0, 2.0, 0.25)),
        ("box, thin", v3(-1.0, -TINY, -2.0), v3(1.0, 0.0, 2.0)),
        ("box, long", v3(0.0, 0.0, 0.0), v3(1.0, 0.5, MILLION)),
    ]
    .into_iter()
    .map(|(name, min, max)| {
        let (c, h) = ((min + max) * 0.5, (max - min) * 0.5);
        let mut rims = Vec::new();
        for i in 0..8 {
            let sign = |k: u32| if i >> k & 1 == 0 { -1.0 } else { 1.0 };
            rims.push(c + h * v3(sign(0), sign(1), sign(2)));
            for x in [-0.75, 0.0, 0.625] {
                rims.push(c + h * v3(x, sign(1), sign(2)));
                rims.push(c + h * v3(sign(0), x, sign(2)));
                rims.push(c + h * v3(sign(0), sign(1), x));
            }
        }
        at.make(
            (name, "box"),
            &[("min", at.point(min)), ("max", at.point(max))],
            ((max - min).length(), (max - min).min_element()),
            Some(c + h * 0.25),
            rims,
            move |p| (p - max).max(min - p).max_element(),
        )
    })
    .collect()
}

fn frusta(at: At) -> Vec<Specimen> {
    // name, base, way to the top, radius, radius at the top, open
    let round = [
        ("cylinder", v3(0.25, -0.5, 0.125), v3(0.0, 2.0, 0.0), 0.75, 0.75, false),
        ("cylinder, oblique", v3(0.25, -0.5, 0.125), v3(1.0, 0.5, -0.75), 0.25, 0.25, false),
        ("cylinder, coin", v3(0.0, 0.0, 0.0), v3(0.0, TINY, 0.0), 1.0, 1.0, false),
        ("cylinder, wire", v3(0.0, 0.0, 0.0), v3(MILLION, 0.0, 0.0), 1.0, 1.0, false),
        (
            "cylinder, oblique wire",
            v3(0.5, 0.0, 0.0),
            v3(0.5, 0.75, 0.5) * MILLION,
            1.0,
            1.0,
            false,
        ),
        ("cylinder, open", v3(0.25, -0.5, 0.125), v3(0.0, -1.0, 0.5), 0.75, 0.75, true),
        ("cone", v3(0.25, -0.5, 0.125), v3(0.0, 2.0, 0.0), 0.75, 0.0, false),
        ("cone, oblique", v3(0.25, -0.5, 0.125), v3(1.0, 0.5, -0.75), 0.5, 0.0, false),
        ("cone, flat", v3(0.0, 0.0, 0.0), v3(0.0, TINY, 0.0), 1.0, 0.0, false),
        ("cone, needle", v3(0.0, 0.0, 0.0), v3(0.0, 0.0, MILLION), 1.0, 0.0, false),
        ("cone, upside down", v3(0.25, -0.5, 0.125), v3(0.0, 1.0, 0.0), 0.0, 0.75, false),
        ("cone, open", v3(0.25, -0.5, 0.125), v3(0.0, 1.5, 0.0), 0.75, 0.0, true),
        ("frustum", v3(0.25, -0.5, 0.125), v3(0.0, 1.5, 0.0), 1.0, 0.5, false),
        ("frustum, widening", v3(0.25, -0.5, 0.125), v3(0.5, 1.0, 0.0), 0.25, 0.75, false),
        (
            "frustum, almost a cylinder",
            v3(0.0, 0.0, 0.0),
            v3(0.0, 1.0, 0.0),
            0.5,
            0.5 + TINY,
            false,
        ),
        ("frustum, open", v3(0.25, -0.5, 0.125), v3(0.5, 1.0, 0.0), 0.25, 0.75, true),
    ];
    round
        .into_iter()
        .map(|(name, base, way, r0, r1, open)| {
            let height = way.length();
            let axis = way / height;
            let slant = (height * height + (r0 - r1) * (r0 - r1)).sqrt();
            let (c, s) = (height / slant, (r0 - r1) / slant);
            let size = height.max(2.0 * r0.max(r1));
            let across = axis.any_orthonormal_vector();
            let along = axis.cross(across);
            let mut rims = Vec::new();
            for i in 0..32 {
                let a = 2.0 * PI * f64::from(i) / 32.0;
                let out = across * cos(a) + along * sin(a);
                rims.extend([base + out * r0, base + way + out * r1]);
                rims.push(base + way * 0.375 + out * (r0 + (r1 - r0) * 0.375));
            }
            let mut args = vec![
                ("base", at.point(base)),
                ("radius", at.length(r0)),
                ("open", Value::Bool(open)),
            ];
            let kind = name.split([' ', ',']).next().unwrap();
            let kind = if kind == "frustum" { "cone" } else { kind };
            if kind == "cone" {
                args.push(("top_radius", at.length(r1)));
            }
            if way.x == 0.0 && way.z == 0.0 && way.y > 0.0 {
                args.push(("height", at.length(way.y)));
            } else {
                args.push(("top", at.point(base + way)));
            }
            at.make(
                (name, kind),
                &args,
                (
                    size,
                    height.min(r0.max(r1)).min(if r0.min(r1) > 0.0 { r0.min(r1) } else { size }),
                ),
                (!open).then_some(base + way * 0.5 + across * (0.5 * (r0 + r1) * 0.125)),
                rims,
                move |p| {
                    let y = (p - base).dot(axis);
                    let side = c * ((p - base - axis * y).length() - r0) + s * y;
                    let caps = (-y).max(y - height);
                    if open { flat(side, caps) } else { side.max(caps) }
                },
            )
        })
        .collect()
}

fn tetrahedra(at: At) -> Vec<Specimen> {
    [
        (
            "tetrahedron",
            [v3(-1.0, 0.0, 0.5), v3(1.0, 0.0, 0.5), v3(0.0, 0.0, -1.0), v3(0.0, 1.5, 0.0)],
            1.0,
        ),
        (
            "tetrahedron, turned",
            [v3(1.0, 0.0, 0.5), v3(-1.0, 0.0, 0.5), v3(0.0, 0.0, -1.0), v3(0.25, 1.5, 0.0)],
            1.0,
        ),
        (
            "tetrahedron, thin",
            [v3(0.0, 0.0, 0.0), v3(1.0, 0.0, 0.0), v3(0.0, 0.0, -1.0), v3(0.25, TINY, -0.25)],
            TINY,
        ),
        (
            "tetrahedron, needle",
            [v3(0.0, 0.0, 0.0), v3(1.0, 0.0, 0.0), v3(0.0, 0.0, -1.0), v3(0.25, MILLION, -0.25)],
            1.0,
        ),
    ]
    .into_iter()
    .map(|(name, c, feature)| {
        let [p, q, r, s] = c;
        let faces = [[q, r, s], [p, r, s], [p, q, s], [p, q, r]];
        let size = (s - p).length().max(2.0);
        let mut rims = c.to_vec();
        for i in 0..4 {
            for k in 0..i {
                rims.extend([0.25, 0.5, 0.875].map(|x| c[i] + (c[k] - c[i]) * x));
            }
        }
        let args = [("a", at.point(p)), ("b", at.point(q)), ("c", at.point(r)), ("d", at.point(s))];
        at.make(
            (name, "tetrahedron"),
            &args,
            (size, feature),
            Some((p + q + r + s) * 0.25),
            rims,
            move |x| {
                let heights = faces.iter().zip(c).map(|(f, opposite)| {
                    let n = normal(f[0], f[1], f[2]);
                    let n = n * -(opposite - f[0]).dot(n).signum();
                    (x - f[0]).dot(n)
                });
                heights.fold(f64::NEG_INFINITY, f64::max)
            },
        )
    })
    .collect()
}

fn tori(at: At) -> Vec<Specimen> {
    [
        ("torus", DVec3::Y, 0.75, 0.25),
        ("torus, oblique and fat", v3(1.0, -2.0, 0.5), 0.75, 0.75 - TINY),
        ("torus, wire", v3(0.0, 0.25, 1.0), 1.0, TINY),
    ]
    .into_iter()
    .map(|(name, axis, major, minor)| {
        let c = v3(0.25, 0.125, -0.5);
        let unit = axis / axis.length();
        let out = unit.any_orthonormal_vector();
        let ring: Vec<DVec3> = (0..32)
            .map(|i| 2.0 * PI * f64::from(i) / 32.0)
            .map(|a| c + (out * cos(a) + unit.cross(out) * sin(a)) * major)
            .collect();
        at.make(
            (name, "torus"),
            &[
                ("center", at.point(c)),
                ("axis", direction_value(axis)),
                ("major_radius", at.length(major)),
                ("minor_radius", at.length(minor)),
            ],
            (2.0 * (major + minor), minor),
            Some(ring[3] + unit * (0.25 * minor)),
            ring,
            move |p| {
                let y = (p - c).dot(unit);
                let x = (p - c - unit * y).length() - major;
                (x * x + y * y).sqrt() - minor
            },
        )
    })
    .collect()
}

fn combinations(at: At) -> Vec<Specimen> {
    let (c, d) = (v3(-0.5, 0.0, 0.25), v3(0.5, 0.25, 0.0));
    let (min, max) = (v3(-1.0, -0.5, -0.5), v3(0.5, 0.5, 0.75));
    let ball = |c: DVec3, r: f64| [("center", at.point(c)), ("radius", at.length(r))];
    let block = [("min", at.point(min)), ("max", at.point(max))];
    let (c_ball, d_ball) = (ball(c, 0.75), ball(d, 0.75));
    let (in_c, in_d) =
        (move |p: DVec3| (p - c).length() - 0.75, move |p: DVec3| (p - d).length() - 0.75);
    let in_block = move |p: DVec3| (p - max).max(min - p).max_element();
    let list = |nodes: &[Value]| vec![("shapes", Value::List(nodes.into()))];
    let make = |name, shape: AnyShape, inside, plain| Specimen {
        name,
        place: at.0,
        shape,
        size: 2.5,
        feature: 0.5,
        inside: Some(inside),
        rims: vec![],
        plain,
    };
    let union = build_of(&[("sphere", &c_ball), ("sphere", &d_ball)], "union", list);
    let lens = build_of(&[("sphere", &c_ball), ("sphere", &d_ball)], "intersection", list);
    let bitten = build_of(&[("box", &block), ("sphere", &d_ball)], "difference", |nodes| {
        vec![("shape", nodes[0].clone()), ("minus", nodes[1].clone())]
    });
    vec![
        make("union of balls", union.unwrap(), c, Box::new(move |p| in_c(p).min(in_d(p)))),
        make("lens", lens.unwrap(), (c + d) * 0.5, Box::new(move |p| in_c(p).max(in_d(p)))),
        make(
            "bitten box",
            bitten.unwrap(),
            v3(-0.75, 0.0, 0.0),
            Box::new(move |p| in_block(p).max(-in_d(p))),
        ),
    ]
}
