// SPDX-License-Identifier: MIT OR Apache-2.0
//! Pictures and the other files that `render` writes.

use dioptric::image::{LayerData, decode_exr};

use super::run::{Folder, finish, good, program, run, scene};

#[test]
fn the_picture_is_named_after_the_scene_and_lands_here() {
    let folder = Folder::new("default");
    let here = folder.file("");
    let ran =
        finish(program(&["render", &scene("spin.star")]).current_dir(&here).output().unwrap());
    assert_eq!(ran.status, 0, "{}", ran.stderr);
    assert_eq!(folder.names(), ["spin.png"]);
    assert!(ran.stdout.is_empty());
    assert_eq!(ran.stderr.lines().count(), 1, "{}", ran.stderr);
    assert!(
        ran.stderr.starts_with("spin.png: 32 x 24, ") && ran.stderr.contains(" rays/s"),
        "{}",
        ran.stderr
    );
}

#[test]
fn a_file_that_cannot_be_written_is_found_before_the_work() {
    let folder = Folder::new("unwritable");
    let endless =
        ["render", &scene("materials.star"), "--samples", "60000", "--antialias", "sobol"];
    let missing = folder.file("nowhere/out.png");
    let here = folder.file("");
    for (option, path, said) in [
        ("-o", missing.as_str(), "make the folder first, or name another with -o"),
        ("-o", "Cargo.toml/out.png", "its folder is a file"),
        ("--stats", missing.as_str(), "no such file or folder"),
        ("--sample-map", missing.as_str(), "no such file or folder"),
    ] {
        let ran = finish(
            program(&[&endless[..], &[option, path]].concat()).env("PWD", &here).output().unwrap(),
        );
        assert_eq!(ran.status, 1, "{option} {path}: {}", ran.stderr);
        assert!(ran.stderr.contains(said), "{option} {path}: {}", ran.stderr);
    }
    std::fs::create_dir(folder.file("folder.png")).unwrap();
    let ran = run(&[&endless[..], &["-o", &folder.file("folder.png")]].concat());
    assert!(ran.status == 1 && ran.stderr.contains("it is a folder"), "{}", ran.stderr);
    assert_eq!(folder.names(), ["folder.png"], "nothing else was left behind");
}

#[test]
fn a_failed_scene_leaves_the_older_picture() {
    let folder = Folder::new("older");
    let out = folder.file("out.png");
    std::fs::write(&out, b"older").unwrap();
    assert_eq!(run(&["render", "tests/errors/no-camera.star", "-o", &out]).status, 1);
    assert_eq!(folder.bytes("out.png"), b"older");
    good(&["render", &scene("spin.star"), "-o", &out]);
    assert_eq!(folder.picture("out.png").width(), 32);
    assert_eq!(folder.names(), ["out.png"]);
}

#[test]
fn metadata_holds_settings_and_version_never_threads_time_or_host() {
    let folder = Folder::new("metadata");
    let out = folder.file("a.exr");
    good(&["render", "scenes/space.star", "--size", "16x16", "-o", &out, "--set", "smooth=False"]);
    let metadata = decode_exr(&folder.bytes("a.exr"), 1 << 20).unwrap().metadata;
    assert_eq!(metadata.get("Software"), Some(&*format!("dioptric {}", dioptric::VERSION)));
    let settings: serde_json::Value =
        serde_json::from_str(metadata.get("Settings").unwrap()).unwrap();
    assert_eq!(settings["size"], serde_json::json!([16, 16]));
    assert_eq!(settings["antialias"], "none");
    assert_eq!(settings["exposure"], 0.8);
    assert!(settings.get("threads").is_none());
    assert_eq!(metadata.get("Params"), Some("smooth = False"));
    assert_eq!(metadata.get("Unfinished"), None);
}

#[test]
fn layers_go_into_one_exr_file() {
    let folder = Folder::new("layers");
    good(&["render", &scene("materials.star"), "-o", &folder.file("a.exr"), "--layers"]);
    let layers = decode_exr(&folder.bytes("a.exr"), 1 << 20).unwrap();
    for name in ["depth", "normal", "albedo", "object", "samples"] {
        assert_eq!(layers.get(name).map(LayerData::len), Some(64 * 48), "{name}");
    }
    let Some(LayerData::Id(samples)) = layers.get("samples") else { panic!("samples are counts") };
    assert_eq!(samples.iter().min(), Some(&4));
    assert_eq!(samples.iter().max(), Some(&12));
}

#[test]
fn formats_follow_the_name() {
    let folder = Folder::new("formats");
    let spin = scene("spin.star");
    for (name, magic) in [
        ("a.png", &b"\x89PNG"[..]),
        ("a.jpg", b"\xff\xd8\xff"),
        ("a.exr", b"\x76\x2f\x31\x01"),
        ("a.hdr", b"#?RADIANCE"),
    ] {
        good(&["render", &spin, "-o", &folder.file(name)]);
        assert!(folder.bytes(name).starts_with(magic), "{name}");
    }
    good(&["render", &spin, "-o", &folder.file("deep.png"), "--bits", "16"]);
    assert_eq!(folder.bytes("deep.png")[24], 16);
    let ran = run(&["render", &spin, "-o", "-", "--to", "exr", "-q"]);
    assert!(ran.stdout == folder.bytes("a.exr"));
    // An EXR file, developed later, is the PNG file.
    good(&["convert", &folder.file("a.exr"), &folder.file("later.png")]);
    assert_eq!(folder.picture("later.png"), folder.picture("a.png"));
}

#[test]
fn the_grid_is_drawn_over_the_picture() {
    let folder = Folder::new("grid");
    let spin = scene("spin.star");
    good(&["render", &spin, "-o", &folder.file("a.png"), "--size", "96x72"]);
    good(&["render", &spin, "-o", &folder.file("b.png"), "--size", "96x72", "--grid"]);
    assert_ne!(folder.picture("a.png"), folder.picture("b.png"));
}

#[test]
fn stats_count_what_was_done() {
    let folder = Folder::new("stats");
    let (out, stats, map) = (folder.file("a.png"), folder.file("s.json"), folder.file("m.png"));
    good(&[
        "render",
        "scenes/space.star",
        "--size",
        "20x10",
        "-o",
        &out,
        "--stats",
        &stats,
        "--sample-map",
        &map,
        "--threads",
        "2",
    ]);
    let stats: serde_json::Value = serde_json::from_slice(&folder.bytes("s.json")).unwrap();
    assert_eq!(stats["rays"]["camera"], 20 * 10 * 4);
    assert_eq!(stats["samples"], 20 * 10 * 4);
    let kinds = ["camera", "shadow", "reflect", "refract", "inside"];
    let total: u64 = kinds.iter().map(|k| stats["rays"][k].as_u64().unwrap()).sum();
    assert_eq!(stats["rays"]["total"], total);
    assert_eq!(stats["threads"], 2);
    assert_eq!(stats["finished"], true);
    assert_eq!(stats["version"], dioptric::VERSION);
    for phase in ["read", "compile", "render"] {
        assert!(stats["seconds"][phase].as_f64().unwrap() >= 0.0);
    }
    assert_eq!(folder.picture("m.png").width(), 20);
}
