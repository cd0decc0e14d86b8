// SPDX-License-Identifier: MIT OR Apache-2.0
//! Invariant 4: the sums of `why`, done again from its JSON alone, are the picture.
//!
//! What is below knows nothing of the renderer: it reads lines of JSON, adds and multiplies, and
//! compares with the pixels of the files that `render` wrote.

use serde_json::Value;

use super::run::{Folder, good, run, scene};

fn rgb(value: &Value) -> [f64; 3] {
    [0, 1, 2].map(|i| value[i].as_f64().unwrap_or_else(|| panic!("no number in {value}")))
}

fn items(value: &Value) -> &[Value] {
    value.as_array().unwrap_or_else(|| panic!("no list: {value}"))
}

fn near(a: [f64; 3], b: [f64; 3], tolerance: f64) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() <= tolerance * b.abs().max(1.0))
}

/// A ray's value from its terms and children alone; what each ray says of itself must agree.
fn sum(ray: &Value, rays: &mut u64) -> [f64; 3] {
    *rays += 1;
    let mut total = [0.0; 3];
    for term in items(&ray["terms"]) {
        let value = rgb(&term["value"]);
        total = [0, 1, 2].map(|i| total[i] + value[i]);
    }
    for child in items(&ray["children"]) {
        let (weight, value) = (rgb(&child["weight"]), sum(&child["ray"], rays));
        total = [0, 1, 2].map(|i| total[i] + weight[i] * value[i]);
    }
    assert!(near(total, rgb(&ray["value"]), 1e-9), "{total:?} is not the value of {ray}");
    total
}

/// The sum over the samples, and how many rays there were.
fn pixel_sum(pixel: &Value) -> ([f64; 3], u64) {
    let (mut total, mut weights, mut rays) = ([0.0; 3], 0.0, 0);
    for sample in items(&pixel["samples"]) {
        let weight = sample["weight"].as_f64().unwrap();
        weights += weight;
        if !sample["ray"].is_null() {
            let value = sum(&sample["ray"], &mut rays);
            total = [0, 1, 2].map(|i| total[i] + weight * value[i]);
        }
    }
    assert!((weights - 1.0).abs() < 1e-9, "weights add up to {weights}");
    (total, rays)
}

/// Checks every pixel of a scene and returns how many rays were added up.
fn check(scene: &str, options: &[&str]) -> u64 {
    let folder = Folder::new("why");
    for name in ["a.exr", "a.png"] {
        good(&[&["render", scene, "-o", &folder.file(name)][..], options].concat());
    }
    let (light, shown) = (folder.picture("a.exr"), folder.picture("a.png"));
    let (width, height) = (light.width(), light.height());
    let all = format!("0,0,{width},{height}");
    let text = good(&[&["why", scene, &all, "--json"][..], options].concat());
    let mut rays = 0;
    let mut lines = text.lines();
    for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
        let pixel: Value = serde_json::from_str(lines.next().expect("a line a pixel")).unwrap();
        let place = format!("{scene} {options:?}, pixel {x},{y}");
        assert_eq!(pixel["schema"], 1, "{place}");
        assert_eq!(pixel["pixel"], serde_json::json!([x, y]), "{place}");
        let (total, count) = pixel_sum(&pixel);
        rays += count;
        let linear = rgb(&pixel["linear"]);
        assert!(near(total, linear, 1e-6), "{place}: the sum is {total:?}, linear {linear:?}");
        let [r, g, b, _] = light.get(x, y).unwrap().map(f64::from);
        assert_eq!(linear, [r, g, b], "{place}: the EXR file");
        let last = items(&pixel["develop"]).last().map(|step| rgb(&step["value"])).unwrap();
        let rgb8 = last.map(|v| (255.0 * v.clamp(0.0, 1.0) + 0.5).floor());
        assert_eq!(rgb8, rgb(&pixel["rgb8"]), "{place}");
        let [r, g, b, _] = shown.get(x, y).unwrap().map(|v| (f64::from(v) * 255.0).round());
        assert_eq!(rgb8, [r, g, b], "{place}: the PNG file");
    }
    assert_eq!(lines.next(), None);
    rays
}

#[test]
fn every_pixel_of_the_reports_picture_adds_up() {
    let rays = check("scenes/space.star", &["--size", "80x80"]);
    assert!(rays > 80 * 80 * 4, "{rays}");
}

