// SPDX-License-Identifier: MIT OR Apache-2.0
//! Smooth random blotches.

use dioptric_math::Spectrum;
use dioptric_scene::{Args, Category, Diagnostic, Param, Schema};

use super::perlin::Perlin;
use super::place::{self, Place, blend};
use super::{Pattern, PatternPoint};
use crate::build::Builder;
use crate::input::ColorInput;

/// One octave of gradient noise.
#[derive(Clone, Debug)]
pub struct Noise {
    low: ColorInput,
    high: ColorInput,
    noise: Perlin,
    place: Place,
}

const PARAMS: &[Param] =
    &[place::LOW, place::HIGH, place::FEATURE_SIZE, place::SEED, place::OFFSET, place::SPACE];

static SCHEMA: Schema = Schema {
    kind: "noise",
    category: Category::Pattern,
    summary: "smooth random blotches",
    doc: "Perlin's improved gradient noise (\"Improving Noise\", SIGGRAPH 2002) with a permutation of its own\n\
          for each seed, divided by its largest possible value, so that 0 and 1 are never passed: most values\n\
          lie between 0.2 and 0.8, and the value is 0.5 at every whole multiple of `size`. It repeats after\n\
          256 times `size`.",
    params: PARAMS,
    example: "sphere(center = (0, 1, 0), radius = 1, material = matte(noise(\"darkgreen\", \"khaki\", size = 0.3)))",
};

impl Pattern for Noise {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args, builder: &mut Builder) -> Result<Self, Diagnostic> {
        Ok(Self {
            low: builder.color(args, "low")?,
            high: builder.color(args, "high")?,
            noise: Perlin::from_args(args)?,
            place: Place::from_args(args)?,
        })
    }

    fn eval(&self, point: &PatternPoint) -> Spectrum {
        let t = 0.5 + 0.5 * self.noise.noise(self.place.of(point));
        blend(&self.low, &self.high, t, point)
    }
}

#[cfg(test)]
mod tests {
    use crate::pattern::testing::{at, grey, n, pattern, v};

    #[test]
    fn half_at_whole_multiples_of_the_size() {
        let noise = pattern("noise", &[("size", n(0.5)), ("offset", v(1.0, 0.0, 0.0))]);
        assert_eq!(noise.eval(&at(2.5, -1.0, 0.5)), grey(0.5));
        assert_ne!(noise.eval(&at(2.6, -1.1, 0.7)), grey(0.5));
    }
}
