// SPDX-License-Identifier: MIT OR Apache-2.0
//! Transparency by fixed shares, as the first ray tracers had it.

use dioptric_math::Spectrum;
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::phong::{COLOR, DIFFUSE, EXPONENT, Lit, SPECULAR};
use super::shared::{
    ABSORPTION, AMBIENT, HIGHLIGHT_COLOR, MODEL, SHADOW, absorption, shadow_pass, unit, unit_color,
};
use super::{Finish, Material, Optics};
use crate::build::Builder;
use crate::input::{ColorInput, NumberInput};
use crate::pattern::PatternPoint;

/// A share of its own colour and a share of what is seen through it.
#[derive(Clone, Debug)]
pub struct Clear {
    lit: Lit,
    own: NumberInput,
    ior: f64,
    tint: ColorInput,
    absorption: Spectrum,
    shadow: Option<f64>,
}

static SCHEMA: Schema = Schema {
    kind: "clear",
    category: Category::Material,
    summary: "transparent by fixed shares: some of its own colour, the rest of what is behind",
    doc: "Shows `own x` its lit colour (ambient, diffuse and highlight as in `phong`) `+ (1 - own) x tint x` what\n\
          is seen through it. The ray is bent by Snell's law where it enters and where it leaves the same object;\n\
          inside, total reflection is followed. The shares are the same for every angle, which is simple and wrong:\n\
          `glass` follows Fresnel instead. One passage through the object counts as one bounce.\n\n\
          `ior` is the index of refraction inside over that outside, so 1 does not bend.\n\n\
          Paths take the same shares, and follow every reflection inside as a bounce.",
    params: &[
        COLOR,
        Param::new(
            "own",
            Type::UNIT_PATTERN,
            Default::Number(0.15),
            "Share of its own colour; the rest is what is seen through it.",
        ),
        Param::new(
            "ior",
            Type::Number { min: 0.1, max: 10.0 },
            Default::Number(1.005),
            "How strongly it bends rays: index of refraction inside over outside.",
        ),
        Param::new(
            "tint",
            Type::ColorPattern,
            Default::Number(1.0),
            "Multiplies what is seen through it, each lane at most 1.",
        ),
        ABSORPTION,
        SPECULAR,
        EXPONENT,
        AMBIENT,
        DIFFUSE,
        MODEL,
        HIGHLIGHT_COLOR,
        SHADOW,
    ],
    example: "box(min = (-1, 0, -1), max = (1, 2, 1), material = clear(\"seagreen\", own = 0.25, ior = 1.02))",
};

impl Material for Clear {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args, builder: &mut Builder) -> Result<Self, Diagnostic> {
        Ok(Self {
            lit: Lit::from_args(args, builder)?,
            own: builder.number(args, "own")?,
            ior: args.number("ior")?,
            tint: builder.color(args, "tint")?,
            absorption: absorption(args)?,
            shadow: args.optional_number("shadow")?,
        })
    }

    fn finish(&self, point: &PatternPoint) -> Finish {
        let own = unit(&self.own, point);
        let tint = unit_color(&self.tint, point);
        Finish {
            optics: Optics::Shares { own, ior: self.ior, tint, absorption: self.absorption },
            shadow_pass: shadow_pass(self.shadow, tint, 1.0 - own),
            ..self.lit.finish(point)
        }
    }

    fn is_opaque(&self) -> bool {
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::testing::{build, point};
    use dioptric_scene::Value;

    /// SCENE.md, "cube": 0.15 of its own green and 0.85 of what is seen, ratio of indices 1/1.005.
    #[test]
    fn the_cube_of_the_report() {
        let cube = build::<Clear>(&[
            ("color", Value::Vec3([0.0, 1.0, 0.0])),
            ("specular", Value::Number(1.0)),
        ])
        .unwrap();
        let finish = cube.finish(&point());
        assert_eq!(
            finish.optics,
            Optics::Shares {
                own: 0.15,
                ior: 1.005,
                tint: Spectrum::ONE,
                absorption: Spectrum::ZERO
            }
        );
        assert_eq!((finish.ambient, finish.diffuse), (Spectrum::Y, Spectrum::Y));
        assert_eq!(finish.highlight.unwrap().exponent, 30.0);
        assert!((finish.shadow_pass - Spectrum::splat(0.85)).length() < 1e-15);
    }

    #[test]
    fn its_shadow_can_be_told() {
        let dark = build::<Clear>(&[("shadow", Value::Number(1.0))]).unwrap();
        assert_eq!(dark.finish(&point()).shadow_pass, Spectrum::ZERO);
        let error = build::<Clear>(&[("absorption", Value::Number(-1.0))]).unwrap_err();
        assert_eq!(error.message, "absorption of clear: expected numbers of at least 0");
    }
}
