// SPDX-License-Identifier: MIT OR Apache-2.0
//! Every scene of the folder `scenes` is read and rendered, small, without an error, a warning, or a
//! picture of one colour.

#![allow(clippy::disallowed_methods, missing_docs)] // tests may use the system's functions

use std::path::{Path, PathBuf};
use std::sync::Arc;

use dioptric::formats::{ReadOptions, read, report};
use dioptric::geometry::Ray;
use dioptric::math::DVec3;
use dioptric::render::compile::{Options, compile};
use dioptric::render::picture;
use dioptric::render::scene::Scene;
use dioptric::render::{Control, Region};
use dioptric::scene::Value;
use dioptric::scene::loader::FolderLoader;

/// All scene files below a folder, sorted.
fn scene_files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(scene_files(&path));
        } else if path.extension().is_some_and(|e| e == "star") {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// The linear colours of a scene's picture, 32 x 24 with one sample a pixel; what is wrong, in words.
fn small_picture(path: &Path, pool: &rayon::ThreadPool) -> Result<Vec<[f32; 4]>, String> {
    let (folder, name) = (path.parent().unwrap(), path.file_name().unwrap().to_str().unwrap());
    let loader = FolderLoader::new(folder);
    let vocabulary = dioptric::render::vocabulary();
    let reading = read(name, &loader, &vocabulary, &ReadOptions::default())
        .map_err(|e| report::render(&e.diagnostics, &e.sources, false))?;
    let said = |list: &[_]| report::render(list, &reading.description.sources, false);
    if !reading.warnings.is_empty() {
        return Err(said(&reading.warnings));
    }
    let description = Arc::new(reading.description.clone());
    let mut options = Options::default();
    options.render.push(("size".into(), Value::Vec2([32.0, 24.0])));
    options.render.push(("antialias".into(), Value::Text("none".into())));
    let (scene, warnings) = compile(&description, &loader, &options).map_err(|e| said(&e))?;
    if !warnings.is_empty() {
        return Err(said(&warnings));
    }
    let film = picture::render(&scene, Region::full([32, 24]), pool, &Control::default())
        .map_err(|e| said(&[e]))?;
    Ok(film.pixels().iter().map(|p| p.rgba()).collect())
}

#[test]
fn every_scene_renders_without_a_complaint() {
    let files = scene_files(
        &Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes").canonicalize().unwrap(),
    );
    assert!(files.len() >= 20, "{files:?}");
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
    let mut faults = Vec::new();
    for file in &files {
        match small_picture(file, &pool) {
            Err(fault) => faults.push(format!("{}: {fault}", file.display())),
            Ok(pixels) if pixels.iter().any(|p| !p.iter().all(|lane| lane.is_finite())) => {
                faults.push(format!("{}: a pixel is not finite", file.display()));
            }
            Ok(pixels) if pixels.iter().all(|p| *p == pixels[0]) => {
                faults.push(format!("{}: all pixels are alike", file.display()));
            }
            Ok(_) => {}
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// A forest of `rows` by `rows` trees, compiled.
fn forest(rows: &str) -> Scene {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/gallery");
    let loader = FolderLoader::new(folder);
    let set = vec![("rows".to_string(), rows.to_string())];
    let options = ReadOptions { set, ..ReadOptions::default() };
    let reading = read("forest.star", &loader, &dioptric::render::vocabulary(), &options).unwrap();
    compile(&Arc::new(reading.description), &loader, &Options::default()).unwrap().0
}

#[test]
fn ten_million_things_fit_into_the_memory_of_a_few_thousand() {
    let (small, large) = (forest("10").world, forest("100").world);
    assert_eq!((small.object_count(), small.instance_count()), (4001, 100));
    assert_eq!((large.object_count(), large.instance_count()), (4001, 10_000));
    let more = large.memory_bytes() - small.memory_bytes();
    assert!(more < 10_000 * 500, "{more} bytes for ten thousand more trees");

    // Rays into the depth of the forest end on trees, each in one of ten million things.
    let ray = |i: u32| {
        let (origin, x) = (DVec3::new(0.0, 9.0, 14.0), f64::from(i) * 0.01 - 0.5);
        Ray::new(origin, DVec3::new(x, -0.07, -1.0))
    };
    let rays: Vec<Ray> = (0..100).map(ray).collect();
    let hits = large.cast(&rays);
    let on_trees = hits.iter().flatten().filter(|hit| hit.id.instance < 10_000).count();
    assert!(on_trees > 95, "{on_trees}");
}

#[test]
fn every_scene_says_how_it_is_rendered_and_is_listed() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes").canonicalize().unwrap();
    let index = std::fs::read_to_string(root.join("README.md")).unwrap();
    for file in scene_files(&root) {
        let name = file.strip_prefix(&root).unwrap().to_str().unwrap().replace('\\', "/");
        assert!(index.contains(&format!("]({name})")), "scenes/README.md lacks {name}");
        let text = std::fs::read_to_string(&file).unwrap();
        let head: String = text.lines().take_while(|line| line.starts_with('#')).collect();
        assert!(head.contains(&format!("dioptric render scenes/{name}")), "the head of {name}");
    }
}
