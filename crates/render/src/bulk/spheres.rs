// SPDX-License-Identifier: MIT OR Apache-2.0
//! `spheres`: a million atoms as one shape.

use std::sync::Arc;

use dioptric_geometry::AnyShape;
use dioptric_geometry::pool::Spheres;
use dioptric_geometry::shapes::sphere::Sphere;
use dioptric_math::DVec3;
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::lists::{points, radii, too_many};
use crate::build::Builder;

pub(super) static SCHEMA: Schema = Schema {
    kind: "spheres",
    category: Category::Shape,
    summary: "many spheres at once: atoms, a point cloud",
    doc: "Exact spheres of one material as one shape, made and traced faster than as many single ones, with less memory. \
          The centres come from a list or from the points of a PLY or OBJ file; a PLY file's property `radius` gives each \
          its radius where neither `radius` nor `radii` is written.\n\n\
          Each is a surface of its own, hit from outside and inside; together they are not solid: glass balls are \
          written as single spheres.\n\n\
          `uv`: that of each [sphere](#sphere). The part of a hit is the index of the sphere, from 0.",
    params: &[
        Param::new("centers", Type::List(&Type::Vec3), Default::Absent, "The centres."),
        Param::new(
            "radius",
            Type::Positive,
            Default::Number(1.0),
            "The radius of all; without it, that in the file.",
        ),
        Param::new(
            "radii",
            Type::List(&Type::Positive),
            Default::Absent,
            "A radius for each, instead of `radius`.",
        ),
        Param::new(
            "file",
            Type::File,
            Default::Absent,
            "A .ply or .obj file whose points are the centres, instead of `centers`.",
        ),
    ],
    example: "helix = [(0.9 * cos(0.42 * i), 0.1 + 0.03 * i, 0.9 * sin(0.42 * i)) for i in range(60)]\n\
              spheres(centers = helix, radii = [0.06 + 0.0012 * i for i in range(60)], material = plastic(\"teal\"))",
};

pub(super) fn build(args: &Args, builder: &mut Builder) -> Result<AnyShape, Diagnostic> {
    let (centers, from_file) = match (args.is_written("centers"), args.is_written("file")) {
        (true, false) => (points(args, "centers")?, None),
        (false, true) => {
            let model = builder.model(args, "file")?;
            let centers = model.mesh.positions.iter().map(|p| DVec3::from(p.map(f64::from)));
            let is_free = !args.is_written("radius") && !args.is_written("radii");
            (centers.collect(), Some(model).filter(|m| is_free && !m.radii.is_empty()))
        }
        (true, true) => {
            return Err(args
                .error("file", "wrong-value", "spheres has both centers and a file")
                .help("leave one of the two away"));
        }
        (false, false) => {
            return Err(args
                .error_here("missing-argument", "spheres needs centers, or a file")
                .help("write centers = [(0, 0, 0), ...] or file = \"atoms.ply\""));
        }
    };
    let radii = match from_file {
        Some(model) => model.radii.iter().map(|&r| f64::from(r)).collect(),
        None => radii(args, "radius", "radii", centers.len())?,
    };
    // What a file says about a radius may be anything: the pool leaves out those that are NaN.
    let radii = radii.into_iter().map(|r| if r > 0.0 { r } else { f64::NAN });
    let spheres = centers.into_iter().zip(radii).map(|(c, r)| Sphere::new(c, r)).collect();
    Ok(AnyShape::Spheres(Arc::new(Spheres::new(spheres).ok_or_else(|| too_many(args))?)))
}
