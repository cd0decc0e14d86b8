// SPDX-License-Identifier: MIT OR Apache-2.0
//! `ambient(...)`: light that comes from everywhere and casts no shadow.

use dioptric_math::Spectrum;
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use crate::build::Builder;

/// The schema of `ambient`.
pub static SCHEMA: Schema = Schema {
    kind: "ambient",
    category: Category::Setting,
    summary: "light from everywhere, in shadow and out",
    doc: "Stands for all light that reaches a point by way of other things. A surface shows\n\
          `intensity x color x` its own ambient colour, besides what the lights give it; shadows would be black\n\
          without it. `intensity` is a share of light and never decoded: `ambient(0.2)` with a light of intensity\n\
          0.8 makes white at most 1.",
    params: &[
        Param::new(
            "intensity",
            Type::NON_NEGATIVE,
            Default::Number(1.0),
            "How strong it is; multiplies the colour.",
        ),
        Param::new("color", Type::Color, Default::Number(1.0), "Its colour."),
    ],
    example: "ambient(0.35, \"lightskyblue\")",
};

/// The ambient light that a node describes.
///
/// # Errors
/// An argument is wrong.
pub fn from_args(args: &Args, builder: &Builder) -> Result<Spectrum, Diagnostic> {
    Ok(builder.constant_color(args, "color")? * args.number("intensity")?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::build::ColorReading;
    use crate::setting::testing::with_args;
    use dioptric_scene::Value;

    #[test]
    fn the_intensity_is_a_share_of_light_and_the_colour_is_decoded() {
        let half = ("intensity", Value::Number(0.5));
        let read = |arguments: &[(&str, Value)], reading| {
            with_args(&SCHEMA, arguments, reading, |args, builder| from_args(args, builder))
                .unwrap()
        };
        for reading in [ColorReading::Srgb, ColorReading::Raw] {
            assert_eq!(read(std::slice::from_ref(&half), reading), Spectrum::splat(0.5));
        }
        let grey = ("color", Value::Number(0.2));
        assert_eq!(read(std::slice::from_ref(&grey), ColorReading::Raw), Spectrum::splat(0.2));
        let decoded = read(&[half, grey], ColorReading::Srgb);
        assert!((decoded.x - 0.5 * crate::build::srgb_to_linear(0.2)).abs() < 1e-15);
    }
}
