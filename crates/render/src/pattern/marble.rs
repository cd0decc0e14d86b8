// SPDX-License-Identifier: MIT OR Apache-2.0
//! Marble: layers of colour, folded by turbulence.

use std::f64::consts::TAU;

use dioptric_math::{DVec3, Spectrum, normalize, pow, sin};
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::perlin::{GAIN, LACUNARITY, OCTAVES, Octaves};
use super::place::{self, Place, blend};
use super::{Pattern, PatternPoint};
use crate::build::Builder;
use crate::input::ColorInput;

/// Veined stone.
#[derive(Clone, Debug)]
pub struct Marble {
    base: ColorInput,
    vein: ColorInput,
    direction: DVec3,
    strength: f64,
    sharpness: f64,
    octaves: Octaves,
    place: Place,
}

static SCHEMA: Schema = Schema {
    kind: "marble",
    category: Category::Pattern,
    summary: "veined stone",
    doc: "Perlin's marble (\"An Image Synthesizer\", SIGGRAPH 1985): with x the distance along `direction` in\n\
          units of `size` and T the turbulence there, the share of the vein's colour is\n\
          `(1/2 + 1/2 sin(2 pi (x + strength T)))^sharpness`.",
    params: &[
        Param::new("base", Type::ColorPattern, Default::Number(0.95), "Colour of the stone."),
        Param::new("vein", Type::ColorPattern, Default::Number(0.2), "Colour of the veins."),
        Param::new("size", Type::Scale, Default::Number(1.0), "Distance from vein to vein."),
        Param::new(
            "direction",
            Type::Direction,
            Default::Vec3([1.0, 0.0, 0.0]),
            "Across the veins; its length does not count.",
        ),
        Param::new(
            "strength",
            Type::NON_NEGATIVE,
            Default::Number(2.0),
            "How far the turbulence moves the veins, in units of `size`; 0 leaves them straight.",
        ),
        Param::new(
            "sharpness",
            Type::Positive,
            Default::Number(3.0),
            "Larger numbers make thinner veins.",
        ),
        OCTAVES,
        LACUNARITY,
        GAIN,
        place::SEED,
        place::OFFSET,
        place::SPACE,
    ],
    example: "sphere(center = (0, 1, 0), radius = 1, material = matte(marble(\"white\", \"darkslategray\", size = 0.7, direction = (1, 1, 0))))",
};

impl Pattern for Marble {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args, builder: &mut Builder) -> Result<Self, Diagnostic> {
        Ok(Self {
            base: builder.color(args, "base")?,
            vein: builder.color(args, "vein")?,
            direction: normalize(args.vec3("direction")?.into()).unwrap_or(DVec3::X),
            strength: args.number("strength")?,
            sharpness: args.number("sharpness")?,
            octaves: Octaves::from_args(args)?,
            place: Place::from_args(args)?,
        })
    }

    fn eval(&self, point: &PatternPoint) -> Spectrum {
        let p = self.place.of(point);
        let x = p.dot(self.direction) + self.strength * self.octaves.turbulence(p);
        // Whole turns are taken off first, so that the sine's argument is small and exact.
        let wave = 0.5 + 0.5 * sin(TAU * (x - x.floor()));
        blend(&self.base, &self.vein, pow(wave, self.sharpness), point)
    }
}

#[cfg(test)]
mod tests {
    use crate::pattern::testing::{at, n, pattern};

    #[test]
    fn without_turbulence_the_veins_are_straight() {
        let args =
            [("base", n(0.0)), ("vein", n(1.0)), ("strength", n(0.0)), ("sharpness", n(1.0))];
        let m = pattern("marble", &args);
        for (x, value) in [(0.0, 0.5), (0.25, 1.0), (0.5, 0.5), (0.75, 0.0), (7.25, 1.0)] {
            assert!((m.eval(&at(x, 3.3, 4.4)).x - value).abs() < 1e-12, "{x}");
        }
        let folded = pattern("marble", &[("base", n(0.0)), ("vein", n(1.0))]);
        assert!((folded.eval(&at(0.25, 3.3, 4.4)).x - 1.0).abs() > 1e-6);
    }
}
