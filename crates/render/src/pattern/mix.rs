// SPDX-License-Identifier: MIT OR Apache-2.0
//! Two patterns, blended by a third.

use dioptric_math::Spectrum;
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::place::blend;
use super::{Pattern, PatternPoint};
use crate::build::Builder;
use crate::input::{ColorInput, NumberInput};

/// A share of one, the rest of the other.
#[derive(Clone, Debug)]
pub struct Mix {
    a: ColorInput,
    b: ColorInput,
    amount: NumberInput,
}

static SCHEMA: Schema = Schema {
    kind: "mix",
    category: Category::Pattern,
    summary: "two patterns, blended by a number or a third pattern",
    doc: "`(1 - amount) a + amount b`, in linear light; an `amount` below 0 counts as 0, above 1 as 1.",
    params: &[
        Param::required("a", Type::ColorPattern, "What shows where `amount` is 0."),
        Param::required("b", Type::ColorPattern, "What shows where `amount` is 1."),
        Param::new("amount", Type::UNIT_PATTERN, Default::Number(0.5), "The share of `b`."),
    ],
    example: "sphere(center = (0, 1, 0), radius = 1, material = matte(mix(checker(\"white\", \"black\", size = 0.25), \"gold\", gradient(end = (0, 2, 0)))))",
};

impl Pattern for Mix {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args, builder: &mut Builder) -> Result<Self, Diagnostic> {
        Ok(Self {
            a: builder.color(args, "a")?,
            b: builder.color(args, "b")?,
            amount: builder.number(args, "amount")?,
        })
    }

    fn eval(&self, point: &PatternPoint) -> Spectrum {
        blend(&self.a, &self.b, self.amount.eval(point), point)
    }
}
