// SPDX-License-Identifier: MIT OR Apache-2.0
//! The transforms that scenes write, and what is wrong with those that do not work.

use dioptric_geometry::{TRANSFORM_SCHEMAS, placement, shapes::SCHEMAS};
use dioptric_math::{DAffine3, DVec3};
use dioptric_scene::args::make_node;
use dioptric_scene::{Args, Description, Diagnostic, Schema, Value};

fn schema(kind: &str) -> &'static Schema {
    TRANSFORM_SCHEMAS.iter().copied().find(|s| s.kind == kind).unwrap()
}

fn v(x: f64, y: f64, z: f64) -> Value {
    Value::Vec3([x, y, z])
}

fn n(x: f64) -> Value {
    Value::Number(x)
}

/// The matrix of a list of transforms on a sphere.
fn list(items: &[(&str, &[(&str, Value)])]) -> Result<DAffine3, Diagnostic> {
    let mut scene = Description::default();
    let nodes: Vec<Value> = items
        .iter()
        .map(|(kind, args)| Value::Node(scene.push(make_node(schema(kind), args).unwrap())))
        .collect();
    let sphere = SCHEMAS.iter().copied().find(|s| s.kind == "sphere").unwrap();
    let list = Value::List(nodes.into());
    let id = scene.push(make_node(sphere, &[("transform", list)]).unwrap());
    placement(&Args::new(&scene, id), "transform")
}

fn one(kind: &str, args: &[(&str, Value)]) -> DAffine3 {
    list(&[(kind, args)]).unwrap()
}

fn error(kind: &str, args: &[(&str, Value)]) -> String {
    let d = list(&[(kind, args)]).unwrap_err();
    assert!(d.help.is_some(), "{d:?}");
    d.message
}

const P: DVec3 = DVec3::new(1.0, 2.0, 3.0);

fn near(a: DVec3, b: DVec3) {
    assert!((a - b).length() < 1e-14 * (1.0 + b.length()), "{a} {b}");
}

#[test]
fn each_kind_does_what_its_page_says() {
    let at = |kind: &str, args: &[(&str, Value)]| one(kind, args).transform_point3(P);
    assert_eq!(list(&[]).unwrap(), DAffine3::IDENTITY);
    assert_eq!(at("translate", &[("by", v(10.0, 20.0, 30.0))]), DVec3::new(11.0, 22.0, 33.0));
    assert_eq!(at("scale", &[("by", n(2.0))]), P * 2.0);
    assert_eq!(at("scale", &[("by", v(-1.0, 2.0, 3.0))]), DVec3::new(-1.0, 4.0, 9.0));
    assert_eq!(at("scale", &[("by", n(3.0)), ("center", v(1.0, 2.0, 3.0))]), P);
    assert_eq!(at("shear", &[("xy", n(10.0))]), DVec3::new(21.0, 2.0, 3.0));
    assert_eq!(at("shear", &[("zx", n(10.0)), ("yz", n(1.0))]), DVec3::new(1.0, 5.0, 13.0));
    assert_eq!(at("reflect", &[("normal", v(0.0, -7.0, 0.0))]), DVec3::new(1.0, -2.0, 3.0));
    let plane = [("normal", v(0.0, 1.0, 0.0)), ("point", v(5.0, 3.0, 5.0))];
    assert_eq!(at("reflect", &plane), DVec3::new(1.0, 4.0, 3.0));
    let rows = [v(1.0, 2.0, 3.0), v(0.0, 1.0, 4.0), v(5.0, 6.0, 0.0)];
    assert_eq!(at("matrix", &[("values", Value::List(rows.into()))]), DVec3::new(14.0, 14.0, 17.0));
    let numbers = [1., 0., 0., 7., 0., 1., 0., 8., 0., 0., 1., 9.].map(n);
    assert_eq!(
        at("matrix", &[("values", Value::List(numbers.into()))]),
        DVec3::new(8.0, 10.0, 12.0)
    );
}

