// SPDX-License-Identifier: MIT OR Apache-2.0
//! Every wrong scene of `tests/errors`, through the program: its text on standard error, its status.

use super::run::{Folder, finish, program, root};

#[test]
fn wrong_scenes_give_their_message_and_status_1() {
    let corpus = root().join("tests/errors");
    let folder = Folder::new("corpus");
    let mut wrong = Vec::new();
    let mut count = 0;
    for entry in std::fs::read_dir(&corpus).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if path.is_dir() || name.ends_with(".txt") {
            continue;
        }
        count += 1;
        let expected = std::fs::read_to_string(path.with_extension("txt")).unwrap();
        let text = String::from_utf8_lossy(&std::fs::read(&path).unwrap()).into_owned();
        let first = text.lines().next().unwrap_or_default();
        let options: Vec<&str> =
            first.strip_prefix("# options:").unwrap_or_default().split_whitespace().collect();
        let out = folder.file("out.png");
        // Scenes that are only doubtful are rendered: small. Sizes of the others may be what is wrong.
        let status = i32::from(expected.contains("error["));
        let size = if status == 0 { &["--size", "8x6"][..] } else { &[] };
        let fixed = ["render", &name, "-q", "-o", &out];
        let args: Vec<&str> = fixed.iter().chain(size).copied().chain(options).collect();
        let ran = finish(program(&args).current_dir(&corpus).output().unwrap());
        let said = &ran.stderr;
        if *said != expected || ran.status != status {
            wrong.push(format!("{name}: status {}\n{said}\nexpected:\n{expected}", ran.status));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n----\n"));
    assert!(count >= 60, "{count} cases");
}
