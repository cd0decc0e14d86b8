// SPDX-License-Identifier: MIT OR Apache-2.0
//! Nothing depends on the units of a scene: the first scene inside of a root that is scaled or moved
//! gives the same picture. And a scene may be large: a million spheres.

#![allow(clippy::disallowed_methods)]

mod support;

use std::time::Instant;

use dioptric::render::job::Control;
use dioptric::render::picture::render;
use dioptric::render::region::Region;
use support::{scene, scene_file};

const SIZE: u32 = 160;

/// The 8-bit values of the first scene's picture.
fn picture(set: &[(&str, &str)]) -> Vec<[u8; 3]> {
    let scene = scene_file("space.star", set, SIZE);
    let threads = rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("threads");
    let film = render(&scene, Region::full([SIZE; 2]), &threads, &Control::default())
        .expect("there is memory");
    film.pixels()
        .iter()
        .map(|p| {
            let [r, g, b, _] = p.rgba();
            scene.develop.to_u8([r, g, b])
        })
        .collect()
}

#[test]
fn a_scaled_or_moved_scene_gives_the_same_picture() {
    let plain = picture(&[]);
    for set in [("root_scale", "1e-6"), ("root_scale", "1e6"), ("root_shift", "1e5")] {
        let other = picture(&[set]);
        let differ = |a: &[u8; 3], b: &[u8; 3]| a.iter().zip(b).any(|(a, b)| a.abs_diff(*b) > 2);
        let off = plain.iter().zip(&other).filter(|(a, b)| differ(a, b)).count();
        let share = off as f64 / plain.len() as f64;
        println!(
            "{} = {}: {:.4} % of the pixels differ by more than 2/255",
            set.0,
            set.1,
            100.0 * share
        );
        assert!(share <= 0.001, "{set:?}: {off} of {} pixels", plain.len());
        // The root is really there: rays start elsewhere.
        assert!(
            scene_file("space.star", &[set], SIZE).root.transform()
                != scene_file("space.star", &[], SIZE).root.transform()
        );
    }
}

#[test]
fn a_million_spheres_are_read_and_compiled() {
    let start = Instant::now();
    let scene = scene(
        "version(1)\n\
         camera(eye = (50, 50, 300), look_at = (50, 50, 50))\n\
         light(position = (0, 500, 500))\n\
         for i in range(100):\n    for j in range(100):\n        for k in range(100):\n            \
         sphere(center = (i, j, k), radius = 0.3)\n",
    );
    let seconds = start.elapsed().as_secs_f64();
    assert_eq!(scene.world.object_count(), 1_000_000);
    println!(
        "a million spheres: {seconds:.2} s to read and compile, {} MB of world",
        scene.world.memory_bytes() >> 20
    );
    // 5 seconds is the promise for an optimised build on a quiet machine; tests may run on a loaded one
    // and without optimisation.
    assert!(seconds < 60.0, "{seconds} s");
    assert!(scene.world.memory_bytes() < 200 << 20);
}
