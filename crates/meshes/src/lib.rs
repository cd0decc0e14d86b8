// SPDX-License-Identifier: MIT OR Apache-2.0
//! Readers of triangle meshes: PLY and Wavefront OBJ, in one pass over the file, with memory in
//! proportion to the mesh.
//!
//! ```
//! use dioptric_meshes::{Limits, read};
//!
//! let file = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
//! let model = read("square.obj", &mut file.as_bytes(), &Limits::default())?;
//! assert_eq!(model.mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
//!
//! let broken = read("square.obj", &mut "v 0 0\n".as_bytes(), &Limits::default()).unwrap_err();
//! assert_eq!(broken.to_string(), "square.obj, line 1: expected three numbers after v, got 2");
//! # Ok::<(), dioptric_meshes::MeshError>(())
//! ```
//!
//! Faces with more than three corners become triangles ([`cut`]): convex ones a fan from their first
//! corner, concave ones by ear clipping. Faces with fewer than three are left out.
//!
//! Why these readers are ours: of the crates for these formats, tobj (4.0) gives errors without the line and
//! cuts every polygon as a fan, and ply-rs-bw (2.0) makes a map of properties on the heap for each record and
//! runs a grammar over each line; they take four to ten times as long (docs/performance.md).

#![forbid(unsafe_code)]

pub mod cut;
mod error;
mod feed;
mod number;
mod obj;
mod ply;
mod write;

pub use error::{MeshError, Place};
pub use write::{PlyEncoding, write_ply};

use std::io::Read;

use dioptric_geometry::MeshData;
use feed::Feed;

/// What a file holds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Model {
    /// Its triangles. Where only some corners have a normal or surface coordinates, the others have zeros.
    pub mesh: MeshData,
    /// A radius for each position, as files of atoms and point clouds have them; empty where there are none.
    pub radii: Vec<f32>,
}

impl Model {
    /// How many bytes of memory it takes.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        let mesh = &self.mesh;
        let bytes = size_of_val(&*mesh.positions)
            + size_of_val(&*mesh.triangles)
            + size_of_val(&*mesh.normals)
            + size_of_val(&*mesh.uvs)
            + size_of_val(&*self.radii);
        bytes as u64
    }
}

/// The formats that are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// The Stanford polygon format: text, or binary of either byte order.
    Ply,
    /// Wavefront's text format.
    Obj,
}

impl Format {
    /// The format that the name of a file says: `.ply` or `.obj`, in capitals too.
    #[must_use]
    pub fn of_name(name: &str) -> Option<Self> {
        match name.rsplit_once('.')?.1 {
            end if end.eq_ignore_ascii_case("ply") => Some(Self::Ply),
            end if end.eq_ignore_ascii_case("obj") => Some(Self::Obj),
            _ => None,
        }
    }
}

/// Where reading stops with an error instead of going on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// The most bytes that a mesh may take in memory: 4 GiB.
    pub bytes: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Self { bytes: 4 << 30 }
    }
}

/// Reads the mesh in a file of this name, which says the format and stands in errors. The reader is asked
/// for large blocks and needs no buffer of its own.
///
/// # Errors
/// The format is not known, the content is no mesh or damaged, it is too large, or the reader fails.
pub fn read(name: &str, reader: &mut dyn Read, limits: &Limits) -> Result<Model, MeshError> {
    let read = match Format::of_name(name) {
        Some(Format::Ply) => ply::read,
        Some(Format::Obj) => obj::read,
        None => {
            let error = MeshError::new(Place::File, "the file is of no format that is known");
            return Err(error.help("meshes are read from .ply and .obj files").in_file(name));
        }
    };
    read(&mut Feed::new(reader), limits).map_err(|e| e.in_file(name))
}

/// Bytes of a mesh with so many positions and triangles.
fn bytes_of(positions: usize, per_position: usize, triangles: usize) -> u64 {
    positions as u64 * per_position as u64 + triangles as u64 * 12
}

/// Says that a mesh is over the limit.
fn too_large(place: Place, limits: &Limits) -> MeshError {
    let limit = match limits.bytes >> 20 {
        0 => format!("{} KiB", limits.bytes >> 10),
        mib => format!("{mib} MiB"),
    };
    MeshError::too_large(place, format!("the mesh takes more than the limit of {limit}"))
}
