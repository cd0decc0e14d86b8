// SPDX-License-Identifier: MIT OR Apache-2.0
//! The examples of the manual's chapters on scene files are read as they stand there.

use dioptric_formats::{ReadOptions, json, read, report};
use dioptric_scene::{MemoryLoader, Severity};

/// The fenced blocks of a chapter in one language.
fn blocks(chapter: &str, language: &str) -> Vec<String> {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/manual/src");
    let text = std::fs::read_to_string(path.join(chapter)).unwrap();
    let mut found = Vec::new();
    let mut inside: Option<String> = None;
    for line in text.lines() {
        match &mut inside {
            Some(block) if line.starts_with("```") => {
                found.push(std::mem::take(block));
                inside = None;
            }
            Some(block) => {
                block.push_str(line);
                block.push('\n');
            }
            None if line == format!("```{language}") => inside = Some(String::new()),
            None => {}
        }
    }
    found
}

#[test]
fn the_examples_of_the_language_are_read() {
    let mut loader = MemoryLoader::new();
    let mut scenes = Vec::new();
    let chapters = [
        "first-scene.md",
        "language.md",
        "patterns.md",
        "meshes.md",
        "materials.md",
        "lights.md",
        "cameras.md",
        "antialiasing.md",
    ];
    let all = chapters.into_iter().flat_map(|chapter| blocks(chapter, "python"));
    for (i, block) in all.enumerate() {
        let first = block.lines().next().unwrap_or_default().to_string();
        if let Some(name) = first.strip_prefix("# file: ") {
            loader = loader.with(name, block);
            continue;
        }
        // What a chapter leaves out because it is about something else.
        let mut stage = String::new();
        if !["camera(", "orthographic(", "fisheye(", "panorama("].iter().any(|c| block.contains(c))
        {
            stage.push_str("camera()\n");
        }
        if !["light(", "spot(", "directional("].iter().any(|l| block.contains(l)) {
            stage.push_str("light((5, 8, 5))\n");
        }
        let name = format!("example-{}.star", i + 1);
        // load() has to come first.
        let (loads, rest): (Vec<&str>, Vec<&str>) =
            block.lines().partition(|line| line.starts_with("load("));
        loader = loader.with(&name, format!("{}\n{stage}{}\n", loads.join("\n"), rest.join("\n")));
        scenes.push(name);
    }
    assert!(scenes.len() >= 12);
    for name in scenes {
        match read(&name, &loader, &dioptric_render::vocabulary(), &ReadOptions::default()) {
            Ok(reading) => assert!(reading.warnings.is_empty(), "{name}: {:?}", reading.warnings),
            Err(error) => panic!("{}", report::render(&error.diagnostics, &error.sources, false)),
        }
    }
}

#[test]
fn the_example_of_the_expanded_form_is_what_is_written() {
    for block in blocks("json.md", "json") {
        let loader = MemoryLoader::new().with("scene.json", block.as_str());
        let vocabulary = dioptric_render::vocabulary();
        let reading = read("scene.json", &loader, &vocabulary, &ReadOptions::default()).unwrap();
        assert!(reading.warnings.iter().all(|d| d.severity == Severity::Warning));
        assert_eq!(json::write(&reading.description), block);
    }
}

#[test]
fn no_kind_hides_a_function_of_the_language() {
    let vocabulary = dioptric_render::vocabulary();
    let functions = dioptric_formats::functions();
    assert!(functions.iter().any(|name| name == "sin"));
    for name in functions {
        assert!(vocabulary.get(&name).is_none(), "{name} is a function and a kind");
    }
}
