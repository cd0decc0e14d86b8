// SPDX-License-Identifier: MIT OR Apache-2.0
//! Layers of two colours in turn.

use dioptric_math::{DVec3, Spectrum, normalize};
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::place::{self, blend, is_even, smooth_step};
use super::{Pattern, PatternPoint, Space};
use crate::build::Builder;
use crate::input::ColorInput;

/// Parallel stripes; slabs in space.
#[derive(Clone, Debug)]
pub struct Stripes {
    even: ColorInput,
    odd: ColorInput,
    /// Unit vector across the stripes.
    direction: DVec3,
    size: f64,
    softness: f64,
    offset: DVec3,
    space: Space,
}

static SCHEMA: Schema = Schema {
    kind: "stripes",
    category: Category::Pattern,
    summary: "stripes of two colours in turn",
    doc: "Stripe i reaches from `i size` to `(i + 1) size` along `direction`, counted from `offset`; i is\n\
          found with floor, so that all are equally wide, and even stripes get the first colour. Stripes of\n\
          more colours are a `ramp` with `interpolation = \"constant\"` over a `gradient` with\n\
          `wrap = \"repeat\"`.",
    params: &[
        Param::required("even", Type::ColorPattern, "Colour of stripes 0, 2, 4 and so on."),
        Param::required("odd", Type::ColorPattern, "Colour of the others."),
        Param::new("size", Type::Positive, Default::Number(1.0), "Width of one stripe."),
        Param::new(
            "direction",
            Type::Direction,
            Default::Vec3([1.0, 0.0, 0.0]),
            "Across the stripes; its length does not count.",
        ),
        Param::new(
            "softness",
            Type::UNIT,
            Default::Number(0.0),
            "Share of a stripe's width over which the colours blend at each edge; 0 is sharp.",
        ),
        place::OFFSET,
        place::SPACE,
    ],
    example: "sphere(center = (0, 1, 0), radius = 1, material = matte(stripes(\"ivory\", \"navy\", size = 0.2, direction = (1, 1, 0))))",
};

impl Pattern for Stripes {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args, builder: &mut Builder) -> Result<Self, Diagnostic> {
        Ok(Self {
            even: builder.color(args, "even")?,
            odd: builder.color(args, "odd")?,
            direction: normalize(args.vec3("direction")?.into()).unwrap_or(DVec3::X),
            size: args.number("size")?,
            softness: args.number("softness")?,
            offset: args.vec3("offset")?.into(),
            space: place::space(args)?,
        })
    }

    fn eval(&self, point: &PatternPoint) -> Spectrum {
        let x = (self.space.of(point) - self.offset).dot(self.direction) / self.size;
        let index = x.floor();
        let (here, other) =
            if is_even(index) { (&self.even, &self.odd) } else { (&self.odd, &self.even) };
        if self.softness == 0.0 {
            return here.eval(point);
        }
        // From half of each colour on the edge to the stripe's own within half the softness.
        let inside = 0.5 - (x - index - 0.5).abs();
        let own = smooth_step(-0.5 * self.softness, self.softness, inside);
        blend(other, here, own, point)
    }
}

#[cfg(test)]
mod tests {
    use crate::pattern::testing::{at, grey, n, pattern, v};

    #[test]
    fn all_stripes_are_equally_wide_at_zero_too() {
        let s = pattern("stripes", &[("even", n(1.0)), ("odd", n(0.0)), ("size", n(2.0))]);
        for (x, value) in
            [(-4.0, 1.0), (-2.1, 1.0), (-2.0, 0.0), (-0.1, 0.0), (0.0, 1.0), (1.9, 1.0), (2.0, 0.0)]
        {
            assert_eq!(s.eval(&at(x, 5.0, 7.0)), grey(value), "{x}");
        }
        // Fault 8: the same colour on both sides of zero.
        let faulty = |x: f64| ((x / 2.0) as i64) % 2 == 0;
        assert_eq!(faulty(-0.1), faulty(0.1));
    }

    #[test]
    fn soft_edges_are_half_and_half_on_the_edge() {
        let s = pattern(
            "stripes",
            &[
                ("even", n(1.0)),
                ("odd", n(0.0)),
                ("direction", v(0.0, 3.0, 0.0)),
                ("softness", n(0.5)),
            ],
        );
        for (y, value) in [(0.5, 1.0), (0.75, 1.0), (1.0, 0.5), (1.25, 0.0), (1.5, 0.0), (2.0, 0.5)]
        {
            assert_eq!(s.eval(&at(9.0, y, 0.0)), grey(value), "{y}");
        }
        assert!(s.eval(&at(0.0, 0.9, 0.0)).x > 0.5 && s.eval(&at(0.0, 1.1, 0.0)).x < 0.5);
    }
}
