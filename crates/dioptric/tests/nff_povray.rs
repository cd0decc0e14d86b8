// SPDX-License-Identifier: MIT OR Apache-2.0
//! NFF against a second program: Dioptric's pictures of small scenes against POV-Ray's of their twins
//! (`tests/data/nff/README.md`).

#![allow(clippy::disallowed_methods)]

mod support;

use dioptric::image::{Encoding, Image, compare, decode};
use dioptric::render::compile::Options;
use dioptric::render::{Control, Region, render};
use dioptric::scene::Value;
use dioptric::scene::loader::FolderLoader;
use support::{load_with, root};

/// Dioptric's picture in the size of the file, one ray in the middle of each pixel, light cut off at 1.
fn ours(name: &str) -> Image {
    let loader = FolderLoader::new(root().join("tests/data/nff"));
    let mut options = Options::default();
    options.render.push(("antialias".into(), Value::Text("none".into())));
    let scene = load_with(&format!("{name}.nff"), &loader, &[], &options);
    let [width, height] = scene.settings.size;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("threads");
    let region = Region::full([width, height]);
    let film = render(&scene, region, &pool, &Control::default()).expect("there is memory");
    Image::from_fn(width, height, Encoding::Srgb, |x, y| {
        let [r, g, b, _] = film.pixel(x, y).expect("in the film").rgba();
        [r, g, b].map(|lane| lane.min(1.0))
    })
    .expect("a small picture")
}

#[test]
fn pictures_agree_with_pov_ray() {
    for (name, least) in [("tree6", 90.0), ("mixed", 40.0)] {
        let path = root().join("tests/data/nff").join(name).with_extension("png");
        let bytes = std::fs::read(&path).expect("the picture is in the repository");
        let theirs = decode(&bytes, name, 1 << 16).expect("it is a picture");
        let found = compare(&ours(name), &theirs, 2.0 / 255.0).expect("of one size");
        println!(
            "{name}: PSNR {:.2} dB, largest difference {:.4} at {:?}, {:.2} % differ by more than 2/255",
            found.psnr,
            found.max_difference,
            found.worst,
            100.0 * found.share_above
        );
        assert!(found.psnr >= least, "{name}: {found:?}");
    }
}
