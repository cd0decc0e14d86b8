// SPDX-License-Identifier: MIT OR Apache-2.0
//! Metals: coloured mirrors that turn white towards the rim.

use dioptric_math::Spectrum;
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

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

/// Measured index of refraction n and extinction coefficient k of a metal, at 650, 550 and 450 nm.
struct Constants {
    n: [f64; 3],
    k: [f64; 3],
}

/// The words of the `metal` parameter, in the order of [`CONSTANTS`].
const NAMES: &[&str] =
    &["aluminium", "brass", "chromium", "copper", "gold", "iron", "nickel", "silver", "titanium"];

/// Interpolated linearly in the published tables. Copper, gold and silver: Johnson and Christy,
/// "Optical Constants of the Noble Metals", Phys. Rev. B 6, 4370 (1972). Chromium, iron, nickel and
/// titanium: Johnson and Christy, "Optical constants of transition metals", Phys. Rev. B 9, 5056
/// (1974). Aluminium: Rakic, "Algorithm for the determination of intrinsic optical constants of metal
/// films", Appl. Opt. 34, 4755 (1995). Brass (70 % copper, 30 % zinc): Querry, "Optical constants",
/// report CRDC-CR-85034 (1985).
const CONSTANTS: [Constants; NAMES.len()] = [
    Constants { n: [1.558, 1.015, 0.633], k: [7.712, 6.627, 5.454] },
    Constants { n: [0.444, 0.527, 1.094], k: [3.695, 2.765, 1.829] },
    Constants { n: [3.107, 3.181, 2.323], k: [3.331, 3.329, 3.135] },
    Constants { n: [0.238, 1.007, 1.240], k: [3.626, 2.582, 2.393] },
    Constants { n: [0.156, 0.424, 1.383], k: [3.602, 2.472, 1.915] },
    Constants { n: [2.911, 2.950, 2.584], k: [3.089, 2.932, 2.767] },
    Constants { n: [1.990, 1.921, 1.729], k: [4.209, 3.616, 2.944] },
    Constants { n: [0.052, 0.060, 0.040], k: [4.409, 3.597, 2.648] },
    Constants { n: [2.741, 2.542, 2.267], k: [3.814, 3.435, 3.038] },
];

impl Constants {
    /// Reflectance in air at a right angle: `((n - 1)^2 + k^2) / ((n + 1)^2 + k^2)` (Born and Wolf,
    /// "Principles of Optics", 7th ed., section 14.2).
    fn reflectance(&self) -> Spectrum {
        let lane =
            |n: f64, k: f64| ((n - 1.0) * (n - 1.0) + k * k) / ((n + 1.0) * (n + 1.0) + k * k);
        let ([n0, n1, n2], [k0, k1, k2]) = (self.n, self.k);
        Spectrum::new(lane(n0, k0), lane(n1, k1), lane(n2, k2))
    }
}

/// The reflectance of a named metal.
fn named(name: &str) -> Option<Spectrum> {
    NAMES.iter().zip(&CONSTANTS).find(|(n, _)| **n == name).map(|(_, c)| c.reflectance())
}

static SCHEMA: Schema = Schema {
    kind: "metal",
    category: Category::Material,
    summary: "gold, silver, copper, ...: a coloured mirror that turns white towards the rim",
    doc: "Shows what the mirrored ray sees, times a weight that goes from the metal's reflectance at a right angle\n\
          to 1 at grazing angles (Schlick, \"An Inexpensive BRDF Model for Physically-based Rendering\", 1994,\n\
          equation 15). The reflectance of a named metal is that of measured optical constants at 650, 550 and\n\
          450 nm: Johnson and Christy 1972 (copper, gold, silver) and 1974 (chromium, iron, nickel, titanium),\n\
          Rakic 1995 (aluminium), Querry 1985 (brass). `color` gives another one. A light's mirror image is its\n\
          highlight, as wide as `roughness` says. Metal has no colour of its own: it needs things around it to\n\
          mirror.",
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
    fn reflectances_are_physical_and_those_of_the_formula() {
        assert!(NAMES.is_sorted());
        for name in NAMES {
            let f0 = named(name).unwrap();
            assert!(f0.min_element() > 0.3 && f0.max_element() < 1.0, "{name} {f0}");
        }
        // ((0.156 - 1)^2 + 3.602^2) / ((0.156 + 1)^2 + 3.602^2) = 13.68674 / 14.31074
        let gold = named("gold").unwrap();
        assert!((gold.x - 13.686_740 / 14.310_740).abs() < 1e-12);
        assert!(gold.x > gold.y && gold.y > gold.z);
        let silver = named("silver").unwrap();
        assert!(silver.min_element() > 0.97);
    }

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
