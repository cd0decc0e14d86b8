// SPDX-License-Identifier: MIT OR Apache-2.0
//! What the manual says about surface coordinates, parts and normals, point by point.

mod common;

use common::{Arguments, build, ray, v3};
use dioptric_geometry::{AnyShape, LocalSurface};
use dioptric_math::{DVec2, DVec3};
use dioptric_scene::Value;

/// The surface that a ray from outside finds at `target`, coming from `from`.
fn seen(shape: &AnyShape, from: DVec3, target: DVec3) -> (u32, LocalSurface) {
    let ray = ray(target + from, -from);
    let root = shape.intersect(&ray).unwrap();
    let f = shape.surface(ray.at(root.t), root.part);
    assert!((f.point - target).length() < 1e-12, "{} instead of {target}", f.point);
    (root.part, f)
}

fn uv(f: LocalSurface, u: f64, v: f64) {
    assert!((f.uv - DVec2::new(u, v)).length() < 1e-12, "uv {} instead of ({u}, {v})", f.uv);
}

fn v(x: f64, y: f64, z: f64) -> Value {
    Value::Vec3([x, y, z])
}

fn n(x: f64) -> Value {
    Value::Number(x)
}

fn make(kind: &str, args: Arguments) -> AnyShape {
    build(kind, args).unwrap_or_else(|e| panic!("{}", e.message))
}

#[test]
fn longitude_begins_at_the_back_and_grows_to_the_right() {
    let around = [(DVec3::NEG_X, 0.25), (DVec3::Z, 0.5), (DVec3::X, 0.75)];
    let sphere = make("sphere", &[]);
    let cylinder = make("cylinder", &[("height", n(2.0))]);
    let cone = make("cone", &[("height", n(2.0))]);
    let torus = make("torus", &[("major_radius", n(0.75)), ("minor_radius", n(0.25))]);
    for (d, u) in around {
        uv(seen(&sphere, d, d).1, u, 0.5);
        uv(seen(&torus, d, d).1, u, 0.5);
        uv(seen(&cylinder, d, d + DVec3::Y * 0.5).1, u, 0.25);
        uv(seen(&cone, d, d * 0.5 + DVec3::Y).1, u, 0.5);
    }
    uv(seen(&sphere, DVec3::Y, DVec3::Y).1, 0.5, 1.0);
    let (_, top) = seen(&torus, DVec3::Y, v3(0.0, 0.25, 0.75));
    uv(top, 0.5, 0.75);
    // Along another axis everything turns with it: +y to +x takes +x to -y and leaves +z.
    let lying = make("cylinder", &[("top", v(2.0, 0.0, 0.0))]);
    uv(seen(&lying, DVec3::NEG_Y, v3(0.5, -1.0, 0.0)).1, 0.75, 0.25);
    uv(seen(&lying, DVec3::Z, v3(0.5, 0.0, 1.0)).1, 0.5, 0.25);
}

#[test]
fn caps_and_discs_show_pictures_upright() {
    let cut = make("cone", &[("radius", n(2.0)), ("height", n(2.0)), ("top_radius", n(1.0))]);
    let (part, f) = seen(&cut, DVec3::Y, v3(0.5, 2.0, -0.25));
    assert_eq!((part, f.normal), (2, DVec3::Y));
    uv(f, 0.75, 0.625);
    let (part, f) = seen(&cut, DVec3::NEG_Y, v3(1.0, 0.0, 1.5));
    assert_eq!((part, f.normal), (1, DVec3::NEG_Y));
    uv(f, 0.75, 0.875);
    let wall = make("disc", &[("normal", v(0.0, 0.0, 3.0)), ("radius", n(2.0))]);
    uv(seen(&wall, DVec3::Z, v3(1.0, 0.5, 0.0)).1, 0.75, 0.625);
    // From behind it is the same point with the same normal.
    let (_, f) = seen(&wall, DVec3::NEG_Z, v3(1.0, 0.5, 0.0));
    assert_eq!(f.normal, DVec3::Z);
    uv(f, 0.75, 0.625);
}

#[test]
fn planes_and_polygons_agree_about_up() {
    uv(seen(&make("plane", &[]), DVec3::Y, v3(3.0, 0.0, -2.0)).1, 3.0, 2.0);
    let wall = make("plane", &[("normal", v(0.0, 0.0, 1.0)), ("point", v(1.0, 1.0, -5.0))]);
    uv(seen(&wall, DVec3::Z, v3(3.0, 2.0, -5.0)).1, 2.0, 1.0);
    let corners = [v(-2.0, 0.0, 0.0), v(2.0, 0.0, 0.0), v(2.0, 1.0, 0.0), v(-2.0, 1.0, 0.0)];
    let wall = make("polygon", &[("points", Value::List(corners.into()))]);
    let (_, f) = seen(&wall, DVec3::Z, v3(1.0, 0.75, 0.0));
    assert_eq!(f.normal, DVec3::Z);
    uv(f, 0.75, 0.75);
    let wall = make("rectangle", &[("edge_u", v(4.0, 0.0, 0.0))]);
    let (_, f) = seen(&wall, DVec3::Z, v3(1.0, 0.75, 0.0));
    assert_eq!(f.normal, DVec3::Z);
    uv(f, 0.25, 0.75);
}

