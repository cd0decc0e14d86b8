// SPDX-License-Identifier: MIT OR Apache-2.0
//! Media that scatter, against what is known without them: furnaces, Beer and Lambert's law, integrals, a plain random walk.

#![allow(clippy::disallowed_methods)] // the standard library's functions are the other opinion

mod support;

use std::f64::consts::PI;

use dioptric::math::random::{mix, unit};
use support::{assert_near, mean, paths, pixel, scene};

/// A camera that looks along one line.
const LINE: &str = "orthographic(eye = (0, 0, 5), look_at = (0, 0, 0), height = 0.0001)\n";

/// What absorbs nothing cannot be seen in a white space, however it scatters.
#[test]
fn white_media_vanish_in_a_white_space() {
    for (material, more) in [
        ("volume(scattering = 1)", ""),
        ("volume(scattering = (0.2, 1, 4), anisotropy = 0.8)", ""),
        ("volume(scattering = (0, 2, 0), anisotropy = -0.6)", ""),
        ("glass(ior = 1.5, scattering = 2, anisotropy = 0.3)", ""),
        ("glass(ior = 1.3, scattering = (3, 0, 1), roughness = 0.3)", ""),
        (
            "volume(scattering = 1)",
            "sphere(center = (0.3, 0, 0), radius = 0.4, material = matte(1))",
        ),
        (
            "volume(scattering = 2)",
            "sphere(center = (0.3, 0, 0), radius = 0.4, material = glass(scattering = 3))",
        ),
        (
            "volume(scattering = 2)",
            "sphere(center = (0.9, 0, 0), radius = 0.7, material = volume(scattering = 3))",
        ),
    ] {
        for how in ["both", "lights", "surfaces"] {
            let settings = paths(8, 100, &format!(", bounces = 10000, light_sampling = \"{how}\""));
            let text = format!(
                "{settings}camera(eye = (0, 0, 5), fov = 20)\nbackground(1)\n{more}\n\
                 sphere(center = (0, 0, 0), radius = 1, material = {material})"
            );
            let (got, error) = mean(&text);
            for lane in 0..3 {
                assert!(error[lane] < 0.06 || how != "both", "{material} {how}: {error:?}");
                assert!(
                    (got[lane] - 1.0).abs() < 4.0 * error[lane] + 0.002,
                    "{material} {how}: {got:?} {error:?}"
                );
            }
        }
    }
}

/// Sharp lights through fog without and with borders: `exp(-extinction d)`, exactly.
#[test]
fn light_fades_by_beer_and_lambert() {
    let floor = "orthographic(eye = (0, 1, 0), look_at = (0, 0, 0), up = (0, 0, 1), height = 0.001)\n\
                 plane(point = (0, 0, 0), material = matte(1))\n\
                 directional(direction = (-3, -4, 0))\n";
    let settings = paths(2, 4, ", bounces = 0");
    let cosine = 0.8;
    let beer = |k: f64| cosine * (-k / cosine).exp();
    let slab = "box(min = (-99, 2, -99), max = (99, 3, 99), material = volume(scattering = (0.5, 1, 0), absorption = (0.1, 0, 0)))";
    let (got, _) = mean(&format!("{settings}{floor}{slab}"));
    assert_near(got, [beer(0.6), beer(1.0), beer(0.0)], 1e-9);
    // Two that overlap: what was entered last counts.
    let second =
        "box(min = (-99, 2.5, -99), max = (99, 2.75, 99), material = volume(scattering = 2))";
    let (got, _) = mean(&format!("{settings}{floor}{slab}\n{second}"));
    assert_near(got, [beer(0.75 * 0.6 + 0.5), beer(0.75 + 0.5), beer(0.5)], 1e-9);
    // A thing in the way is in the way.
    let (got, _) =
        mean(&format!("{settings}{floor}{slab}\nsphere(center = (1.875, 2.5, 0), radius = 0.2)"));
    assert_near(got, [0.0; 3], 0.0);
    // The whole space, and scenes of other sizes. The camera looks through 1 of it.
    for scale in [1.0, 1000.0] {
        let lamp = format!(
            "version(1)\nscene(colors = \"raw\", transform = scale({scale}))\n\
             render(size = (2, 2), integrator = \"path\", samples = 4, bounces = 0)\n\
             orthographic(eye = (0, 1, 0), look_at = (0, 0, 0), up = (0, 0, 1), height = 0.001)\n\
             plane(point = (0, 0, 0), material = matte(1))\nlight(position = (0, 2, 0))\n"
        );
        // Light that the fog itself turns is left out by a cover over the ray to the camera: only what the floor sends.
        let scene = scene(&format!("{lamp}medium(scattering = (0.5, 1, 0), absorption = 0.25)"));
        let found = pixel(&scene, 0, 0);
        let direct = found.paths.unwrap().groups.into_iter().find(|g| g.class == "LDE").unwrap();
        // Not every sample of the camera's gets to the floor; those that do count for all.
        let expected = [0.75_f64, 1.25, 0.25].map(|k| (-3.0 * k).exp());
        for (lane, expected) in expected.iter().enumerate() {
            let off = (direct.value[lane] - expected).abs();
            assert!(off < 4.0 * direct.standard_error[lane] + 1e-4, "{direct:?}");
        }
    }
}

