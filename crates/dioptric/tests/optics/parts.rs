// SPDX-License-Identifier: MIT OR Apache-2.0
//! Objects of several materials, objects in groups, and normals that were given.

use crate::support::{assert_near, one_ray, render_setting, transmitted};

const VIEW: &str =
    "camera(eye = (0, 0, 5), look_at = (0, 0, 0), fov = 0.1)\nambient(1)\nbackground((0, 0, 1))\n";

/// The far side of a ball that is clear in front and dull behind is seen through its front.
#[test]
fn what_is_not_transparent_is_seen_from_within() {
    for material in ["clear(own = 0, ior = 1.1, specular = 0)", "glass(ior = 1, specular = 0)"] {
        let patched = format!(
            "sphere(radius = 1, material = patched(matte((1, 0, 0)), {material}, \
             mask = gradient(0, 1, start = (0, 0, -0.1), end = (0, 0, 0.1))))"
        );
        let joined = format!(
            "union([box(min = (-1, -1, 0), max = (1, 1, 1), material = {material}), \
             box(min = (-1, -1, -1), max = (1, 1, 0), material = matte((1, 0, 0)))])"
        );
        for shape in [patched, joined] {
            let node = one_ray(9, &format!("{VIEW}{shape}"));
            assert_near(node.value, [1.0, 0.0, 0.0], 1e-12);
        }
    }
}

/// The same of shadows: a wall that is glass in front lets no light through its back.
#[test]
fn shadows_are_as_dark_as_the_darkest_part() {
    for (first, second) in
        [("glass()", "matte(1)"), ("matte(1)", "glass()"), ("clear()", "clear(shadow = 1)")]
    {
        let node = render_setting(
            "shadows = \"tinted\"",
            &format!(
                "camera(eye = (0, 1, 5), look_at = (0, 0, 0), fov = 0.1)\nlight(position = (0, 50, 0))\n\
                 plane(normal = (0, 1, 0), material = matte(1))\n\
                 union([box(min = (-1, 4, -1), max = (1, 5, 1), material = {first}), \
                 box(min = (-1, 5, -1), max = (1, 6, 1), material = {second})])"
            ),
        );
        assert_near(node.value, [0.0; 3], 0.0);
    }
}

#[test]
fn glass_in_an_instance_is_glass() {
    let ball = "sphere(radius = 1, material = glass(ior = 1.5, absorption = (0.5, 0.1, 0)))\n\
                sphere(radius = 0.4, material = glass(ior = 1.2))\n";
    let plain = one_ray(9, &format!("{VIEW}{ball}"));
    let grouped = one_ray(
        9,
        &format!(
            "{VIEW}two = group([{}])\n\
             group([two], transform = [scale(by = 2), scale(by = 0.5)])\n\
             group([two], transform = translate(by = (5, 0, 0)))",
            ball.replace('\n', ",")
        ),
    );
    assert_near(grouped.value, plain.value, 1e-12);
    assert_eq!(transmitted(&plain).len(), 5);
    let media = |n: &dioptric::render::integrator::recorder::Node| {
        n.detail.get("medium").map(|m| m["ior"].as_f64().unwrap())
    };
    let of = |n| transmitted(n).into_iter().map(media).collect::<Vec<_>>();
    assert_eq!(of(&grouped), [None, Some(1.5), Some(1.2), Some(1.5), None]);
    assert_eq!(of(&grouped), of(&plain));
}

/// A triangle whose corners' normals lean away is shaded by them, and neither turns them round where they are
/// seen from behind nor is lit from its back.
#[test]
fn given_normals_stay_on_their_side() {
    let seen = |eye: &str, light: &str, lean: f64| {
        one_ray(
            0,
            &format!(
                "camera(eye = {eye}, look_at = (0, 0, 0), fov = 0.1)\nlight(position = {light})\n\
                 n = ({lean}, 0, 1)\n\
                 triangle((-2, -2, 0), (2, -2, 0), (0, 3, 0), normals = [n, n, n], material = matte(1))"
            ),
        )
        .value[0]
    };
    let cosine = |lean: f64, light: [f64; 2]| {
        (lean * light[0] + light[1]) / (1.0 + lean * lean).sqrt() / light[0].hypot(light[1])
    };
    assert!((seen("(0, 0, 5)", "(3, 0, 4)", 1.0) - cosine(1.0, [3.0, 4.0])).abs() < 1e-9);
    // From the left the normal is seen from behind, though the surface is not: it stays on its side.
    assert!(seen("(-5, 0, 1)", "(-3, 0, 4)", 1.0) > 0.0);
    assert!(seen("(-5, 0, 1)", "(3, 0, 4)", 1.0) > 0.5);
    // A light behind the surface lights nothing, though the normal leans towards it.
    assert_eq!(seen("(0, 0, 5)", "(4, 0, -1)", 1.0), 0.0);
    assert!(cosine(1.0, [4.0, -1.0]) > 0.5);
    // From the back the back is lit.
    assert!(seen("(0, 0, -5)", "(0, 0, -4)", 1.0) > 0.5);
}

#[test]
fn the_back_of_a_sheet_has_its_highlight_too() {
    for side in [1.0, -1.0] {
        let node = one_ray(
            0,
            &format!(
                "camera(eye = (0, 0, {side} * 5), look_at = (0, 0, 0), fov = 0.1)\n\
                 light(position = (0, 0, {side} * 9))\n\
                 rectangle(corner = (-1, -1, 0), edge_u = (2, 0, 0), edge_v = (0, 2, 0), \
                 material = phong((0.5, 0, 0), specular = 0.25))"
            ),
        );
        assert_near(node.value, [0.75, 0.25, 0.25], 1e-9);
    }
    // A light on the other side shows nothing.
    let node = one_ray(
        0,
        "camera(eye = (0, 0, 5), look_at = (0, 0, 0), fov = 0.1)\nlight(position = (0, 0, -9))\n\
         rectangle(corner = (-1, -1, 0), edge_u = (2, 0, 0), edge_v = (0, 2, 0), material = phong(1))",
    );
    assert_near(node.value, [0.0; 3], 0.0);
    assert_eq!(node.terms[0].detail["behind"], true);
}
