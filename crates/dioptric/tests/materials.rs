// SPDX-License-Identifier: MIT OR Apache-2.0
//! What all materials may have: holes, light of their own, mixtures, maps of normals, in both integrators.

#![allow(clippy::disallowed_methods)]

mod support;

use dioptric::render::{Control, Region, render};
use rayon::ThreadPoolBuilder;
use support::scene;

/// The linear pixels of a picture.
fn pixels(text: &str) -> Vec<[f64; 3]> {
    let scene = scene(text);
    let [width, height] = scene.settings.size;
    let pool = ThreadPoolBuilder::new().num_threads(2).build().unwrap();
    let whole = Region::crop([width, height], [0, 0, width, height]).unwrap();
    let film = render(&scene, whole, &pool, &Control::default()).unwrap();
    film.pixels().iter().map(|p| p.linear().to_array()).collect()
}

fn mean(pixels: &[[f64; 3]]) -> [f64; 3] {
    [0, 1, 2].map(|i| pixels.iter().map(|p| p[i]).sum::<f64>() / pixels.len() as f64)
}

const INTEGRATORS: [&str; 2] = ["whitted", "path"];

/// A floor, lamps and things on it.
fn stage(integrator: &str, shadows: &str, things: &str) -> String {
    format!(
        r#"
version(1)
scene(colors = "raw")
render(size = (40, 40), integrator = "{integrator}", antialias = "sobol", samples = 4, shadows = "{shadows}")
camera(eye = (0, 3, 7), look_at = (0, 0.5, 0), fov = 40)
background(gradient((0.2, 0.3, 0.4), (0.6, 0.7, 0.9)))
light(position = (3, 6, 3), radius = 0.5)
light(position = (-3, 6, 3), color = (1, 0.5, 0.2))
plane(point = (0, 0, 0), normal = (0, 1, 0), material = matte(0.6))
sphere(center = (0.4, 0.6, -0.5), radius = 0.6, material = mirror())
{things}"#
    )
}

#[test]
fn what_is_all_hole_is_not_there() {
    let ghost = "sphere(center = (0, 1, 1), radius = 0.9, material = plastic(opacity = 0))\n\
                 sphere(center = (0.4, 0.6, -0.5), radius = 0.8, material = glass(opacity = 0))\n\
                 rectangle((-5, 0, -5), (10, 0, 0), (0, 0, 10), material = matte(opacity = 0))";
    for integrator in INTEGRATORS {
        for shadows in ["opaque", "tinted"] {
            let bare = pixels(&stage(integrator, shadows, ""));
            let haunted = pixels(&stage(integrator, shadows, ghost));
            assert!(bare == haunted, "{integrator} {shadows}");
        }
    }
}

#[test]
fn holes_are_where_the_pattern_says_for_rays_and_for_shadows() {
    // One of two squares: as a square, and as what is left of both. Their edges are no pixel's middle.
    let square = "rectangle((0, 1, 0), (1.05, 0, 0), (0, 1.3, 0.2), material = matte(0.7))";
    let mask = "stripes(1, 0, size = 1.05)";
    for integrator in INTEGRATORS {
        for shadows in ["opaque", "tinted"] {
            let one = pixels(&stage(integrator, shadows, square));
            let both = format!(
                "rectangle((-1.05, 1, 0), (2.1, 0, 0), (0, 1.3, 0.2), material = matte(0.7, opacity = {mask}))"
            );
            let left = pixels(&stage(integrator, shadows, &both));
            let apart = one
                .iter()
                .zip(&left)
                .filter(|(a, b)| a.iter().zip(b.iter()).any(|(x, y)| (x - y).abs() > 1e-9));
            let apart = apart.count();
            // Paths look for their light elsewhere on a surface that is described otherwise: nowhere, as it is dull.
            assert!(apart <= 4, "{integrator} {shadows}: {apart} pixels differ");
        }
    }
}

#[test]
fn half_there_is_seen_half() {
    for (integrator, opacity) in [("whitted", 0.3), ("path", 0.3), ("path", 0.8)] {
        let text = format!(
            "version(1)\nscene(colors = \"raw\")\n\
             render(size = (32, 32), integrator = \"{integrator}\", samples = 64, antialias = \"jitter\")\n\
             camera(eye = (0, 0, 4), look_at = (0, 0, 0), fov = 20)\nbackground((1, 0.5, 0.25))\n\
             rectangle((-9, -9, 0), (18, 0, 0), (0, 18, 0), material = matte(0, opacity = {opacity}))\n"
        );
        let [r, g, _] = mean(&pixels(&text));
        // 65536 draws: a standard error of 0.002.
        assert!((r - (1.0 - opacity)).abs() < 0.008, "{integrator} {opacity}: {r}");
        assert!((g / r - 0.5).abs() < 1e-9);
    }
}

