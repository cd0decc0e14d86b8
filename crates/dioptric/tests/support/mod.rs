// SPDX-License-Identifier: MIT OR Apache-2.0
//! What several tests need: a scene from a text, one value of one pixel.

#![allow(dead_code, clippy::disallowed_methods, missing_docs)] // each test uses a part of it

use std::path::PathBuf;
use std::sync::Arc;

use dioptric::formats::{ReadOptions, read, report};
use dioptric::render::compile::{Options, compile};
use dioptric::render::integrator::recorder::{Node, RayKind};
use dioptric::render::scene::Scene;
use dioptric::render::why::{Pixel, explain};
use dioptric::render::{Control, Film, Region, render};
use dioptric::scene::loader::{FolderLoader, Loader, MemoryLoader};
use rayon::ThreadPoolBuilder;

/// The repository's root.
pub fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Compiles a scene text; panics with the rendered diagnostics where it is wrong.
pub fn scene(text: &str) -> Scene {
    load("test.star", &MemoryLoader::new().with("test.star", text.as_bytes().to_vec()), &[])
}

/// Compiles a scene of the repository's `scenes` folder, with `--set` and overrides of `render`.
pub fn scene_file(name: &str, set: &[(&str, &str)], size: u32) -> Scene {
    let loader = FolderLoader::new(root().join("scenes"));
    let mut options = Options::default();
    options.render.push(("size".into(), dioptric::scene::Value::Vec2([f64::from(size); 2])));
    load_with(name, &loader, set, &options)
}

pub fn load(path: &str, loader: &dyn Loader, set: &[(&str, &str)]) -> Scene {
    load_with(path, loader, set, &Options::default())
}

pub fn load_with(
    path: &str,
    loader: &dyn Loader,
    set: &[(&str, &str)],
    options: &Options,
) -> Scene {
    let read_options = ReadOptions {
        set: set.iter().map(|(k, v)| ((*k).to_string(), (*v).to_string())).collect(),
        ..ReadOptions::default()
    };
    let vocabulary = dioptric::render::vocabulary();
    let reading = read(path, loader, &vocabulary, &read_options)
        .unwrap_or_else(|e| panic!("{}", report::render(&e.diagnostics, &e.sources, false)));
    let description = Arc::new(reading.description);
    compile(&description, loader, options)
        .unwrap_or_else(|e| panic!("{}", report::render(&e, &description.sources, false)))
        .0
}

/// The whole picture, made by so many threads.
pub fn film(scene: &Scene, threads: usize) -> Film {
    let pool = ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    render(scene, Region::full(scene.settings.size), &pool, &Control::default()).unwrap()
}

/// Mean and standard error of the mean over all samples of a small picture, a lane each. Pixels are means of many
/// samples, so their spread tells the error.
pub fn mean(text: &str) -> ([f64; 3], [f64; 3]) {
    let pixels: Vec<[f64; 3]> =
        film(&scene(text), 2).pixels().iter().map(|p| p.linear().to_array()).collect();
    let n = pixels.len() as f64;
    let mean = [0, 1, 2].map(|i| pixels.iter().map(|p| p[i]).sum::<f64>() / n);
    let error = [0, 1, 2].map(|i| {
        let square: f64 = pixels.iter().map(|p| (p[i] - mean[i]) * (p[i] - mean[i])).sum();
        (square / (n - 1.0) / n).sqrt()
    });
    (mean, error)
}

/// Settings of a picture of paths, colours as they are.
pub fn paths(size: u32, samples: u32, more: &str) -> String {
    format!(
        "version(1)\nscene(colors = \"raw\")\nrender(size = ({size}, {size}), integrator = \"path\", samples = {samples}{more})\n"
    )
}

/// All there is to know of a pixel.
pub fn pixel(scene: &Scene, x: u32, y: u32) -> Pixel {
    explain(scene, x, y).expect("the pixel is in the picture")
}

/// What every test of optics begins with: one pixel, one ray straight ahead, colours as they are.
pub const ONE_RAY: &str = r#"
version(1)
scene(colors = "raw")
develop(encoding = "raw")
render(size = (1, 1), antialias = "none", min_contribution = 0, BOUNCES)
"#;

/// The tree of the one ray of a scene text that says nothing of how it is rendered.
pub fn one_ray(bounces: u32, text: &str) -> Node {
    render_setting(&format!("bounces = {bounces}"), text)
}

/// The same with more settings of `render`.
pub fn render_setting(setting: &str, text: &str) -> Node {
    let scene = scene(&format!("{}\n{text}", ONE_RAY.replace("BOUNCES", setting)));
    let pixel = pixel(&scene, 0, 0);
    assert_eq!(pixel.samples.len(), 1);
    let ray = pixel.samples[0].ray.clone().expect("the camera sees everywhere");
    assert_sums(&ray);
    ray
}

/// Every value of a tree is the sum of its parts; returns the number of rays by kind.
pub fn assert_sums(node: &Node) -> [u64; 3] {
    let mut counts = [0; 3];
    counts[node.kind as usize] += 1;
    let mut sum = [0.0; 3];
    for term in &node.terms {
        sum = [0, 1, 2].map(|i| sum[i] + term.value[i]);
    }
    for child in &node.children {
        let below = assert_sums(&child.ray);
        counts = [0, 1, 2].map(|i| counts[i] + below[i]);
        sum = [0, 1, 2].map(|i| sum[i] + child.weight[i] * child.ray.value[i]);
    }
    for (a, b) in sum.iter().zip(node.value) {
        assert!((a - b).abs() <= 1e-12 * b.abs().max(1.0), "{sum:?} is not the value of {node:?}");
    }
    counts
}

/// Panics unless three numbers are what they should be.
#[track_caller]
pub fn assert_near(got: [f64; 3], expected: [f64; 3], tolerance: f64) {
    assert!(
        got.iter().zip(expected).all(|(a, b)| (a - b).abs() <= tolerance),
        "{got:?}, expected {expected:?}"
    );
}

/// The ray itself and all that it passed on to through surfaces, in order.
pub fn transmitted(node: &Node) -> Vec<&Node> {
    let mut chain = vec![node];
    while let Some(next) =
        chain.last().and_then(|n| n.children.iter().find(|c| c.ray.kind == RayKind::Transmitted))
    {
        chain.push(&next.ray);
    }
    chain
}
