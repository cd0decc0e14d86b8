// SPDX-License-Identifier: MIT OR Apache-2.0
//! `cylinders`: many columns as one shape.

use std::sync::Arc;

use dioptric_geometry::AnyShape;
use dioptric_geometry::pool::Cylinders;
use dioptric_geometry::shapes::cylinder::Cylinder;
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::lists::{ends, no_extent, radii, too_many};
use crate::build::Builder;

pub(super) static SCHEMA: Schema = Schema {
    kind: "cylinders",
    category: Category::Shape,
    summary: "many cylinders at once: bonds, a scaffold",
    doc: "Exact [cylinders](#cylinder) of one material as one shape, made and traced faster than as many single ones, with \
          less memory. Each is a surface of its own; together they are not solid.\n\n\
          `uv`: that of each cylinder. The part of a hit is 4 times the index of the cylinder, from 0, plus 0 for its side, 1 \
          for the disc at its first end, 2 for the other.",
    params: &[
        Param::required(
            "ends",
            Type::List(&Type::Pair(&Type::Vec3, &Type::Vec3)),
            "For each the middles of its two discs.",
        ),
        Param::new("radius", Type::Positive, Default::Number(1.0), "The radius of all."),
        Param::new(
            "radii",
            Type::List(&Type::Positive),
            Default::Absent,
            "A radius for each, instead of `radius`.",
        ),
        Param::new("open", Type::Bool, Default::Bool(false), "Whether to leave the discs away."),
    ],
    example: "corners = [(x, y, z) for x in (-1, 1) for y in (0.1, 1.9) for z in (-1, 1)]\n\
              edges = [(a, b) for a in corners for b in corners\n         \
              if a < b and len([i for i in range(3) if a[i] == b[i]]) == 2]\n\
              cylinders(ends = edges, radius = 0.05, material = metal(\"copper\"))\n\
              spheres(centers = corners, radius = 0.12, material = plastic(\"ivory\"))",
};

pub(super) fn build(args: &Args, _builder: &mut Builder) -> Result<AnyShape, Diagnostic> {
    let ends = ends(args, "ends")?;
    let radii = radii(args, "radius", "radii", ends.len())?;
    let open = args.bool("open")?;
    let mut all = Vec::with_capacity(ends.len());
    for (i, ([a, b], radius)) in ends.into_iter().zip(radii).enumerate() {
        let cylinder = Cylinder::new(a, b - a, radius, open);
        all.push(cylinder.ok_or_else(|| no_extent(args, i, "cylinder", "no length"))?);
    }
    Ok(AnyShape::Cylinders(Arc::new(Cylinders::new(all).ok_or_else(|| too_many(args))?)))
}
