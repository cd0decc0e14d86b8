// SPDX-License-Identifier: MIT OR Apache-2.0
//! A surface that shines by itself.

use dioptric_math::Spectrum;
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::{Finish, Material};
use crate::build::Builder;
use crate::input::ColorInput;
use crate::pattern::PatternPoint;

/// Light of its own and nothing else.
#[derive(Clone, Debug)]
pub struct Glow {
    color: ColorInput,
    strength: f64,
}

static SCHEMA: Schema = Schema {
    kind: "glow",
    category: Category::Material,
    summary: "a surface that shines by itself: lamps, screens, the sky as a picture",
    doc: "Shows `strength x color` from everywhere, whatever light falls on it. In Whitted's pictures it lights\n\
          nothing else: put a light where it is. It casts a shadow like anything else.",
    params: &[
        Param::new("color", Type::ColorPattern, Default::Number(1.0), "Its colour."),
        Param::new("strength", Type::NON_NEGATIVE, Default::Number(1.0), "Multiplies the colour."),
    ],
    example: "sphere(center = (0, 1, 0), radius = 0.6, material = glow(\"gold\"))",
};

impl Material for Glow {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args, builder: &mut Builder) -> Result<Self, Diagnostic> {
        Ok(Self { color: builder.color(args, "color")?, strength: args.number("strength")? })
    }

    fn finish(&self, point: &PatternPoint) -> Finish {
        let color = self.color.eval(point);
        Finish { base: color, emission: color * self.strength, ..Finish::matte(Spectrum::ZERO) }
    }

    fn may_shine(&self) -> bool {
        self.strength > 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::testing::{build, point};
    use dioptric_scene::Value;

    #[test]
    fn it_shines_and_reflects_nothing() {
        let lamp = build::<Glow>(&[
            ("color", Value::Vec3([1.0, 0.5, 0.0])),
            ("strength", Value::Number(4.0)),
        ]);
        let finish = lamp.unwrap().finish(&point());
        assert_eq!(finish.emission, Spectrum::new(4.0, 2.0, 0.0));
        assert_eq!((finish.ambient, finish.diffuse), (Spectrum::ZERO, Spectrum::ZERO));
    }
}
