// SPDX-License-Identifier: MIT OR Apache-2.0
//! Cubes of two colours in turn.

use dioptric_math::{DVec3, Spectrum};
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::{Pattern, PatternPoint, Space};
use crate::build::Builder;
use crate::input::ColorInput;

/// A checkerboard in space.
#[derive(Clone, Debug)]
pub struct Checker {
    even: ColorInput,
    odd: ColorInput,
    size: DVec3,
    offset: DVec3,
    space: Space,
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
        Param::new(
            "size",
            Type::Scale,
            Default::Number(1.0),
            "Edge lengths of a cell; 0 leaves a direction out.",
        ),
        Param::new(
            "offset",
            Type::Vec3,
            Default::Vec3([0.0; 3]),
            "A corner of the cell (0, 0, 0).",
        ),
        Param::new(
            "space",
            Type::Choice(Space::NAMES),
            Default::Text("object"),
            "Where the pattern lives.",
        ),
    ],
    example: "sphere(center = (0, 1, 0), radius = 1, material = matte(checker(\"ivory\", \"firebrick\", size = 0.5)))",
};

impl Pattern for Checker {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args, builder: &mut Builder) -> Result<Self, Diagnostic> {
        let size = DVec3::from(args.vec3("size")?);
        if size.min_element() < 0.0 {
            return Err(args.error(
                "size",
                "wrong-value",
                "size of checker: expected numbers of at least 0",
            ));
        }
        Ok(Self {
            even: builder.color(args, "even")?,
            odd: builder.color(args, "odd")?,
            size,
            offset: args.vec3("offset")?.into(),
            space: Space::from_name(&args.text("space")?).unwrap_or(Space::Object),
        })
    }

    fn eval(&self, point: &PatternPoint) -> Spectrum {
        let p = self.space.of(point) - self.offset;
        let index = |x: f64, size: f64| if size > 0.0 { (x / size).floor() } else { 0.0 };
        let sum = index(p.x, self.size.x) + index(p.y, self.size.y) + index(p.z, self.size.z);
        // Euclidean remainder in f64: right for negative cells and for cells beyond any integer.
        if sum.rem_euclid(2.0) == 0.0 { self.even.eval(point) } else { self.odd.eval(point) }
    }
}
