// SPDX-License-Identifier: MIT OR Apache-2.0
//! Mirrors, coats and normals that are not those of the true surface.

use crate::support::{assert_near, one_ray};
use dioptric::render::integrator::recorder::{Node, RayKind};

#[test]
fn mirrors_that_face_each_other_are_a_geometric_series() {
    for bounces in [0, 1, 2, 7, 64] {
        let got = one_ray(
            bounces,
            "camera(eye = (0, 0, 0), look_at = (0, 0, -1), fov = 1)\nambient(1)\n\
             m = phong((1, 0.5, 0), diffuse = 0, specular = 0, mirror = 0.5)\n\
             plane(point = (0, 0, -1), normal = (0, 0, 1), material = m)\n\
             plane(point = (0, 0, 1), normal = (0, 0, -1), material = m)",
        );
        let sum = 2.0 - 0.5_f64.powi(bounces as i32);
        assert_near(got.value, [sum, 0.5 * sum, 0.0], 1e-12);
    }
}

#[test]
fn rays_too_weak_to_matter_are_not_followed() {
    let text = "camera(eye = (0, 0, 0), look_at = (0, 0, -1), fov = 1)\nambient(1)\n\
                m = phong(1, diffuse = 0, specular = 0, mirror = 0.5)\n\
                plane(point = (0, 0, -1), normal = (0, 0, 1), material = m)\n\
                plane(point = (0, 0, 1), normal = (0, 0, -1), material = m)";
    let scene = crate::support::scene(&format!(
        "version(1)\nscene(colors = \"raw\")\nrender(size = (1, 1), antialias = \"none\", bounces = 64, \
         min_contribution = 0.1)\n{text}"
    ));
    let ray = crate::support::pixel(&scene, 0, 0).samples[0].ray.clone().unwrap();
    // 0.5^3 = 0.125 is followed, 0.5^4 is not: four terms.
    assert_near(ray.value, [1.875; 3], 1e-12);
    let mut last = &ray;
    while let Some(next) = last.children.first() {
        last = &next.ray;
    }
    assert_eq!(last.detail["not_followed"][0]["kind"], "reflected");
    assert_eq!(last.detail["not_followed"][0]["weight"][1], 0.5);
}

/// A surface in the plane z = 0, seen at an angle to its normal, in a space that is white all round.
fn in_white_space(degrees: f64, material: &str) -> Node {
    let (s, c) = degrees.to_radians().sin_cos();
    one_ray(
        1,
        &format!(
            "camera(eye = ({}, 0, {}), look_at = (0, 0, 0), up = (0, 1, 0), fov = 1)\nambient(1)\nbackground(1)\n\
             plane(point = (0, 0, 0), normal = (0, 0, 1), material = {material})",
            5.0 * s,
            5.0 * c
        ),
    )
}

#[test]
fn coats_take_what_they_mirror_from_the_colour_below() {
    for degrees in [0.0_f64, 30.0, 60.0, 85.0] {
        let w = 0.04 + 0.96 * (1.0 - degrees.to_radians().cos()).powi(5);
        let white = in_white_space(degrees, "plastic(1, specular = 0)");
        assert_near(white.value, [1.0; 3], 1e-12);
        let dull = in_white_space(degrees, "plastic((0.5, 0.25, 0), specular = 0)");
        assert_near(dull.value, [0.5, 0.25, 0.0].map(|c| (1.0 - w) * c + w), 1e-12);
        assert_eq!(dull.terms[0].detail["scaled_by"][0]["by"], "coat");
        assert!(dull.children[0].scaled_by.is_empty());
        let gold = in_white_space(degrees, "metal(color = (0.9, 0.6, 0.3), specular = 0)");
        let m = (1.0 - degrees.to_radians().cos()).powi(5);
        assert_near(gold.value, [0.9, 0.6, 0.3].map(|f| f + (1.0 - f) * m), 1e-12);
    }
}

