// SPDX-License-Identifier: MIT OR Apache-2.0
//! Paths of light against what is known without them: furnaces, form factors, Whitted's picture where both mean the same.

#![allow(clippy::disallowed_methods)] // the standard library's functions are the other opinion

mod support;

use std::f64::consts::PI;

use support::{assert_near, film, mean, paths, pixel, scene};

const CAMERAS: [&str; 3] = [
    "camera(eye = (0.1, 0.2, 0.3), look_at = (1, 0.5, -1), fov = 70)\n",
    "panorama(eye = (0.1, 0.2, 0.3))\n",
    "orthographic(eye = (0.1, 0.2, 0.3), look_at = (1, 0.5, -1), height = 0.5)\n",
];

/// QUALITY.md: a sphere around the camera, albedo and emission one half, is 1 everywhere; as it is with a point light
/// that sends 1 to everything.
#[test]
fn spheres_of_albedo_one_half_are_white() {
    for camera in CAMERAS {
        for antialias in ["sobol", "jitter"] {
            for light in ["both", "lights", "surfaces"] {
                let settings = paths(
                    8,
                    64,
                    &format!(", antialias = \"{antialias}\", light_sampling = \"{light}\""),
                );
                let glow = "sphere(center = (0, 0, 0), radius = 1, material = phong(0.5, specular = 0, emission = 0.5))";
                let (got, _) = mean(&format!("{settings}{camera}{glow}"));
                assert_near(got, [1.0; 3], 0.025);
                let lamp = "light(position = (0, 0, 0), falloff = \"square\")\n\
                            sphere(center = (0, 0, 0), radius = 1, material = matte(0.5))";
                let (got, _) = mean(&format!("{settings}{camera}{lamp}"));
                assert_near(got, [1.0; 3], 0.025);
            }
        }
    }
}

/// QUALITY.md: inside of a box with emission 1 and albedo a there is 1 / (1 - a) everywhere, of which 1 + a come by at
/// most one bounce.
#[test]
fn furnaces_are_as_bright_as_the_series() {
    for a in [0.5, 0.8] {
        for light in ["both", "surfaces"] {
            let room = format!(
                "camera(eye = (0.1, 0.2, 0.3), look_at = (1, 0.5, -1), fov = 70)\n\
                 box(min = (-1, -1, -1), max = (1, 1, 1), material = phong({a}, specular = 0, emission = 1))"
            );
            let setting = |bounces: u32| {
                paths(16, 256, &format!(", bounces = {bounces}, light_sampling = \"{light}\""))
            };
            let (got, error) = mean(&format!("{}{room}", setting(1000)));
            let expected = 1.0 / (1.0 - a);
            assert!(error[0] < 0.02 * expected, "{a} {light}: {error:?}");
            assert_near(got, [expected; 3], 4.0 * error[0]);
            let (got, error) = mean(&format!("{}{room}", setting(0)));
            assert_near(got, [1.0 + a; 3], 4.0 * error[0] + 1e-9);
        }
    }
}

/// A mirror or glass adds and takes nothing: in a space that is white all round no thing can be seen.
#[test]
fn lossless_things_vanish_in_a_white_space() {
    for material in [
        "mirror(1)",
        "mirror(1, roughness = 0.3)",
        "glass(ior = 1.5)",
        "glass(ior = 2.4)",
        "plastic(1, ior = 1.5)",
        "matte(1)",
        "clear(1, specular = 0, own = 0.3, ior = 1.2)",
    ] {
        let text = format!(
            "{}camera(eye = (0, 0, 5), fov = 20)\nbackground(1)\nsphere(center = (0, 0, 0), radius = 1, material = {material})",
            paths(16, 256, ", bounces = 10000")
        );
        let (got, error) = mean(&text);
        assert_near(got, [1.0; 3], 0.01 + 4.0 * error[0]);
    }
}

/// Direct light of sharp lights means the same in both ways to render: no random number is in it but the way on.
#[test]
fn sharp_lights_shine_as_in_whitted_s_pictures() {
    let settings = |integrator: &str| {
        format!(
            "version(1)\nscene(colors = \"raw\")\n\
             render(size = (24, 18), antialias = \"none\", bounces = 0, integrator = \"{integrator}\")\n"
        )
    };
    let text = "camera(eye = (0, 2, 6), look_at = (0, 0.7, 0), fov = 40)\n\
         light(position = (3, 5, 4), intensity = 0.8, falloff = FALLOFF)\n\
         plane(point = (0, 0, 0), material = matte(checker((0.8, 0.2, 0.1), 0.3)))\n\
         sphere(center = (-1, 1, 0), radius = 1, material = phong((0.2, 0.3, 0.9), specular = 0.7, exponent = 20))\n\
         sphere(center = (1.2, 0.7, 0.6), radius = 0.7, material = phong(0.6, specular = 0.4, exponent = 8, model = \"blinn\"))\n";
    for falloff in ["\"none\"", "\"square\""] {
        let text = text.replace("FALLOFF", falloff);
        let [whitted, path] = ["whitted", "path"].map(|i| scene(&format!("{}{text}", settings(i))));
        for (x, y) in (0..18).flat_map(|y| (0..24).map(move |x| (x, y))) {
            let [a, b] =
                [&whitted, &path].map(|s| pixel(s, x, y).samples[0].ray.clone().unwrap().value);
            assert_near(b, a, 1e-9);
        }
    }
}

