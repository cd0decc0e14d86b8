// SPDX-License-Identifier: MIT OR Apache-2.0
//! Plastic, varnish, glazed pottery: a colour under a clear coat.

use dioptric_math::Spectrum;
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::shared::{AMBIENT, Glint, ROUGHNESS, SHARP_EXPONENT, unit, unit_color};
use super::{Finish, Material, Optics, Reflectance};
use crate::build::Builder;
use crate::input::{ColorInput, NumberInput};
use crate::pattern::PatternPoint;

/// A dull colour under a smooth coat.
#[derive(Clone, Debug)]
pub struct Plastic {
    color: ColorInput,
    ambient: NumberInput,
    /// Reflectance of the coat at a right angle.
    reflectance: f64,
    roughness: NumberInput,
    glint: Glint,
}

static SCHEMA: Schema = Schema {
    kind: "plastic",
    category: Category::Material,
    summary: "a colour under a clear coat that mirrors more towards the rim",
    doc: "With w, the share that the coat mirrors, it shows `(1 - w) x` the lit colour below (ambient, diffuse and\n\
          highlight) `+ w x` what the mirrored ray sees, so that a coat never makes light. w is\n\
          ((ior - 1) / (ior + 1))^2 at a right angle, 4 % for an index of 1.5, and grows to 1 at grazing angles\n\
          (Schlick, \"An Inexpensive BRDF Model for Physically-based Rendering\", 1994, equation 15). A light's\n\
          mirror image is its highlight.\n\n\
          In paths the coat mirrors by Fresnel's equations, over facets where it is rough (GGX), and throws light\n\
          from below back to the colour again and again, which deepens it: `(1 - F_in) (1 - F_out) / ior^2 x color /\n\
          (1 - color F_inside)`. A white one loses nothing.",
    params: &[
        Param::new(
            "color",
            Type::ColorPattern,
            Default::Number(0.8),
            "The colour under the coat, each lane at most 1.",
        ),
        Param::new(
            "ior",
            Type::Number { min: 1.0, max: 10.0 },
            Default::Number(1.5),
            "Index of refraction of the coat: the higher, the more it mirrors.",
        ),
        ROUGHNESS,
        Param::new(
            "specular",
            Type::NumberPattern { min: 0.0, max: f64::INFINITY },
            Default::Number(0.5),
            "Strength of the highlight; 0 for none.",
        ),
        SHARP_EXPONENT,
        AMBIENT,
    ],
    example: "sphere(center = (0, 1, 0), radius = 1, material = plastic(\"crimson\"))",
};

impl Material for Plastic {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args, builder: &mut Builder) -> Result<Self, Diagnostic> {
        let ior = args.number("ior")?;
        let root = (ior - 1.0) / (ior + 1.0);
        Ok(Self {
            color: builder.color(args, "color")?,
            ambient: builder.number(args, "ambient")?,
            reflectance: root * root,
            roughness: builder.number(args, "roughness")?,
            glint: Glint::from_args(args, builder)?,
        })
    }

    fn finish(&self, point: &PatternPoint) -> Finish {
        let color = unit_color(&self.color, point);
        let roughness = unit(&self.roughness, point);
        Finish {
            ambient: color * unit(&self.ambient, point),
            highlight: self.glint.at(point, Spectrum::ONE, roughness),
            optics: Optics::Mirror {
                reflect: Reflectance::Curve {
                    normal: Spectrum::splat(self.reflectance),
                    grazing: Spectrum::ONE,
                },
                roughness,
                covers: true,
            },
            ..Finish::matte(color)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::testing::{build, point};
    use dioptric_scene::Value;

    #[test]
    fn the_coat_mirrors_four_percent_and_covers_the_colour() {
        let red = build::<Plastic>(&[("color", Value::Vec3([5.0, 0.1, 0.0]))]).unwrap();
        let finish = red.finish(&point());
        let Optics::Mirror { reflect, covers, .. } = finish.optics else { panic!() };
        assert!((reflect.at(1.0) - Spectrum::splat(0.04)).length() < 1e-15);
        assert!(reflect.at(0.0) == Spectrum::ONE && covers);
        // (1 - w) own + w mirrored is at most 1 for each w while own is.
        assert_eq!(finish.diffuse, Spectrum::new(1.0, 0.1, 0.0));
    }

    #[test]
    fn a_coat_of_index_1_is_none() {
        let bare = build::<Plastic>(&[("ior", Value::Number(1.0))]).unwrap();
        let Optics::Mirror { reflect, .. } = bare.finish(&point()).optics else { panic!() };
        assert_eq!(reflect.at(1.0), Spectrum::ZERO);
        assert!(build::<Plastic>(&[("ior", Value::Number(0.9))]).is_err());
    }
}
