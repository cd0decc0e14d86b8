// SPDX-License-Identifier: MIT OR Apache-2.0
//! Clouds, smoke and fire: noise on many scales.

use dioptric_math::Spectrum;
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::perlin::{GAIN, LACUNARITY, OCTAVES, Octaves};
use super::place::{self, Place, blend};
use super::{Pattern, PatternPoint};
use crate::build::Builder;
use crate::input::ColorInput;

/// A sum of octaves of noise.
#[derive(Clone, Debug)]
pub struct Turbulence {
    low: ColorInput,
    high: ColorInput,
    octaves: Octaves,
    /// Sum of the signed values instead of the absolute ones.
    signed: bool,
    place: Place,
}

static SCHEMA: Schema = Schema {
    kind: "turbulence",
    category: Category::Pattern,
    summary: "clouds and smoke: noise on many scales",
    doc: "The sum over the octaves of `gain^i |noise(lacunarity^i p)|`, divided by the sum of the weights\n\
          (Perlin, \"An Image Synthesizer\", SIGGRAPH 1985): dark creases between bright billows, values\n\
          mostly from 0 to 0.5. `form = \"fbm\"` leaves out the absolute values (fractional Brownian\n\
          motion): clouds without creases around 0.5.",
    params: &[
        place::LOW,
        place::HIGH,
        place::FEATURE_SIZE,
        OCTAVES,
        LACUNARITY,
        GAIN,
        Param::new(
            "form",
            Type::Choice(&["turbulence", "fbm"]),
            Default::Text("turbulence"),
            "With creases, or without.",
        ),
        place::SEED,
        place::OFFSET,
        place::SPACE,
    ],
    example: "sphere(center = (0, 1, 0), radius = 1, material = matte(ramp(turbulence(form = \"fbm\"), [(0.4, \"royalblue\"), (0.6, \"white\")])))",
};

impl Pattern for Turbulence {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args, builder: &mut Builder) -> Result<Self, Diagnostic> {
        Ok(Self {
            low: builder.color(args, "low")?,
            high: builder.color(args, "high")?,
            octaves: Octaves::from_args(args)?,
            signed: &*args.text("form")? == "fbm",
            place: Place::from_args(args)?,
        })
    }

    fn eval(&self, point: &PatternPoint) -> Spectrum {
        let p = self.place.of(point);
        let t =
            if self.signed { 0.5 + 0.5 * self.octaves.fbm(p) } else { self.octaves.turbulence(p) };
        blend(&self.low, &self.high, t, point)
    }
}
