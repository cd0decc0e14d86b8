// SPDX-License-Identifier: MIT OR Apache-2.0
//! What `why` tells: everything that a reader needs, without changing what it tells about.

use dioptric::render::integrator::recorder::{Silent, TreeRecorder};
use dioptric::render::picture::shoot;
use dioptric::render::sampling::pixel_sample;
use dioptric::render::stats::RayCounts;
use serde_json::Value;

use crate::support::{assert_near, assert_sums, one_ray, pixel, scene};

const EVERYTHING: &str = r#"
version(1)
scene(colors = "raw")
render(size = (24, 16), antialias = "jitter", samples = 2, bounces = 5, shadows = "tinted", min_contribution = 0.01)
camera(eye = (0, 2, 7), look_at = (0, 0.8, 0), fov = 40, aperture = 0.1, focus = 7)
ambient(0.2)
background((0.1, 0.2, 0.3))
fog(distance = 30, color = (0.7, 0.6, 0.5))
medium(ior = 1.05, absorption = 0.01)
light(position = (3, 6, 5), intensity = 0.6, name = "lamp")
area_light(corner = (-4, 5, 0), edge_u = (1, 0, 0), edge_v = (0, 0, 1), samples = 4, intensity = 0.5)
plane(point = (0, 0, 0), normal = (0, 1, 0), material = phong(checker(1, (0.2, 0.3, 0.4), size = 0.7), mirror = 0.3))
sphere(center = (-1.4, 1, 0), radius = 0.9, material = glass((0.9, 1, 0.9), absorption = (0.5, 0.1, 0.2), roughness = 0.2))
box(min = (0.2, 0.1, -0.4), max = (1.4, 1.3, 0.8), material = clear((0, 1, 0), own = 0.2, absorption = 0.3))
sphere(center = (0.8, 0.7, 0.2), radius = 0.3, material = plastic("crimson"))
sphere(center = (2, 0.6, 0.6), radius = 0.6, material = metal("gold", roughness = 0.1))
"#;

/// The recorder changes no bit and no number of rays, and every ray that is counted is told.
#[test]
fn a_recorder_changes_nothing_and_tells_every_ray() {
    let scene = scene(EVERYTHING);
    let mut rays = 0;
    for (x, y) in (0..16).flat_map(|y| (0..24).map(move |x| (x, y))) {
        for sample in 0..2 {
            let (place, stream) = pixel_sample(&scene.settings, [x, y], sample);
            let (mut quiet, mut told) = (RayCounts::default(), RayCounts::default());
            let mut recorder = TreeRecorder::default();
            let a = shoot(&scene, &place, stream, &mut quiet, &mut Silent);
            let b = shoot(&scene, &place, stream, &mut told, &mut recorder);
            assert_eq!(a, b, "{x},{y}");
            assert_eq!(quiet, told);
            let root = recorder.into_root().expect("a ray");
            assert_near(root.value, a.color.to_array(), 0.0);
            assert_eq!(assert_sums(&root), [told.camera, told.reflect, told.refract], "{x},{y}");
            rays += told.total();
        }
    }
    assert!(rays > 5_000, "{rays}");
}

/// Reading the JSON gives the same bits: every number of a pixel survives being written and read.
#[test]
fn numbers_survive_being_written() {
    let scene = scene(EVERYTHING);
    let mut numbers = 0;
    for (x, y) in [(3, 4), (12, 9), (8, 8), (15, 10), (20, 3)] {
        let pixel = pixel(&scene, x, y);
        let value = serde_json::to_value(&pixel).unwrap();
        let read: Value = serde_json::from_str(&serde_json::to_string(&pixel).unwrap()).unwrap();
        assert_eq!(value, read);
        count_numbers(&read, &mut numbers);
    }
    assert!(numbers > 1000, "{numbers}");
}

/// Counts, and finds what could not be written: infinite numbers and those that are none become null.
fn count_numbers(value: &Value, numbers: &mut u64) {
    match value {
        Value::Number(_) => *numbers += 1,
        Value::Array(items) => items.iter().for_each(|v| {
            assert!(!v.is_null(), "{items:?}");
            count_numbers(v, numbers);
        }),
        Value::Object(map) => map.iter().for_each(|(key, v)| {
            let may_be_null = ["object", "source", "t", "ray"].contains(&key.as_str());
            assert!(!v.is_null() || may_be_null, "{key}");
            count_numbers(v, numbers);
        }),
        _ => {}
    }
}

