// SPDX-License-Identifier: MIT OR Apache-2.0
//! Courses of bricks with mortar between.

use dioptric_math::{DVec3, Spectrum};
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::place::{self, Place, blend, is_even, smooth_step};
use super::{Pattern, PatternPoint};
use crate::build::Builder;
use crate::input::ColorInput;

/// A wall.
#[derive(Clone, Debug)]
pub struct Bricks {
    brick: ColorInput,
    mortar: ColorInput,
    joint: f64,
    shift: f64,
    softness: f64,
    place: Place,
}

static SCHEMA: Schema = Schema {
    kind: "bricks",
    category: Category::Pattern,
    summary: "bricks with mortar between them",
    doc: "`size` is the length (x), height (y) and depth (z) of a brick with its share of mortar; the mortar\n\
          fills half of `joint` on each side of the borders. Courses begin at y = 0, counted from `offset`;\n\
          neighbouring courses are moved by `shift` of a brick against each other in x and z. With the usual\n\
          half, walls at whole and half multiples of the length or depth lie a quarter of a brick away from\n\
          the nearest joint and show bricks, not the mortar behind them. A lane of `size` that is 0 does not\n\
          count: `size = (0.4, 0.15, 0)` is a flat pattern.\n\n\
          With a `softness` the pattern makes a good bump map.",
    params: &[
        Param::new(
            "brick",
            Type::ColorPattern,
            Default::Vec3([0.55, 0.2, 0.13]),
            "Colour of the bricks.",
        ),
        Param::new("mortar", Type::ColorPattern, Default::Number(0.7), "Colour of the mortar."),
        Param::new(
            "size",
            Type::Scale,
            Default::Vec3([0.4, 0.15, 0.2]),
            "Length, height and depth of a brick; 0 leaves a direction out.",
        ),
        Param::new("joint", Type::NON_NEGATIVE, Default::Number(0.02), "Thickness of the mortar."),
        Param::new(
            "shift",
            Type::UNIT,
            Default::Number(0.5),
            "How far neighbouring courses are moved against each other, in bricks.",
        ),
        Param::new(
            "softness",
            Type::NON_NEGATIVE,
            Default::Number(0.0),
            "Width of the soft edge of the bricks, as a length; 0 is sharp.",
        ),
        place::OFFSET,
        place::SPACE,
    ],
    example: "box(min = (-1, 0, -1), max = (1, 2, 1), material = matte(bricks()))",
};

impl Pattern for Bricks {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args, builder: &mut Builder) -> Result<Self, Diagnostic> {
        Ok(Self {
            brick: builder.color(args, "brick")?,
            mortar: builder.color(args, "mortar")?,
            joint: args.number("joint")?,
            shift: args.number("shift")?,
            softness: args.number("softness")?,
            place: Place::from_args(args)?,
        })
    }

    fn eval(&self, point: &PatternPoint) -> Spectrum {
        let (p, size) = (self.place.of(point), self.place.size());
        let shift = if is_even(p.y.floor()) { 0.5 * self.shift } else { -0.5 * self.shift };
        let p = DVec3::new(p.x + shift + 0.5, p.y, p.z + shift + 0.5);
        // Distance to the nearest border, in the units of the space.
        let border = |x: f64, size: f64| {
            if size > 0.0 { (0.5 - (x - x.floor() - 0.5).abs()) * size } else { f64::INFINITY }
        };
        let d = border(p.x, size.x).min(border(p.y, size.y)).min(border(p.z, size.z));
        let t = smooth_step(0.5 * self.joint, self.softness, d);
        blend(&self.mortar, &self.brick, t, point)
    }
}

#[cfg(test)]
mod tests {
    use crate::pattern::testing::{at, grey, n, pattern, v};

    #[test]
    fn joints_lie_on_the_borders_and_courses_are_shifted() {
        let wall = pattern(
            "bricks",
            &[("brick", n(1.0)), ("mortar", n(0.0)), ("size", v(2.0, 1.0, 0.0)), ("joint", n(0.2))],
        );
        for (x, y, value) in [
            // Borders at x = 0.5 and every 2 from there in even courses, at -0.5 in odd ones.
            (0.0, 0.5, 1.0),
            (0.39, 0.5, 1.0),
            (0.41, 0.5, 0.0),
            (0.59, 0.5, 0.0),
            (0.61, 0.5, 1.0),
            (-1.45, 0.5, 0.0),
            (-0.5, 0.5, 1.0),
            (-0.5, 1.5, 0.0),
            (0.5, 1.5, 1.0),
            (1.55, -0.5, 0.0),
            // Between the courses.
            (0.0, 0.09, 0.0),
            (0.0, 0.11, 1.0),
            (0.0, 0.95, 0.0),
        ] {
            assert_eq!(wall.eval(&at(x, y, 12.3)), grey(value), "{x} {y}");
        }
    }

    #[test]
    fn walls_at_whole_and_half_multiples_show_bricks() {
        let wall = pattern("bricks", &[("brick", n(1.0)), ("mortar", n(0.0))]);
        for z in [0.0, 0.1, 0.2, 1.0, -1.0, 3.3] {
            for y in [0.05, 0.2] {
                assert_eq!(wall.eval(&at(0.0, y, z)), grey(1.0), "{z} {y}");
                assert_eq!(wall.eval(&at(2.0 * z, y, 0.0)), grey(1.0), "{z} {y}");
            }
        }
    }
}
