// SPDX-License-Identifier: MIT OR Apache-2.0
//! Glass, water, diamond: light is reflected and refracted as Fresnel's equations say.

use dioptric_math::Spectrum;
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::interior::{ANISOTROPY, Interior, SCATTERING, Scattering};
use super::shared::{
    ABSORPTION, BUMP, BUMP_HEIGHT, Glint, ROUGHNESS, SHADOW, SHARP_EXPONENT, absorption, bump,
    shadow_pass, unit, unit_color,
};
use super::{Bump, Finish, Material, Optics};
use crate::build::Builder;
use crate::input::{ColorInput, NumberInput};
use crate::pattern::PatternPoint;

/// A dielectric.
#[derive(Clone, Debug)]
pub struct Glass {
    color: ColorInput,
    reflection: ColorInput,
    ior: f64,
    absorption: Spectrum,
    scattering: Option<Scattering>,
    roughness: NumberInput,
    glint: Glint,
    shadow: Option<f64>,
    bump: Option<Bump>,
}

static SCHEMA: Schema = Schema {
    kind: "glass",
    category: Category::Material,
    summary: "glass, water, diamond: reflects and refracts by Fresnel's equations",
    doc: "The share of light that is mirrored grows with the angle as Fresnel's equations say (Born and Wolf,\n\
          \"Principles of Optics\", 7th ed., section 1.5.2); the rest is refracted (Snell's law). Where it cannot\n\
          leave it is reflected wholly. Things within things work: the index outside is that of whatever the ray\n\
          is in. Indices: water 1.33, window glass 1.52, flint glass 1.62, diamond 2.42.\n\n\
          `color` tints light once, where it enters; `absorption` weakens it all the way through the inside, so\n\
          that thick parts are darker. A light's mirror image is its highlight, `specular x light x\n\
          max(0, n.h)^exponent`. Its tinted shadow is what crosses two surfaces at a right angle, tinted and\n\
          absorbed but not bent: bright caustics are not found.\n\n\
          In paths rough glass is made of facets (GGX; Walter et al., \"Microfacet Models for Refraction through\n\
          Rough Surfaces\", EGSR 2007) that also send light to each other, so that roughness takes none away;\n\
          shadows and mirror images of lights are what paths find, without `shadow` and `specular`. With `scattering` it
\
          is murky inside: milk, jade, muddy water.",
    params: &[
        Param::new(
            "color",
            Type::ColorPattern,
            Default::Number(1.0),
            "Tint of what goes into it, each lane at most 1.",
        ),
        Param::new(
            "ior",
            Type::Number { min: 0.1, max: 10.0 },
            Default::Number(1.5),
            "Index of refraction.",
        ),
        ABSORPTION,
        SCATTERING,
        ANISOTROPY,
        ROUGHNESS,
        Param::new(
            "reflection",
            Type::ColorPattern,
            Default::Number(1.0),
            "Tint of what its surface mirrors, each lane at most 1; 1 in nature.",
        ),
        Param::new(
            "specular",
            Type::NumberPattern { min: 0.0, max: f64::INFINITY },
            Default::Number(0.5),
            "Strength of the highlight; 0 for none.",
        ),
        SHARP_EXPONENT,
        SHADOW,
        BUMP,
        BUMP_HEIGHT,
    ],
    example: "sphere(center = (0, 1, 0), radius = 1, material = glass(ior = 1.5))",
};

impl Material for Glass {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args, builder: &mut Builder) -> Result<Self, Diagnostic> {
        Ok(Self {
            color: builder.color(args, "color")?,
            reflection: builder.color(args, "reflection")?,
            ior: args.number("ior")?,
            absorption: absorption(args)?,
            scattering: Scattering::from_args(args)?,
            roughness: builder.number(args, "roughness")?,
            glint: Glint::from_args(args, builder)?,
            shadow: args.optional_number("shadow")?,
            bump: bump(args, builder)?,
        })
    }

    fn finish(&self, point: &PatternPoint) -> Finish {
        let transmit = unit_color(&self.color, point);
        let reflect = unit_color(&self.reflection, point);
        let roughness = unit(&self.roughness, point);
        let mirrored = (self.ior - 1.0) / (self.ior + 1.0);
        let through = 1.0 - mirrored * mirrored; // one surface, at a right angle
        Finish {
            base: transmit,
            highlight: self.glint.at(point, reflect, roughness),
            optics: Optics::Dielectric {
                ior: self.ior,
                reflect,
                transmit,
                absorption: self.absorption,
                roughness,
            },
            shadow_pass: shadow_pass(self.shadow, transmit, through * through),
            ..Finish::matte(Spectrum::ZERO)
        }
    }

    fn is_opaque(&self) -> bool {
        false
    }

    fn interior(&self) -> Interior {
        Interior { scattering: self.scattering, ..Interior::PLAIN }
    }

    fn bump(&self) -> Option<&Bump> {
        self.bump.as_ref()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::testing::{build, point};
    use dioptric_scene::Value;

    #[test]
    fn it_has_no_colour_of_its_own_and_lets_light_through_its_shadow() {
        let glass = build::<Glass>(&[("color", Value::Vec3([1.0, 0.5, 0.0]))]).unwrap();
        let finish = glass.finish(&point());
        assert_eq!((finish.ambient, finish.diffuse), (Spectrum::ZERO, Spectrum::ZERO));
        // 4 % are lost at each of two surfaces of index 1.5; the tint counts once.
        let expected = Spectrum::new(0.9216, 0.9216 * 0.5, 0.0);
        assert!((finish.shadow_pass - expected).length() < 1e-12);
    }

    #[test]
    fn tints_never_make_light() {
        let lit =
            build::<Glass>(&[("color", Value::Number(3.0)), ("reflection", Value::Number(2.0))]);
        let finish = lit.unwrap().finish(&point());
        let Optics::Dielectric { reflect, transmit, .. } = finish.optics else { panic!() };
        assert_eq!((reflect, transmit), (Spectrum::ONE, Spectrum::ONE));
    }
}
