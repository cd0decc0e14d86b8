// SPDX-License-Identifier: MIT OR Apache-2.0
//! One colour everywhere.

use dioptric_math::Spectrum;
use dioptric_scene::{Args, Category, Diagnostic, Param, Schema, Type};

use super::{Pattern, PatternPoint};
use crate::build::Builder;

/// The same colour at every point.
#[derive(Clone, Copy, Debug)]
pub struct Solid {
    color: Spectrum,
}

static SCHEMA: Schema = Schema {
    kind: "solid",
    category: Category::Pattern,
    summary: "one colour everywhere",
    doc: "A colour may be written wherever a pattern may, so this is needed only where a program wants a\n\
          pattern and nothing else.",
    params: &[Param::required("color", Type::Color, "The colour.")],
    example: "sphere(center = (0, 1, 0), radius = 1, material = matte(solid(\"teal\")))",
};

impl Pattern for Solid {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args, builder: &mut Builder) -> Result<Self, Diagnostic> {
        Ok(Self { color: builder.constant_color(args, "color")? })
    }

    fn eval(&self, _point: &PatternPoint) -> Spectrum {
        self.color
    }
}
