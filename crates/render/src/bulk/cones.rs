// SPDX-License-Identifier: MIT OR Apache-2.0
//! `cones`: many cones as one shape.

use std::sync::Arc;

use dioptric_geometry::AnyShape;
use dioptric_geometry::pool::Cones;
use dioptric_geometry::shapes::cone::Cone;
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::lists::{ends, no_extent, radii, too_many};
use crate::build::Builder;

pub(super) static SCHEMA: Schema = Schema {
    kind: "cones",
    category: Category::Shape,
    summary: "many cones at once: arrows, thorns, branches",
    doc: "Exact [cones](#cone) of one material as one shape, made and traced faster than as many single ones, with less \
          memory. Each is a surface of its own; together they are not solid.\n\n\
          `uv`: that of each cone. The part of a hit is 4 times the index of the cone, from 0, plus 0 for its side, 1 for the \
          disc at its base, 2 for that at its top.",
    params: &[
        Param::required(
            "ends",
            Type::List(&Type::Pair(&Type::Vec3, &Type::Vec3)),
            "For each the middle of its base, and its apex or the middle of its top.",
        ),
        Param::new("radius", Type::NON_NEGATIVE, Default::Number(1.0), "The radius of all bases."),
        Param::new(
            "radii",
            Type::List(&Type::NON_NEGATIVE),
            Default::Absent,
            "A base's radius for each, instead of `radius`.",
        ),
        Param::new(
            "top_radius",
            Type::NON_NEGATIVE,
            Default::Number(0.0),
            "The radius of all tops.",
        ),
        Param::new(
            "top_radii",
            Type::List(&Type::NON_NEGATIVE),
            Default::Absent,
            "A top's radius for each, instead of `top_radius`.",
        ),
        Param::new("open", Type::Bool, Default::Bool(false), "Whether to leave the discs away."),
    ],
    example: "r = random(3)\n\
              def needle(i):\n    \
              x, z = r.uniform(-1.5, 1.5), r.uniform(-1.5, 1.5)\n    \
              return ((x, 0, z), (x + r.uniform(-0.2, 0.2), r.uniform(0.5, 1.6), z))\n\
              cones(ends = [needle(i) for i in range(150)], radius = 0.08, material = matte(\"seagreen\"))",
};

pub(super) fn build(args: &Args, _builder: &mut Builder) -> Result<AnyShape, Diagnostic> {
    let ends = ends(args, "ends")?;
    let bases = radii(args, "radius", "radii", ends.len())?;
    let tops = radii(args, "top_radius", "top_radii", ends.len())?;
    let open = args.bool("open")?;
    let mut all = Vec::with_capacity(ends.len());
    for (i, (([a, b], base), top)) in ends.into_iter().zip(bases).zip(tops).enumerate() {
        let cone = Cone::new(a, b - a, base, top, open);
        let what = if base.max(top) > 0.0 { "no length" } else { "no radius" };
        all.push(cone.ok_or_else(|| no_extent(args, i, "cone", what))?);
    }
    Ok(AnyShape::Cones(Arc::new(Cones::new(all).ok_or_else(|| too_many(args))?)))
}