#[test]
fn the_steps_of_the_reports_picture_are_its_exposure_and_nothing_else() {
    let text = good(&["why", "scenes/space.star", "30,52", "--size", "80x80", "--json"]);
    let pixel: Value = serde_json::from_str(&text).unwrap();
    let exposed = rgb(&pixel["linear"]).map(|v| v * 0.8);
    for step in items(&pixel["develop"]) {
        let expected =
            if step["step"] == "exposure" { exposed } else { exposed.map(|v| v.min(1.0)) };
        assert!(near(rgb(&step["value"]), expected, 1e-12), "{step}");
    }
}

#[test]
fn all_materials_add_up() {
    check(&scene("materials.star"), &[]);
}

#[test]
fn all_lights_add_up() {
    check(&scene("lights.star"), &[]);
}

#[test]
fn all_shapes_add_up() {
    check(&scene("shapes.star"), &[]);
}

#[test]
fn all_ways_of_sampling_add_up() {
    let materials = scene("materials.star");
    for (mode, filter) in [
        ("none", "box"),
        ("grid", "tent"),
        ("report", "mitchell"),
        ("jitter", "blackman_harris"),
        ("sobol", "gaussian"),
    ] {
        let samples = if mode == "jitter" { "9" } else { "4" };
        let options =
            ["--size", "16x12", "--antialias", mode, "--filter", filter, "--samples", samples];
        check(&materials, &options);
    }
}

#[test]
fn paths_add_up() {
    let options =
        ["--size", "16x12", "--integrator", "path", "--antialias", "sobol", "--samples", "4"];
    for scene in [scene("materials.star"), scene("lights.star"), scene("shapes.star")] {
        check(&scene, &options);
    }
}

#[test]
fn all_views_add_up() {
    let materials = scene("materials.star");
    for view in ["eyelight", "normals", "depth", "uv", "object", "material", "cost", "rays"] {
        check(&materials, &["--size", "16x12", "--integrator", view]);
    }
}

#[test]
fn the_text_tells_what_the_json_tells() {
    let folder = Folder::new("why-text");
    let place = ["why", "scenes/space.star", "30,40", "--size", "80x80"];
    let text = good(&place);
    for part in [
        "hits mirror ball (scenes/space.star:",
        "+ ambient",
        "+ 0.7 x reflected ray",
        "= linear light",
        "8-bit value #",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    assert!(!text.contains('\x1b'), "{text}");
    let folded = good(&[&place[..], &["--depth", "0"]].concat());
    assert!(folded.lines().count() < text.lines().count() && folded.contains("folded"), "{folded}");
    let colored = good(&[&place[..], &["--color", "always"]].concat());
    assert!(colored.contains("\x1b[48;2;"), "{colored}");
    let file = folder.file("why.txt");
    assert_eq!(good(&[&place[..], &["-o", &file]].concat()), "");
    assert_eq!(String::from_utf8(folder.bytes("why.txt")).unwrap(), text);
}

#[test]
fn a_command_line_of_render_becomes_one_of_why() {
    let plain = good(&["why", "scenes/space.star", "30,40", "--size", "80x80"]);
    let options = [
        "--size",
        "80x80",
        "--grid",
        "--layers",
        "--bits",
        "16",
        "--quality",
        "50",
        "-q",
        "--to",
        "exr",
        "--stats",
        "nowhere/stats.json",
        "--sample-map",
        "nowhere/map.png",
        "--crop",
        "0,0,5,5",
        "--threads",
        "3",
        "--frames",
        "0-9",
    ];
    let same = good(&[&["why", "scenes/space.star", "30,40"][..], &options].concat());
    assert_eq!(same, plain);
}

#[test]
fn places_outside_of_the_picture_are_wrong_usage() {
    for (place, said) in [
        ("800,0", "the pixel 800,0 is not inside the picture of 800 x 800 pixels"),
        ("0,0,801,1", "the part 0,0,801,1 is not inside"),
        ("-1,5", "write X,Y or X,Y,WIDTH,HEIGHT"),
        ("5", "write X,Y or X,Y,WIDTH,HEIGHT"),
    ] {
        let ran = run(&["why", "scenes/space.star", place]);
        assert_eq!(ran.status, 2, "{place}: {}", ran.stderr);
        assert!(ran.stderr.contains(said), "{place}: {}", ran.stderr);
    }
}
