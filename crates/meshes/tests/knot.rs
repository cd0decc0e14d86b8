// SPDX-License-Identifier: MIT OR Apache-2.0
//! The knot that scenes show is what the program of this crate makes.

#[path = "../examples/knot/shape.rs"]
mod shape;

use dioptric_geometry::Shape;
use dioptric_geometry::mesh::Mesh;
use dioptric_meshes::{Limits, read};

#[test]
fn the_knot_is_as_it_is_made_and_closed() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/meshes/knot.ply");
    let bytes = std::fs::read(path).unwrap();
    let made = shape::knot();
    assert_eq!(read("knot.ply", &mut bytes.as_slice(), &Limits::default()).unwrap().mesh, made);
    let outward = made.triangles.iter().all(|t| {
        let [a, b, c] = t.map(|i| made.positions[i as usize].map(f64::from));
        let edge = |p: [f64; 3]| [0, 1, 2].map(|k| p[k] - a[k]);
        let (e, f) = (edge(b), edge(c));
        let n = made.normals[t[0] as usize].map(f64::from);
        let volume = n[0] * (e[1] * f[2] - e[2] * f[1])
            + n[1] * (e[2] * f[0] - e[0] * f[2])
            + n[2] * (e[0] * f[1] - e[1] * f[0]);
        volume > 0.0
    });
    assert!(outward, "normals and winding agree");
    assert!(Mesh::new(made).is_solid());
}