/// Henyey and Greenstein's function.
fn phase(g: f64, cos: f64) -> f64 {
    (1.0 - g * g) / (4.0 * PI * (1.0 + g * g - 2.0 * g * cos).powf(1.5))
}

/// What a line sees of a light without a size by one turn, by Simpson's rule... by plain sums that are fine enough.
fn single(light: [f64; 3], k: f64, s: f64, g: f64, lit: impl Fn([f64; 3]) -> f64) -> f64 {
    let n = 200_000;
    let (far, mut sum) = (30.0, 0.0);
    for i in 0..n {
        let t = (f64::from(i) + 0.5) / f64::from(n) * far;
        let p = [0.0, 0.0, 5.0 - t];
        let way = [0, 1, 2].map(|i| light[i] - p[i]);
        let d2: f64 = way.iter().map(|x| x * x).sum();
        let d = d2.sqrt();
        sum += s * phase(g, -way[2] / d) * PI / d2 * (-k * (t + d)).exp() * lit(p) * far
            / f64::from(n);
    }
    sum
}

#[test]
fn one_turn_towards_a_small_light_is_the_integral() {
    let light = [0.4, 0.3, 1.0];
    for (g, s, a) in [(0.0, 0.1, 0.0), (0.7, 0.3, 0.2), (-0.5, 0.8, 0.1)] {
        for how in ["both", "lights"] {
            let settings = paths(8, 256, &format!(", bounces = 0, light_sampling = \"{how}\""));
            let medium = format!("medium(scattering = {s}, absorption = {a}, anisotropy = {g})\n");
            let all = |_: [f64; 3]| 1.0;
            let point = "light(position = (0.4, 0.3, 1), falloff = \"square\")";
            let (got, error) = mean(&format!("{settings}{LINE}{medium}{point}"));
            let expected = single(light, s + a, s, g, all);
            assert!(error[0] < 0.02 * expected, "{g}: {error:?} of {expected}");
            assert_near(got, [expected; 3], 4.0 * error[0] + 1e-4 * expected);
            // The beam of a spot crosses the line at a right angle.
            let spot = "spot(position = (0.4, 0.3, 1), look_at = (0, 0, 1), angle = 20, soft = 0, falloff = \"square\")";
            let (got, error) = mean(&format!("{settings}{LINE}{medium}{spot}"));
            let half = 10_f64.to_radians().tan() * 0.5;
            let beam = |p: [f64; 3]| f64::from(u8::from((p[2] - 1.0).abs() < half));
            let expected = single(light, s + a, s, g, beam);
            assert!(error[0] < 0.02 * expected, "spot {g}: {error:?} of {expected}");
            assert_near(got, [expected; 3], 4.0 * error[0] + 1e-3 * expected);
        }
    }
}

