// SPDX-License-Identifier: MIT OR Apache-2.0
//! Guides for gathered light: they change no mean, and take noise away.

mod support;

use dioptric::math::Spectrum;
use support::{film, scene};

/// All pixels of a picture.
fn pixels(text: &str, threads: usize) -> Vec<Spectrum> {
    let film = film(&scene(text), threads);
    film.pixels().iter().map(|p| p.linear()).collect()
}

/// Mean, its standard error, and the root mean square of the pixels' differences from the mean.
fn figures(pixels: &[Spectrum]) -> (f64, f64, f64) {
    let n = pixels.len() as f64;
    let mean = pixels.iter().map(|p| p.y).sum::<f64>() / n;
    let square = pixels.iter().map(|p| (p.y - mean) * (p.y - mean)).sum::<f64>() / n;
    (mean, (square / n).sqrt(), square.sqrt())
}

/// A spot of a floor where a ball of glass gathers the light of a lamp, and nothing else comes: it is nearly of one brightness.
fn gathered(lamp: f64, glass: &str, samples: u32, photons: u32) -> String {
    format!(
        "version(1)\nscene(colors = \"raw\")\n\
         render(size = (16, 16), integrator = \"path\", antialias = \"jitter\", samples = {samples}, caustics = {photons}, bounces = 4)\n\
         orthographic(eye = (3, 1, 0), look_at = (0, 0, 0), up = (0, 1, 0), height = 0.02)\n\
         plane(point = (0, 0, 0), material = matte(0.5))\n\
         sphere(center = (0, 1.6, 0), radius = 0.5, material = {glass})\n\
         sphere(center = (0, 8, 0), radius = {lamp}, material = glow({}))",
        1.0 / (lamp * lamp)
    )
}

#[test]
fn guides_change_no_mean_and_take_noise_away() {
    for (glass, less) in [("glass(ior = 1.5)", false), ("glass(ior = 1.5, dispersion = 15)", true)]
    {
        let plain = figures(&pixels(&gathered(0.5, glass, 256, 0), 2));
        let guided = figures(&pixels(&gathered(0.5, glass, 64, 20_000), 2));
        let error = (plain.1 * plain.1 + guided.1 * guided.1).sqrt();
        assert!((plain.0 - guided.0).abs() < 4.0 * error, "{plain:?} {guided:?}");
        // The smaller the lamp, the less often chance finds it. (Over balls that bend all light alike it is found anyway.)
        let plain = figures(&pixels(&gathered(0.1, glass, 64, 0), 2));
        let guided = figures(&pixels(&gathered(0.1, glass, 64, 20_000), 2));
        assert!(!less || guided.2 < 0.5 * plain.2, "{plain:?} {guided:?}");
    }
}

/// What is gathered may come by way of mirrors, of the sky, of lamps that are no objects; and from nowhere.
#[test]
fn all_kinds_of_things_and_lights_are_found() {
    let settings = |samples: u32, photons: u32| {
        format!(
            "version(1)\nscene(colors = \"raw\")\nrender(size = (16, 16), integrator = \"path\", samples = {samples}, caustics = {photons})\n\
             camera(eye = (0, 2, 4), look_at = (0, 0.3, 0), fov = 40)\nplane(point = (0, 0, 0), material = plastic(0.5))\n"
        )
    };
    for things in [
        "background(1)\nsphere((0, 0.6, 0), 0.5, material = mirror(0.9))",
        "light((2, 4, 0), radius = 0.5, intensity = 1)\nbox((-0.5, 0.1, -0.5), (0.5, 1, 0.5), material = mirror(0.9))",
        "light((2, 4, 0), radius = 0.5, intensity = 1)\nsphere((0, 0.6, 0), 0.5, material = clear(own = 0.1, ior = 1.3))",
        "light((2, 4, 0))\nsphere((0, 0.6, 0), 0.5, material = glass())",
        "sphere((0, 0.6, 0), 0.5, material = glass())",
        "background(1)\nsphere((0, 0.6, 0), 0.5)",
        "background(0.5)\nlight((2, 4, 0), radius = 0.5)\ndifference(box((-0.5, 0, -0.5), (0.5, 0.7, 0.5)), minus = [sphere((0, 0.9, 0), 0.5)], material = glass())\n\
         box((-9, -1, -9), (9, 9, 9), material = volume(scattering = 0.05))",
    ] {
        let plain = figures(&pixels(&format!("{}{things}", settings(256, 0)), 2));
        let guided = figures(&pixels(&format!("{}{things}", settings(256, 5000)), 2));
        let off = (plain.0 - guided.0).abs();
        assert!(off < 0.015 * plain.0 + 1e-12, "{things}: {plain:?} {guided:?}");
    }
}

