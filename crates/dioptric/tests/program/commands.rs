// SPDX-License-Identifier: MIT OR Apache-2.0
//! Commands and options: statuses, messages, and what the smaller commands print.

use std::io::Write;
use std::process::Stdio;

use super::run::{Folder, finish, good, program, run, scene};

#[test]
fn wrong_usage_is_status_2_with_the_remedy() {
    for (args, said) in [
        (&["rendr", "a.star"][..], "a similar subcommand exists: 'render'"),
        (&["render", "a.star", "--sampels", "4"], "a similar argument exists: '--samples'"),
        (&["render", "a.star", "--size", "0x5"], "write WIDTHxHEIGHT in pixels"),
        (
            &["render", "a.star", "--size", "1000000000x1000000000"],
            "raise the limit with --max-pixels",
        ),
        (&["render", "a.star", "--antialias", "sobel"], "did you mean \"sobol\"?"),
        (&["render", "a.star", "--integrator", "paths"], "--integrator: expected one of"),
        (&["render", "a.star", "--samples", "0"], "--samples: expected a whole number from 1"),
        (&["render", "a.star", "--threads", "0"], "0 is not in 1.."),
        (&["render", "a.star", "--set", "fog"], "write NAME=VALUE"),
        (&["render", "a.star", "-o", "a.gif"], "unknown picture format \"gif\""),
        (&["render", "a.star", "-o", "picture"], "has no extension"),
        (&["render", "a.star", "--sample-map", "m.gif"], "unknown picture format \"gif\""),
        (&["render", "a.star", "-o", "a.png", "--layers"], "only .exr files have layers"),
        (&["render", "a.star", "-o", "a.exr", "--grid"], "drawn over a developed picture"),
        (&["compare", "a.png", "b.png", "--tolerance=-1"], "a number of at least 0"),
        (&["convert", "scenes/space.star", "space.obj"], "end the name with .json"),
        (&["list", "spheer"], "did you mean \"sphere\"?"),
        (&["list", "shapes", "checker"], "unknown shape \"checker\""),
        (&["list", "shaeps"], "did you mean \"shape\"?"),
    ] {
        let ran = run(args);
        assert_eq!(ran.status, 2, "{args:?}: {}", ran.stderr);
        assert!(ran.stderr.contains(said), "{args:?}: {}", ran.stderr);
        assert!(ran.stdout.is_empty(), "{args:?}");
    }
}

#[test]
fn files_at_fault_are_status_1_with_the_remedy() {
    let folder = Folder::new("faults");
    std::fs::write(folder.file("bad.png"), b"no picture").unwrap();
    for (args, said) in [
        (&["render", "scenes/spac.star"][..], "did you mean scenes/space.star?"),
        (&["render", "nowhere/space.star"], "no such file or folder"),
        (&["render", "scenes"], "it is a folder"),
        (&["render", "Cargo.toml"], "is in no known scene format"),
        (&["compare", "missing.png", "missing.png"], "cannot read missing.png"),
        (&["compare", &folder.file("bad.png"), &folder.file("bad.png")], "bad.png: "),
        (&["render", "scenes/space.star", "--set", "smoth=1"], "did you mean \"smooth\"?"),
        (&["render", "scenes/space.star", "--max-steps", "3"], "--max-steps"),
    ] {
        let ran = run(args);
        assert_eq!(ran.status, 1, "{args:?}: {}", ran.stderr);
        assert!(ran.stderr.contains(said), "{args:?}: {}", ran.stderr);
    }
}

#[test]
fn help_and_version_are_answers() {
    assert!(good(&["--help"]).contains("Exit status: 0 done; 1 a scene or file is at fault"));
    assert!(good(&["render", "--help"]).contains("--antialias"));
    assert_eq!(good(&["--version"]), format!("dioptric {}\n", dioptric::VERSION));
    assert!(good(&["completions", "bash"]).contains("dioptric"));
    assert!(good(&["man", "render"]).contains(".TH"));
    assert_eq!(run(&["man", "rendr"]).status, 2);
}

