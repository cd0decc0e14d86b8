// SPDX-License-Identifier: MIT OR Apache-2.0
//! What makes no shape, and what is said about it.

mod common;

use common::{Arguments, build};
use dioptric_scene::Value;

fn v(x: f64, y: f64, z: f64) -> Value {
    Value::Vec3([x, y, z])
}

fn n(x: f64) -> Value {
    Value::Number(x)
}

fn list(items: &[Value]) -> Value {
    Value::List(items.into())
}

#[test]
fn shapes_without_extent_are_errors_with_a_remedy() {
    let line = list(&[v(0.0, 0.0, 0.0), v(0.1, 0.2, 0.3), v(0.2, 0.4, 0.6)]);
    let square = [v(0.0, 0.0, 0.0), v(1.0, 0.0, 0.0), v(1.0, 1.0, 0.0), v(0.0, 1.0, 0.0)];
    let bent = list(&[square[0].clone(), square[1].clone(), v(1.0, 1.0, 0.1), square[3].clone()]);
    let (abc, d) =
        ([("a", v(0., 0., 0.)), ("b", v(1., 0., 0.)), ("c", v(0., 1., 0.))], v(0.3, 0.3, 0.0));
    let cases: &[(&str, Arguments, &str, &str)] = &[
        (
            "box",
            &[("max", v(1.0, -1.0, 1.0))],
            "flat-box",
            "the box has no extent in y: min and max are both -1",
        ),
        (
            "box",
            &[("max", v(1.0, 1.0, -2.0))],
            "inside-out-box",
            "max.z = -2 of the box is below min.z = -1",
        ),
        (
            "rectangle",
            &[("edge_v", v(3.0, 0.0, 0.0))],
            "flat-shape",
            "edge_u and edge_v of the rectangle are parallel",
        ),
        (
            "disc",
            &[("inner_radius", n(1.0))],
            "no-ring",
            "inner_radius of the disc is 1, not below its radius 1",
        ),
        (
            "cylinder",
            &[("height", n(2.0)), ("top", v(0.0, 1.0, 0.0))],
            "two-heights",
            "the cylinder has both a height and a top",
        ),
        (
            "cylinder",
            &[("top", v(0.0, 0.0, 0.0))],
            "no-size",
            "the cylinder has no length: base and top are the same point",
        ),
        ("cone", &[("radius", n(0.0))], "no-size", "radius and top_radius of the cone are both 0"),
        (
            "cone",
            &[("base", v(1.0, 2.0, 3.0)), ("top", v(1.0, 2.0, 3.0))],
            "no-size",
            "the cone has no length: base and top are the same point",
        ),
        (
            "triangle",
            &[("a", v(0.0, 0.0, 0.0)), ("b", v(0.1, 0.2, 0.3)), ("c", v(0.2, 0.4, 0.6))],
            "flat-shape",
            "the corners of the triangle lie on a line",
        ),
        (
            "triangle",
            &[abc[0].clone(), abc[1].clone(), abc[2].clone(), ("normals", list(&square[1..3]))],
            "wrong-count",
            "normals of the triangle: expected 3, got 2",
        ),
        (
            "tetrahedron",
            &[abc[0].clone(), abc[1].clone(), abc[2].clone(), ("d", d)],
            "flat-shape",
            "the corners of the tetrahedron lie in a plane",
        ),
        (
            "polygon",
            &[("points", list(&square[..2]))],
            "too-few-points",
            "the polygon has fewer than 3 different points",
        ),
        ("polygon", &[("points", line)], "flat-shape", "the points of the polygon lie on a line"),
        ("polygon", &[("points", bent)], "not-planar", "of the polygon lies 0.02"),
        (
            "polygon",
            &[("points", list(&square)), ("holes", list(&[list(&square[..2])]))],
            "too-few-points",
            "hole 1 has fewer than 3 different points",
        ),
        (
            "torus",
            &[("minor_radius", n(1.5))],
            "no-hole",
            "minor_radius of the torus is 1.5, not below its major_radius 1",
        ),
    ];
    for (kind, args, code, message) in cases {
        let error = build(kind, args).expect_err(kind);
        assert_eq!(error.code, *code, "{kind}: {}", error.message);
        assert!(error.message.contains(message), "{kind}: {}", error.message);
        assert!(error.help.is_some_and(|h| !h.is_empty()), "{kind}: no remedy for {message}");
    }
}

#[test]
fn sizes_that_are_no_sizes_are_errors() {
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let cases: &[(&str, Arguments)] = &[
            ("sphere", &[("radius", n(bad))]),
            ("disc", &[("radius", n(bad))]),
            ("cylinder", &[("radius", n(bad))]),
            ("cylinder", &[("height", n(bad))]),
            ("cone", &[("height", n(bad))]),
            ("cone", &[("radius", n(bad))]),
            ("torus", &[("major_radius", n(bad))]),
            ("torus", &[("minor_radius", n(bad))]),
            ("plane", &[("normal", v(bad, 0.0, 0.0))]),
            ("rectangle", &[("edge_u", v(bad.min(0.0), 0.0, 0.0))]),
        ];
        for (kind, args) in cases {
            let harmless = bad == -1.0 && ["plane", "rectangle"].contains(kind);
            assert!(harmless || build(kind, args).is_err(), "{kind} {args:?}");
        }
    }
}

#[test]
fn every_schema_explains_itself() {
    for schema in dioptric_geometry::shapes::SCHEMAS {
        let kind = schema.kind;
        assert!(!schema.summary.ends_with('.') && !schema.doc.is_empty(), "{kind}");
        assert!(schema.example.contains(&format!("{kind}(")), "{kind}");
        assert!(schema.params.iter().all(|p| p.doc.ends_with('.')), "{kind}");
    }
}

#[test]
fn a_sphere_stays_small_among_large_shapes() {
    assert!(std::mem::size_of::<dioptric_geometry::AnyShape>() <= 48);
}
