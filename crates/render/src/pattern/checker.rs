// SPDX-License-Identifier: MIT OR Apache-2.0
//! Cubes of two colours in turn.

use dioptric_math::Spectrum;
use dioptric_scene::{Args, Category, Diagnostic, Param, Schema, Type};

use super::place::{self, Place, is_even};
use super::{Pattern, PatternPoint};
use crate::build::Builder;
use crate::input::ColorInput;

/// A checkerboard in space.
#[derive(Clone, Debug)]
pub struct Checker {
    even: ColorInput,
    odd: ColorInput,
    place: Place,
}

static SCHEMA: Schema = Schema {
    kind: "checker",
    category: Category::Pattern,
    summary: "cubes or squares of two colours in turn",
    doc: "The cell is found with floor, so that the cell at zero is as wide as any other; cells whose three\n\
          indices sum to an even number get the first colour. A lane whose size is 0 does not count: with\n\
          `size = (4, 0, 4)` a floor is checked in x and z only.",
    params: &[
        Param::required(
            "even",
            Type::ColorPattern,
            "Colour where the indices of the cell sum to an even number.",
        ),
        Param::required("odd", Type::ColorPattern, "Colour of the other cells."),
        place::SIZE,
        place::OFFSET,
        place::SPACE,
    ],
    example: "sphere(center = (0, 1, 0), radius = 1, material = matte(checker(\"ivory\", \"firebrick\", size = 0.5)))",
};

impl Pattern for Checker {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args, builder: &mut Builder) -> Result<Self, Diagnostic> {
        Ok(Self {
            even: builder.color(args, "even")?,
            odd: builder.color(args, "odd")?,
            place: Place::from_args(args)?,
        })
    }

    fn eval(&self, point: &PatternPoint) -> Spectrum {
        let cell = self.place.of(point).floor();
        if is_even(cell.x + cell.y + cell.z) { self.even.eval(point) } else { self.odd.eval(point) }
    }
}

#[cfg(test)]
mod tests {
    use crate::pattern::testing::{at, grey, n, pattern, t, v};
    use dioptric_math::random::Random;

    #[test]
    fn the_reports_floor() {
        let floor = pattern(
            "checker",
            &[
                ("even", n(0.2)),
                ("odd", n(1.0)),
                ("size", v(4.0, 0.0, 4.0)),
                ("offset", v(-200.0, 0.0, -200.0)),
                ("space", t("world")),
            ],
        );
        let mut r = Random::new(5);
        for i in 0..2000 {
            let (mut x, mut z) = (r.uniform(-60.0, 60.0), r.uniform(-200.0, -40.0));
            if i % 2 == 0 {
                (x, z) = ((x / 4.0).floor() * 4.0, (z / 4.0).floor() * 4.0);
            }
            let index = |x: f64| ((x + 200.0) / 4.0).floor() as i64;
            let dark = index(x).rem_euclid(2) == index(z).rem_euclid(2);
            assert_eq!(floor.eval(&at(x, -20.0, z)), grey(if dark { 0.2 } else { 1.0 }), "{x} {z}");
        }
    }

    #[test]
    fn the_cell_at_zero_is_as_wide_as_any_other() {
        let c = pattern("checker", &[("even", n(1.0)), ("odd", n(0.0))]);
        assert_eq!(c.eval(&at(0.5, 0.5, 0.5)), grey(1.0));
        assert_eq!(c.eval(&at(-0.5, 0.5, 0.5)), grey(0.0));
        assert_eq!(c.eval(&at(-1.5, 0.5, 0.5)), grey(1.0));
        // Fault 8: the same colour on both sides of zero.
        let faulty = |x: f64| (x as i32) % 2 == 0;
        assert_eq!(faulty(0.5), faulty(-0.5));
    }
}
