// SPDX-License-Identifier: MIT OR Apache-2.0
//! Wood: year rings around a trunk's axis.

use dioptric_math::{DVec3, Spectrum, normalize};
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::perlin::Octaves;
use super::place::{self, Place, blend, smooth_step};
use super::{Pattern, PatternPoint};
use crate::build::Builder;
use crate::input::ColorInput;

/// Rings that bend and waver.
#[derive(Clone, Debug)]
pub struct Wood {
    light: ColorInput,
    dark: ColorInput,
    axis: DVec3,
    strength: f64,
    octaves: Octaves,
    place: Place,
}

static SCHEMA: Schema = Schema {
    kind: "wood",
    category: Category::Pattern,
    summary: "year rings around an axis",
    doc: "With r the distance from the axis through `offset` in units of `size` and N a noise of two octaves\n\
          that is stretched along the axis: the ring's phase is the fraction of `r + strength N`. A ring\n\
          darkens slowly through its summer (phase 0 to 0.8) and lightens fast in spring, as real rings do.\n\
          After the rings of Perlin, \"An Image Synthesizer\", SIGGRAPH 1985.",
    params: &[
        Param::new(
            "light",
            Type::ColorPattern,
            Default::Vec3([0.76, 0.54, 0.3]),
            "Colour of the wood that grew in spring.",
        ),
        Param::new(
            "dark",
            Type::ColorPattern,
            Default::Vec3([0.42, 0.24, 0.1]),
            "Colour of the wood that grew in autumn.",
        ),
        Param::new("size", Type::Scale, Default::Number(0.15), "Thickness of a ring."),
        Param::new(
            "axis",
            Type::Direction,
            Default::Vec3([0.0, 1.0, 0.0]),
            "Along the trunk; its length does not count.",
        ),
        Param::new(
            "strength",
            Type::NON_NEGATIVE,
            Default::Number(0.6),
            "How far the rings waver, in rings; 0 makes them round.",
        ),
        place::SEED,
        place::OFFSET,
        place::SPACE,
    ],
    example: "box(min = (-1, 0, -1), max = (1, 2, 1), material = matte(wood(offset = (-0.6, 0, 0.4), axis = (0.2, 1, 0.1))))",
};

impl Pattern for Wood {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args, builder: &mut Builder) -> Result<Self, Diagnostic> {
        Ok(Self {
            light: builder.color(args, "light")?,
            dark: builder.color(args, "dark")?,
            axis: normalize(args.vec3("axis")?.into()).unwrap_or(DVec3::Y),
            strength: args.number("strength")?,
            octaves: Octaves::two(args.integer("seed")? as u64),
            place: Place::from_args(args)?,
        })
    }

    fn eval(&self, point: &PatternPoint) -> Spectrum {
        let p = self.place.of(point);
        let along = p.dot(self.axis);
        let across = p - self.axis * along;
        // Features a few rings wide and many rings long.
        let grain = across * 0.3 + self.axis * (along * 0.05);
        let rings = across.length() + self.strength * self.octaves.fbm(grain);
        let phase = rings - rings.floor();
        let darkness = if phase < 0.8 {
            smooth_step(0.0, 0.8, phase)
        } else {
            1.0 - smooth_step(0.8, 0.2, phase)
        };
        blend(&self.light, &self.dark, darkness, point)
    }
}

#[cfg(test)]
mod tests {
    use crate::pattern::testing::{at, n, pattern};

    #[test]
    fn without_wavering_the_rings_are_round_and_run_along_the_axis() {
        let args = [("light", n(0.0)), ("dark", n(1.0)), ("size", n(1.0)), ("strength", n(0.0))];
        let w = pattern("wood", &args);
        for (r, value) in [(0.0, 0.0), (0.4, 0.5), (0.8, 1.0), (0.9, 0.5), (3.4, 0.5)] {
            assert!((w.eval(&at(r, -7.0, 0.0)).x - value).abs() < 1e-12, "{r}");
            let turned = w.eval(&at(0.6 * r, 99.0, -0.8 * r)).x;
            assert!((turned - value).abs() < 1e-9, "{r}");
        }
    }
}
