// SPDX-License-Identifier: MIT OR Apache-2.0
//! Rhombi from two crossing families of diagonal stripes: the report's tree.

use dioptric_math::Spectrum;
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::place::{self, Place, is_even};
use super::{Pattern, PatternPoint, Space};
use crate::build::Builder;
use crate::input::ColorInput;

/// Diagonal stripes, joined by "or".
#[derive(Clone, Debug)]
pub struct Lattice {
    even: ColorInput,
    odd: ColorInput,
    truncate: bool,
    place: Place,
}

static SCHEMA: Schema = Schema {
    kind: "lattice",
    category: Category::Pattern,
    summary: "rhombi left open by crossing diagonal stripes",
    doc: "With x and y in units of `size`, counted from `offset`: the first colour where `floor(x - y)` is\n\
          even or `floor(x + y)` is even, the second elsewhere, so that a quarter of the surface gets the\n\
          second colour. z does not count.\n\n\
          `rounding = \"truncate\"` rounds towards zero instead, as `(int)` does in many languages. That\n\
          makes the stripe at zero twice as wide; old pictures need it.",
    params: &[
        Param::required("even", Type::ColorPattern, "Colour of the stripes."),
        Param::required("odd", Type::ColorPattern, "Colour of the rhombi between them."),
        Param::new(
            "size",
            Type::Scale,
            Default::Number(1.0),
            "The unit of x and y; a stripe is size / sqrt(2) wide.",
        ),
        Param::new(
            "rounding",
            Type::Choice(&["floor", "truncate"]),
            Default::Text("floor"),
            "How x - y and x + y become whole numbers: down, or towards zero.",
        ),
        place::OFFSET,
        Param::new(
            "space",
            Type::Choice(Space::NAMES),
            Default::Text("world"),
            "Where the pattern lives: \"object\", \"world\" or \"uv\".",
        ),
    ],
    example: "sphere(center = (0, 1, 0), radius = 1, material = matte(lattice(\"limegreen\", \"black\", size = 0.2)))",
};

impl Pattern for Lattice {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args, builder: &mut Builder) -> Result<Self, Diagnostic> {
        Ok(Self {
            even: builder.color(args, "even")?,
            odd: builder.color(args, "odd")?,
            truncate: &*args.text("rounding")? == "truncate",
            place: Place::from_args(args)?,
        })
    }

    fn eval(&self, point: &PatternPoint) -> Spectrum {
        let p = self.place.of(point);
        let stripe = |x: f64| is_even(if self.truncate { x.trunc() } else { x.floor() });
        if stripe(p.x - p.y) || stripe(p.x + p.y) {
            self.even.eval(point)
        } else {
            self.odd.eval(point)
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::pattern::testing::{at, grey, n, pattern, t};
    use dioptric_math::random::Random;

    #[test]
    fn truncation_is_the_reports_formula() {
        let args = [("even", n(1.0)), ("odd", n(0.0)), ("rounding", t("truncate"))];
        let report = pattern("lattice", &args);
        let mut r = Random::new(3);
        for _ in 0..2000 {
            let (x, y) = (r.uniform(-20.0, 20.0), r.uniform(-20.0, 20.0));
            let green = ((x - y) as i64) % 2 == 0 || ((x + y) as i64) % 2 == 0;
            assert_eq!(report.eval(&at(x, y, -90.0)), grey(f64::from(green)), "{x} {y}");
        }
    }

    #[test]
    fn stripes_of_floor_are_equally_wide_and_those_of_truncation_are_not() {
        let floor = pattern("lattice", &[("even", n(1.0)), ("odd", n(0.0))]);
        let truncate =
            pattern("lattice", &[("even", n(1.0)), ("odd", n(0.0)), ("rounding", t("truncate"))]);
        // On the line x + y = 1.5 the second family is odd either way: what is left is x - y.
        let run = |pattern: &crate::pattern::AnyPattern, from: f64| {
            let mut steps = 0;
            while steps < 10_000 {
                let d = from + f64::from(steps) * 1e-3;
                let (x, y) = ((1.5 + d) / 2.0, (1.5 - d) / 2.0);
                if pattern.eval(&at(x, y, 0.0)) != grey(1.0) {
                    break;
                }
                steps += 1;
            }
            steps
        };
        assert!((999..=1001).contains(&run(&floor, 0.0005)), "floor, at zero");
        assert!((999..=1001).contains(&run(&floor, 2.0005)), "floor, elsewhere");
        assert!((1998..=2001).contains(&run(&truncate, -0.9995)), "fault 8: twice as wide");
    }

    #[test]
    fn a_quarter_is_odd() {
        let floor = pattern("lattice", &[("even", n(1.0)), ("odd", n(0.0)), ("size", n(0.3))]);
        let mut r = Random::new(8);
        let odd = (0..20_000)
            .filter(|_| {
                floor.eval(&at(r.uniform(-9.0, 9.0), r.uniform(-9.0, 9.0), 0.0)) == grey(0.0)
            })
            .count();
        assert!((4800..5200).contains(&odd), "{odd}");
    }
}