/// The same bytes for any number of threads.
#[test]
fn guides_are_the_same_each_time() {
    let text = gathered(0.2, "glass(ior = 1.5, dispersion = 20)", 16, 3000);
    let one = pixels(&text, 1);
    assert!(one == pixels(&text, 2) && one == pixels(&text, 7));
}

/// A spot of a floor to which light comes over a ball, from a lamp, by one of the ways to look for it.
fn over(ball: &str, floor: &str, lamp: &str, how: &str, samples: u32) -> String {
    format!(
        "version(1)\nscene(colors = \"raw\")\n\
         render(size = (16, 16), integrator = \"path\", samples = {samples}, bounces = 6, light_sampling = \"{how}\")\n\
         orthographic(eye = (3, 1, 0.3), look_at = (0.1, 0, 0.2), up = (0, 1, 0), height = 0.02)\n\
         plane(point = (0, 0, 0), material = {floor})\n{ball}\n{lamp}"
    )
}

/// Ways over balls are solved for: the mean stays as it is where paths find them by themselves, and most noise goes.
#[test]
fn light_over_balls_is_found_without_bias() {
    let lamp = "sphere(center = (0.5, 5, 1), radius = 0.8, material = glow(3))";
    let balls = [
        "sphere(center = (0, 0.9, 0), radius = 0.5, material = glass(ior = 1.5))",
        "sphere(center = (0, 0.9, 0), radius = 0.5, material = glass(ior = 1.5, color = (0.9, 0.5, 0.7)))",
        "sphere(center = (0, 0.52, 0), radius = 0.5, material = glass(ior = 2.2))\nsphere(center = (0.1, 0.6, 0.1), radius = 0.15, material = matte(0.7))",
        "sphere(center = (0.9, 0.6, 0), radius = 0.5, material = mirror((0.9, 0.6, 0.3)))",
        "sphere(center = (0.9, 0.6, 0), radius = 0.5, material = metal(\"gold\", roughness = 0))\nsphere(center = (-0.8, 0.6, 0), radius = 0.4, material = glass(ior = 1.4))",
    ];
    let others = [
        "disc(center = (0.5, 5, 1), normal = (0.2, 1, 0), radius = 0.9, material = glow(3))",
        "rectangle((0, 4, 0), (1, 0, 0.1), (0, 0.3, 1.2), material = glow(3))",
        "box((0, 4, 0), (0.8, 4.4, 1), material = glow(3))",
    ];
    let cases = balls.iter().map(|ball| (*ball, "matte(0.5)", lamp));
    let cases = cases.chain(others.iter().map(|other| (balls[0], "plastic(0.5)", *other)));
    let mut gains = 0;
    for (ball, floor, lamp) in cases {
        let chance = figures(&pixels(&over(ball, floor, lamp, "surfaces", 1024), 2));
        for how in ["both", "lights"] {
            let asked = figures(&pixels(&over(ball, floor, lamp, how, 1024), 2));
            let error = (chance.1 * chance.1 + asked.1 * asked.1).sqrt();
            assert!(
                (chance.0 - asked.0).abs() < 4.0 * error,
                "{ball} {lamp} {how}: {chance:?} {asked:?}"
            );
            gains += u32::from(how == "both" && asked.2 < 0.5 * chance.2);
        }
    }
    assert!(gains >= 5, "{gains}");
}
