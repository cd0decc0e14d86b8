// SPDX-License-Identifier: MIT OR Apache-2.0
//! The classical material of ray tracers: ambient, diffuse and highlight, and a mirror on top.

use dioptric_math::Spectrum;
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::shared::{AMBIENT, Gloss, HIGHLIGHT_COLOR, MODEL, unit};
use super::{Finish, Material, Optics, Reflectance};
use crate::build::Builder;
use crate::input::{ColorInput, NumberInput};
use crate::pattern::PatternPoint;

/// Ambient, Lambert and a highlight, with a mirrored ray added.
#[derive(Clone, Debug)]
pub struct Phong {
    lit: Lit,
    mirror: NumberInput,
}

/// The lit sum that `phong` and `clear` share: ambient, diffuse and highlight.
#[derive(Clone, Debug)]
pub(super) struct Lit {
    color: ColorInput,
    ambient: NumberInput,
    diffuse: NumberInput,
    gloss: Gloss,
}

/// `color` of the materials with a lit sum.
pub(super) const COLOR: Param =
    Param::new("color", Type::ColorPattern, Default::Number(0.8), "Its colour.");
/// `specular`.
pub(super) const SPECULAR: Param = Param::new(
    "specular",
    Type::NumberPattern { min: 0.0, max: f64::INFINITY },
    Default::Number(0.5),
    "Strength of the highlight; 0 for none.",
);
/// `exponent`.
pub(super) const EXPONENT: Param = Param::new(
    "exponent",
    Type::NumberPattern { min: 0.0, max: 1e6 },
    Default::Number(30.0),
    "Sharpness of the highlight: the higher, the smaller.",
);
/// `diffuse`.
pub(super) const DIFFUSE: Param = Param::new(
    "diffuse",
    Type::UNIT_PATTERN,
    Default::Number(1.0),
    "How much of the lights it reflects to all sides, times its colour.",
);

impl Lit {
    /// Reads the parameters.
    pub(super) fn from_args(args: &Args, builder: &mut Builder) -> Result<Self, Diagnostic> {
        Ok(Self {
            color: builder.color(args, "color")?,
            ambient: builder.number(args, "ambient")?,
            diffuse: builder.number(args, "diffuse")?,
            gloss: Gloss::from_args(args, builder)?,
        })
    }

    /// The lit sum's parts at a point.
    pub(super) fn finish(&self, point: &PatternPoint) -> Finish {
        let color = self.color.eval(point);
        Finish {
            ambient: color * unit(&self.ambient, point),
            diffuse: color * unit(&self.diffuse, point),
            highlight: self.gloss.at(point),
            ..Finish::matte(color)
        }
    }
}

static SCHEMA: Schema = Schema {
    kind: "phong",
    category: Category::Material,
    summary: "ambient, diffuse and a highlight, with a mirror added if wanted",
    doc: "The sum of\n\n\
          - `ambient x color x` the scene's ambient light,\n\
          - for each light that reaches the point: `diffuse x color x light x n.l`,\n\
          - and its highlight `specular x highlight_color x light x max(0, r.v)^exponent`, with the light's\n\
            direction r mirrored at the normal (Phong, \"Illumination for Computer Generated Pictures\", CACM 18(6),\n\
            1975), or `max(0, n.h)^exponent` with the half vector h (Blinn, \"Models of Light Reflection for\n\
            Computer Synthesized Pictures\", SIGGRAPH 1977),\n\
          - `emission`,\n\
          - `mirror x` what the mirrored ray sees (Whitted, \"An Improved Illumination Model for Shaded Display\",\n\
            CACM 23(6), 1980).\n\n\
          Nothing keeps the sum below 1: it is a recipe, not a measurement. For surfaces that never reflect more\n\
          than they receive see `plastic`, `metal` and `mirror`.\n\n\
          Paths scatter light by the same formulas, divided by pi, so that sharp lights look the same; there is no\n\
          ambient light.",
    params: &[
        COLOR,
        SPECULAR,
        EXPONENT,
        Param::new(
            "mirror",
            Type::UNIT_PATTERN,
            Default::Number(0.0),
            "How much of the mirrored ray is added.",
        ),
        AMBIENT,
        DIFFUSE,
        MODEL,
        HIGHLIGHT_COLOR,
    ],
    example: "sphere(center = (0, 1, 0), radius = 1, material = phong(\"royalblue\", specular = 1, exponent = 60))",
};

impl Material for Phong {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args, builder: &mut Builder) -> Result<Self, Diagnostic> {
        Ok(Self { lit: Lit::from_args(args, builder)?, mirror: builder.number(args, "mirror")? })
    }

    fn finish(&self, point: &PatternPoint) -> Finish {
        let mirror = Spectrum::splat(unit(&self.mirror, point));
        let optics = if mirror == Spectrum::ZERO {
            Optics::Opaque
        } else {
            Optics::Mirror { reflect: Reflectance::constant(mirror), roughness: 0.0, covers: false }
        };
        Finish { optics, ..self.lit.finish(point) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::HighlightModel;
    use crate::material::testing::{build, point};
    use dioptric_scene::Value;

    /// SCENE.md, "mirror ball": blue, highlight 1 with exponent 30, 0.7 of what is reflected.
    #[test]
    fn the_mirror_ball_of_the_report() {
        let ball = build::<Phong>(&[
            ("color", Value::Vec3([0.0, 0.0, 1.0])),
            ("specular", Value::Number(1.0)),
            ("mirror", Value::Number(0.7)),
        ])
        .unwrap();
        let finish = ball.finish(&point());
        assert_eq!(finish.ambient, Spectrum::Z);
        assert_eq!(finish.diffuse, Spectrum::Z);
        let highlight = finish.highlight.unwrap();
        assert_eq!(highlight.model, HighlightModel::Phong);
        assert_eq!((highlight.color, highlight.exponent), (Spectrum::ONE, 30.0));
        let weight = Spectrum::splat(0.7);
        assert_eq!(
            finish.optics,
            Optics::Mirror {
                reflect: Reflectance::constant(weight),
                roughness: 0.0,
                covers: false
            }
        );
        assert_eq!(finish.shadow_pass, Spectrum::ZERO);
    }

    #[test]
    fn what_is_switched_off_costs_nothing() {
        let plain = build::<Phong>(&[("specular", Value::Number(0.0))]).unwrap();
        let finish = plain.finish(&point());
        assert_eq!(finish.highlight, None);
        assert_eq!(finish.optics, Optics::Opaque);
        let blinn = build::<Phong>(&[("model", Value::Text("blinn".into()))]).unwrap();
        assert_eq!(blinn.finish(&point()).highlight.unwrap().model, HighlightModel::Blinn);
        assert!(build::<Phong>(&[("mirror", Value::Number(1.5))]).is_err());
    }
}
