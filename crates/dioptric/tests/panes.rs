// SPDX-License-Identifier: MIT OR Apache-2.0
//! Flat shapes and open ones have no inside: what is transparent looks the same from both sides, and
//! does not bend rays.

#![allow(clippy::disallowed_methods)]

mod support;

use support::{pixel, scene};

/// The value of a ray at a slant through a pane that faces it (1) or not (-1), with a red lamp straight
/// behind.
fn through(material: &str, side: f64) -> [f64; 3] {
    let scene = scene(&format!(
        r#"
version(1)
scene(colors = "raw")
develop(encoding = "raw")
render(size = (1, 1), antialias = "none", min_contribution = 0)
background((0.2, 0.4, 0.6))
camera(eye = (0, 0, 4), look_at = (1, 0, 0), up = (0, 1, 0), fov = 1)
light(position = (-1.5, 0.5, 5))
triangle((-9, -9, 0), ({side} * 9, {side} * -9, 0), ({side} * -9, {side} * 9, 0),
    material = {material})
sphere(center = (2, 0, -4), radius = 0.05, material = glow((1, 0, 0)))
"#
    ));
    pixel(&scene, 0, 0).samples[0].ray.as_ref().expect("the camera sees everywhere").value
}

#[test]
fn panes_have_no_inside() {
    for material in [
        "clear((0.9, 0.3, 0.3), own = 0.3, tint = (0.5, 1, 1), ior = 1.5, exponent = 3)",
        "glass((0.5, 1, 1), ior = 1.5, exponent = 3)",
    ] {
        let (front, back) = (through(material, 1.0), through(material, -1.0));
        assert_eq!(front, back, "{material}");
        // Bent rays would miss the lamp and see the blue background.
        assert!(front[0] > front[2] + 0.2, "{material}: {front:?}");
    }
}
