// SPDX-License-Identifier: MIT OR Apache-2.0
//! Triangles as files hold them: what readers of meshes hand to geometry.

/// Indexed triangles in single precision, as files store them; these numbers are the exact shape.
///
/// Nothing is promised about the content: indices may point beyond the arrays, numbers may be NaN. Whoever
/// builds something from it leaves such triangles out.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshData {
    /// Corners that triangles share.
    pub positions: Vec<[f32; 3]>,
    /// Three indices into `positions` for each triangle, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// A normal for each position, of any length but zero; empty where the file has none.
    pub normals: Vec<[f32; 3]>,
    /// Surface coordinates for each position; empty where the file has none.
    pub uvs: Vec<[f32; 2]>,
}
