// SPDX-License-Identifier: MIT OR Apache-2.0
//! Metals: coloured mirrors that turn white towards the rim.

use dioptric_math::Spectrum;
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::metal_data::NAMES;
use super::metal_lanes::named;
use super::shared::{Glint, ROUGHNESS, SHARP_EXPONENT, unit, unit_color};
use super::{Conductor, Finish, Material, Optics, Reflectance};
use crate::build::Builder;
use crate::input::{ColorInput, NumberInput};
use crate::pattern::PatternPoint;

/// A metal.
#[derive(Clone, Debug)]
pub struct Metal {
    kind: Kind,
    roughness: NumberInput,
    glint: Glint,
}

/// What is known of it.
#[derive(Clone, Debug)]
enum Kind {
    /// What it reflects at a right angle.
    Colored(ColorInput),
    /// How it bends and weakens light.
    Measured(Conductor),
}

static SCHEMA: Schema = Schema {
    kind: "metal",
    category: Category::Material,
    summary: "gold, silver, copper, ...: a coloured mirror that turns white towards the rim",
    doc: "Shows what the mirrored ray sees, times what a metal reflects at that angle by Fresnel's equations for its\n\
          complex index of refraction `n + ik` (Born and Wolf, \"Principles of Optics\", section 14.4.1). Each of\n\
          red, green and blue has its own; `n` and `k` give those of any metal.\n\n\
          Those of a named metal are worked out from measurements by wavelength, so that each lane reflects what\n\
          the standard observer sees of the metal in daylight (D65, Rec. 709): at a right angle exactly, and as\n\
          nearly as may be at 80 degrees; at no angle is the difference above 0.006. The measurements: Johnson and Christy 1972\n\
          (copper, gold, silver) and 1974 (chromium, cobalt, iron, nickel, palladium, titanium), Rakic 1995\n\
          (aluminium), Rakic and others 1998 (platinum, tungsten), Querry 1985 (brass), Inagaki and others 1981\n\
          (mercury).\n\n\
          `color` makes a metal of any colour, which goes to white by Schlick's curve (\"An Inexpensive BRDF Model\n\
          for Physically-based Rendering\", 1994, equation 15). A light's mirror image is its highlight, as wide as\n\
          `roughness` says. Metal has no colour of its own: it needs things around it to mirror.\n\n\
          In paths it is as rough as a rough `mirror`; facets that mirror light to each other deepen its colour.",
    params: &[
        Param::new(
            "metal",
            Type::Choice(NAMES),
            Default::Absent,
            "Which metal. Either this, or `color`, or `n` and `k`.",
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
        Param::new(
            "n",
            Type::Scale,
            Default::Absent,
            "Index of refraction: one number, or three for red, green and blue.",
        ),
        Param::new("k", Type::Scale, Default::Absent, "Extinction coefficient, in the same way."),
    ],
    example: "sphere(center = (0, 1, 0), radius = 1, material = metal(\"gold\", roughness = 0.1))",
};

/// `n` or `k`: numbers that are at least 0.
fn constant(args: &Args, name: &str) -> Result<Spectrum, Diagnostic> {
    let value = Spectrum::from(args.vec3(name)?);
    if value.min_element() < 0.0 || value.max_element() > 1e3 {
        return Err(args
            .error(name, "wrong-value", format!("{name} of metal: expected numbers from 0 to 1000"))
            .help("gold has n = (0.16, 0.42, 1.37), k = (3.4, 2.4, 1.8), or thereabouts"));
    }
    Ok(value)
}

fn kind(args: &Args, builder: &mut Builder) -> Result<Kind, Diagnostic> {
    let [name, color, n, k] = ["metal", "color", "n", "k"].map(|word| args.is_written(word));
    match (name, color, n || k) {
        (true, false, false) => {
            let name = args.text("metal")?;
            let metal = named(&name).ok_or_else(|| {
                args.error("metal", "wrong-value", format!("unknown metal \"{name}\""))
            })?;
            Ok(Kind::Measured(metal))
        }
        (false, true, false) => Ok(Kind::Colored(builder.color(args, "color")?)),
        (false, false, true) => {
            if !(n && k) {
                let (given, missing) = if n { ("n", "k") } else { ("k", "n") };
                let message = format!("metal has {given}, but no {missing}");
                return Err(args
                    .error(given, "missing-argument", message)
                    .help(format!("write both n and k: without {missing} nothing is known")));
            }
            Ok(Kind::Measured(Conductor::new(constant(args, "n")?, constant(args, "k")?)))
        }
        (false, false, false) => Err(args
            .error_here("missing-argument", "metal needs the name of a metal, or color, or n and k")
            .help("write metal(\"gold\"), or metal(color = (0.9, 0.6, 0.3))")),
        (name, color, _) => {
            let first = if name { "metal" } else { "color" };
            let second = if name && color {
                "color"
            } else if n {
                "n"
            } else {
                "k"
            };
            Err(args
                .error(
                    second,
                    "contradiction",
                    format!("metal: both {first} and {second} are given"),
                )
                .help("keep one of them"))
        }
    }
}

impl Material for Metal {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args, builder: &mut Builder) -> Result<Self, Diagnostic> {
        Ok(Self {
            kind: kind(args, builder)?,
            roughness: builder.number(args, "roughness")?,
            glint: Glint::from_args(args, builder)?,
        })
    }

    fn finish(&self, point: &PatternPoint) -> Finish {
        let reflect = match &self.kind {
            Kind::Measured(metal) => Reflectance::Metal(*metal),
            Kind::Colored(color) => {
                Reflectance::Curve { normal: unit_color(color, point), grazing: Spectrum::ONE }
            }
        };
        let (base, roughness) = (reflect.at(1.0), unit(&self.roughness, point));
        Finish {
            base,
            highlight: self.glint.at(point, base, roughness),
            optics: Optics::Mirror { reflect, roughness, covers: false },
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
    fn a_metal_is_named_or_has_a_colour_or_constants() {
        let message = |arguments: &[(&str, Value)]| build::<Metal>(arguments).unwrap_err().message;
        let gold = ("metal", Value::Text("gold".into()));
        let color = ("color", Value::Number(0.5));
        let [n, k] = ["n", "k"].map(|name| (name, Value::Vec3([0.2, 0.4, 1.4])));
        assert_eq!(message(&[]), "metal needs the name of a metal, or color, or n and k");
        assert_eq!(
            message(&[gold.clone(), color.clone()]),
            "metal: both metal and color are given"
        );
        assert_eq!(message(&[gold.clone(), k.clone()]), "metal: both metal and k are given");
        assert_eq!(message(&[color, n.clone(), k.clone()]), "metal: both color and n are given");
        assert_eq!(message(std::slice::from_ref(&n)), "metal has n, but no k");
        let negative = ("k", Value::Number(-1.0));
        assert_eq!(message(&[n.clone(), negative]), "k of metal: expected numbers from 0 to 1000");
        let finish = build::<Metal>(&[gold]).unwrap().finish(&point());
        assert_eq!(finish.base, named("gold").unwrap().at(1.0));
        assert_eq!(finish.highlight.unwrap().color, finish.base * 0.5);
        let by_hand = build::<Metal>(&[n, k]).unwrap().finish(&point());
        let Optics::Mirror { reflect, .. } = by_hand.optics else { panic!() };
        // ((1.4 - 1)^2 + 1.4^2) / ((1.4 + 1)^2 + 1.4^2)
        assert!((reflect.at(1.0).z - 2.12 / 7.72).abs() < 1e-12);
        assert_eq!(reflect.at(0.0), Spectrum::ONE);
    }

    #[test]
    fn a_coloured_metal_whitens_by_schlicks_curve() {
        let color = build::<Metal>(&[("color", Value::Vec3([1.5, 0.5, 0.0]))]).unwrap();
        let Optics::Mirror { reflect, .. } = color.finish(&point()).optics else { panic!() };
        assert_eq!(reflect.at(1.0), Spectrum::new(1.0, 0.5, 0.0));
        assert_eq!(reflect.at(0.5), Spectrum::new(1.0, 0.515_625, 0.031_25));
    }
}
