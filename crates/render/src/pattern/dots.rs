// SPDX-License-Identifier: MIT OR Apache-2.0
//! Round dots on a grid.

use dioptric_math::Spectrum;
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::place::{self, Place, blend, smooth_step};
use super::{Pattern, PatternPoint};
use crate::build::Builder;
use crate::input::{ColorInput, NumberInput};

/// Balls on a grid in space; dots where a surface cuts them.
#[derive(Clone, Debug)]
pub struct Dots {
    dot: ColorInput,
    base: ColorInput,
    radius: NumberInput,
    softness: f64,
    place: Place,
}

static SCHEMA: Schema = Schema {
    kind: "dots",
    category: Category::Pattern,
    summary: "round dots on a grid",
    doc: "A dot's centre lies at `offset` and at every multiple of `size` from there. In space the dots are\n\
          balls, so that a surface shows those which it cuts; a lane of `size` that is 0 does not count, so\n\
          that `size = (1, 0, 1)` makes columns and `space = \"uv\"` with `size = (0.1, 0.1, 0)` discs.\n\n\
          A radius that is a pattern makes a halftone.",
    params: &[
        Param::required("dot", Type::ColorPattern, "Colour of the dots."),
        Param::required("base", Type::ColorPattern, "Colour between them."),
        Param::new(
            "size",
            Type::Scale,
            Default::Number(1.0),
            "Distances of the dots; 0 leaves a direction out.",
        ),
        Param::new(
            "radius",
            Type::UNIT_PATTERN,
            Default::Number(0.3),
            "Radius of a dot as a share of `size`; from 0.5 on neighbours touch.",
        ),
        Param::new(
            "softness",
            Type::UNIT,
            Default::Number(0.0),
            "Width of the soft edge inside the dot, as a share of `size`; 0 is sharp.",
        ),
        place::OFFSET,
        place::SPACE,
    ],
    example: "sphere(center = (0, 1, 0), radius = 1, material = matte(dots(\"crimson\", \"white\", size = 0.4)))",
};

impl Pattern for Dots {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args, builder: &mut Builder) -> Result<Self, Diagnostic> {
        Ok(Self {
            dot: builder.color(args, "dot")?,
            base: builder.color(args, "base")?,
            radius: builder.number(args, "radius")?,
            softness: args.number("softness")?,
            place: Place::from_args(args)?,
        })
    }

    fn eval(&self, point: &PatternPoint) -> Spectrum {
        let p = self.place.of(point);
        let distance = (p - (p + 0.5).floor()).length();
        let radius = self.radius.eval(point);
        blend(&self.base, &self.dot, smooth_step(0.0, self.softness, radius - distance), point)
    }
}

#[cfg(test)]
mod tests {
    use crate::pattern::testing::{at, grey, n, pattern, v};

    #[test]
    fn dots_are_round_and_at_every_multiple() {
        let args = [("dot", n(1.0)), ("base", n(0.0)), ("radius", n(0.25)), ("size", n(2.0))];
        let d = pattern("dots", &args);
        for (x, y, z, value) in [
            (0.0, 0.0, 0.0, 1.0),
            (-4.0, 2.0, 6.0, 1.0),
            (0.5, 0.0, 0.0, 1.0),
            (0.51, 0.0, 0.0, 0.0),
            (-0.49, 0.0, 0.0, 1.0),
            (0.4, 0.4, 0.0, 0.0),
            (1.0, 1.0, 1.0, 0.0),
        ] {
            assert_eq!(d.eval(&at(x, y, z)), grey(value), "{x} {y} {z}");
        }
        let columns =
            pattern("dots", &[("dot", n(1.0)), ("base", n(0.0)), ("size", v(1.0, 0.0, 1.0))]);
        assert_eq!(columns.eval(&at(3.0, 0.5, -2.0)), grey(1.0));
    }
}