/// The irradiance of lamps that glow, by their form factors (Howell, "A Catalog of Radiation Heat Transfer Configuration
/// Factors"), whichever way they are found.
#[test]
fn glowing_things_light_as_their_form_factors_say() {
    // A white floor seen from above: its radiance is E / pi = the form factor of the lamp's radiance 1.
    let lamps = [
        // B-12: a disc parallel to the surface, r = 1 at distance 2: r^2 / (r^2 + d^2).
        ("disc(center = (0, 2, 0), normal = (0, -1, 0), radius = 1, material = glow(1))", 0.2),
        // A sphere: (r / d)^2.
        ("sphere(center = (0, 2, 0), radius = 0.5, material = glow(1))", 1.0 / 16.0),
        // B-3: a square of side 2 at distance 2, four times a corner of 1 x 1.
        (
            "rectangle(corner = (-1, 2, -1), edge_u = (2, 0, 0), edge_v = (0, 0, 2), material = glow(1))",
            {
                let x = 0.5_f64;
                let p = (1.0 + x * x).sqrt();
                4.0 * (x / p * (x / p).atan()) / PI
            },
        ),
    ];
    for (lamp, expected) in lamps {
        for how in ["both", "lights", "surfaces"] {
            let text = format!(
                "{}orthographic(eye = (0, 1, 0), look_at = (0, 0, 0), up = (0, 0, 1), height = 0.001)\n\
                 plane(point = (0, 0, 0), material = matte(1))\n{lamp}",
                paths(8, 1024, &format!(", bounces = 0, light_sampling = \"{how}\""))
            );
            let (got, error) = mean(&text);
            assert!(error[0] < 0.02 * expected, "{lamp} {how}: {error:?}");
            assert_near(got, [expected; 3], 4.0 * error[0] + 1e-6);
        }
    }
}

/// Veach's scene in small: plates from sharp to dull under lamps from small to large. All ways of finding light agree,
/// and both together are never much worse than the better one.
#[test]
fn both_ways_together_are_nearly_as_good_as_the_better_one() {
    for alpha in [0.02, 0.1, 0.3] {
        for radius in [0.05, 0.3, 1.0] {
            let strength = 1.0 / (radius * radius);
            let text = |how: &str| {
                format!(
                    "{}camera(eye = (0, 2, 4), look_at = (0, 0, 0), fov = 25)\n\
                     plane(point = (0, 0, 0), material = mirror(0.8, roughness = {alpha}))\n\
                     sphere(center = (0, 2, -4), radius = {radius}, material = glow({strength}))",
                    paths(
                        16,
                        64,
                        &format!(
                            ", antialias = \"jitter\", bounces = 0, light_sampling = \"{how}\""
                        )
                    )
                )
            };
            let [both, lights, surfaces] =
                ["both", "lights", "surfaces"].map(|how| noise(&text(how)));
            let limit = 1.1 * lights.1.min(surfaces.1);
            assert!(
                both.1 <= limit,
                "alpha {alpha}, radius {radius}: {both:?} {lights:?} {surfaces:?}"
            );
            for other in [lights, surfaces] {
                let error = (both.2 * both.2 + other.2 * other.2).sqrt();
                let apart = (both.0 - other.0).abs();
                // Where one way is hopeless, its error is not known from so few samples.
                assert!(
                    apart < 4.0 * error || other.1 > 10.0 * both.1,
                    "alpha {alpha}, radius {radius}"
                );
            }
        }
    }
}

/// Mean, noise within pixels (root of the mean variance of a sample) and standard error of the mean.
fn noise(text: &str) -> (f64, f64, f64) {
    let scene = scene(text);
    let [width, height] = scene.settings.size;
    let (mut mean, mut variance, mut error) = (0.0, 0.0, 0.0);
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        let pixel = pixel(&scene, x, y);
        let values: Vec<f64> =
            pixel.samples.iter().map(|s| s.ray.as_ref().map_or(0.0, |r| r.value[1])).collect();
        let n = values.len() as f64;
        let own = values.iter().sum::<f64>() / n;
        let square = values.iter().map(|v| (v - own) * (v - own)).sum::<f64>() / (n - 1.0);
        mean += own;
        variance += square;
        error += square / n;
    }
    let count = f64::from(width * height);
    (mean / count, (variance / count).sqrt(), error.sqrt() / count)
}

