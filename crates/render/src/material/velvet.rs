// SPDX-License-Identifier: MIT OR Apache-2.0
//! Cloth with fibres that stand up: velvet, felt, a peach.

use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::principled::{FuzzInput, SHEEN_COLOR, layered};
use super::shared::unit_color;
use super::{Finish, Layers, Material};
use crate::build::Builder;
use crate::input::ColorInput;
use crate::pattern::PatternPoint;

/// A dull ground under fuzz.
#[derive(Clone, Debug)]
pub struct Velvet {
    color: ColorInput,
    fuzz: FuzzInput,
}

static SCHEMA: Schema = Schema {
    kind: "velvet",
    category: Category::Material,
    summary: "cloth with fibres that stand up and shine at the rim: velvet, felt, a peach",
    doc: "A dull `color` under fibres that stand up from it. They shine where light or view grazes the surface: the rim of a\n\
          ball, the folds of a curtain (Estevez and Kulla, \"Production Friendly Microfacet Sheen BRDF\", SIGGRAPH\n\
          2017 course). What they send back is taken from what the ground gets and sends, so that white stays white. It\n\
          is the fuzz of `principled` by itself.\n\n\
          Whitted's pictures show it as a dull surface that is lighter by what the fibres send back in the mean; the\n\
          rim is for paths.",
    params: &[
        Param::new(
            "color",
            Type::ColorPattern,
            Default::Number(0.2),
            "Colour of the ground, each lane at most 1.",
        ),
        Param::new("sheen", Type::UNIT_PATTERN, Default::Number(1.0), "How dense the fibres are."),
        SHEEN_COLOR,
        Param::new(
            "roughness",
            Type::UNIT_PATTERN,
            Default::Number(0.4),
            "How far from upright they stand: the wider, the less they shine at the rim only.",
        ),
    ],
    example: "# By paths: Whitted's pictures do not show the rim.\n\
              render(size = (320, 240), integrator = \"path\", samples = 64)\n\
              sphere(center = (-1.1, 0.8, 0), radius = 0.8, material = velvet(\"midnightblue\", sheen_color = \"lightsteelblue\"))\n\
              sphere(center = (1.1, 0.8, 0), radius = 0.8, material = matte(\"midnightblue\"))",
};

impl Material for Velvet {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args, builder: &mut Builder) -> Result<Self, Diagnostic> {
        Ok(Self {
            color: builder.color(args, "color")?,
            fuzz: FuzzInput::from_args(args, "roughness", builder)?,
        })
    }

    fn finish(&self, point: &PatternPoint) -> Finish {
        let (sheen, sheen_roughness) = self.fuzz.at(point);
        layered(
            unit_color(&self.color, point),
            Layers {
                ior: 1.0,
                specular: 0.0,
                metallic: 0.0,
                alpha: 0.0,
                transmission: 0.0,
                coat: 0.0,
                coat_alpha: 0.0,
                sheen,
                sheen_roughness,
            },
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::Optics;
    use crate::material::testing::{build, point};
    use dioptric_math::Spectrum;
    use dioptric_scene::Value;

    #[test]
    fn it_is_dull_and_mirrors_nothing() {
        let finish = build::<Velvet>(&[("sheen", Value::Number(0.0))]).unwrap().finish(&point());
        assert_eq!((finish.diffuse, finish.highlight), (Spectrum::splat(0.2), None));
        let Optics::Layered(layers) = finish.optics else { panic!() };
        assert_eq!(layers.mirrors(finish.base, 0.1), Spectrum::ZERO);
    }
}
