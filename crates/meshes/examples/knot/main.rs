// SPDX-License-Identifier: MIT OR Apache-2.0
//! Writes the knot that scenes show: the same bytes on every machine, part of the project with its licence.
//!
//!     cargo run --release -p dioptric-meshes --example knot > scenes/meshes/knot.ply

mod shape;

use dioptric_meshes::{PlyEncoding, write_ply};

fn main() -> std::io::Result<()> {
    write_ply(&shape::knot(), PlyEncoding::Little, &mut std::io::stdout().lock())
}
