// SPDX-License-Identifier: MIT OR Apache-2.0
//! A writer of PLY files, for tests, benchmarks and programs that make meshes.

use std::io::{self, Write};

use dioptric_geometry::MeshData;

/// How a PLY file holds its numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlyEncoding {
    /// As text. Reading it gives the same numbers.
    Ascii,
    /// As binary data, the low byte first.
    Little,
    /// As binary data, the high byte first.
    Big,
}

/// Writes a mesh as a PLY file.
///
/// # Errors
/// What `out` fails with.
pub fn write_ply(mesh: &MeshData, encoding: PlyEncoding, out: &mut dyn Write) -> io::Result<()> {
    let name = match encoding {
        PlyEncoding::Ascii => "ascii",
        PlyEncoding::Little => "binary_little_endian",
        PlyEncoding::Big => "binary_big_endian",
    };
    let count = mesh.positions.len();
    let has_normals = mesh.normals.len() == count && count > 0;
    let has_uvs = mesh.uvs.len() == count && count > 0;
    write!(out, "ply\nformat {name} 1.0\nelement vertex {count}\n")?;
    let normals: &[&str] = if has_normals { &["nx", "ny", "nz"] } else { &[] };
    let uvs: &[&str] = if has_uvs { &["u", "v"] } else { &[] };
    for property in ["x", "y", "z"].iter().chain(normals).chain(uvs) {
        writeln!(out, "property float {property}")?;
    }
    let faces = mesh.triangles.len();
    write!(out, "element face {faces}\nproperty list uchar uint vertex_indices\nend_header\n")?;
    let mut record: Vec<u8> = Vec::new();
    for (i, position) in mesh.positions.iter().enumerate() {
        let normal = mesh.normals.get(i).filter(|_| has_normals);
        let uv = mesh.uvs.get(i).filter(|_| has_uvs);
        let numbers = position.iter().chain(normal.into_iter().flatten());
        record.clear();
        for x in numbers.chain(uv.into_iter().flatten()) {
            match encoding {
                PlyEncoding::Ascii => write!(record, "{x} ")?,
                PlyEncoding::Little => record.extend(x.to_le_bytes()),
                PlyEncoding::Big => record.extend(x.to_be_bytes()),
            }
        }
        end(&mut record, encoding);
        out.write_all(&record)?;
    }
    for corners in &mesh.triangles {
        record.clear();
        match encoding {
            PlyEncoding::Ascii => write!(record, "3 ")?,
            _ => record.push(3),
        }
        for i in corners {
            match encoding {
                PlyEncoding::Ascii => write!(record, "{i} ")?,
                PlyEncoding::Little => record.extend(i.to_le_bytes()),
                PlyEncoding::Big => record.extend(i.to_be_bytes()),
            }
        }
        end(&mut record, encoding);
        out.write_all(&record)?;
    }
    Ok(())
}

/// Ends a line of text.
fn end(record: &mut Vec<u8>, encoding: PlyEncoding) {
    if encoding == PlyEncoding::Ascii {
        record.pop();
        record.push(b'\n');
    }
}