#[test]
fn lists_name_every_kind_and_pages_every_parameter() {
    let list = good(&["list"]);
    for schema in dioptric::render::vocabulary().iter() {
        assert!(list.contains(&format!("\n  {} ", schema.kind)), "{}", schema.kind);
        let page = good(&["list", schema.category.name(), schema.kind]);
        for param in schema.all_params() {
            assert!(page.contains(&format!("\n  {} ", param.name)), "{page}");
        }
    }
}

#[test]
fn info_counts_and_shows_params() {
    let text = good(&["info", "scenes/space.star", "--set", "smooth=false"]);
    assert!(text.contains("\n  smooth = False (default True): "), "{text}");
    assert!(text.contains("3 cone, 1 cylinder"), "{text}");
    assert!(text.contains(" 800x800  none anti-aliasing, 1 sample a pixel"), "{text}");
    assert!(text.contains("  scenes/space.star ("), "{text}");
}

#[test]
fn the_expanded_form_renders_to_the_same_picture() {
    let folder = Folder::new("convert");
    let shapes = scene("shapes.star");
    good(&["convert", &shapes, &folder.file("shapes.json")]);
    good(&["render", &shapes, "-o", &folder.file("a.png")]);
    good(&["render", &folder.file("shapes.json"), "-o", &folder.file("b.png")]);
    assert!(folder.bytes("a.png") == folder.bytes("b.png"));
    // The same through the standard streams.
    let json = good(&["convert", &shapes, "-"]);
    assert_eq!(json.as_bytes(), folder.bytes("shapes.json"));
    let mut child = program(&["render", "-", "-o", "-", "-q"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    child.stdin.take().unwrap().write_all(json.as_bytes()).unwrap();
    let ran = finish(child.wait_with_output().unwrap());
    assert_eq!((ran.status, ran.stderr.as_str()), (0, ""));
    assert!(ran.stdout == folder.bytes("a.png"));
}

#[test]
fn errors_on_standard_input_say_so() {
    let mut child =
        program(&["render", "-"]).stdin(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    child.stdin.take().unwrap().write_all(b"camera()\nspheer()\n").unwrap();
    let ran = finish(child.wait_with_output().unwrap());
    assert_eq!(ran.status, 1);
    assert!(ran.stderr.contains("--> <stdin>:2:1"), "{}", ran.stderr);
}

#[test]
fn comparing_says_how_far_apart_and_where() {
    let folder = Folder::new("compare");
    let [a, b, figure] = ["a.png", "b.png", "figure.png"].map(|name| folder.file(name));
    let spin = scene("spin.star");
    good(&["render", &spin, "-o", &a]);
    good(&["render", &spin, "-o", &b, "--exposure", "1.1"]);
    assert_eq!(good(&["compare", &a, &a]), "identical\n");
    let ran = run(&["compare", &a, &b, "-o", &figure]);
    assert_eq!((ran.status, ran.stderr.as_str()), (1, ""));
    assert!(ran.text().starts_with("RMSE 0."), "{}", ran.text());
    assert!(folder.picture("figure.png").width() > 3 * 32);
    good(&["compare", &a, &b, "--tolerance", "60/255"]);
    good(&["compare", &a, &b, "--share", "1"]);
    let json = run(&["compare", &a, &b, "--json"]);
    let numbers: serde_json::Value = serde_json::from_slice(&json.stdout).unwrap();
    assert_eq!((json.status, &numbers["same"]), (1, &false.into()));
    let other = folder.file("other.png");
    good(&["render", &spin, "-o", &other, "--size", "16x12"]);
    let ran = run(&["compare", &a, &other]);
    assert_eq!(ran.status, 1);
    assert!(ran.stderr.contains("32 x 24"), "{}", ran.stderr);
}

#[test]
fn colour_is_for_terminals_unless_asked_for() {
    let args = ["render", "nowhere.star"];
    assert!(!run(&args).stderr.contains('\x1b'));
    assert!(run(&["render", "nowhere.star", "--color", "always"]).stderr.contains('\x1b'));
    assert!(!run(&["render", "nowhere.star", "--color", "never"]).stderr.contains('\x1b'));
}
