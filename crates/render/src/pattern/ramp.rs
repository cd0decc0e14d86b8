// SPDX-License-Identifier: MIT OR Apache-2.0
//! A pattern's value, turned into colours by a table.

use dioptric_math::Spectrum;
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type, Value};

use super::place::{blend, smooth_step};
use super::{Pattern, PatternPoint};
use crate::build::Builder;
use crate::input::{ColorInput, NumberInput};

/// What is between two stops.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Interpolation {
    Linear,
    Smooth,
    Constant,
}

/// A table of colours over a number.
#[derive(Clone, Debug)]
pub struct Ramp {
    value: NumberInput,
    /// Sorted by position, at least one.
    stops: Vec<(f64, ColorInput)>,
    interpolation: Interpolation,
}

static SCHEMA: Schema = Schema {
    kind: "ramp",
    category: Category::Pattern,
    summary: "a pattern's value turned into colours by a list of stops",
    doc: "The luminance of `pattern` is looked up among the stops. Before the first and after the last stop\n\
          their colours go on. Two stops at one position make a sharp edge; colours are mixed in linear\n\
          light, and a stop's colour may itself be a pattern.",
    params: &[
        Param::required(
            "pattern",
            Type::NumberPattern { min: f64::NEG_INFINITY, max: f64::INFINITY },
            "Where the numbers come from.",
        ),
        Param::required(
            "stops",
            Type::List(&Type::Pair(&Type::NUMBER, &Type::ColorPattern)),
            "Pairs (position, colour) with rising positions, mostly from 0 to 1.",
        ),
        Param::new(
            "interpolation",
            Type::Choice(&["linear", "smooth", "constant"]),
            Default::Text("linear"),
            "Between two stops: a straight passage, one without kinks, or the first one's colour.",
        ),
    ],
    example: "sphere(center = (0, 1, 0), radius = 1, material = matte(ramp(turbulence(size = 0.8), [(0, \"black\"), (0.2, \"firebrick\"), (0.4, \"orange\"), (0.7, \"lightyellow\")])))",
};

impl Pattern for Ramp {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args, builder: &mut Builder) -> Result<Self, Diagnostic> {
        let mut stops: Vec<(f64, ColorInput)> = Vec::new();
        for item in args.list("stops")? {
            let items = item.items();
            let [Value::Number(position), color] = items.as_slice() else {
                return Err(args.error("stops", "wrong-value", "stops of ramp: expected pairs"));
            };
            if stops.last().is_some_and(|(last, _)| !(position >= last)) {
                return Err(args
                    .error(
                        "stops",
                        "wrong-value",
                        format!("stops of ramp: position {position} comes after a larger one"),
                    )
                    .help("sort the stops by their positions"));
            }
            stops.push((*position, builder.color_value(args, "stops", color)?));
        }
        if stops.is_empty() {
            return Err(args
                .error("stops", "wrong-value", "ramp needs at least one stop")
                .help("write stops = [(0, \"black\"), (1, \"white\")]"));
        }
        Ok(Self {
            value: builder.number(args, "pattern")?,
            stops,
            interpolation: match &*args.text("interpolation")? {
                "smooth" => Interpolation::Smooth,
                "constant" => Interpolation::Constant,
                _ => Interpolation::Linear,
            },
        })
    }

    fn eval(&self, point: &PatternPoint) -> Spectrum {
        let x = self.value.eval(point);
        // The first stop beyond x; stops at x itself lie before.
        let next = self.stops.partition_point(|(position, _)| *position <= x);
        let before = next.checked_sub(1).and_then(|i| self.stops.get(i));
        match (before, self.stops.get(next)) {
            (Some((from, a)), Some((to, b))) => {
                let t = match self.interpolation {
                    Interpolation::Linear => (x - from) / (to - from),
                    Interpolation::Smooth => smooth_step(*from, to - from, x),
                    Interpolation::Constant => 0.0,
                };
                blend(a, b, t, point)
            }
            (Some((_, only)), None) | (None, Some((_, only))) => only.eval(point),
            (None, None) => Spectrum::ZERO,
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::pattern::testing::{Bench, at, grey, n, t, v};
    use dioptric_scene::Value;

    fn stops(pairs: &[(f64, f64)]) -> Value {
        Value::from_items(pairs.iter().map(|&(p, c)| Value::Vec2([p, c])).collect())
    }

    #[test]
    fn values_at_between_and_beyond_the_stops() {
        let mut bench = Bench::default();
        let height = bench.node("gradient", &[("end", v(0.0, 10.0, 0.0))]);
        let table = stops(&[(0.2, 1.0), (0.4, 3.0), (0.4, 5.0), (0.8, 9.0)]);
        let mut ramp = |how: &str| {
            let args = [
                ("pattern", Value::Node(height)),
                ("stops", table.clone()),
                ("interpolation", t(how)),
            ];
            let id = bench.node("ramp", &args);
            bench.build(id).unwrap()
        };
        let (linear, smooth, constant) = (ramp("linear"), ramp("smooth"), ramp("constant"));
        for (y, l, s, c) in [
            (0.0, 1.0, 1.0, 1.0),
            (3.0, 2.0, 2.0, 1.0),
            (4.0, 5.0, 5.0, 5.0),
            (5.0, 6.0, 5.625, 5.0),
            (8.0, 9.0, 9.0, 9.0),
            (20.0, 9.0, 9.0, 9.0),
        ] {
            let p = at(1.0, y, 2.0);
            assert!((linear.eval(&p) - grey(l)).length() < 1e-12, "{y}");
            assert!((smooth.eval(&p) - grey(s)).length() < 1e-12, "{y}");
            assert_eq!(constant.eval(&p), grey(c), "{y}");
        }
    }

    #[test]
    fn unsorted_and_empty_stops_are_refused() {
        let build = |stops: Value| {
            let mut bench = Bench::default();
            let id = bench.node("ramp", &[("pattern", n(0.5)), ("stops", stops)]);
            bench.build(id).unwrap_err().message
        };
        assert_eq!(
            build(stops(&[(0.5, 1.0), (0.2, 1.0)])),
            "stops of ramp: position 0.2 comes after a larger one"
        );
        assert_eq!(build(Value::List([].into())), "ramp needs at least one stop");
        assert!(build(n(3.0)).starts_with("stops of ramp: item 1: expected a pair"));
    }
}