/// A random walk without any art: how much of the light that comes from a white sky is left after its way through a ball.
fn walk(k: f64, albedo: f64, g: f64, walks: u64) -> (f64, f64) {
    let mut state = 1_u64;
    let mut next = || {
        state += 1;
        unit(mix(state))
    };
    let (mut sum, mut square) = (0.0, 0.0);
    for _ in 0..walks {
        let (mut p, mut d) = ([0.0, 0.0, 1.0], [0.0, 0.0, -1.0_f64]);
        let mut left = 1.0;
        loop {
            let t = -(1.0 - next()).ln() / k;
            p = [0, 1, 2].map(|i| p[i] + d[i] * t);
            if p.iter().map(|x| x * x).sum::<f64>() > 1.0 {
                break;
            }
            left *= albedo;
            // Turned by a cosine that is picked by its share, around by any angle.
            let v = next();
            let cos = if g == 0.0 {
                2.0 * v - 1.0
            } else {
                let q = (1.0 - g * g) / (1.0 - g + 2.0 * g * v);
                (1.0 + g * g - q * q) / (2.0 * g)
            };
            let sin = (1.0 - cos * cos).max(0.0).sqrt();
            let (b, a) = (2.0 * PI * next()).sin_cos();
            let helper = if d[0].abs() < 0.5 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
            let cross = |a: [f64; 3], b: [f64; 3]| {
                [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
            };
            let x = cross(d, helper);
            let length = x.iter().map(|c| c * c).sum::<f64>().sqrt();
            let x = x.map(|c| c / length);
            let y = cross(d, x);
            d = [0, 1, 2].map(|i| d[i] * cos + x[i] * sin * a + y[i] * sin * b);
        }
        sum += left;
        square += left * left;
    }
    let n = walks as f64;
    (sum / n, ((square / n - (sum / n) * (sum / n)) / n).sqrt())
}

#[test]
fn deep_media_are_as_a_plain_random_walk_says() {
    for (k, albedo, g) in [(1.0, 0.5, 0.0), (5.0, 0.95, 0.0), (10.0, 0.9, 0.8), (20.0, 0.99, 0.0)] {
        let (expected, own) = walk(k, albedo, g, 40_000);
        let (s, a) = (k * albedo, k * (1.0 - albedo));
        // Glass that bends nothing is a volume, too.
        for (how, thing) in
            [("both", "volume("), ("surfaces", "volume("), ("both", "glass(ior = 1, ")]
        {
            let text = format!(
                "{}{LINE}background(1)\nsphere(center = (0, 0, 0), radius = 1, material = {thing}scattering = {s}, absorption = {a}, anisotropy = {g}))",
                paths(8, 200, &format!(", bounces = 10000, light_sampling = \"{how}\""))
            );
            let (got, error) = mean(&text);
            assert!(error[0] < 0.03 * expected, "{k}: {error:?}");
            let limit = 4.0 * (error[0] * error[0] + own * own).sqrt();
            assert_near(got, [expected; 3], limit);
        }
    }
}

/// The same fog, once between all things and once as the inside of a box, whose faces are those of the room, too; with
/// lamps of each kind.
#[test]
fn fog_is_the_same_with_and_without_borders() {
    for lamp in [
        "light(position = (0.3, 0.8, 0))",
        "light(position = (0.3, 0.8, 0), radius = 0.1)",
        "sphere(center = (0.3, 0.5, 0), radius = 0.2, material = glow(3))",
        "area_light(corner = (-0.3, 0.9, -0.3), edge_u = (0.6, 0, 0), edge_v = (0, 0, 0.6))",
    ] {
        let room = format!(
            "{}camera(eye = (0.1, 0.2, 0.9), look_at = (0, -0.3, -1), fov = 70)\n{lamp}\n\
             box(min = (-1, -1, -1), max = (1, 1, 1), material = matte((0.7, 0.4, 0.2)))\n\
             sphere(center = (-0.4, -0.6, -0.2), radius = 0.4, material = mirror(0.9))\n",
            paths(16, 128, "")
        );
        let inside = "scattering = (0.4, 0.8, 1.2), absorption = (0.1, 0, 0.2), anisotropy = 0.3";
        let [(plain, e), (boxed, f), (split, h)] = [
            format!("medium({inside})"),
            format!("box(min = (-1, -1, -1), max = (1, 1, 1), material = volume({inside}))"),
            // Two halves, and things lie on their common face.
            format!(
                "box(min = (-1, -1, -1), max = (0, 1, 1), material = volume({inside}))\n\
                 box(min = (0, -1, -1), max = (1, 1, 1), material = volume({inside}))"
            ),
        ]
        .map(|fog| mean(&format!("{room}{fog}")));
        for lane in 0..3 {
            let limit = |a: f64, b: f64| 4.0 * (a * a + b * b).sqrt();
            assert!(e[lane] < 0.2 * plain[lane], "{lamp}: {e:?}");
            assert!(
                (plain[lane] - boxed[lane]).abs() < limit(e[lane], f[lane]),
                "{lamp}: {plain:?} {boxed:?}"
            );
            assert!(
                (plain[lane] - split[lane]).abs() < limit(e[lane], h[lane]),
                "{lamp}: {plain:?} {split:?}"
            );
        }
    }
}

/// `why` tells which light was turned in the fog, and its sums are the pixel's.
#[test]
fn why_adds_up_and_tells_volumes_from_surfaces() {
    let text = format!(
        "{}camera(eye = (0, 0.5, 4), fov = 40)\nspot(position = (0, 3, 0), look_at = (0, 0, 0), angle = 30)\n\
         plane(point = (0, -1, 0), material = matte(0.7))\nmedium(scattering = 0.2)\n\
         sphere(center = (0, 0, 0), radius = 0.7, material = volume(scattering = 1))",
        paths(8, 64, "")
    );
    let scene = scene(&text);
    let found = pixel(&scene, 4, 4);
    let groups = found.paths.unwrap().groups;
    let classes: Vec<&str> = groups.iter().map(|g| &*g.class).collect();
    assert!(classes.contains(&"LVE") && classes.contains(&"LVVE"), "{classes:?}");
    let sum = groups.iter().map(|g| g.value[1]).sum::<f64>();
    assert!((sum - found.linear[1]).abs() < 1e-7 * sum, "{sum} {:?}", found.linear);
}
