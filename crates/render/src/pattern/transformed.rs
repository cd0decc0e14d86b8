// SPDX-License-Identifier: MIT OR Apache-2.0
//! A pattern that is moved, turned, stretched or sheared.

use dioptric_geometry::{Transform, placement};
use dioptric_math::{DVec3, Spectrum, normalize};
use dioptric_scene::{Args, Category, Diagnostic, Param, Schema, Type};

use super::{Pattern, PatternPoint};
use crate::build::Builder;
use crate::input::ColorInput;

/// A pattern under a transform.
#[derive(Clone, Debug)]
pub struct Transformed {
    pattern: ColorInput,
    transform: Box<Transform>,
}

static SCHEMA: Schema = Schema {
    kind: "transformed",
    category: Category::Pattern,
    summary: "a pattern that is moved, turned or stretched",
    doc: "What `transform` does to a shape it does to the pattern, in whichever space the pattern lives:\n\
          `rotate` turns it, `scale` by 2 makes it twice as large. In uv space the transforms act on\n\
          `(u, v, 0)`.",
    params: &[
        Param::required("pattern", Type::ColorPattern, "The pattern."),
        Param::required(
            "transform",
            Type::List(&Type::Node(Category::Transform)),
            "One transform or a list of them, applied in the order of the list.",
        ),
    ],
    example: "sphere(center = (0, 1, 0), radius = 1, material = matte(transformed(checker(\"white\", \"seagreen\", size = 0.3), rotate(z = 45))))",
};

impl Pattern for Transformed {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args, builder: &mut Builder) -> Result<Self, Diagnostic> {
        let Some(transform) = Transform::new(placement(args, "transform")?) else {
            return Err(args
                .error("transform", "singular-transform", "these transforms have no inverse")
                .help("choose numbers that do not flatten space"));
        };
        Ok(Self { pattern: builder.color(args, "pattern")?, transform: Box::new(transform) })
    }

    fn eval(&self, point: &PatternPoint) -> Spectrum {
        let back = self.transform.to_local();
        let away = self.transform.to_world().matrix3;
        // Normals go back by the transpose of the way there.
        let normal = |n: DVec3| normalize(away.transpose() * n).unwrap_or(n);
        self.pattern.eval(&PatternPoint {
            object: back.transform_point3(point.object),
            world: back.transform_point3(point.world),
            uv: back.transform_point3(point.uv.extend(0.0)).truncate(),
            object_normal: normal(point.object_normal),
            world_normal: normal(point.world_normal),
            lot: point.lot,
        })
    }
}

#[cfg(test)]
mod tests {
    use crate::pattern::testing::{Bench, at, n, v};
    use dioptric_scene::Value;

    #[test]
    fn the_pattern_moves_as_a_shape_would() {
        let mut bench = Bench::default();
        let inner = bench.node("gradient", &[("end", v(1.0, 0.0, 0.0))]);
        let double = bench.transform("scale", &[("by", n(2.0))]);
        let turn = bench.transform("rotate", &[("z", n(90.0))]);
        let shift = bench.transform("translate", &[("by", v(0.0, 10.0, 0.0))]);
        let list = Value::List([double, turn, shift].map(Value::Node).into());
        let id = bench.node("transformed", &[("pattern", Value::Node(inner)), ("transform", list)]);
        let moved = bench.build(id).unwrap();
        // Twice as long, turned upwards, ten higher: 0 at y = 10, 1 at y = 12.
        for (y, value) in [(9.0, 0.0), (10.5, 0.25), (11.0, 0.5), (12.0, 1.0)] {
            assert!((moved.eval(&at(7.0, y, -3.0)).x - value).abs() < 1e-12, "{y}");
        }
    }

    #[test]
    fn mappings_by_normal_turn_too() {
        let mut bench = Bench::default();
        let turn = bench.transform("rotate", &[("y", n(90.0))]);
        let picture =
            dioptric_image::Image::from_fn(3, 1, dioptric_image::Encoding::Srgb, |x, _| {
                [x as f32 / 2.0; 3]
            });
        let file = dioptric_image::encode(
            &picture.unwrap().into(),
            dioptric_image::FileFormat::Png,
            &dioptric_image::EncodeOptions::default(),
        );
        bench.files = bench.files.with("a.png", file.unwrap());
        let text = |s: &str| Value::Text(s.into());
        let args =
            [("file", text("a.png")), ("mapping", text("asin")), ("filter", text("nearest"))];
        let image = bench.node("image", &args);
        let args = [("pattern", Value::Node(image)), ("transform", Value::Node(turn))];
        let id = bench.node("transformed", &args);
        let turned = bench.build(id).unwrap();
        // The picture's right edge, +x, has come to -z.
        assert_eq!(turned.eval(&at(0.0, 0.0, -1.0)).x, 1.0);
        assert_eq!(turned.eval(&at(0.0, 0.0, 1.0)).x, 0.0);
    }
}