#[test]
fn a_hardly_rough_mirror_is_a_mirror() {
    let seen = |roughness: f64| {
        one_ray(
            3,
            &format!(
                "camera(eye = (1, 2, 5), look_at = (0.3, 0.4, 0), fov = 1)\n\
                 background(gradient((1, 0, 0), (0, 1, 0.5), start = (-1, -1, -1), end = (1, 1, 1)))\n\
                 sphere(radius = 1, material = metal(color = (0.9, 0.6, 0.3), specular = 0, roughness = {roughness}))\n\
                 sphere(center = (0, 0, 9), radius = 2, material = glass(ior = 1.4, specular = 0, roughness = {roughness}))"
            ),
        )
        .value
    };
    let sharp = seen(0.0);
    assert_near(seen(1e-9), sharp, 1e-7);
    assert!(seen(0.5) != sharp);
}

/// No ray of a rough or bumpy thing may end up on the wrong side of its true surface: at a plane of metal all
/// rays go up, at glass what is reflected goes up and what is transmitted down.
#[test]
fn bent_normals_send_no_ray_to_the_wrong_side() {
    let bump = "bump = noise(size = 0.01), bump_height = 1";
    for material in [
        "metal(\"gold\", roughness = 1)".to_string(),
        format!("metal(\"gold\", {bump})"),
        "glass(roughness = 1)".to_string(),
        format!("glass({bump})"),
        format!("glass(roughness = 0.7, {bump})"),
        format!("clear(own = 0, ior = 1.5, {bump})"),
    ] {
        let scene = crate::support::scene(&format!(
            "version(1)\nrender(size = (24, 24), antialias = \"none\", bounces = 1, min_contribution = 0)\n\
             background(1)\ncamera(eye = (0, 0.3, 5), look_at = (0, 0, 0), fov = 20)\nlight(position = (0, -5, 9))\n\
             box(min = (-90, -9, -90), max = (90, 0, 90), material = {material})"
        ));
        let mut rays = 0;
        for (x, y) in (12..24).flat_map(|y| (0..24).map(move |x| (x, y))) {
            let ray = crate::support::pixel(&scene, x, y).samples[0].ray.clone().unwrap();
            if ray.object.is_none() || ray.detail["point"][1].as_f64() != Some(0.0) {
                continue;
            }
            assert!(
                ray.value.iter().all(|v| v.is_finite() && *v <= 1.0 + 1e-9),
                "{material} {ray:?}"
            );
            // The light is below the surface: it lights nothing, however the normals are bent.
            assert!(
                ray.terms.iter().all(|t| t.value == [0.0; 3] || t.name != "highlight"),
                "{material}"
            );
            for child in &ray.children {
                let up = child.ray.direction[1] > 0.0;
                if material.starts_with("clear") {
                    continue; // goes through the whole box
                }
                assert_eq!(up, child.ray.kind == RayKind::Reflected, "{material} {x},{y}");
                rays += 1;
            }
            // Nothing is lost either.
            if material.starts_with("glass") {
                let weight: f64 = ray.children.iter().map(|c| c.weight[0]).sum();
                assert!((weight - 1.0).abs() < 1e-9, "{material} {weight}");
            }
        }
        assert!(rays > 100 || material.starts_with("clear"), "{material}: {rays} rays");
    }
}

#[test]
fn a_light_behind_the_true_surface_lights_no_bump() {
    let seen = |side: f64| {
        let node = one_ray(
            1,
            &format!(
                "camera(eye = (0, 0, 5), look_at = (0, 0, 0), fov = 1)\n\
                 light(position = (9, 0, {side}), intensity = 1)\n\
                 rectangle(corner = (-9, -9, 0), edge_u = (18, 0, 0), edge_v = (0, 18, 0), \
                 material = matte(1, bump = gradient(1, 0, start = (-1, 0, 0), end = (1, 0, 0)), bump_height = 4))"
            ),
        );
        node.value[0]
    };
    assert!(seen(0.5) > 0.5, "{}", seen(0.5));
    assert_eq!(seen(-0.5), 0.0);
}
