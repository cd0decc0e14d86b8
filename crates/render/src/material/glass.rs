// SPDX-License-Identifier: MIT OR Apache-2.0
//! Glass, water, diamond: light is reflected and refracted as Fresnel's equations say.

use dioptric_math::Spectrum;
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::glasses::{NAMES, named};
use super::interior::{ANISOTROPY, Interior, PRIORITY, SCATTERING, Scattering};
use super::shared::{
    ABSORPTION, Glint, ROUGHNESS, SHADOW, SHARP_EXPONENT, absorption, shadow_pass, unit, unit_color,
};
use super::{Finish, Material, Optics};
use crate::build::Builder;
use crate::input::{ColorInput, NumberInput};
use crate::pattern::PatternPoint;
use crate::wavelength::Cauchy;

/// A dielectric.
#[derive(Clone, Debug)]
pub struct Glass {
    color: ColorInput,
    reflection: ColorInput,
    ior: f64,
    absorption: Spectrum,
    interior: Interior,
    roughness: NumberInput,
    glint: Glint,
    shadow: Option<f64>,
}

static SCHEMA: Schema = Schema {
    kind: "glass",
    category: Category::Material,
    summary: "glass, water, diamond: reflects and refracts by Fresnel's equations",
    doc: "The share of light that is mirrored grows with the angle as Fresnel's equations say (Born and Wolf,\n\
          \"Principles of Optics\", 7th ed., section 1.5.2); the rest is refracted (Snell's law). Where it cannot\n\
          leave it is reflected wholly. Things within things work: the index outside is that of whatever the ray\n\
          is in. Indices: water 1.33, window glass 1.52, flint glass 1.62, diamond 2.42.\n\n\
          With `dispersion` paths of light (`integrator = \"path\"`) bend blue more than red, so that a prism makes a rainbow: by\n\
          Cauchy's formula through Abbe's number (n_d - 1) / (n_F - n_C), about 60 for crown glass, 30 for heavy flint; the\n\
          smaller the more colourful. `kind` is a known glass with its index and number. Whitted's pictures bend all colours\n\
          by `ior`, the index of yellow light (n_d).\n\n\
          Things may overlap: a drink that reaches a little into its glass is modelled so. With `priority` the higher one\n\
          is there, and the lower one's surface inside of it is not (Schmidt and Budge, \"Simple Nested Dielectrics in\n\
          Ray Traced Images\", Journal of Graphics Tools 7(2), 2002).\n\n\
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
        Param::new(
            "kind",
            Type::Choice(NAMES),
            Default::Text("plain"),
            "A glass with a measured index and dispersion, instead of `ior` and `dispersion`.",
        ),
        Param::new(
            "dispersion",
            Type::Number { min: 1.0, max: 1e6 },
            Default::Absent,
            "Abbe's number: how little it spreads colours; none if absent.",
        ),
        ABSORPTION,
        SCATTERING,
        ANISOTROPY,
        PRIORITY,
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
    ],
    example: "sphere(center = (0, 1, 0), radius = 1, material = glass(ior = 1.5))",
};

/// Its index of refraction, and its Abbe number if it has one.
fn index(args: &Args) -> Result<(f64, Option<f64>), Diagnostic> {
    let kind = args.text("kind")?;
    let Some((ior, abbe)) = named(&kind) else {
        return Ok((args.number("ior")?, args.optional_number("dispersion")?));
    };
    for other in ["ior", "dispersion"] {
        if args.is_written(other) {
            return Err(args
                .error(
                    other,
                    "contradiction",
                    format!("{other} of glass: \"{kind}\" has one of its own"),
                )
                .help(format!(
                    "leave out kind and write ior = {ior}, dispersion = {abbe}, changed as you like"
                )));
        }
    }
    Ok((ior, Some(abbe)))
}

impl Material for Glass {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args, builder: &mut Builder) -> Result<Self, Diagnostic> {
        let (ior, abbe) = index(args)?;
        let interior = Interior {
            scattering: Scattering::from_args(args)?,
            dispersion: abbe.map(|abbe| Cauchy::new(ior, abbe)),
            priority: args.integer("priority")? as i32,
            ..Interior::PLAIN
        };
        Ok(Self {
            color: builder.color(args, "color")?,
            reflection: builder.color(args, "reflection")?,
            ior,
            absorption: absorption(args)?,
            interior,
            roughness: builder.number(args, "roughness")?,
            glint: Glint::from_args(args, builder)?,
            shadow: args.optional_number("shadow")?,
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
        self.interior
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
    fn known_glasses_bring_their_index_and_dispersion() {
        let diamond = build::<Glass>(&[("kind", Value::Text("diamond".into()))]).unwrap();
        let own = [("ior", Value::Number(2.4175)), ("dispersion", Value::Number(55.3))];
        assert_eq!(diamond.interior(), build::<Glass>(&own).unwrap().interior());
        assert!(diamond.interior().dispersion.is_some());
        let both = [("kind", Value::Text("bk7".into())), ("ior", Value::Number(1.5))];
        let error = build::<Glass>(&both).unwrap_err();
        assert_eq!(error.message, "ior of glass: \"bk7\" has one of its own");
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