#[test]
fn every_material_may_shine_and_paths_look_for_it() {
    // A ceiling lamp of metal that shines gives what one that only shines gives, where nothing else lights it.
    let room = |lamp: &str, how: &str| {
        format!(
            "version(1)\nscene(colors = \"raw\")\n\
             render(size = (24, 24), integrator = \"path\", samples = 64, light_sampling = \"{how}\", bounces = 1)\n\
             camera(eye = (0, 1, 5), look_at = (0, 0.2, 0), fov = 30)\n\
             plane(point = (0, 0, 0), normal = (0, 1, 0), material = matte(0.8))\n\
             sphere(center = (0, 3, 0), radius = 1, material = {lamp})\n"
        )
    };
    let expected = mean(&pixels(&room("glow((2, 1, 0.5))", "both")));
    for lamp in [
        "metal(\"gold\", emission = (1, 0.5, 0.25), emission_strength = 2)",
        "matte(0, emission = (2, 1, 0.5))",
        "glass(emission = (2, 1, 0.5))",
        "blend(glow((4, 2, 1)), matte(0), amount = 0.5)",
    ] {
        for how in ["both", "surfaces"] {
            let got = mean(&pixels(&room(lamp, how)));
            let off = (0..3).map(|i| (got[i] / expected[i] - 1.0).abs()).fold(0.0, f64::max);
            assert!(off < 0.03, "{lamp} {how}: {got:?} {expected:?}");
        }
    }
    let half = mean(&pixels(&room("matte(0, emission = (2, 1, 0.5), opacity = 0.5)", "both")));
    assert!((half[0] / expected[0] - 0.5).abs() < 0.03, "{half:?} {expected:?}");
}

#[test]
fn mixtures_are_the_mean_of_both() {
    for integrator in INTEGRATORS {
        let with = |material: &str| {
            let ball = format!("sphere(center = (0, 1, 1), radius = 0.9, material = {material})");
            let text = stage(integrator, "opaque", &ball).replace("samples = 4", "samples = 64");
            mean(&pixels(&text))
        };
        // Drawn by lot, and added up.
        for (a, b, amount) in [
            ("plastic((0.9, 0.2, 0.1))", "metal(\"copper\", roughness = 0.2, specular = 0)", 0.3),
            ("matte((0.1, 0.5, 0.9))", "mirror((0.9, 0.8, 0.7))", 0.6),
        ] {
            let (first, second) = (with(a), with(b));
            let mixed = with(&format!("blend({a}, {b}, amount = {amount})"));
            for i in 0..3 {
                // The ball's own light on the rest is not quite linear in what it is; not much of it.
                let expected = (1.0 - amount) * first[i] + amount * second[i];
                assert!(
                    (mixed[i] - expected).abs() < 0.004,
                    "{integrator} {a}: {mixed:?} {expected}"
                );
            }
        }
    }
}

#[test]
fn a_map_of_normals_turns_them_by_u_and_v() {
    // Constant over the surface but for a corner: (0.5, 0, sqrt(3) / 2) is 30 degrees towards u.
    let value = |map: &str, strength: f64| {
        let text = format!(
            "version(1)\nscene(colors = \"raw\")\nrender(size = (1, 1))\n\
             camera(eye = (0, 0, 4), look_at = (0, 0, 0), fov = 1)\n\
             directional(direction = (-1, 0, -1))\n\
             rectangle((-1, -1, 0), (2, 0, 0), (0, 2, 0),\n\
                material = matte(1, normal_map = {map}, normal_strength = {strength}))\n"
        );
        pixels(&text)[0][0]
    };
    // As a pattern that is the same nearly everywhere.
    let map = |x: f64, y: f64, z: f64| {
        format!("stripes(({x}, {y}, {z}), (0.5, 0.5, 1), size = 100, offset = (-50, 0, 0))")
    };
    // The light comes from between u and the normal.
    let near = |got: f64, expected: f64| assert!((got - expected).abs() < 1e-6, "{got} {expected}");
    let (high, root) = (0.5 + 0.25 * 3f64.sqrt(), 0.5f64.sqrt());
    let tilted = map(0.75, 0.5, high);
    near(value(&tilted, 1.0), 15f64.to_radians().cos());
    near(value(&tilted, -1.0), 75f64.to_radians().cos());
    near(value(&tilted, 0.0), root);
    near(value(&map(0.5, 0.75, high), 1.0), 30f64.to_radians().cos() * root);
}

/// The manual's tables of materials leave none out.
#[test]
fn tables_of_the_manual_have_every_material() {
    let read = |page: &str| {
        std::fs::read_to_string(support::root().join("docs/manual/src").join(page)).unwrap()
    };
    let (means, shows) = (read("path.md"), read("materials.md"));
    for schema in dioptric::render::material::SCHEMAS {
        let kind = format!("`{}`", schema.kind);
        let row = |text: &str| {
            text.lines().any(|l| {
                l.starts_with('|') && l.split('|').nth(1).is_some_and(|c| c.contains(&kind))
            })
        };
        assert!(row(&means), "path.md has no row for {kind}");
        assert!(shows.contains(&kind), "materials.md does not mention {kind}");
    }
}

/// What the sky shows below the horizon is what a white floor shows that sky and sun light.
#[test]
fn the_sky_and_its_sun_light_the_ground_as_they_say() {
    for (sun, up) in [("(0.5, 0.7, 0.5)", "y"), ("(0.8, 0.1, 0.3)", "z")] {
        let (eye, normal) =
            if up == "y" { ("(0, 2, 0.1)", "(0, 1, 0)") } else { ("(0, 0.1, 2)", "(0, 0, 1)") };
        let with = |floor: &str| {
            let text = format!(
                "version(1)\nscene(colors = \"raw\", up = \"{up}\")\n\
                 render(size = (16, 16), integrator = \"path\", samples = 256, bounces = 1)\n\
                 camera(eye = {eye}, look_at = (0, 0, 0), fov = 20)\n\
                 background(sky(sun = {sun}, ground = 1), intensity = 0.5)\n{floor}"
            );
            mean(&pixels(&text))
        };
        let said = with("");
        let got =
            with(&format!("plane(point = (0, 0, 0), normal = {normal}, material = matte(1))"));
        for i in 0..3 {
            assert!((got[i] / said[i] - 1.0).abs() < 0.02, "{got:?} {said:?}");
        }
    }
}
