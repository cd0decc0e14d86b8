// SPDX-License-Identifier: MIT OR Apache-2.0
//! Metals: coloured mirrors that turn white towards the rim.

use dioptric_math::Spectrum;
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::metal_data::{NAMES, named};
use super::shared::{BUMP, BUMP_HEIGHT, Glint, ROUGHNESS, SHARP_EXPONENT, bump, unit, unit_color};
use super::{Bump, Finish, Material, Optics};
use crate::build::Builder;
use crate::input::{ColorInput, NumberInput};
use crate::pattern::PatternPoint;

/// A metal.
#[derive(Clone, Debug)]
pub struct Metal {
    /// Reflectance at a right angle.
    color: ColorInput,
    roughness: NumberInput,
    glint: Glint,
    bump: Option<Bump>,
}

static SCHEMA: Schema = Schema {
    kind: "metal",
    category: Category::Material,
    summary: "gold, silver, copper, ...: a coloured mirror that turns white towards the rim",
    doc: "Shows what the mirrored ray sees, times a weight that goes from the metal's reflectance at a right angle\n\
          to 1 at grazing angles (Schlick, \"An Inexpensive BRDF Model for Physically-based Rendering\", 1994,\n\
          equation 15). The colour of a named metal is worked out from measured optical constants: reflectance\n\
          ((n - 1)^2 + k^2) / ((n + 1)^2 + k^2) by wavelength, seen in daylight (D65) by the standard observer.\n\
          The measurements: Johnson and Christy 1972 (copper, gold, silver) and 1974 (chromium, iron, nickel,\n\
          titanium), Rakic 1995 (aluminium), Querry 1985 (brass). `color` gives another one. A light's mirror\n\
          image is its highlight, as wide as `roughness` says. Metal has no colour of its own: it needs things\n\
          around it to mirror.\n\n\
          In paths it is as rough as a rough `mirror`; facets that mirror light to each other deepen its colour.",
    params: &[
        Param::new(
            "metal",
            Type::Choice(NAMES),
            Default::Absent,
            "Which metal. Either this or `color`.",
        ),
        Param::new(
            "color",
            Type::ColorPattern,
            Default::Absent,
            "Reflectance at a right angle, each lane at most 1.",
        ),
        ROUGHNESS,
        Param::new(
            "specular",
            Type::NumberPattern { min: 0.0, max: f64::INFINITY },
            Default::Number(0.5),
            "Strength of the highlight; 0 for none.",
        ),
        SHARP_EXPONENT,
        BUMP,
        BUMP_HEIGHT,
    ],
    example: "sphere(center = (0, 1, 0), radius = 1, material = metal(\"gold\", roughness = 0.1))",
};

impl Material for Metal {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args, builder: &mut Builder) -> Result<Self, Diagnostic> {
        let color = match (args.is_written("metal"), args.is_written("color")) {
            (true, false) => {
                let name = args.text("metal")?;
                ColorInput::Constant(named(&name).ok_or_else(|| {
                    args.error("metal", "wrong-value", format!("unknown metal \"{name}\""))
                })?)
            }
            (false, true) => builder.color(args, "color")?,
            (true, true) => {
                return Err(args
                    .error("color", "contradiction", "metal: both metal and color are given")
                    .help("keep one of them"));
            }
            (false, false) => {
                return Err(args
                    .error_here("missing-argument", "metal needs the name of a metal, or color")
                    .help("write metal(\"gold\"), or metal(color = (0.9, 0.6, 0.3))"));
            }
        };
        Ok(Self {
            color,
            roughness: builder.number(args, "roughness")?,
            glint: Glint::from_args(args, builder)?,
            bump: bump(args, builder)?,
        })
    }

    fn finish(&self, point: &PatternPoint) -> Finish {
        let reflect = unit_color(&self.color, point);
        let roughness = unit(&self.roughness, point);
        Finish {
            base: reflect,
            highlight: self.glint.at(point, reflect, roughness),
            optics: Optics::Mirror { reflect, grazing: Spectrum::ONE, roughness, covers: false },
            ..Finish::matte(Spectrum::ZERO)
        }
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
    fn a_metal_is_named_or_has_a_colour() {
        let message = |arguments: &[(&str, Value)]| build::<Metal>(arguments).unwrap_err().message;
        let gold = ("metal", Value::Text("gold".into()));
        assert_eq!(message(&[]), "metal needs the name of a metal, or color");
        assert_eq!(
            message(&[gold.clone(), ("color", Value::Number(0.5))]),
            "metal: both metal and color are given"
        );
        let finish = build::<Metal>(&[gold]).unwrap().finish(&point());
        assert!(matches!(finish.optics, Optics::Mirror { grazing: Spectrum::ONE, .. }));
        assert_eq!(finish.highlight.unwrap().color, named("gold").unwrap() * 0.5);
    }
}
