// SPDX-License-Identifier: MIT OR Apache-2.0
//! The sum of two patterns.

use dioptric_math::Spectrum;
use dioptric_scene::{Args, Category, Diagnostic, Param, Schema, Type};

use super::{Pattern, PatternPoint};
use crate::build::Builder;
use crate::input::ColorInput;

/// One pattern on top of another.
#[derive(Clone, Debug)]
pub struct Add {
    a: ColorInput,
    b: ColorInput,
}

static SCHEMA: Schema = Schema {
    kind: "add",
    category: Category::Pattern,
    summary: "the sum of two patterns",
    doc: "`a + b`, channel by channel in linear light. Sums of heights make bump maps with coarse and fine\n\
          detail; `multiply` weighs the parts.",
    params: &[
        Param::required("a", Type::ColorPattern, "One summand."),
        Param::required("b", Type::ColorPattern, "The other summand."),
    ],
    example: "sphere(center = (0, 1, 0), radius = 1, material = matte(add(dots(\"maroon\", \"black\", size = 0.4), gradient(\"black\", \"teal\", end = (0, 2, 0)))))",
};

impl Pattern for Add {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args, builder: &mut Builder) -> Result<Self, Diagnostic> {
        Ok(Self { a: builder.color(args, "a")?, b: builder.color(args, "b")? })
    }

    fn eval(&self, point: &PatternPoint) -> Spectrum {
        self.a.eval(point) + self.b.eval(point)
    }
}
