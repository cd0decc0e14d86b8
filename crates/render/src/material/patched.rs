// SPDX-License-Identifier: MIT OR Apache-2.0
//! Two materials on one surface: rust on iron, tiles of mirror and stone.

use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::shared::{BUMP, BUMP_HEIGHT, bump};
use super::{AnyMaterial, Bump, Finish, Interior, Material};
use crate::build::Builder;
use crate::input::NumberInput;
use crate::pattern::PatternPoint;

/// One material here, another there.
#[derive(Clone, Debug)]
pub struct Patched {
    first: Box<AnyMaterial>,
    second: Box<AnyMaterial>,
    mask: NumberInput,
    threshold: f64,
    bump: Option<Bump>,
}

static SCHEMA: Schema = Schema {
    kind: "patched",
    category: Category::Material,
    summary: "two materials on one surface, told apart by a pattern",
    doc: "Is `second` where the pattern `mask` is at least `threshold`, else `first`; a checker of 0 and 1 makes\n\
          tiles of two materials. Each point has one of the two, so that they may differ in everything: to blend\n\
          colours use a pattern as the `color` of one material. Bump maps of the two are not used: this has its\n\
          own. Where paths are scattered inside, both must say so alike.",
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
        BUMP,
        BUMP_HEIGHT,
    ],
    example: "sphere(center = (0, 1, 0), radius = 1,\n       \
              material = patched(matte(\"maroon\"), mirror(), mask = checker(0, 1, size = 0.5)))",
};

/// The material that an argument names.
fn part(args: &Args, name: &str, builder: &mut Builder) -> Result<Box<AnyMaterial>, Diagnostic> {
    let id = args.optional_node(name)?.ok_or_else(|| {
        args.error_here("missing-argument", format!("patched needs {name}, a material"))
    })?;
    // A node refers only to earlier nodes, so this recursion ends; readers bound its depth.
    AnyMaterial::from_args(&Args::new(args.description, id), builder).map(Box::new)
}

impl Material for Patched {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args, builder: &mut Builder) -> Result<Self, Diagnostic> {
        Ok(Self {
            first: part(args, "first", builder)?,
            second: part(args, "second", builder)?,
            mask: builder.number(args, "mask")?,
            threshold: args.number("threshold")?,
            bump: bump(args, builder)?,
        })
    }

    fn finish(&self, point: &PatternPoint) -> Finish {
        let second = self.mask.eval(point) >= self.threshold;
        if second { self.second.finish(point) } else { self.first.finish(point) }
    }

    fn is_opaque(&self) -> bool {
        self.first.is_opaque() && self.second.is_opaque()
    }

    fn may_shine(&self) -> bool {
        self.first.may_shine() || self.second.may_shine()
    }

    fn interior(&self) -> Interior {
        // One object has one inside.
        let first = self.first.interior();
        if first == self.second.interior() { first } else { Interior::PLAIN }
    }

    fn bump(&self) -> Option<&Bump> {
        self.bump.as_ref()
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
    fn each_cell_has_its_own_material() {
        let mut scene = Description::default();
        let mut add = |schema, args: &[(&str, Value)]| {
            Value::Node(scene.push(make_node(schema, args).unwrap()))
        };
        let first = add(crate::material::matte::Matte::SCHEMA, &[]);
        let second = add(crate::material::mirror::Mirror::SCHEMA, &[]);
        let checker = crate::pattern::SCHEMAS.iter().find(|s| s.kind == "checker").unwrap();
        let cells = [("even", Value::Number(0.0)), ("odd", Value::Number(1.0))];
        let mask = add(checker, &cells);
        let Value::Node(id) = add(&SCHEMA, &[("first", first), ("second", second), ("mask", mask)])
        else {
            panic!()
        };
        let tiles = with_node(&scene, id, ColorReading::Raw, Patched::from_args).unwrap();
        let at = |x: f64| PatternPoint { object: DVec3::new(x, 0.5, 0.5), ..point() };
        assert_eq!(tiles.finish(&at(0.5)).optics, Optics::Opaque);
        assert!(matches!(tiles.finish(&at(1.5)).optics, Optics::Mirror { .. }));
    }
}
