// SPDX-License-Identifier: MIT OR Apache-2.0
//! Things that reach into each other, by their priorities, against the same things cut to fit.

use crate::support::{assert_near, one_ray, pixel, scene};

const LIGHTS: &str = "background(gradient((1, 0.5, 0.2), (0.1, 0.3, 1), end = (0, 1, 0)))\n\
    light(position = (3, 4, 5), intensity = 0.5)\n\
    plane(point = (0, -1.5, 0), material = matte(checker(0.9, 0.3, size = 0.3)))\n";

/// A ball of glass with water in it, cut to fit: the water's surface is that of the glass.
const FITTED: &str = "sphere(center = (0, 0, 0), radius = 1, material = glass(ior = 1.5, specular = 0))\n\
    sphere(center = (0, 0, 0), radius = 0.7, material = glass(ior = 1.33, absorption = (0.1, 0.3, 0.6), specular = 0))";

/// The same: a hollow ball of glass, and the water reaches into its wall.
const OVERLAPPING: &str = "difference(sphere(center = (0, 0, 0), radius = 1), minus = [sphere(center = (0, 0, 0), radius = 0.7)],\n\
        material = glass(ior = 1.5, priority = 2, specular = 0))\n\
    sphere(center = (0, 0, 0), radius = 0.85, material = glass(ior = 1.33, absorption = (0.1, 0.3, 0.6), priority = 1, specular = 0))";

#[test]
fn water_that_reaches_into_its_glass_is_water_that_fits() {
    for (eye, bounces) in [("(0.2, 0.1, 5)", 16), ("(2, 3, 4)", 16), ("(-4, 0.5, 1)", 16)] {
        let camera = format!("camera(eye = {eye}, look_at = (0.1, 0.2, 0), fov = 1)\n");
        let [a, b] = [FITTED, OVERLAPPING]
            .map(|things| one_ray(bounces, &format!("{camera}{LIGHTS}{things}")).value);
        // Surfaces that are not there count as bounces in Whitted's trees of rays, so these end a little sooner.
        assert_near(a, b, 2e-3);
    }
}

#[test]
fn paths_do_not_even_notice() {
    let settings = "version(1)\nscene(colors = \"raw\")\nrender(size = (8, 8), samples = 16, integrator = \"path\")\n\
        camera(eye = (2, 3, 4), look_at = (0, 0, 0), fov = 30)\n";
    let [a, b] = [FITTED, OVERLAPPING].map(|things| scene(&format!("{settings}{LIGHTS}{things}")));
    let mut differ = 0;
    for (x, y) in (0..8).flat_map(|y| (0..8).map(move |x| (x, y))) {
        let [a, b] = [&a, &b].map(|s| pixel(s, x, y));
        for (a, b) in a.samples.iter().zip(&b.samples) {
            let [a, b] = [a, b].map(|s| s.ray.as_ref().unwrap().value);
            // The same random numbers meet the same surfaces, but for rounding where one ends.
            differ += u32::from((0..3).any(|i| (a[i] - b[i]).abs() > 1e-6 * (1.0 + a[i])));
        }
    }
    assert!(differ <= 5, "{differ} of 1024 samples");
}

/// Of equal priorities, which is what things have that say nothing, the one that was entered last counts.
#[test]
fn the_order_matters_only_among_equals() {
    let thing = |z: [f64; 2], ior: f64, priority: i32| {
        format!(
            "box(min = (-9, -9, {}), max = (9, 9, {}), material = glass(ior = {ior}, priority = {priority}, specular = 0))\n",
            z[0], z[1]
        )
    };
    let camera = "camera(eye = (0, 0, 5), fov = 1)\nbackground(1)\n";
    let indices = |things: &str| {
        let ray = one_ray(8, &format!("{camera}{things}"));
        crate::support::transmitted(&ray)
            .iter()
            .filter_map(|n| n.detail.get("fresnel"))
            .map(|f| ["ior_from", "ior_to"].map(|key| f[key].as_f64().unwrap()))
            .collect::<Vec<_>>()
    };
    let (front, back) = ([-1.0, 1.0], [-2.0, 0.0]);
    let equal = indices(&(thing(front, 1.5, 0) + &thing(back, 1.3, 0)));
    assert_eq!(equal, [[1.0, 1.5], [1.5, 1.3], [1.3, 1.3], [1.3, 1.0]]);
    let first = indices(&(thing(front, 1.5, 1) + &thing(back, 1.3, 0)));
    assert_eq!(first, [[1.0, 1.5], [1.5, 1.3], [1.3, 1.0]]);
    let second = indices(&(thing(front, 1.5, -1) + &thing(back, 1.3, 0)));
    assert_eq!(second, [[1.0, 1.5], [1.5, 1.3], [1.3, 1.0]]);
}
