// SPDX-License-Identifier: MIT OR Apache-2.0
//! Invariant 2: the same bytes for any number of threads, twice in a row, and for a crop.

use super::run::{Folder, good, scene};

/// Scenes with the report's picture, adaptive sampling, and random numbers in lenses and lights.
fn scenes() -> Vec<(String, Vec<&'static str>)> {
    vec![
        ("scenes/space.star".into(), vec!["--size", "80x80"]),
        (scene("materials.star"), vec![]),
        (scene("materials.star"), vec!["--integrator", "path", "--size", "40x32"]),
        (scene("lights.star"), vec!["--integrator", "path", "--size", "40x32"]),
        (scene("lights.star"), vec![]),
        (scene("shapes.star"), vec![]),
    ]
}

#[test]
fn threads_and_repetition_change_no_byte() {
    let folder = Folder::new("threads");
    for (scene, options) in scenes() {
        let mut first = None;
        for (i, threads) in ["1", "2", "7", "2"].iter().enumerate() {
            for format in ["png", "exr"] {
                let name = format!("{i}.{format}");
                let out = folder.file(&name);
                let mut args = vec!["render", scene.as_str(), "-o", &out, "--threads", threads];
                args.extend(&options);
                if format == "exr" {
                    args.push("--layers");
                }
                good(&args);
            }
            let bytes = [folder.bytes(&format!("{i}.png")), folder.bytes(&format!("{i}.exr"))];
            let first = first.get_or_insert_with(|| bytes.clone());
            assert!(*first == bytes, "{scene}: {threads} threads");
        }
    }
}

#[test]
fn a_crop_is_the_same_region_of_the_whole() {
    let folder = Folder::new("crop");
    for (scene, options) in scenes() {
        let mut args = vec!["render", scene.as_str(), "--layers"];
        args.extend(&options);
        let whole = folder.file("whole.exr");
        good(&[&args[..], &["-o", &whole]].concat());
        let whole = folder.picture("whole.exr");
        for [x, y, w, h] in
            [[0, 0, 17, 5], [9, 11, 20, 18], [whole.width() - 8, whole.height() - 3, 8, 3]]
        {
            let crop = format!("{x},{y},{w},{h}");
            good(&[&args[..], &["-o", &folder.file("crop.exr"), "--crop", &crop]].concat());
            let part = folder.picture("crop.exr");
            assert_eq!([part.width(), part.height()], [w, h]);
            for (row, column) in (0..h).flat_map(|r| (0..w).map(move |c| (r, c))) {
                assert_eq!(
                    part.get(column, row),
                    whole.get(x + column, y + row),
                    "{scene}: {column},{row} of {crop}"
                );
            }
        }
    }
}
