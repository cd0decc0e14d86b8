// SPDX-License-Identifier: MIT OR Apache-2.0
//! Every wrong scene of `tests/errors` makes the program say exactly the text beside it and end with
//! status 1 (0 where it only warns), never with a panic.
//!
//! A scene's first line may hold options of the program, `# options: --max-steps 1000`. With
//! `UPDATE_EXPECTED=1` in the environment the texts are written anew; read them before you commit.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Mutex;

/// Scenes that are only warned of.
const WARNED: [&str; 4] = ["no-light", "same-name", "unused-material", "unused-pattern"];

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

/// What the program says about a scene, and its exit status.
fn diagnose(name: &str, picture: &Path) -> (String, Option<i32>) {
    let bytes = std::fs::read(folder().join(name)).unwrap();
    let text = String::from_utf8_lossy(&bytes);
    let first = text.lines().next().unwrap_or_default();
    let options = first.strip_prefix("# options:").unwrap_or_default();
    let mut command = Command::new(env!("CARGO_BIN_EXE_dioptric"));
    command.current_dir(folder()).args(["render", "--quiet", name, "-o"]).arg(picture);
    if !text.contains("render(") {
        command.args(["--size", "8x8"]);
    }
    let output = command.args(options.split_whitespace()).output().unwrap();
    (String::from_utf8(output.stderr).unwrap(), output.status.code())
}

#[test]
fn every_wrong_scene_gives_its_message_and_status() {
    let update = std::env::var_os("UPDATE_EXPECTED").is_some();
    let cases = Mutex::new(cases());
    let wrong = Mutex::new(Vec::new());
    let check = || {
        loop {
            let Some(name) = cases.lock().unwrap().pop() else { return };
            let picture = std::env::temp_dir()
                .join(format!("dioptric-errors-{}-{name}.png", std::process::id()));
            let (text, status) = diagnose(&name, &picture);
            let made = std::fs::remove_file(&picture).is_ok();
            let warned = WARNED.iter().any(|warned| name == format!("{warned}.star"));
            let mut faults = wrong.lock().unwrap();
            if status != Some(i32::from(!warned)) || made != warned {
                faults.push(format!("--- {name}: status {status:?}, picture {made}\n{text}"));
            }
            let expected = folder().join(&name).with_extension("txt");
            if update {
                std::fs::write(&expected, &text).unwrap();
            }
            let expected = std::fs::read_to_string(&expected).unwrap_or_default();
            if expected != text {
                faults.push(format!("--- {name}, expected:\n{expected}--- got:\n{text}"));
            }
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(check);
        }
    });
    let wrong = wrong.into_inner().unwrap();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn the_corpus_is_as_large_as_promised() {
    assert!(cases().len() >= 100, "{}", cases().len());
}
