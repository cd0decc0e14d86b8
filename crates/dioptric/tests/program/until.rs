// SPDX-License-Identifier: MIT OR Apache-2.0
//! Pictures until an error or for a time.

use super::run::{Folder, good, run};

const SCENE: &str = r#"
version(1)
render(size = (48, 32), integrator = "path")
camera(eye = (0, 1, 6), look_at = (0, 0.8, 0), fov = 40)
background("skyblue")
plane(point = (0, 0, 0), material = matte("wheat"))
sphere(center = (0, 0.8, 0), radius = 0.8, material = metal("gold", roughness = 0.2))
sphere(center = (0, 4, 1), radius = 0.5, material = glow("white", strength = 12))
"#;

fn place(name: &str) -> (Folder, String) {
    let folder = Folder::new(name);
    let scene = folder.file("scene.star");
    std::fs::write(&scene, SCENE).unwrap();
    (folder, scene)
}

#[test]
fn noise_falls_below_what_was_asked_for_and_bits_do_not_depend_on_threads() {
    let (folder, scene) = place("noise");
    let out = |name: &str| folder.file(name);
    let mut first = Vec::new();
    for threads in ["1", "2", "7"] {
        let ran =
            run(&["render", &scene, "--noise", "0.03", "--threads", threads, "-o", &out("a.png")]);
        assert_eq!(ran.status, 0, "{}", ran.stderr);
        assert!(ran.stderr.contains("0.03 is reached with up to "), "{}", ran.stderr);
        let bytes = folder.bytes("a.png");
        assert!(first.is_empty() || first == bytes, "{threads} threads");
        first = bytes;
    }
    good(&["render", &scene, "--samples", "2048", "-o", &out("reference.png")]);
    let compared = run(&["compare", &out("a.png"), &out("reference.png"), "--json"]);
    let numbers: serde_json::Value = serde_json::from_str(&compared.text()).unwrap();
    // Rounding to 8 bits is 0.0011.
    let error = numbers["rmse"].as_f64().unwrap();
    assert!((0.002..0.033).contains(&error), "{error}");
    let ran = run(&[
        "render",
        &scene,
        "--noise",
        "0.0001",
        "--max-samples",
        "32",
        "-o",
        &out("b.png"),
        "-q",
    ]);
    assert!(ran.stderr.contains("0.0001 is not reached with up to 32 samples"), "{}", ran.stderr);
}

#[test]
fn what_a_budget_reached_is_made_again_by_its_samples() {
    let (folder, scene) = place("budget");
    let (a, b) = (folder.file("a.png"), folder.file("b.png"));
    let ran = run(&["render", &scene, "--budget", "0.5s", "-o", &a]);
    let said = ran.stderr.split("again with --samples ").nth(1).expect("it says how many");
    let samples = said.split_whitespace().next().unwrap();
    good(&["render", &scene, "--samples", samples, "-o", &b]);
    assert!(folder.bytes("a.png") == folder.bytes("b.png"), "{samples}");
}

#[test]
fn what_makes_no_sense_is_explained() {
    let (folder, scene) = place("wrong");
    let out = folder.file("a.png");
    for (args, says) in [
        (&["--noise", "0"][..], "write a number above 0"),
        (&["--noise", "0.1", "--samples", "8"], "cannot be used with"),
        (&["--noise", "0.1", "--checkpoint", "a.part"], "compares the last pass with all before"),
        (&["--budget", "1s", "--checkpoint", "a.part"], "ends by the clock"),
        (&["--budget", "1d"], "write a time such as"),
        (&["--budget", "1s", "--antialias", "grid"], "antialias \"grid\" cannot"),
    ] {
        let ran = run(&[&["render", &scene, "-o", &out], args].concat());
        assert_eq!(ran.status, 2, "{args:?}");
        assert!(ran.stderr.contains(says), "{args:?}: {}", ran.stderr);
    }
}
