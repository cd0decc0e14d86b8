// SPDX-License-Identifier: MIT OR Apache-2.0
//! Paper, chalk, plaster: the same brightness from everywhere.

use dioptric_math::Spectrum;
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::shared::{AMBIENT, unit};
use super::{Finish, Material};
use crate::build::Builder;
use crate::input::{ColorInput, NumberInput};
use crate::pattern::PatternPoint;

/// Lambert's surface.
#[derive(Clone, Debug)]
pub struct Matte {
    color: ColorInput,
    ambient: NumberInput,
    roughness: NumberInput,
}

static SCHEMA: Schema = Schema {
    kind: "matte",
    category: Category::Material,
    summary: "a dull surface, equally bright from everywhere",
    doc: "Reflects light by the cosine of its angle to the normal (Lambert, \"Photometria\", 1760):\n\
          `color (ambient x scene's ambient + sum of light x n.l)`.\n\n\
          Paths know `roughness`, too: the surface is made of small facets that hide each other and throw light\n\
          at each other, which flattens a ball and brightens its rim (Oren and Nayar, \"Generalization of Lambert's\n\
          Reflectance Model\", SIGGRAPH 1994; here as by Portsmouth, Kutz and Hill, \"EON: A Practical\n\
          Energy-Preserving Rough Diffuse BRDF\", JCGT 14(1), 2025). In Whitted's pictures it changes nothing.",
    params: &[
        Param::new(
            "color",
            Type::ColorPattern,
            Default::Number(0.8),
            "How much light it reflects.",
        ),
        AMBIENT,
        Param::new(
            "roughness",
            Type::UNIT_PATTERN,
            Default::Number(0.0),
            "How uneven the surface is in small, for paths: 0 is Lambert's, 1 like the moon's.",
        ),
    ],
    example: "sphere(center = (0, 1, 0), radius = 1, material = matte(\"peru\"))",
};

impl Matte {
    /// A matte surface of one colour.
    #[must_use]
    pub const fn new(color: Spectrum) -> Self {
        Self {
            color: ColorInput::Constant(color),
            ambient: NumberInput::Constant(1.0),
            roughness: NumberInput::Constant(0.0),
        }
    }
}

impl Material for Matte {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args, builder: &mut Builder) -> Result<Self, Diagnostic> {
        Ok(Self {
            color: builder.color(args, "color")?,
            ambient: builder.number(args, "ambient")?,
            roughness: builder.number(args, "roughness")?,
        })
    }

    fn finish(&self, point: &PatternPoint) -> Finish {
        let color = self.color.eval(point);
        Finish {
            ambient: color * unit(&self.ambient, point),
            unevenness: unit(&self.roughness, point),
            ..Finish::matte(color)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::testing::{build, point};
    use dioptric_math::Spectrum;
    use dioptric_scene::Value;

    #[test]
    fn its_roughness_is_told() {
        let rough = build::<Matte>(&[("roughness", Value::Number(0.4))]).unwrap();
        assert_eq!(rough.finish(&point()).unevenness, 0.4);
        assert!(build::<Matte>(&[("roughness", Value::Number(1.5))]).is_err());
    }

    #[test]
    fn the_ambient_share_leaves_the_diffuse_colour_alone() {
        let matte = build::<Matte>(&[
            ("color", Value::Vec3([0.2, 0.4, 0.8])),
            ("ambient", Value::Number(0.5)),
        ])
        .unwrap();
        let finish = matte.finish(&point());
        assert_eq!(finish.ambient, Spectrum::new(0.1, 0.2, 0.4));
        assert_eq!(finish.diffuse, Spectrum::new(0.2, 0.4, 0.8));
    }
}
