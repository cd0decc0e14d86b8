// SPDX-License-Identifier: MIT OR Apache-2.0
//! `mesh`: triangles from a file or from lists.

use std::sync::Arc;

use dioptric_geometry::mesh::Mesh;
use dioptric_geometry::{AnyShape, MeshData};
use dioptric_meshes::cut::cut;
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type, Value};

use crate::build::Builder;

pub(super) static SCHEMA: Schema = Schema {
    kind: "mesh",
    category: Category::Shape,
    summary: "triangles from a PLY or OBJ file, or from lists",
    doc: "Many triangles as one shape: those of a `file`, or the `faces` between `points`. Faces with more than three \
          corners are cut into triangles. Triangles that share edges leave no gap, and triangles without area, or with \
          numbers in a file that are not finite, are left out. Coordinates are kept in single precision.\n\n\
          A mesh that is closed (each edge is passed as often in one direction as in the other) is solid: it can be \
          glass, and its normal points outwards. Of others the normal points to who sees the corners counterclockwise, \
          or to the side to which most of the corners' normals point.\n\n\
          With `smooth = True` the surface is shaded with the interpolation of the normals at the corners, where the file \
          or `normals` gives them; with False every triangle is flat.\n\n\
          `uv`: interpolated from the file's coordinates or `uvs`; without them 0, 0 at a triangle's first corner, u = 1 at \
          the second and v = 1 at the third.\n\n\
          A file that is used several times is kept in memory once. See [Meshes](meshes.md) for what is read of files.",
    params: &[
        Param::new(
            "file",
            Type::File,
            Default::Absent,
            "A .ply or .obj file, instead of `points` and `faces`.",
        ),
        Param::new("points", Type::List(&Type::Vec3), Default::Absent, "The corners of the faces."),
        Param::new(
            "faces",
            Type::List(&Type::List(&Type::Integer { min: 0, max: u32::MAX as i64 })),
            Default::Absent,
            "For each face the indices of its corners in `points`, which count from 0, in order around it.",
        ),
        Param::new(
            "normals",
            Type::List(&Type::Direction),
            Default::Absent,
            "A normal for each of the `points`, of any length.",
        ),
        Param::new(
            "uvs",
            Type::List(&Type::Vec2),
            Default::Absent,
            "A pair of surface coordinates for each of the `points`.",
        ),
        Param::new(
            "smooth",
            Type::Bool,
            Default::Bool(true),
            "Whether to shade with the normals at the corners.",
        ),
    ],
    example: "mesh(file = \"meshes/knot.ply\", transform = translate((0, 1, 0)), material = plastic(\"tomato\"))",
};

pub(super) fn build(args: &Args, builder: &mut Builder) -> Result<AnyShape, Diagnostic> {
    let lists = ["points", "faces", "normals", "uvs"];
    let smooth = args.bool("smooth")?;
    if args.is_written("file") {
        if let Some(list) = lists.into_iter().find(|name| args.is_written(name)) {
            return Err(args
                .error(list, "wrong-value", format!("mesh has both a file and {list}"))
                .help("leave one of the two away"));
        }
        return builder.mesh(args, "file", smooth).map(AnyShape::Mesh);
    }
    if let Some(missing) = ["points", "faces"].into_iter().find(|name| !args.is_written(name)) {
        return Err(args
            .error_here("missing-argument", format!("mesh needs a file, or {missing}"))
            .help("write file = \"model.ply\", or points = [...] and faces = [...]"));
    }
    let mut data = inline(args)?;
    if !smooth {
        data.normals = Vec::new();
    }
    Ok(AnyShape::Mesh(Arc::new(Mesh::new(data))))
}

/// The mesh that the lists describe.
fn inline(args: &Args) -> Result<MeshData, Diagnostic> {
    let single = |v: [f64; 3]| v.map(|x| x as f32);
    let vectors = |name: &str| -> Result<Vec<[f32; 3]>, Diagnostic> {
        let list = args.list(name)?;
        Ok(list
            .iter()
            .filter_map(|v| if let Value::Vec3(p) = v { Some(single(*p)) } else { None })
            .collect())
    };
    let pair = |v: &Value| if let Value::Vec2(uv) = v { Some(uv.map(|x| x as f32)) } else { None };
    let mut data = MeshData {
        positions: vectors("points")?,
        triangles: Vec::new(),
        normals: vectors("normals")?,
        uvs: args.list("uvs")?.iter().filter_map(pair).collect(),
    };
    let count = data.positions.len();
    for (name, found) in [("normals", data.normals.len()), ("uvs", data.uvs.len())] {
        if found != 0 && found != count {
            return Err(args
                .error(name, "wrong-value", format!("{name} has {found} items for {count} points"))
                .help("give one for each of the points, or none"));
        }
    }
    let mut face: Vec<u32> = Vec::new();
    let mut corners: Vec<[f32; 3]> = Vec::new();
    for (i, indices) in args.list("faces")?.iter().enumerate() {
        face.clear();
        corners.clear();
        for index in indices.items() {
            let Value::Number(index) = index else { continue };
            let Some(corner) = data.positions.get(index as usize) else {
                let message = format!("face {} names point {index}, but there are {count}", i + 1);
                return Err(args
                    .error("faces", "wrong-value", message)
                    .help("the points count from 0"));
            };
            face.push(index as u32);
            corners.push(*corner);
        }
        if face.len() < 3 {
            return Err(args
                .error("faces", "wrong-value", format!("face {} has fewer than 3 corners", i + 1))
                .help("write each face as a list of its own: faces = [[0, 1, 2], [0, 2, 3]]"));
        }
        cut(&corners, |t| data.triangles.push(t.map(|k| face[k])));
    }
    Ok(data)
}
