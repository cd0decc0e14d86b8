// SPDX-License-Identifier: MIT OR Apache-2.0
//! How fast meshes are read: a closed, bumpy ball of a million triangles from memory, as every kind of file; or
//! the files that are named.
//!
//!     cargo run --release -p dioptric-meshes --example read_speed [FILE ...]

use std::io::Write;
use std::time::Instant;

use dioptric_geometry::MeshData;
use dioptric_math::{cos, sin};
use dioptric_meshes::{Limits, PlyEncoding, read, write_ply};

/// A ball of `2 * n * n` triangles with normals along its radii.
fn ball(n: u32) -> MeshData {
    let mut mesh = MeshData::default();
    for i in 0..=n {
        let polar = f64::from(i) / f64::from(n) * std::f64::consts::PI;
        for j in 0..n {
            let around = f64::from(j) / f64::from(n) * std::f64::consts::TAU;
            let r = 1.0 + 0.05 * sin(11.0 * polar) * cos(13.0 * around);
            let out = [sin(polar) * cos(around), cos(polar), sin(polar) * sin(around)];
            mesh.positions.push(out.map(|x| (r * x) as f32));
            mesh.normals.push(out.map(|x| x as f32));
        }
    }
    let at = |i: u32, j: u32| i * n + j % n;
    for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
        mesh.triangles.push([at(i, j), at(i, j + 1), at(i + 1, j)]);
        mesh.triangles.push([at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)]);
    }
    mesh
}

/// As OBJ, with or without normals.
fn obj(mesh: &MeshData, has_normals: bool) -> std::io::Result<Vec<u8>> {
    let mut out = Vec::new();
    for [x, y, z] in &mesh.positions {
        writeln!(out, "v {x:.6} {y:.6} {z:.6}")?;
    }
    if has_normals {
        for [x, y, z] in &mesh.normals {
            writeln!(out, "vn {x:.4} {y:.4} {z:.4}")?;
        }
    }
    for t in &mesh.triangles {
        let [a, b, c] = t.map(|i| i + 1);
        if has_normals {
            writeln!(out, "f {a}//{a} {b}//{b} {c}//{c}")?;
        } else {
            writeln!(out, "f {a} {b} {c}")?;
        }
    }
    Ok(out)
}

fn main() -> std::io::Result<()> {
    let mut files = Vec::new();
    for name in std::env::args().skip(1) {
        files.push((name.clone(), std::fs::read(name)?));
    }
    if files.is_empty() {
        let mut mesh = ball(708);
        files.push(("with normals.obj".into(), obj(&mesh, true)?));
        files.push(("without normals.obj".into(), obj(&mesh, false)?));
        mesh.normals.clear();
        for encoding in [PlyEncoding::Ascii, PlyEncoding::Little, PlyEncoding::Big] {
            let mut bytes = Vec::new();
            write_ply(&mesh, encoding, &mut bytes)?;
            files.push((format!("{encoding:?}.ply"), bytes));
        }
    }
    for (name, bytes) in files {
        let mut best = f64::INFINITY;
        let mut triangles = 0;
        for _ in 0..5 {
            let start = Instant::now();
            match read(&name, &mut bytes.as_slice(), &Limits::default()) {
                Ok(model) => triangles = model.mesh.triangles.len(),
                Err(error) => println!("{error}"),
            }
            best = best.min(start.elapsed().as_secs_f64());
        }
        let mib = bytes.len() as f64 / f64::from(1 << 20);
        println!("{name}: {triangles} triangles, {mib:.1} MiB, {:.1} ms", best * 1e3);
    }
    Ok(())
}