/// `why` follows each path by itself, pictures take points sixteen at a time: to the same bits, whatever is around.
#[test]
fn points_side_by_side_are_points_one_by_one() {
    let room = "rectangle((-2, 0, 2), (4, 0, 0), (0, 0, -4), material = matte(checker((0.9, 0.8, 0.7), 0.2)))\n\
                sphere((-0.6, 0.5, 0), 0.5, material = mirror(0.9))\n\
                sphere((0.5, 0.5, 0.3), 0.5, material = glass(ior = 1.5, absorption = (1, 0.2, 0)))\n\
                box((0.2, 0, -1.5), (1.2, 1, -0.8), material = matte((0.7, 0.3, 0.2)))\n\
                sphere((-1.2, 0.3, 0.8), 0.3, material = plastic(0.6))\n\
                camera(eye = (0, 1.2, 4), look_at = (0, 0.5, 0), fov = 45)\n";
    let panel = "rectangle((-0.5, 2, -0.5), (1, 0, 0), (0, 0, 1), material = glow((9, 7, 5)), name = \"lamp\")\n";
    let around = [
        String::new(),
        "fog(color = 0.5, distance = 4)\n".into(),
        "medium(absorption = (0.2, 0.1, 0.05))\nlight(position = (1, 3, 2), falloff = \"square\")\n".into(),
        "background(gradient((1.0, 0.6, 0.3), (0.1, 0.25, 0.8), end = (0, 1, 0)))\n\
         sphere((1.6, 0.4, 0.5), 0.2, material = glow(3))\n"
            .into(),
    ];
    for around in &around {
        for more in
            ["", ", light_sampling = \"lights\"", ", clamp = 0.5", ", antialias = \"jitter\""]
        {
            let text = format!("{}{around}{room}{panel}", paths(12, 8, more));
            let scene = scene(&text);
            let film = film(&scene, 2);
            for (own, place) in film.pixels().iter().zip(0..) {
                let (x, y) = (place % 12, place / 12);
                let alone = pixel(&scene, x, y);
                let [r, g, b, alpha] = own.rgba().map(f64::from);
                assert_eq!(([r, g, b], alpha), (alone.linear, alone.alpha), "{x} {y}: {text}");
            }
        }
    }
}

/// Neighbouring pixels complete each other: means over 2 x 2 pixels are nearer to the truth than they would be if pixels knew
/// nothing of each other, and single pixels are no worse.
#[test]
fn errors_of_neighbouring_pixels_cancel() {
    let text = |samples: u32, seed: u64| {
        format!(
            "{}camera(eye = (0, 2, 6), look_at = (0, 0.6, 0), fov = 40)\n\
             rectangle((-3, 0, 3), (6, 0, 0), (0, 0, -6), material = matte(0.7))\n\
             rectangle((-3, 0, -2), (6, 0, 0), (0, 4, 0), material = matte(0.5))\n\
             rectangle((-1, 3, 0), (2, 0, 0), (0, 0, 2), material = glow(4))\n",
            paths(32, samples, &format!(", bounces = 2, seed = {seed}"))
        )
    };
    let picture = |samples: u32, seed: u64| -> Vec<f64> {
        film(&scene(&text(samples, seed)), 2).pixels().iter().map(|p| p.linear().x).collect()
    };
    let truth = picture(1024, 99);
    for samples in [1, 4, 12] {
        let all: Vec<_> = (0..4).map(|seed| picture(samples, seed)).collect();
        // Of four pictures one with four independent pixels in each block.
        let apart = |shift: usize| -> Vec<f64> {
            let from = |i: usize| (i % 2 + i / 32 % 2 * 2 + shift) % 4;
            (0..truth.len()).map(|i| all[from(i)][i]).collect()
        };
        let error = |picture: &[f64], blocks: bool| -> f64 {
            let off = |i: usize| picture[i] - truth[i];
            let corners = (0..truth.len()).filter(|i| i % 2 == 0 && i / 32 % 2 == 0);
            match blocks {
                false => (0..truth.len()).map(|i| off(i) * off(i)).sum(),
                true => {
                    let sum = |i: usize| off(i) + off(i + 1) + off(i + 32) + off(i + 33);
                    corners.map(|i| sum(i) * sum(i)).sum()
                }
            }
        };
        let ratio = |blocks: bool| -> f64 {
            let own: f64 = all.iter().map(|p| error(p, blocks)).sum();
            let others: f64 = (0..4).map(|shift| error(&apart(shift), blocks)).sum();
            own / others
        };
        println!("{samples} samples: {:.3} of blocks, {:.3} of pixels", ratio(true), ratio(false));
        assert!(ratio(true) < 0.75, "{samples}: {}", ratio(true));
        // The same pixels in another order.
        assert!((ratio(false) - 1.0).abs() < 1e-9);
    }
}
