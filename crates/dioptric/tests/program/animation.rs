// SPDX-License-Identifier: MIT OR Apache-2.0
//! Animations: a picture a frame.

use super::run::{Folder, good, run, scene};

#[test]
fn frames_are_numbered_and_each_has_its_time() {
    let folder = Folder::new("frames");
    let (spin, out, stats) =
        (scene("spin.star"), folder.file("f_###.png"), folder.file("stats.json"));
    good(&["render", &spin, "--frames", "9-11", "--fps", "10", "-o", &out, "--stats", &stats]);
    assert_eq!(folder.names(), ["f_009.png", "f_010.png", "f_011.png", "stats.json"]);
    assert_ne!(folder.picture("f_009.png"), folder.picture("f_010.png"));
    let all: serde_json::Value = serde_json::from_slice(&folder.bytes("stats.json")).unwrap();
    assert_eq!(all.as_array().unwrap().len(), 3);
    // One frame alone is the same picture.
    let alone = folder.file("alone.png");
    good(&["render", &spin, "--frame", "10", "--fps", "10", "-o", &alone]);
    assert_eq!(folder.picture("alone.png"), folder.picture("f_010.png"));
}

#[test]
fn frames_need_files() {
    let ran = run(&["render", &scene("spin.star"), "--frames", "1-2", "-o", "-"]);
    assert_eq!(ran.status, 2, "{}", ran.stderr);
    assert!(ran.stderr.contains("an animation is not"), "{}", ran.stderr);
    assert_eq!(run(&["render", &scene("spin.star"), "--frames", "2-1"]).status, 2);
}