#[test]
fn faces_of_a_box_show_pictures_upright_and_hits_lie_on_them() {
    let cube = make("box", &[("min", v(0.1, 0.2, 0.3)), ("max", v(1.1, 2.2, 3.3))]);
    // Down from the top, a quarter of the way along x, y, z.
    let p = v3(0.1, 0.2, 0.3) + v3(1.0, 2.0, 3.0) * 0.25;
    let faces = [
        (DVec3::NEG_X, 0, 0.25, 0.25),
        (DVec3::X, 1, 0.75, 0.25),
        (DVec3::NEG_Y, 2, 0.25, 0.25),
        (DVec3::Y, 3, 0.25, 0.75),
        (DVec3::NEG_Z, 4, 0.75, 0.25),
        (DVec3::Z, 5, 0.25, 0.25),
    ];
    for (d, part, u, w) in faces {
        let mut target = p;
        let axis = d.abs().max_position();
        let face = if d[axis] > 0.0 { [1.1, 2.2, 3.3][axis] } else { [0.1, 0.2, 0.3][axis] };
        target[axis] = face;
        let (found, f) = seen(&cube, d * 7.3, target);
        assert_eq!((found, f.normal), (part, d));
        assert!(f.point[axis] == face && f.error == 0.0, "exactly on the face");
        uv(f, u, w);
    }
}

#[test]
fn triangles_interpolate_what_they_are_given() {
    let corners = [("a", v(0.0, 0.0, 0.0)), ("b", v(1.0, 0.0, 0.0)), ("c", v(0.0, 1.0, 0.0))];
    let p = v3(0.5, 0.25, 0.0);
    let plain = make("triangle", &corners);
    let (_, f) = seen(&plain, DVec3::Z, p);
    assert_eq!((f.normal, f.shading_normal), (DVec3::Z, DVec3::Z));
    uv(f, 0.5, 0.25);

    let list = |items: [Value; 3]| Value::List(items.into());
    let normals = list([v(0.0, 0.0, -2.0), v(3.0, 0.0, -3.0), v(0.0, 0.0, -1.0)]);
    let uvs = list([[0.0, 0.0], [2.0, 0.0], [0.0, 4.0]].map(Value::Vec2));
    let mut args = corners.to_vec();
    args.extend([("normals", normals), ("uvs", uvs)]);
    let (_, f) = seen(&make("triangle", &args), DVec3::Z, p);
    // The normals say that the other side is the front.
    assert_eq!(f.normal, DVec3::NEG_Z);
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let expected = v3(half * 0.5, 0.0, -half * 0.5 - 0.5).normalize();
    assert!((f.shading_normal - expected).length() < 1e-12, "{}", f.shading_normal);
    uv(f, 1.0, 1.0);

    // Normals that cancel, and coordinates that say nothing, give no NaN.
    let mut args = corners.to_vec();
    args.push(("normals", list([v(1.0, 0.0, 0.0), v(-1.0, 0.0, 0.0), v(0.0, 1.0, 0.0)])));
    args.push(("uvs", list([[0.5, 0.5]; 3].map(Value::Vec2))));
    let odd = make("triangle", &args);
    let f = odd.surface(v3(0.5, 0.0, 0.0), 0);
    assert_eq!(f.shading_normal, DVec3::Z);
    assert!(f.dpdu.is_finite() && f.dpdv.is_finite() && f.dpdu.cross(f.dpdv).dot(f.normal) > 0.0);
}

#[test]
fn cones_have_one_nappe() {
    let cone = make("cone", &[("radius", n(1.0)), ("height", n(2.0))]);
    // Above the apex, where the mirror image would be.
    for y in [2.1, 3.0, 3.9] {
        assert_eq!(cone.intersect(&ray(v3(-5.0, y, 0.1), DVec3::X)), None, "y = {y}");
    }
    // Steep rays meet the mirror image's root first.
    let steep = ray(v3(0.2, 5.0, 0.0), v3(0.02, -1.0, 0.0));
    let root = cone.intersect(&steep).unwrap();
    assert_eq!(root.part, 0);
    let p = steep.at(root.t);
    assert!(p.y < 2.0 && (p.x - (1.0 - p.y / 2.0)).abs() < 1e-14, "{p}");
}
