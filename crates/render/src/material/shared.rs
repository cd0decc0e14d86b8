// SPDX-License-Identifier: MIT OR Apache-2.0
//! Parameters that several materials have, with one meaning everywhere, and how they are read.

use dioptric_math::Spectrum;
use dioptric_scene::{Args, Default, Diagnostic, Param, Type};

use super::{Highlight, HighlightModel};
use crate::build::Builder;
use crate::input::{ColorInput, NumberInput};
use crate::pattern::PatternPoint;

/// `ambient`.
pub(super) const AMBIENT: Param = Param::new(
    "ambient",
    Type::UNIT_PATTERN,
    Default::Number(1.0),
    "How much of the scene's ambient light it reflects, times its colour.",
);

/// `model`.
pub(super) const MODEL: Param = Param::new(
    "model",
    Type::Choice(&["phong", "blinn"]),
    Default::Text("phong"),
    "The highlight's formula: \"phong\" is max(0, r.v)^exponent, \"blinn\" max(0, n.h)^exponent.",
);

/// `highlight_color`.
pub(super) const HIGHLIGHT_COLOR: Param = Param::new(
    "highlight_color",
    Type::ColorPattern,
    Default::Number(1.0),
    "Colour of the highlight, times the light's own.",
);

/// `roughness`.
pub(super) const ROUGHNESS: Param = Param::new(
    "roughness",
    Type::UNIT_PATTERN,
    Default::Number(0.0),
    "How much mirrored and refracted rays spread: the GGX distribution's alpha, 0 for sharp.",
);

/// `exponent` of materials that have a roughness.
pub(super) const SHARP_EXPONENT: Param = Param::new(
    "exponent",
    Type::NumberPattern { min: 0.0, max: 1e6 },
    Default::Absent,
    "Sharpness of the highlight (Blinn's); from `roughness` if absent.",
);

/// `absorption`.
pub(super) const ABSORPTION: Param = Param::new(
    "absorption",
    Type::Scale,
    Default::Number(0.0),
    "How strongly light fades inside, per unit of length: after a distance d the share exp(-absorption d) is \
     left. One number, or three for red, green and blue.",
);

/// `shadow`.
pub(super) const SHADOW: Param = Param::new(
    "shadow",
    Type::UNIT,
    Default::Absent,
    "How dark its shadow is where the scene's shadows are tinted: 1 opaque, 0 none; the material's own share if absent.",
);

/// The widest and the sharpest highlight that a roughness gives.
const EXPONENTS: (f64, f64) = (1.0, 400.0);

/// `x` forced into `[0, largest]`; NaN, which `clamp` would keep, counts as 0.
fn within(x: f64, largest: f64) -> f64 {
    if x > 0.0 { x.min(largest) } else { 0.0 }
}

/// A number's value, forced into `[0, 1]`; patterns may leave it. Not a number counts as 0.
pub(super) fn unit(input: &NumberInput, point: &PatternPoint) -> f64 {
    within(input.eval(point), 1.0)
}

/// A number's value, at least 0 and finite. Not a number counts as 0.
pub(super) fn non_negative(input: &NumberInput, point: &PatternPoint) -> f64 {
    within(input.eval(point), f64::MAX)
}

/// A colour's value, each lane forced into `[0, 1]`, for weights of rays that must not grow.
pub(super) fn unit_color(input: &ColorInput, point: &PatternPoint) -> Spectrum {
    Spectrum::from(input.eval(point).to_array().map(|x| within(x, 1.0)))
}

/// The coefficients of [`ABSORPTION`].
pub(crate) fn absorption(args: &Args) -> Result<Spectrum, Diagnostic> {
    coefficients(args, "absorption", "fades")
}

/// What happens to each of red, green and blue per unit of length: at least 0.
pub(crate) fn coefficients(args: &Args, name: &str, verb: &str) -> Result<Spectrum, Diagnostic> {
    let coefficients = Spectrum::from(args.vec3(name)?);
    if coefficients.min_element() < 0.0 {
        let kind = args.node().schema.kind;
        return Err(args
            .error(name, "wrong-value", format!("{name} of {kind}: expected numbers of at least 0"))
            .help(format!(
                "write how strongly each of red, green and blue {verb} per unit of length"
            )));
    }
    Ok(coefficients)
}

