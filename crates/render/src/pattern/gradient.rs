// SPDX-License-Identifier: MIT OR Apache-2.0
//! From one colour to another along a line or outward from a point.

use dioptric_math::{DVec3, Spectrum, atan2, normalize, orthonormal_basis};
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::place::{self, blend};
use super::{Pattern, PatternPoint, Space};
use crate::build::Builder;
use crate::input::ColorInput;

/// How the distance is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Form {
    Linear,
    Radial,
    Angular,
}

/// What happens beyond the end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Wrap {
    Clamp,
    Repeat,
    Mirror,
}

/// A smooth passage between two colours.
#[derive(Clone, Debug)]
pub struct Gradient {
    low: ColorInput,
    high: ColorInput,
    form: Form,
    wrap: Wrap,
    start: DVec3,
    /// From start to end: unit vector and length.
    direction: DVec3,
    length: f64,
    space: Space,
}

static SCHEMA: Schema = Schema {
    kind: "gradient",
    category: Category::Pattern,
    summary: "a smooth passage from one colour to another",
    doc: "The value goes from 0 at `start` to 1 at `end`. \"linear\": along the line between them, the same\n\
          across it. \"radial\": by the distance from `start`, 1 on the sphere through `end`. \"angular\": by\n\
          the angle around the axis from `start` to `end`, once around from 0 to 1.\n\n\
          Beyond the end the last colour stays (\"clamp\"), the passage begins again (\"repeat\") or runs back\n\
          (\"mirror\"). The colours are mixed in linear light. A passage through more colours is a `ramp`\n\
          over this pattern.",
    params: &[
        place::LOW,
        place::HIGH,
        Param::new("start", Type::Vec3, Default::Vec3([0.0; 3]), "Where the value is 0."),
        Param::new("end", Type::Vec3, Default::Vec3([0.0, 1.0, 0.0]), "Where the value is 1."),
        Param::new(
            "form",
            Type::Choice(&["linear", "radial", "angular"]),
            Default::Text("linear"),
            "How the distance is measured.",
        ),
        Param::new(
            "wrap",
            Type::Choice(&["clamp", "repeat", "mirror"]),
            Default::Text("clamp"),
            "What happens beyond the end.",
        ),
        place::SPACE,
    ],
    example: "sphere(center = (0, 1, 0), radius = 1, material = matte(gradient(\"midnightblue\", \"orange\", end = (0, 2, 0))))",
};

impl Gradient {
    /// Whether nothing of it depends on coordinates on surfaces.
    pub(crate) fn ignores_uv(&self) -> bool {
        let plain = |color: &ColorInput| matches!(color, ColorInput::Constant(_));
        !matches!(self.space, Space::Uv) && plain(&self.low) && plain(&self.high)
    }
}

impl Pattern for Gradient {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args, builder: &mut Builder) -> Result<Self, Diagnostic> {
        let start = DVec3::from(args.vec3("start")?);
        let line = DVec3::from(args.vec3("end")?) - start;
        let Some(direction) = normalize(line) else {
            return Err(args
                .error("end", "wrong-value", "gradient: start and end are the same point")
                .help("write two different points"));
        };
        Ok(Self {
            low: builder.color(args, "low")?,
            high: builder.color(args, "high")?,
            form: match &*args.text("form")? {
                "radial" => Form::Radial,
                "angular" => Form::Angular,
                _ => Form::Linear,
            },
            wrap: match &*args.text("wrap")? {
                "repeat" => Wrap::Repeat,
                "mirror" => Wrap::Mirror,
                _ => Wrap::Clamp,
            },
            start,
            direction,
            length: line.dot(direction),
            space: place::space(args)?,
        })
    }

    fn eval(&self, point: &PatternPoint) -> Spectrum {
        let p = self.space.of(point) - self.start;
        let t = match self.form {
            Form::Linear => p.dot(self.direction) / self.length,
            Form::Radial => p.length() / self.length,
            Form::Angular => {
                let (a, b) = orthonormal_basis(self.direction);
                atan2(p.dot(a), p.dot(b)) / std::f64::consts::TAU + 0.5
            }
        };
        let t = match self.wrap {
            Wrap::Clamp => t,
            Wrap::Repeat => t - t.floor(),
            Wrap::Mirror => 1.0 - (t.rem_euclid(2.0) - 1.0).abs(),
        };
        blend(&self.low, &self.high, t, point)
    }
}

#[cfg(test)]
mod tests {
    use crate::pattern::testing::{at, grey, pattern, t, try_pattern, v};

    #[test]
    fn linear_values_at_the_ends_between_and_beyond() {
        let end = ("end", v(0.0, 0.0, 4.0));
        let clamp = pattern("gradient", std::slice::from_ref(&end));
        let repeat = pattern("gradient", &[end.clone(), ("wrap", t("repeat"))]);
        let mirror = pattern("gradient", &[end, ("wrap", t("mirror"))]);
        for (z, c, r, m) in [
            (0.0, 0.0, 0.0, 0.0),
            (1.0, 0.25, 0.25, 0.25),
            (5.0, 1.0, 0.25, 0.75),
            (-1.0, 0.0, 0.75, 0.25),
            (-7.0, 0.0, 0.25, 0.25),
        ] {
            let p = at(3.0, -2.0, z);
            assert_eq!(clamp.eval(&p), grey(c), "{z}");
            assert_eq!(repeat.eval(&p), grey(r), "{z}");
            assert_eq!(mirror.eval(&p), grey(m), "{z}");
        }
    }

    #[test]
    fn radial_and_angular() {
        let radial = pattern("gradient", &[("form", t("radial")), ("end", v(0.0, 10.0, 0.0))]);
        assert_eq!(radial.eval(&at(3.0, 0.0, 4.0)), grey(0.5));
        let angular = pattern("gradient", &[("form", t("angular"))]);
        let value = |a: f64| angular.eval(&at(dioptric_math::cos(a), 5.0, dioptric_math::sin(a))).x;
        let steps: Vec<f64> =
            (0..8).map(|i| value(0.1 + f64::from(i) * std::f64::consts::FRAC_PI_4)).collect();
        let rising =
            steps.windows(2).filter(|w| ((w[1] - w[0]).abs() - 0.125).abs() < 1e-4).count();
        assert_eq!(rising, 6, "seven steps of an eighth, one of them over the seam: {steps:?}");
    }

    #[test]
    fn a_gradient_needs_two_points() {
        let error = try_pattern("gradient", &[("end", v(0.0, 0.0, 0.0))]).unwrap_err();
        assert_eq!(error.message, "gradient: start and end are the same point");
    }
}
