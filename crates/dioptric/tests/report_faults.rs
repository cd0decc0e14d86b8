// SPDX-License-Identifier: MIT OR Apache-2.0
//! The faults of the program that the report describes, as far as they are faults of shading: ours must
//! be free of them. Each test also evaluates the faulty formula at the same point and asserts that it
//! is wrong. Faults of shapes (1, 2, 3, 10) are tested in the geometry crate, of patterns (8, 9) in the
//! render crate, of bitmaps (11) in the image crate.

#![allow(clippy::disallowed_methods)]

mod support;

use support::{pixel, scene};

/// One pixel, one ray straight ahead, colours as they are.
const HEAD: &str = r#"
version(1)
scene(colors = "raw")
develop(encoding = "raw")
render(size = (1, 1), antialias = "none", bounces = 4, min_contribution = 0)
"#;

fn value(text: &str) -> [f64; 3] {
    let scene = scene(&format!("{HEAD}\n{text}"));
    let pixel = pixel(&scene, 0, 0);
    assert_eq!(pixel.samples.len(), 1);
    pixel.samples[0].ray.as_ref().expect("the camera sees everywhere").value
}

fn near(a: [f64; 3], b: [f64; 3]) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-9)
}

/// Fault 4: a refracted ray that leaves the scene returned the background and lost the surface's own
/// colour: black dots on the rim of glass.
#[test]
fn glass_before_nothing_keeps_its_own_colour() {
    let ours = value(
        r#"
camera(eye = (0, 0, 5), look_at = (0, 0, 0), fov = 1)
ambient(1)
background((0, 0, 0.5))
sphere(center = (0, 0, 0), radius = 1, material = clear((1, 0, 0), own = 0.3, ior = 1.05, specular = 0))
"#,
    );
    let background = [0.0, 0.0, 0.5];
    let right = [0.3, 0.0, 0.7 * 0.5];
    assert!(near(ours, right), "{ours:?}");
    // The published program: `if (Rayout.xindex == -1) return backgroundCol;`
    assert!(!near(background, right));
}

/// Fault 5: the exit of a transparent object was taken to be the next hit of any object. Where the
/// cube stands on the floor the exit is the cube's own bottom, and the floor that coincides with it is
/// seen through it, in the shadow of the cube.
#[test]
fn the_floor_under_a_clear_cube_is_seen_through_it() {
    for y in [0.0, -20.0, 0.1, 1e5 + 0.3] {
        let text = format!(
            r#"
camera(eye = (0.2, {top}, 0.3), look_at = (0.2, {y}, 0.3), up = (0, 0, -1), fov = 1)
ambient(0.2)
light(position = (100, {light}, 5), intensity = 0.5)
light(position = (-100, {light}, 5), intensity = 0.5)
rectangle(corner = (-50, {y}, 50), edge_u = (100, 0, 0), edge_v = (0, 0, -100), material = matte((0.6, 0.8, 1)), name = "floor")
box(min = (-4, {y}, -4), max = (4, {top_of_cube}, 4), material = clear((0, 1, 0), own = 0.15, ior = 1.005, specular = 0), name = "cube")
"#,
            top = y + 40.0,
            light = y + 120.0,
            top_of_cube = y + 8.0,
        );
        let ours = value(&text);
        // The cube's own colour at its top: ambient and both lights, seen from (0.2, 8, 0.3) above the floor.
        let point = [0.2, 8.0, 0.3];
        let own_green: f64 = 0.2
            + [100.0, -100.0]
                .iter()
                .map(|x| {
                    let way = [x - point[0], 120.0 - point[1], 5.0 - point[2]];
                    0.5 * way[1] / way.iter().map(|w| w * w).sum::<f64>().sqrt()
                })
                .sum::<f64>();
        let floor = [0.6, 0.8, 1.0].map(|c| 0.2 * c);
        let right = [0.85 * floor[0], 0.15 * own_green + 0.85 * floor[1], 0.85 * floor[2]];
        assert!(
            ours.iter().zip(right).all(|(a, b)| (a - b).abs() < 1e-6),
            "at {y}: {ours:?} {right:?}"
        );
        // The published program took the floor for the exit; its next ray started there and met nothing:
        // a slab in the colour of the background.
        let slab = [0.0, 0.15 * own_green, 0.0];
        assert!((slab[0] - right[0]).abs() > 0.05);
    }
}

/// Fault 6: total internal reflection gave a zero vector and black; it must reflect.
#[test]
fn light_that_cannot_get_out_is_reflected() {
    // Into the front of a glass cube (ior 1.5) at 45 degrees, close to its right face: inside, the ray
    // meets that face at 62 degrees, beyond the critical angle of 42, so it must be mirrored there and
    // leave through the back towards the left, where the wall is red; on the right it is green.
    let ours = value(
        r#"
camera(eye = (-4.1, 0, 6), look_at = (0.9, 0, 1), fov = 0.01)
ambient(1)
box(min = (-1, -1, -1), max = (1, 1, 1), material = clear((0, 0, 0), own = 0, ior = 1.5, specular = 0))
rectangle(corner = (-9, -9, -99), edge_u = (0, 18, 0), edge_v = (0, 0, 98), material = matte((1, 0, 0)))
rectangle(corner = (9, -9, -99), edge_u = (0, 18, 0), edge_v = (0, 0, 98), material = matte((0, 1, 0)))
"#,
    );
    assert!(near(ours, [1.0, 0.0, 0.0]), "{ours:?}");
    // The published program: glm::refract gives the zero vector beyond the critical angle.
    let (cos_inside, eta) = ((0.5_f64.sqrt() / 1.5), 1.5);
    let k = 1.0 - eta * eta * (1.0 - cos_inside * cos_inside);
    assert!(k < 0.0, "the formula has an answer here, {k}");
}

/// Fault 7: one light's shadow test overwrote the other light's light, and ambient light was added
/// 3.5 times where both shadows fell. The overlap must be the darkest.
#[test]
fn the_overlap_of_two_shadows_is_the_darkest() {
    // A ball over a floor between two lights; the floor is looked at from above past the ball.
    let at = |x: f64, z: f64| {
        value(&format!(
            r#"
camera(eye = ({x}, 60, {z}), look_at = ({x}, 0, {z}), up = (0, 0, -1), fov = 0.01)
ambient(0.2)
light(position = (15, 30, 40), intensity = 0.5)
light(position = (-15, 30, 40), intensity = 0.5)
plane(point = (0, 0, 0), normal = (0, 1, 0), material = matte((1, 1, 1)))
sphere(center = (0, 4, 0), radius = 3)
"#,
        ))[1]
    };
    let mut seen = Vec::new();
    for i in 0..60 {
        seen.push(at(f64::from(i) * 0.25 - 7.5, -6.0));
    }
    let ambient = 0.2;
    let darkest = seen.iter().copied().fold(f64::INFINITY, f64::min);
    let brightest = seen.iter().copied().fold(0.0, f64::max);
    assert!((darkest - ambient).abs() < 1e-9, "the overlap has ambient light alone, got {darkest}");
    let single: Vec<f64> =
        seen.iter().copied().filter(|v| *v > ambient + 1e-6 && *v < brightest - 0.1).collect();
    assert!(!single.is_empty(), "no single shadow among {seen:?}");
    assert!(single.iter().all(|v| *v > darkest + 0.05));
    // The published program's overlap: 3.5 times the ambient light of one light's 0.1, plus the base 0.2.
    let faulty_overlap = 0.2 + 3.5 * 0.1;
    assert!(
        single.iter().any(|v| faulty_overlap > *v),
        "the faulty overlap outshines a single shadow"
    );
}