/// What passes through the surface of a thing whose own share of light is `passing`.
pub(super) fn shadow_pass(shadow: Option<f64>, tint: Spectrum, passing: f64) -> Spectrum {
    tint * shadow.map_or(passing, |dark| 1.0 - dark)
}

/// A highlight with its parameters; no highlight where its strength is the constant 0.
#[derive(Clone, Debug)]
pub(super) struct Gloss {
    model: HighlightModel,
    strength: NumberInput,
    color: ColorInput,
    exponent: NumberInput,
}

impl Gloss {
    /// Reads `specular`, `exponent`, [`MODEL`] and [`HIGHLIGHT_COLOR`].
    pub(super) fn from_args(args: &Args, builder: &mut Builder) -> Result<Self, Diagnostic> {
        Ok(Self {
            model: match &*args.text("model")? {
                "blinn" => HighlightModel::Blinn,
                _ => HighlightModel::Phong,
            },
            strength: builder.number(args, "specular")?,
            color: builder.color(args, "highlight_color")?,
            exponent: builder.number(args, "exponent")?,
        })
    }

    /// The highlight at a point.
    pub(super) fn at(&self, point: &PatternPoint) -> Option<Highlight> {
        if self.strength.is_zero() {
            return None;
        }
        Some(Highlight {
            model: self.model,
            color: self.color.eval(point) * non_negative(&self.strength, point),
            exponent: non_negative(&self.exponent, point),
            image: false,
        })
    }
}

/// The mirror image of a light on a smooth thing: Blinn's highlight, as wide as its roughness says.
#[derive(Clone, Debug)]
pub(super) struct Glint {
    strength: NumberInput,
    exponent: Option<NumberInput>,
}

impl Glint {
    /// Reads `specular` and [`SHARP_EXPONENT`].
    pub(super) fn from_args(args: &Args, builder: &mut Builder) -> Result<Self, Diagnostic> {
        Ok(Self {
            strength: builder.number(args, "specular")?,
            exponent: args
                .is_written("exponent")
                .then(|| builder.number(args, "exponent"))
                .transpose()?,
        })
    }

    /// The highlight at a point of a thing of this colour and roughness.
    pub(super) fn at(
        &self,
        point: &PatternPoint,
        color: Spectrum,
        roughness: f64,
    ) -> Option<Highlight> {
        if self.strength.is_zero() {
            return None;
        }
        Some(Highlight {
            model: HighlightModel::Blinn,
            color: color * non_negative(&self.strength, point),
            exponent: match &self.exponent {
                Some(written) => non_negative(written, point),
                None => exponent_of(roughness),
            },
            image: true,
        })
    }
}

/// The exponent of Blinn's highlight that is about as wide as a microfacet lobe: `2 / alpha^2 - 2`
/// (Walter et al., "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007, section 5.2,
/// `alpha_p = 2 / alpha_b^2 - 2`), within bounds that keep it visible.
pub(super) fn exponent_of(roughness: f64) -> f64 {
    (2.0 / (roughness * roughness) - 2.0).max(EXPONENTS.0).min(EXPONENTS.1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn highlights_widen_with_roughness() {
        assert_eq!(exponent_of(0.0), 400.0);
        assert_eq!(exponent_of(1.0), 1.0);
        assert!((exponent_of(0.5) - 6.0).abs() < 1e-12);
        assert!((exponent_of(0.1) - 198.0).abs() < 1e-9);
    }

    #[test]
    fn shadows_follow_the_share_unless_told_otherwise() {
        let tint = Spectrum::new(0.0, 1.0, 0.5);
        assert_eq!(shadow_pass(None, tint, 0.5), Spectrum::new(0.0, 0.5, 0.25));
        assert_eq!(shadow_pass(Some(1.0), tint, 0.5), Spectrum::ZERO);
        assert_eq!(shadow_pass(Some(0.0), tint, 0.5), tint);
    }
}
