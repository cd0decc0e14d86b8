// SPDX-License-Identifier: MIT OR Apache-2.0
//! Every wrong scene of `tests/errors` gives exactly the text beside it, and never a panic.
//!
//! A scene's first line may hold options of the program, `# options: --max-steps 1000`. With
//! `UPDATE_EXPECTED=1` in the environment the texts are written anew; read them before you commit.

use std::path::{Path, PathBuf};

use dioptric_formats::{ReadOptions, read, report};
use dioptric_scene::{Diagnostic, FolderLoader, Severity, Sources};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/errors")
}

/// The wrong scenes by name.
fn cases() -> Vec<String> {
    let entries = std::fs::read_dir(folder()).unwrap();
    let mut names: Vec<String> = entries
        .map(|entry| entry.unwrap())
        .filter(|entry| entry.file_type().unwrap().is_file())
        .map(|entry| entry.file_name().into_string().unwrap())
        .filter(|name| !name.ends_with(".txt"))
        .collect();
    names.sort();
    names
}

/// The options that a scene's first line asks for.
fn options(path: &Path) -> ReadOptions {
    let mut options = ReadOptions::default();
    let text = String::from_utf8_lossy(&std::fs::read(path).unwrap()).into_owned();
    let first = text.lines().next().unwrap_or_default();
    let mut words = first.strip_prefix("# options:").unwrap_or_default().split_whitespace();
    while let (Some(flag), Some(value)) = (words.next(), words.next()) {
        match flag {
            "--set" => {
                let (name, value) = value.split_once('=').unwrap();
                options.set.push((name.into(), value.into()));
            }
            "--camera" => options.camera = Some(value.into()),
            "--max-steps" => options.limits.steps = value.parse().unwrap(),
            "--max-objects" => options.limits.objects = value.parse().unwrap(),
            "--max-memory" => options.limits.memory = value.parse::<usize>().unwrap() << 20,
            other => panic!("unknown option {other}"),
        }
    }
    options
}

/// What the program says about a scene before it renders.
fn diagnose(name: &str) -> (Vec<Diagnostic>, Sources) {
    let loader = FolderLoader::new(folder());
    let vocabulary = dioptric_render::vocabulary();
    match read(name, &loader, &vocabulary, &options(&folder().join(name))) {
        Ok(reading) => (reading.warnings, reading.description.sources),
        Err(error) => (error.diagnostics, error.sources),
    }
}

#[test]
fn every_wrong_scene_gives_its_message() {
    let update = std::env::var_os("UPDATE_EXPECTED").is_some();
    let mut wrong = Vec::new();
    for name in cases() {
        let (diagnostics, sources) = diagnose(&name);
        let warns = ["no-light", "same-name", "unused-material", "unused-pattern"];
        let only_warns = warns.iter().any(|w| name == format!("{w}.star"));
        let errors = diagnostics.iter().any(|d| d.severity == Severity::Error);
        if errors == only_warns {
            wrong.push(format!("--- {name}: {diagnostics:?}"));
        }
        let text = report::render(&diagnostics, &sources, false);
        let expected = folder().join(&name).with_extension("txt");
        if update {
            std::fs::write(&expected, &text).unwrap();
        }
        let expected = std::fs::read_to_string(&expected).unwrap_or_default();
        if expected != text {
            wrong.push(format!("--- {name}, expected:\n{expected}--- got:\n{text}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn the_corpus_is_as_large_as_promised() {
    assert!(cases().len() >= 60);
}
