// SPDX-License-Identifier: MIT OR Apache-2.0
//! A mirror: nothing but what it reflects.

use dioptric_math::Spectrum;
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::shared::{Glint, ROUGHNESS, SHARP_EXPONENT, unit, unit_color};
use super::{Finish, Material, Optics, Reflectance};
use crate::build::Builder;
use crate::input::{ColorInput, NumberInput};
use crate::pattern::PatternPoint;

/// A mirror.
#[derive(Clone, Debug)]
pub struct Mirror {
    color: ColorInput,
    roughness: NumberInput,
    glint: Glint,
}

static SCHEMA: Schema = Schema {
    kind: "mirror",
    category: Category::Material,
    summary: "a mirror, the same for all angles",
    doc: "Shows `color x` what the mirrored ray sees, and nothing of its own. To mix a mirror with a colour use\n\
          `phong(mirror = ...)`; for gold or steel, which whiten towards the rim, `metal`. A light's mirror image\n\
          is a highlight if `specular` is above 0.\n\n\
          In paths a rough one is made of small facets (GGX; Walter et al., \"Microfacet Models for Refraction\n\
          through Rough Surfaces\", EGSR 2007) that also mirror light to each other (Kulla and Conty, \"Revisiting\n\
          Physically Based Shading at Imageworks\", SIGGRAPH 2017 course), so that roughness takes no light away;\n\
          the mirror image of a light is found, and no highlight is added.",
    params: &[
        Param::new(
            "color",
            Type::ColorPattern,
            Default::Number(0.95),
            "How much it reflects, each lane at most 1.",
        ),
        ROUGHNESS,
        Param::new(
            "specular",
            Type::NumberPattern { min: 0.0, max: f64::INFINITY },
            Default::Number(0.0),
            "Strength of the highlight; 0 for none.",
        ),
        SHARP_EXPONENT,
    ],
    example: "sphere(center = (0, 1, 0), radius = 1, material = mirror())",
};

impl Material for Mirror {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args, builder: &mut Builder) -> Result<Self, Diagnostic> {
        Ok(Self {
            color: builder.color(args, "color")?,
            roughness: builder.number(args, "roughness")?,
            glint: Glint::from_args(args, builder)?,
        })
    }

    fn finish(&self, point: &PatternPoint) -> Finish {
        let reflect = unit_color(&self.color, point);
        let roughness = unit(&self.roughness, point);
        Finish {
            base: reflect,
            highlight: self.glint.at(point, reflect, roughness),
            optics: Optics::Mirror {
                reflect: Reflectance::constant(reflect),
                roughness,
                covers: false,
            },
            ..Finish::matte(Spectrum::ZERO)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::testing::{build, point};
    use dioptric_scene::Value;

    #[test]
    fn it_is_the_same_for_all_angles_and_never_brighter_than_what_it_sees() {
        let mirror = build::<Mirror>(&[("color", Value::Vec3([0.5, 1.0, 7.0]))]).unwrap();
        let finish = mirror.finish(&point());
        let reflect = Spectrum::new(0.5, 1.0, 1.0);
        assert_eq!(
            finish.optics,
            Optics::Mirror {
                reflect: Reflectance::constant(reflect),
                roughness: 0.0,
                covers: false
            }
        );
        assert_eq!(
            (finish.ambient, finish.diffuse, finish.highlight),
            (Spectrum::ZERO, Spectrum::ZERO, None)
        );
    }
}