#[test]
fn fog_and_absorption_scale_what_they_weaken() {
    let text = "camera(eye = (0, 0, 3), look_at = (0, 0, 0), fov = 1)\nambient(1)\n\
                fog(distance = 4, color = (0, 0.5, 1))\nmedium(absorption = (0.25, 0.5, 0))\n\
                plane(point = (0, 0, 0), normal = (0, 0, 1), \
                material = phong((1, 1, 0.5), diffuse = 0, specular = 0, mirror = 0.5))\n\
                plane(point = (0, 0, 5), normal = (0, 0, -1), material = glow(1))";
    let node = one_ray(3, text);
    let through = |d: f64, seen: [f64; 3]| {
        let t = (-d / 4.0).exp();
        let water = [(-0.25 * d).exp(), (-0.5 * d).exp(), 1.0];
        [0, 1, 2].map(|i| seen[i] * water[i] * t + [0.0, 0.5, 1.0][i] * (1.0 - t))
    };
    let mirrored = through(5.0, [1.0; 3]);
    let own = [1.0, 1.0, 0.5];
    assert_near(node.value, through(3.0, [0, 1, 2].map(|i| own[i] + 0.5 * mirrored[i])), 1e-12);
    // The ambient term says by what it was multiplied, and so does the weight of the mirrored ray.
    let names = |list: &Value| -> Vec<String> {
        list.as_array().unwrap().iter().map(|s| s["by"].as_str().unwrap().to_string()).collect()
    };
    assert_eq!(names(&node.terms[0].detail["scaled_by"]), ["absorption", "fog"]);
    assert_eq!(
        names(&serde_json::to_value(&node.children[0].scaled_by).unwrap()),
        ["absorption", "fog"]
    );
    let mut rebuilt = own;
    for scaling in node.terms[0].detail["scaled_by"].as_array().unwrap() {
        rebuilt = [0, 1, 2].map(|i| rebuilt[i] * scaling["factor"][i].as_f64().unwrap());
    }
    assert_near(rebuilt, node.terms[0].value, 1e-15);
    assert_eq!(node.terms.last().unwrap().name, "fog");
}

/// The list of the issue: what a reader must find of each ray.
#[test]
fn a_ray_tells_all_about_itself() {
    let node = one_ray(
        1,
        "camera(eye = (0, 1, 5), look_at = (0, 1, 0), fov = 1)\nambient(0.1)\n\
         light(position = (0, 9, 5), name = \"lamp\")\n\
         ball = sphere(center = (0, 1, 0), radius = 1, name = \"ball\", \
         material = phong(stripes((1, 0, 0), (0, 1, 0), size = 0.5), mirror = 0.5))\n\
         box(min = (-1, 6, -1), max = (1, 7, 4), name = \"upper\")\n\
         box(min = (-1, 4, -1), max = (1, 5, 4), name = \"lower\")",
    );
    let json = serde_json::to_value(&node).unwrap();
    assert_eq!(json["kind"], "camera");
    assert_eq!(json["object"], "ball");
    assert_eq!(json["source"]["file"], "test.star");
    assert_eq!(json["source"]["line"], 10);
    for key in [
        "origin",
        "direction",
        "t",
        "point",
        "point_in_file",
        "point_in_object",
        "normal",
        "shading_normal",
    ] {
        assert!(!json[key].is_null(), "{key}: {json}");
    }
    assert_near(node.value, node.value, 0.0);
    assert_eq!(json["normal"], serde_json::json!([0.0, 0.0, 1.0]));
    assert_eq!(json["pattern"].as_array().unwrap().len(), 3);
    assert_eq!(json["uv"].as_array().unwrap().len(), 2);
    assert_eq!(
        (&json["from_outside"], &json["bounce"]),
        (&Value::Bool(true), &serde_json::json!(0))
    );
    let diffuse =
        json["terms"].as_array().unwrap().iter().find(|t| t["name"] == "diffuse").unwrap();
    assert_eq!((&diffuse["light"], &diffuse["light_source"]["line"]), (&"lamp".into(), &9.into()));
    let blockers = diffuse["blockers"].as_array().unwrap();
    let names: Vec<&str> = blockers.iter().map(|b| b["object"].as_str().unwrap()).collect();
    assert_eq!(names, ["lower", "upper"]);
    assert!(blockers[0]["t"].as_f64() < blockers[1]["t"].as_f64());
    assert_eq!(diffuse["value"], serde_json::json!([0.0, 0.0, 0.0]));
    assert!(
        diffuse["unshadowed"][0].as_f64().unwrap() + diffuse["unshadowed"][1].as_f64().unwrap()
            > 0.4
    );
    assert_eq!(json["children"][0]["ray"]["kind"], "reflected");
    assert_eq!(json["children"][0]["weight"], serde_json::json!([0.5, 0.5, 0.5]));
}

