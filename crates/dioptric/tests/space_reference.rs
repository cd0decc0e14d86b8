// SPDX-License-Identifier: MIT OR Apache-2.0
//! The first scene against a second, plain program (`reference/mod.rs`), pixel by pixel.

#![allow(clippy::disallowed_methods)]

mod reference;
mod support;

use dioptric::image::decode;
use dioptric::render::job::Control;
use dioptric::render::picture::render;
use dioptric::render::region::Region;
use reference::{Picture, Space, V};
use support::{root, scene_file};

/// A picture of the repository, bilinear between texel centres, clamped or repeated at its edges.
fn picture(name: &str) -> Picture {
    let bytes = std::fs::read(root().join("scenes/pictures").join(name))
        .expect("the picture is in the repository");
    let image = decode(&bytes, name, 1 << 24).expect("it is a picture");
    let (w, h) = (image.width() as i64, image.height() as i64);
    Box::new(move |u, v| {
        let (x, y) = (u * w as f64 - 0.5, (1.0 - v) * h as f64 - 0.5);
        let (x0, y0) = (x.floor(), y.floor());
        let (fx, fy) = (x - x0, y - y0);
        let mut sum = V(0.0, 0.0, 0.0);
        for (dx, wx) in [(0, 1.0 - fx), (1, fx)] {
            for (dy, wy) in [(0, 1.0 - fy), (1, fy)] {
                let (px, py) = ((x0 as i64 + dx).rem_euclid(w), (y0 as i64 + dy).rem_euclid(h));
                let [r, g, b, _] = image.get(px as u32, py as u32).expect("inside");
                sum = sum + V(f64::from(r), f64::from(g), f64::from(b)) * (wx * wy);
            }
        }
        sum
    })
}

#[test]
fn every_pixel_agrees_with_a_second_program() {
    // At 80 x 80 two samples fall exactly on an edge of the cube, where either face is right.
    let size = 81;
    let threads = rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("threads");
    for (file, dark) in [("space.star", V(0.2, 0.2, 0.2)), ("space-orange.star", V(1.0, 0.5, 0.0))]
    {
        let scene = scene_file(file, &[], size);
        let film = render(&scene, Region::full([size; 2]), &threads, &Control::default())
            .expect("there is memory");
        let plain = Space::new(picture("night-sky.png"), picture("football.png"), dark);
        let (mut worst, mut off) = (0.0_f64, Vec::new());
        for y in 0..size {
            for x in 0..size {
                let ours = film.pixel(x, y).expect("in the film").linear().to_array();
                let theirs = plain.pixel(x, y, size);
                let difference =
                    ours.iter().zip(theirs).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                worst = worst.max(difference);
                if difference > 1.0 / 255.0 {
                    off.push((x, y, ours, theirs));
                }
            }
        }
        println!("{file}: largest difference {worst:.3e} over {} pixels", size * size);
        // Rounding may put a sample on the other side of an edge; nothing else may differ.
        assert!(
            off.is_empty(),
            "{file}: {} pixels differ, such as {:?}",
            off.len(),
            &off[..off.len().min(5)]
        );
    }
}
