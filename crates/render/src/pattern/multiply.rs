// SPDX-License-Identifier: MIT OR Apache-2.0
//! The product of two patterns.

use dioptric_math::Spectrum;
use dioptric_scene::{Args, Category, Diagnostic, Param, Schema, Type};

use super::{Pattern, PatternPoint};
use crate::build::Builder;
use crate::input::ColorInput;

/// A filter over a pattern.
#[derive(Clone, Debug)]
pub struct Multiply {
    a: ColorInput,
    b: ColorInput,
}

static SCHEMA: Schema = Schema {
    kind: "multiply",
    category: Category::Pattern,
    summary: "the product of two patterns",
    doc: "`a b`, channel by channel in linear light: tints, stains and dirt.",
    params: &[
        Param::required("a", Type::ColorPattern, "One factor."),
        Param::required("b", Type::ColorPattern, "The other factor."),
    ],
    example: "sphere(center = (0, 1, 0), radius = 1, material = matte(multiply(checker(\"white\", \"tomato\", size = 0.25), noise(0.3, 1, size = 0.3))))",
};

impl Pattern for Multiply {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args, builder: &mut Builder) -> Result<Self, Diagnostic> {
        Ok(Self { a: builder.color(args, "a")?, b: builder.color(args, "b")? })
    }

    fn eval(&self, point: &PatternPoint) -> Spectrum {
        self.a.eval(point) * self.b.eval(point)
    }
}
