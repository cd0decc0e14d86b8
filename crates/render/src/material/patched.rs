// SPDX-License-Identifier: MIT OR Apache-2.0
//! Two materials on one surface: rust on iron, tiles of mirror and stone.

use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::{Dressed, Finish, Interior, Material, Relief};
use crate::build::Builder;
use crate::input::NumberInput;
use crate::pattern::PatternPoint;

/// One material here, another there.
#[derive(Clone, Debug)]
pub struct Patched {
    first: Box<Dressed>,
    second: Box<Dressed>,
    mask: NumberInput,
    threshold: f64,
}

static SCHEMA: Schema = Schema {
    kind: "patched",
    category: Category::Material,
    summary: "two materials on one surface, told apart by a pattern",
    doc: "Is `second` where the pattern `mask` is at least `threshold`, else `first`; a checker of 0 and 1 makes\n\
          tiles of two materials. Each point has one of the two, so that they may differ in everything; to go\n\
          from one to the other gradually use `blend`. The heights of a part's `bump` are added to those of this one's.\n\
          Where paths are scattered inside, both must say so alike.",
    params: &[
        Param::required("first", Type::Node(Category::Material), "Where the mask is low."),
        Param::required("second", Type::Node(Category::Material), "Where the mask is high."),
        Param::required(
            "mask",
            Type::NumberPattern { min: f64::NEG_INFINITY, max: f64::INFINITY },
            "Which of the two is where.",
        ),
        Param::new(
            "threshold",
            Type::NUMBER,
            Default::Number(0.5),
            "From which value of the mask on it is the second.",
        ),
    ],
    example: "sphere(center = (0, 1, 0), radius = 1,\n       \
              material = patched(matte(\"maroon\"), mirror(), mask = checker(0, 1, size = 0.5)))",
};

/// The material that an argument names.
pub(super) fn part(
    args: &Args,
    name: &str,
    builder: &mut Builder,
) -> Result<Box<Dressed>, Diagnostic> {
    let id = args.optional_node(name)?.ok_or_else(|| {
        let kind = args.node().schema.kind;
        args.error_here("missing-argument", format!("{kind} needs {name}, a material"))
    })?;
    // A node refers only to earlier nodes, so this recursion ends; readers bound its depth.
    Dressed::from_args(&Args::new(args.description, id), builder).map(Box::new)
}

/// The inside of an object that is made of two materials, which is one: what both say.
pub(super) fn common(first: &Dressed, second: &Dressed) -> Interior {
    let interior = first.interior();
    if interior == second.interior() { interior } else { Interior::PLAIN }
}

impl Patched {
    fn at(&self, point: &PatternPoint) -> &Dressed {
        if self.mask.eval(point) >= self.threshold { &self.second } else { &self.first }
    }
}

impl Material for Patched {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args, builder: &mut Builder) -> Result<Self, Diagnostic> {
        Ok(Self {
            first: part(args, "first", builder)?,
            second: part(args, "second", builder)?,
            mask: builder.number(args, "mask")?,
            threshold: args.number("threshold")?,
        })
    }

    fn finish(&self, point: &PatternPoint) -> Finish {
        self.at(point).finish(point)
    }

    fn relief<'a>(&'a self, point: &PatternPoint, relief: &mut Relief<'a>) {
        self.at(point).relief(point, relief);
    }

    fn is_opaque(&self) -> bool {
        self.first.is_opaque() && self.second.is_opaque()
    }

    fn may_shine(&self) -> bool {
        self.first.may_shine() || self.second.may_shine()
    }

    fn interior(&self) -> Interior {
        common(&self.first, &self.second)
    }

    fn is_by_lot(&self) -> bool {
        self.first.is_by_lot() || self.second.is_by_lot()
    }

    fn has_holes(&self) -> bool {
        self.first.has_holes() || self.second.has_holes()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::build::ColorReading;
    use crate::material::Optics;
    use crate::material::testing::point;
    use crate::setting::testing::with_node;
    use dioptric_math::DVec3;
    use dioptric_scene::args::make_node;
    use dioptric_scene::{Description, Value};

    #[test]
    fn each_cell_has_its_own_material_and_its_own_relief() {
        let mut scene = Description::default();
        let mut add = |schema, args: &[(&str, Value)]| {
            Value::Node(scene.push(make_node(schema, args).unwrap()))
        };
        let pattern = |kind| *crate::pattern::SCHEMAS.iter().find(|s| s.kind == kind).unwrap();
        let noise = add(pattern("noise"), &[]);
        let first = add(crate::material::matte::Matte::SCHEMA, &[("bump", noise.clone())]);
        let second = add(crate::material::mirror::Mirror::SCHEMA, &[]);
        let cells = [("even", Value::Number(0.0)), ("odd", Value::Number(1.0))];
        let mask = add(pattern("checker"), &cells);
        let arguments = [("first", first), ("second", second), ("mask", mask), ("bump", noise)];
        let Value::Node(id) = add(&SCHEMA, &arguments) else { panic!() };
        let tiles = with_node(&scene, id, ColorReading::Raw, Dressed::from_args).unwrap();
        let at = |x: f64| PatternPoint { object: DVec3::new(x, 0.5, 0.5), ..point() };
        assert_eq!(tiles.finish(&at(0.5)).optics, Optics::Opaque);
        assert!(matches!(tiles.finish(&at(1.5)).optics, Optics::Mirror { .. }));
        for (x, bumps) in [(0.5, 2), (1.5, 1)] {
            let mut relief = Relief::default();
            tiles.relief(&at(x), &mut relief);
            assert_eq!(relief.bumps.len(), bumps);
        }
    }
}