#[test]
fn quarter_turns_are_exact_and_in_the_order_x_y_z() {
    for turns in -9..9 {
        for (axis, name) in [(DVec3::X, "x"), (DVec3::Y, "y"), (DVec3::Z, "z")] {
            let angle = f64::from(turns) * 90.0;
            let by_name = one("rotate", &[(name, n(angle))]);
            let args = [("axis", v(axis.x * 3.0, axis.y * 3.0, axis.z * 3.0)), ("angle", n(angle))];
            assert_eq!(by_name, one("rotate", &args));
            assert!(by_name.matrix3.to_cols_array().iter().all(|x| [0.0, 1.0, -1.0].contains(x)));
        }
    }
    let turned = one("rotate", &[("z", n(90.0))]).transform_vector3(DVec3::X);
    assert_eq!(turned, DVec3::Y);
    // x takes y to z; then y takes z to x; then z takes x to y.
    let all = one("rotate", &[("z", n(90.0)), ("y", n(90.0)), ("x", n(90.0))]);
    assert_eq!(all.transform_vector3(DVec3::Y), DVec3::Y);
    assert_eq!(all.transform_vector3(DVec3::X), -DVec3::Z);
    let x: &[(&str, Value)] = &[("x", n(33.0))];
    let y: &[(&str, Value)] = &[("y", n(-71.0))];
    let z: &[(&str, Value)] = &[("z", n(12.0))];
    let listed = list(&[("rotate", x), ("rotate", y), ("rotate", z)]).unwrap();
    let at_once = one("rotate", &[("x", n(33.0)), ("y", n(-71.0)), ("z", n(12.0))]);
    near(listed.transform_point3(P), at_once.transform_point3(P));
    assert_eq!(
        one("rotate", &[("x", n(90.0)), ("center", v(1.0, 2.0, 3.0))]).transform_point3(P),
        P
    );
}

#[test]
fn a_list_is_applied_in_its_order() {
    let moved: &[(&str, Value)] = &[("by", v(1.0, 0.0, 0.0))];
    let scaled: &[(&str, Value)] = &[("by", n(2.0))];
    let both = list(&[("translate", moved), ("scale", scaled)]).unwrap();
    assert_eq!(both.transform_point3(DVec3::ZERO), DVec3::new(2.0, 0.0, 0.0));
    let other = list(&[("scale", scaled), ("translate", moved)]).unwrap();
    assert_eq!(other.transform_point3(DVec3::ZERO), DVec3::X);
}

#[test]
fn orient_is_a_rotation_for_all_pairs_opposite_ones_too() {
    let directions = [
        DVec3::X,
        DVec3::Y,
        -DVec3::Y,
        DVec3::Z,
        -DVec3::Z,
        DVec3::new(1.0, 2.0, -3.0),
        DVec3::new(-1.0, -2.0, 3.0),
        DVec3::new(-1.0, -2.0, 3.0 + 1e-7),
        DVec3::new(-1.0, -2.0, 3.01),
        DVec3::new(1e-200, 0.0, 1e-200),
    ];
    for from in directions {
        for to in directions {
            let args = [("axis", v(from.x, from.y, from.z)), ("to", v(to.x, to.y, to.z))];
            let m = one("orient", &args).matrix3;
            let unit = |d: DVec3| dioptric_math::normalize(d).unwrap();
            assert!((m * unit(from) - unit(to)).length() < 1e-9, "{from} {to}");
            assert!((m.determinant() - 1.0).abs() < 1e-9);
            assert!(((m * P).length() / P.length() - 1.0).abs() < 1e-9);
        }
    }
    assert_eq!(one("orient", &[("to", v(0.0, 3.0, 0.0))]), DAffine3::IDENTITY);
}

#[test]
fn what_has_no_inverse_or_no_meaning_is_an_error_with_a_remedy() {
    assert_eq!(
        error("scale", &[("by", v(1.0, 0.0, 2.0))]),
        "scale by 0 along y flattens the shape"
    );
    assert_eq!(error("scale", &[("by", n(0.0))]), "scale by 0 along x flattens the shape");
    assert_eq!(error("shear", &[("xy", n(1.0)), ("yx", n(1.0))]), "this shear has no inverse");
    assert_eq!(error("scale", &[("by", v(1e-9, 1.0, 1e9))]), "this scale has no inverse");
    let flat = [1., 2., 3., 4., 5., 6., 7., 8., 9.].map(n);
    assert_eq!(
        error("matrix", &[("values", Value::List(flat.into()))]),
        "this matrix has no inverse"
    );
    let transposed = [1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0., 7., 8., 9., 1.].map(n);
    assert_eq!(
        error("matrix", &[("values", Value::List(transposed.into()))]),
        "the last row of a 4 x 4 matrix must be 0, 0, 0, 1"
    );
    assert_eq!(error("rotate", &[("axis", v(0.0, 1.0, 0.0))]), "rotate about an axis needs angle");
    assert_eq!(error("rotate", &[("angle", n(5.0))]), "rotate by an angle needs axis");
    let both = [("y", n(1.0)), ("axis", v(0.0, 1.0, 0.0)), ("angle", n(5.0))];
    assert_eq!(error("rotate", &both), "rotate takes either y or axis");
    let thin: &[(&str, Value)] = &[("by", v(1.0, 1e-10, 1.0))];
    let product = list(&[("scale", thin), ("scale", thin)]).unwrap_err();
    assert_eq!(product.message, "transform: the product of the list has no inverse");
    assert!(product.help.is_some());
    let huge: &[(&str, Value)] = &[("by", n(1e200))];
    assert!(list(&[("scale", huge)]).is_err());
}
