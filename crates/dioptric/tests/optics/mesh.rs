// SPDX-License-Identifier: MIT OR Apache-2.0
//! Closed meshes are solids: glass cubes of triangles look like the exact box, whichever way their faces turn,
//! and things in bulk look like as many single ones.

use crate::support::scene;
use dioptric::render::{Control, Region, picture};

const STAGE: &str = "render(size = (40, 30), samples = 1, antialias = \"grid\", bounces = 8)\n\
    camera(eye = (1.3, 2.1, 5), fov = 34)\nlight(position = (-3, 6, 4))\nambient(0.2)\n\
    background(gradient(low = (0.2, 0.5, 0.9), high = (0.9, 0.6, 0.1)))\n\
    plane(point = (0, -1.5, 0), material = matte(checker(\"white\", \"navy\", size = 0.7)))\n\
    turned = [rotate(y = 23), rotate(x = 11), translate((0.1, 0.2, 0))]\n\
    clear_glass = glass(ior = 1.5)\n";

fn colors(text: &str) -> Vec<[f32; 4]> {
    let scene = scene(&format!("{STAGE}{text}\n"));
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
    let film = picture::render(&scene, Region::full([40, 30]), &pool, &Control::default()).unwrap();
    film.pixels().iter().map(|p| p.rgba()).collect()
}

/// All but a few pixels are the same: rays along edges may meet either face.
#[track_caller]
fn assert_alike(one: &str, other: &str) {
    let (a, b) = (colors(one), colors(other));
    let differ =
        |(a, b): (&[f32; 4], &[f32; 4])| a.iter().zip(b).any(|(a, b)| (a - b).abs() > 1e-5);
    let count = a.iter().zip(&b).filter(|&pair| differ(pair)).count();
    assert!(count <= 3, "{count} pixels differ: {one}\n{other}");
    let empty = colors("");
    let seen = a.iter().zip(&empty).filter(|&pair| differ(pair)).count();
    assert!(seen > 50, "it is seen in {seen} pixels: {one}");
}

const POINTS: &str = "points = [(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)]";

#[test]
fn a_glass_cube_of_triangles_is_the_box() {
    let exact =
        "box(min = (-1, -1, -1), max = (1, 1, 1), material = clear_glass, transform = turned)";
    let outward =
        "[[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]";
    let faces = [outward.to_string(), format!("[f[::-1] for f in {outward}]")];
    for faces in faces {
        let mesh =
            format!("mesh({POINTS}, faces = {faces}, material = clear_glass, transform = turned)");
        assert_alike(exact, &mesh);
    }
}

#[test]
fn pools_look_like_single_things() {
    let place = "[(0.9 * i - 0.9, 0.3 * i, -0.4 * i) for i in range(3)]";
    for (one, bulk) in [
        (
            format!("[sphere(center = p, radius = 0.4, material = mirror()) for p in {place}]"),
            format!("spheres(centers = {place}, radius = 0.4, material = mirror())"),
        ),
        (
            format!(
                "[cylinder(base = p, top = (p[0], 1, 0.5), radius = 0.3, material = plastic(\"red\")) for p in {place}]"
            ),
            format!(
                "cylinders(ends = [(p, (p[0], 1, 0.5)) for p in {place}], radius = 0.3, material = plastic(\"red\"))"
            ),
        ),
        (
            format!(
                "[cone(base = p, top = (p[0], 1, 0.5), radius = 0.4, top_radius = 0.1, open = True) for p in {place}]"
            ),
            format!(
                "cones(ends = [(p, (p[0], 1, 0.5)) for p in {place}], radius = 0.4, top_radius = 0.1, open = True)"
            ),
        ),
    ] {
        assert_alike(&one, &bulk);
    }
}
