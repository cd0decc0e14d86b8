// SPDX-License-Identifier: MIT OR Apache-2.0
//! Paper, chalk, plaster: the same brightness from everywhere.

use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::{Finish, Material};
use crate::build::Builder;
use crate::input::ColorInput;
use crate::pattern::PatternPoint;

/// Lambert's surface.
#[derive(Clone, Debug)]
pub struct Matte {
    color: ColorInput,
}

static SCHEMA: Schema = Schema {
    kind: "matte",
    category: Category::Material,
    summary: "a dull surface, equally bright from everywhere",
    doc: "Reflects light by the cosine of its angle to the normal (Lambert, \"Photometria\", 1760).",
    params: &[Param::new(
        "color",
        Type::ColorPattern,
        Default::Number(0.8),
        "How much light it reflects.",
    )],
    example: "sphere(center = (0, 1, 0), radius = 1, material = matte(\"peru\"))",
};

impl Material for Matte {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args, builder: &mut Builder) -> Result<Self, Diagnostic> {
        Ok(Self { color: builder.color(args, "color")? })
    }

    fn finish(&self, point: &PatternPoint) -> Finish {
        Finish::matte(self.color.eval(point))
    }
}
