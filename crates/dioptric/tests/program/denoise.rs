// SPDX-License-Identifier: MIT OR Apache-2.0
//! `--denoise` through the real program, as far as it needs nothing that may not be installed.

use super::run::{Folder, finish, good, program, run};

const SCENE: &str = r#"
version(1)
render(size = (96, 64), samples = 2, integrator = "path")
camera(eye = (0, 1, 6), look_at = (0, 0.8, 0), fov = 40)
background("gray")
plane(point = (0, 0, 0), material = matte("wheat"))
sphere(center = (0, 0.8, 0), radius = 0.8, material = matte("tomato"))
sphere(center = (2, 3, 2), radius = 0.5, material = glow("white", strength = 12))
"#;

#[test]
fn the_plain_filter_takes_noise_out_and_says_so() {
    let folder = Folder::new("denoise");
    let (scene, out) = (folder.file("scene.star"), |name: &str| folder.file(name));
    std::fs::write(&scene, SCENE).unwrap();
    good(&["render", &scene, "--samples", "1024", "-o", &out("exact.png")]);
    good(&["render", &scene, "-o", &out("noisy.png")]);
    let error = |name: &str| {
        let ran = run(&["compare", &out(name), &out("exact.png"), "--json"]);
        let numbers: serde_json::Value = serde_json::from_str(&ran.text()).unwrap();
        numbers["rmse"].as_f64().unwrap()
    };
    let mut first = Vec::new();
    for threads in ["1", "2", "7"] {
        good(&["render", &scene, "--denoise=plain", "--threads", threads, "-o", &out("plain.png")]);
        let bytes = folder.bytes("plain.png");
        assert!(first.is_empty() || first == bytes, "{threads} threads");
        first = bytes;
    }
    assert!(first.windows(8).any(|w| w == b"Denoised"));
    let (noisy, plain) = (error("noisy.png"), error("plain.png"));
    assert!(plain < 0.75 * noisy, "{noisy} {plain}");
    // Parts keep what it needs.
    good(&[
        "render",
        &scene,
        "--denoise=plain",
        "--sample-range",
        "1-2",
        "--checkpoint",
        &out("a.part"),
    ]);
    good(&["merge", &out("a.part"), "--denoise=plain", "-o", &out("merged.png"), "-q"]);
    assert!(folder.bytes("merged.png") == first);
}

#[test]
fn a_missing_library_is_explained_before_the_work() {
    let folder = Folder::new("no-oidn");
    let (scene, out) = (folder.file("scene.star"), folder.file("a.png"));
    std::fs::write(&scene, SCENE).unwrap();
    let none = folder.file("none.so");
    for by in ["--denoise=oidn", "--denoise"] {
        let ran = run(&["render", &scene, by, "--oidn", &none, "-o", &out]);
        assert_eq!(ran.status, 1);
        assert!(ran.stderr.contains("cannot load Open Image Denoise: "), "{}", ran.stderr);
        assert!(
            ran.stderr.contains("pip install pyoidn") && ran.stderr.contains("--denoise=plain")
        );
    }
    let mut command = program(&["render", &scene, "--denoise=oidn", "-o", &out]);
    let ran = finish(command.env("DIOPTRIC_OIDN", &none).output().unwrap());
    assert!(ran.status == 1 && ran.stderr.contains("none.so"), "{}", ran.stderr);
    assert_eq!(run(&["render", &scene, "--denoise=best", "-o", &out]).status, 2);
    assert_eq!(folder.names(), ["scene.star"]);
}
