// SPDX-License-Identifier: MIT OR Apache-2.0
//! `fog(...)`: what is far away fades into one colour.

use dioptric_math::{Spectrum, exp};
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::root::Root;
use crate::build::Builder;

/// The schema of `fog`.
pub static SCHEMA: Schema = Schema {
    kind: "fog",
    category: Category::Setting,
    summary: "what is far away fades into one colour",
    doc: "What a ray sees at the distance d becomes `T x seen + (1 - T) x color`, with the share T that the fog lets\n\
          through:\n\n\
          - `kind = \"exponential\"`: exp(-(d - start) / distance), as in an even haze (Beer and Lambert);\n\
          - `kind = \"squared\"`: exp(-((d - start) / distance)^2), clear near by and dense further on;\n\
          - `kind = \"linear\"`: (end - d) / (end - start), clear up to `start`, nothing but fog from `end` on\n\
          (OpenGL 2.1 specification, section 3.10, has the same three).\n\n\
          T is 1 up to `start`. Where nothing is hit only fog is seen; mirrored and refracted rays fade by their\n\
          own length. Fog does not weaken the lights.",
    params: &[
        Param::new("color", Type::Color, Default::Number(0.7), "Colour of the fog."),
        Param::new(
            "distance",
            Type::Positive,
            Default::Absent,
            "For \"exponential\" and \"squared\": the distance after `start` at which 37 % (1/e) still comes through.",
        ),
        Param::new(
            "kind",
            Type::Choice(&["exponential", "squared", "linear"]),
            Default::Text("exponential"),
            "How it thickens.",
        ),
        Param::new("start", Type::NON_NEGATIVE, Default::Number(0.0), "Where it begins."),
        Param::new(
            "end",
            Type::Positive,
            Default::Absent,
            "For \"linear\": where nothing else is seen.",
        ),
    ],
    example: "fog(\"lightgrey\", distance = 8, start = 4)\n\
              sphere(center = (0.8, 0.6, 1), radius = 0.6, material = matte(\"firebrick\"))\n\
              sphere(center = (-0.9, 0.6, -3), radius = 0.6, material = matte(\"firebrick\"))\n\
              sphere(center = (-3.2, 0.6, -8), radius = 0.6, material = matte(\"firebrick\"))",
};

/// How fog thickens with distance.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Law {
    Exponential,
    Squared,
    Linear,
}

/// Fog, in the space of rays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fog {
    /// Its colour.
    pub color: Spectrum,
    law: Law,
    start: f64,
    /// To 1/e, or to nothing for linear fog, counted from `start`.
    length: f64,
}

impl Fog {
    /// The fog that a node describes.
    ///
    /// # Errors
    /// An argument is wrong, or one that its kind of fog needs is missing.
    pub fn from_args(args: &Args, builder: &Builder, root: &Root) -> Result<Self, Diagnostic> {
        let law = match &*args.text("kind")? {
            "linear" => Law::Linear,
            "squared" => Law::Squared,
            _ => Law::Exponential,
        };
        let (needed, other) =
            if law == Law::Linear { ("end", "distance") } else { ("distance", "end") };
        if args.is_written(other) {
            let kind = args.text("kind")?;
            return Err(args
                .error(other, "contradiction", format!("{other} of fog: {kind} fog has none"))
                .help(format!("write {needed} = ... instead")));
        }
        let Some(length) = args.optional_number(needed)? else {
            let kind = args.text("kind")?;
            return Err(args
                .error_here(
                    "missing-argument",
                    format!("fog needs {needed} where its kind is \"{kind}\""),
                )
                .help(format!("write {needed} = ... in units of the scene")));
        };
        let start = args.number("start")?;
        let length = if law == Law::Linear { length - start } else { length };
        if length <= 0.0 {
            return Err(args
                .error("end", "wrong-value", "end of fog: expected a distance beyond start")
                .help("write an end that is larger than start"));
        }
        Ok(Self {
            color: builder.constant_color(args, "color")?,
            law,
            start: start * root.scale(),
            length: length * root.scale(),
        })
    }

    /// The share that comes through a distance in the space of rays; it may be infinite.
    #[must_use]
    pub fn transmittance(&self, distance: f64) -> f64 {
        if !(distance > self.start) {
            return 1.0;
        }
        let x = (distance - self.start) / self.length;
        match self.law {
            Law::Exponential => exp(-x),
            Law::Squared => exp(-x * x),
            Law::Linear => (1.0 - x).max(0.0),
        }
    }

    /// What is left of a colour seen at a distance in the space of rays, with the fog before it.
    #[must_use]
    pub fn apply(&self, seen: Spectrum, distance: f64) -> Spectrum {
        let t = self.transmittance(distance);
        seen * t + self.color * (1.0 - t)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::build::ColorReading;
    use crate::setting::testing::{scaled_root, with_args};
    use dioptric_scene::Value;

    fn fog(arguments: &[(&str, Value)], scale: f64) -> Result<Fog, Diagnostic> {
        with_args(&SCHEMA, arguments, ColorReading::Raw, |args, builder| {
            Fog::from_args(args, builder, &scaled_root(scale))
        })
    }

    fn kind(word: &str) -> (&'static str, Value) {
        ("kind", Value::Text(word.into()))
    }

    #[test]
    fn the_three_laws_at_known_distances() {
        let number = Value::Number;
        for scale in [1e-6, 1.0, 1e6] {
            let haze = fog(&[("distance", number(10.0)), ("start", number(5.0))], scale).unwrap();
            let thick = fog(&[kind("squared"), ("distance", number(10.0))], scale).unwrap();
            let wall =
                fog(&[kind("linear"), ("start", number(10.0)), ("end", number(30.0))], scale)
                    .unwrap();
            let cases = [
                (haze, 5.0, 1.0),
                (haze, 15.0, 0.367_879_441_171_442_33),
                (haze, 25.0, 0.135_335_283_236_612_7),
                (thick, 20.0, 0.018_315_638_888_734_18),
                (wall, 10.0, 1.0),
                (wall, 15.0, 0.75),
                (wall, 31.0, 0.0),
            ];
            for (fog, distance, expected) in cases {
                assert!(
                    (fog.transmittance(distance * scale) - expected).abs() < 1e-12,
                    "{distance}"
                );
            }
            for fog in [haze, thick, wall] {
                assert_eq!(fog.transmittance(f64::INFINITY), 0.0);
                assert_eq!(fog.apply(Spectrum::X, f64::INFINITY), Spectrum::splat(0.7));
                assert_eq!(fog.apply(Spectrum::X, 0.0), Spectrum::X);
            }
        }
    }

    #[test]
    fn each_kind_asks_for_its_own_distance() {
        let message = |arguments: &[(&str, Value)]| fog(arguments, 1.0).unwrap_err().message;
        assert_eq!(message(&[]), "fog needs distance where its kind is \"exponential\"");
        assert_eq!(message(&[kind("linear")]), "fog needs end where its kind is \"linear\"");
        assert_eq!(
            message(&[kind("linear"), ("distance", Value::Number(1.0))]),
            "distance of fog: linear fog has none"
        );
        assert_eq!(
            message(&[kind("linear"), ("start", Value::Number(5.0)), ("end", Value::Number(5.0))]),
            "end of fog: expected a distance beyond start"
        );
    }
}
