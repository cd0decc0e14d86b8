// SPDX-License-Identifier: MIT OR Apache-2.0
//! Veach's scene: four plates from sharp to dull under four lamps from small to large. All ways of finding light give the
//! same means, and both together are nowhere much worse than the better one.

#![allow(clippy::disallowed_methods)] // the standard library's functions are the other opinion

mod support;

use dioptric::render::compile::Options;
use dioptric::scene::Value;
use dioptric::scene::loader::FolderLoader;

const SIZE: [usize; 2] = [48, 36];
const SEEDS: u32 = if cfg!(debug_assertions) { 24 } else { 64 };

/// Rows of the plates, sharp to dull, and columns below the lamps, large to small.
const PLATES: [(usize, usize); 4] = [(14, 18), (19, 22), (24, 27), (28, 32)];
const LAMPS: [(usize, usize); 4] = [(9, 16), (16, 23), (24, 31), (31, 38)];

/// A picture for each of many seeds.
fn pictures(how: &str) -> Vec<Vec<f64>> {
    let loader = FolderLoader::new(support::root().join("scenes"));
    let picture = |seed: u32| {
        let mut options = Options::default();
        let size = SIZE.map(|n| n as f64);
        options.render = vec![
            ("size".into(), Value::Vec2(size)),
            ("samples".into(), Value::Number(4.0)),
            ("antialias".into(), Value::Text("jitter".into())),
            ("seed".into(), Value::Number(f64::from(seed))),
        ];
        let scene = support::load_with("veach.star", &loader, &[("find", how)], &options);
        support::film(&scene, 2).pixels().iter().map(|p| p.linear().y).collect()
    };
    (1..=SEEDS).map(picture).collect()
}

/// Mean over a piece of the pictures, its standard error, and the noise of a pixel: the root of the mean variance.
fn judge(all: &[Vec<f64>], rows: (usize, usize), columns: (usize, usize)) -> [f64; 3] {
    let n = f64::from(SEEDS);
    let (mut sum, mut variance, mut count) = (0.0, 0.0, 0.0);
    for (x, y) in (rows.0..rows.1).flat_map(|y| (columns.0..columns.1).map(move |x| (x, y))) {
        let values = || all.iter().map(|picture| picture[y * SIZE[0] + x]);
        let mean = values().sum::<f64>() / n;
        sum += mean;
        variance += values().map(|v| (v - mean) * (v - mean)).sum::<f64>() / (n - 1.0);
        count += 1.0;
    }
    [sum / count, (variance / n).sqrt() / count, (variance / count).sqrt()]
}

#[test]
fn both_ways_are_as_good_as_the_better_one_on_every_plate_below_every_lamp() {
    let [both, lights, surfaces] = ["both", "lights", "surfaces"].map(pictures);
    let mut better = [0, 0];
    for (plate, rows) in PLATES.into_iter().enumerate() {
        for (lamp, columns) in LAMPS.into_iter().enumerate() {
            let [b, mut l, mut s] =
                [&both, &lights, &surfaces].map(|all| judge(all, rows, columns));
            for other in [&mut l, &mut s] {
                // Who has hardly found any light does not know its noise.
                if other[0] < 0.5 * b[0] {
                    other[2] = f64::INFINITY;
                }
            }
            println!(
                "plate {plate}, lamp {lamp}: mean {:.4} {:.4} {:.4}, noise {:.4} {:.4} {:.4}",
                b[0], l[0], s[0], b[2], l[2], s[2]
            );
            better[usize::from(s[2] < l[2])] += 1;
            assert!(b[2] <= 1.1 * l[2].min(s[2]), "plate {plate}, lamp {lamp}: {b:?} {l:?} {s:?}");
            for other in [l, s] {
                let error = (b[1] * b[1] + other[1] * other[1]).sqrt();
                // Where one way is hopeless, its error is not known either.
                let hopeless = other[2] > 8.0 * b[2];
                let apart = (b[0] - other[0]).abs() / error;
                assert!(apart < 4.0 || hopeless, "plate {plate}, lamp {lamp}: {b:?} {other:?}");
            }
        }
    }
    // Each way is the better one somewhere, or the scene would show nothing.
    assert!(better[0] >= 3 && better[1] >= 3, "{better:?}");
}