/// Of shapes in bulk it says which of the many things is hit.
#[test]
fn triangles_and_atoms_are_told_apart() {
    let scene = scene(
        "render(size = (3, 1), antialias = \"none\")\ncamera(eye = (0, 0, 9), fov = 10)\nlight(position = (5, 5, 5))\n\
         spheres(centers = [(-1.2, 5, 0), (-1.2, 0, 0)], radius = 0.5)\n\
         cylinders(ends = [((0, 3, 0), (0, 4, 0)), ((9, 0, 0), (9, 1, 0)), ((0, -1, 0), (0, 1, 0))], radius = 0.5)\n\
         mesh(points = [(1, -1, 0), (2, -1, 0), (2, 1, 0), (1, 1, 0)], faces = [[0, 1, 2, 3]])",
    );
    for (x, part) in [(0, "sphere 1"), (1, "cylinder 2"), (2, "triangle ")] {
        let json = serde_json::to_value(pixel(&scene, x, 0)).unwrap();
        let told = json["samples"][0]["ray"]["part"].as_str().unwrap_or_default();
        assert!(told.starts_with(part), "{told} is not {part}");
    }
}

/// Every key that the program writes stands on the manual's page, and the numbers of its example are the
/// program's.
#[test]
fn the_manual_names_every_key_and_tells_the_truth() {
    let path = crate::support::root().join("docs/manual/src/why-json.md");
    let page = std::fs::read_to_string(path).expect("the page is there");
    let clear = "version(1)\nrender(size = (2, 1), antialias = \"none\", bounces = 1)\n\
                 camera(eye = (0, 0, 5), look_at = (0, 0, 0), fov = 20)\nbackground(1)\n\
                 box(min = (-1, -1, -1), max = (0, 1, 1), material = clear(own = 0, ior = 0.5))\n\
                 box(min = (0.3, -2, -1), max = (2, 2, 1), material = clear(ior = 1.3), transform = rotate(y = 40))\n\
                 sphere(center = (-9, 0, 0), radius = 9, material = glow(0.1))";
    let mut keys = std::collections::BTreeSet::new();
    for text in [EVERYTHING, clear] {
        let scene = scene(text);
        let [width, height] = scene.settings.size;
        for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
            collect_keys(&serde_json::to_value(pixel(&scene, x, y)).unwrap(), &mut keys);
        }
    }
    assert!(keys.len() > 50, "{keys:?}");
    for key in &keys {
        let named = page.contains(&format!("`{key}`")) || page.contains(&format!("`{{{key}, "));
        assert!(named || page.contains(&format!(", {key}}}`")), "{key} is not documented");
    }
    let (_, example) = page.split_once("```python\n").expect("an example");
    let example = scene(example.split_once("```").expect("its end").0);
    let told = serde_json::to_value(pixel(&example, 1, 0)).unwrap();
    let mut numbers = std::collections::BTreeSet::new();
    collect_numbers(&told, &mut numbers);
    let (_, shown) = page.split_once("```text\n").expect("its answer");
    let shown = shown.split_once("```").expect("its end").0;
    let long = shown.split(|c: char| !(c.is_ascii_digit() || "-.e".contains(c)));
    let long: Vec<&str> = long
        .filter(|n| n.len() > 8 && n.starts_with(|c: char| c.is_ascii_digit() || c == '-'))
        .collect();
    assert!(long.len() > 30, "{long:?}");
    for number in long {
        assert!(numbers.contains(number), "the program does not say {number}: {numbers:?}");
    }
}

fn collect_keys(value: &Value, keys: &mut std::collections::BTreeSet<String>) {
    match value {
        Value::Array(items) => items.iter().for_each(|v| collect_keys(v, keys)),
        Value::Object(map) => map.iter().for_each(|(key, v)| {
            keys.insert(key.clone());
            collect_keys(v, keys);
        }),
        _ => {}
    }
}

fn collect_numbers(value: &Value, numbers: &mut std::collections::BTreeSet<String>) {
    match value {
        Value::Number(n) => drop(numbers.insert(n.to_string())),
        Value::Array(items) => items.iter().for_each(|v| collect_numbers(v, numbers)),
        Value::Object(map) => map.values().for_each(|v| collect_numbers(v, numbers)),
        _ => {}
    }
}
