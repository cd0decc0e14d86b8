// SPDX-License-Identifier: MIT OR Apache-2.0
//! The functions and constants that scenes compute with. Angles are in radians, as in Python.

use dioptric_math as f;
use starlark::environment::GlobalsBuilder;
use starlark::eval::Evaluator;
use starlark::starlark_module;
use starlark::values::float::UnpackFloat;
use starlark::values::none::NoneType;
use starlark::values::tuple::AllocTuple;
use starlark::values::{Heap, Value};

use dioptric_scene::Diagnostic;

use super::convert::{items, number};
use super::errors::Raised;
use super::state::State;

/// A result that must be a number; `what` is the call in words.
fn checked(x: f64, what: impl FnOnce() -> String) -> starlark::Result<f64> {
    if x.is_finite() {
        Ok(x)
    } else {
        Err(Raised::error("not-a-number", format!("{} is not a finite number", what())))
    }
}

fn one(name: &str, function: impl Fn(f64) -> f64, x: UnpackFloat) -> starlark::Result<f64> {
    checked(function(x.0), || format!("{name}({})", x.0))
}

fn whole<'v>(name: &str, x: f64, heap: Heap<'v>) -> starlark::Result<Value<'v>> {
    if x.abs() < 9.0e15 {
        Ok(heap.alloc(x as i64))
    } else {
        Err(Raised::error("not-a-number", format!("{name}: {x} is too large")))
    }
}

fn wrong(message: impl Into<String>) -> starlark::Error {
    Raised::error("wrong-value", message)
}

#[starlark_module]
fn scene_functions(builder: &mut GlobalsBuilder) {
    fn sin(#[starlark(require = pos)] x: UnpackFloat) -> starlark::Result<f64> {
        one("sin", f::sin, x)
    }

    fn cos(#[starlark(require = pos)] x: UnpackFloat) -> starlark::Result<f64> {
        one("cos", f::cos, x)
    }

    fn tan(#[starlark(require = pos)] x: UnpackFloat) -> starlark::Result<f64> {
        one("tan", f::tan, x)
    }

    fn asin(#[starlark(require = pos)] x: UnpackFloat) -> starlark::Result<f64> {
        one("asin", f::asin, x)
    }

    fn acos(#[starlark(require = pos)] x: UnpackFloat) -> starlark::Result<f64> {
        one("acos", f::acos, x)
    }

    fn atan(#[starlark(require = pos)] x: UnpackFloat) -> starlark::Result<f64> {
        one("atan", f::atan, x)
    }

    fn atan2(
        #[starlark(require = pos)] y: UnpackFloat,
        #[starlark(require = pos)] x: UnpackFloat,
    ) -> starlark::Result<f64> {
        checked(f::atan2(y.0, x.0), || format!("atan2({}, {})", y.0, x.0))
    }

    fn sqrt(#[starlark(require = pos)] x: UnpackFloat) -> starlark::Result<f64> {
        one("sqrt", f64::sqrt, x)
    }

    fn exp(#[starlark(require = pos)] x: UnpackFloat) -> starlark::Result<f64> {
        one("exp", f::exp, x)
    }

    fn log(
        #[starlark(require = pos)] x: UnpackFloat,
        #[starlark(require = pos)] base: Option<UnpackFloat>,
    ) -> starlark::Result<f64> {
        match base {
            None => one("log", f::ln, x),
            Some(base) => {
                let log = f::ln(x.0) / f::ln(base.0);
                checked(log, || format!("log({}, {})", x.0, base.0))
            }
        }
    }

    fn pow(
        #[starlark(require = pos)] x: UnpackFloat,
        #[starlark(require = pos)] y: UnpackFloat,
    ) -> starlark::Result<f64> {
        checked(f::pow(x.0, y.0), || format!("pow({}, {})", x.0, y.0))
    }

    fn floor<'v>(
        #[starlark(require = pos)] x: UnpackFloat,
        heap: Heap<'v>,
    ) -> starlark::Result<Value<'v>> {
        whole("floor", x.0.floor(), heap)
    }

    fn ceil<'v>(
        #[starlark(require = pos)] x: UnpackFloat,
        heap: Heap<'v>,
    ) -> starlark::Result<Value<'v>> {
        whole("ceil", x.0.ceil(), heap)
    }

    /// Halves go to the even neighbour, as in Python.
    fn round<'v>(
        #[starlark(require = pos)] x: UnpackFloat,
        heap: Heap<'v>,
    ) -> starlark::Result<Value<'v>> {
        whole("round", x.0.round_ties_even(), heap)
    }

    fn degrees(#[starlark(require = pos)] x: UnpackFloat) -> starlark::Result<f64> {
        one("degrees", f64::to_degrees, x)
    }

    fn radians(#[starlark(require = pos)] x: UnpackFloat) -> starlark::Result<f64> {
        one("radians", f64::to_radians, x)
    }

    fn lerp<'v>(
        #[starlark(require = pos)] a: Value<'v>,
        #[starlark(require = pos)] b: Value<'v>,
        #[starlark(require = pos)] t: UnpackFloat,
        heap: Heap<'v>,
    ) -> starlark::Result<Value<'v>> {
        let mix = |a: Value, b: Value| match (number(a), number(b)) {
            (Some(a), Some(b)) => checked(a + (b - a) * t.0, || format!("lerp({a}, {b}, {})", t.0)),
            _ => {
                Err(wrong("lerp takes two numbers, or two lists of as many numbers, and a number"))
            }
        };
        match (items(a), items(b)) {
            (Some(a), Some(b)) if a.len() == b.len() => {
                let mixed: Result<Vec<f64>, _> =
                    a.iter().zip(b).map(|(a, b)| mix(*a, *b)).collect();
                Ok(heap.alloc(AllocTuple(mixed?)))
            }
            _ => Ok(heap.alloc(mix(a, b)?)),
        }
    }

    fn clamp<'v>(
        #[starlark(require = pos)] x: Value<'v>,
        #[starlark(require = pos)] low: Value<'v>,
        #[starlark(require = pos)] high: Value<'v>,
    ) -> starlark::Result<Value<'v>> {
        match (number(x), number(low), number(high)) {
            (Some(a), Some(l), Some(h)) if l <= h => Ok(if a < l {
                low
            } else if a > h {
                high
            } else {
                x
            }),
            (Some(_), Some(l), Some(h)) => {
                Err(wrong(format!("clamp from {l} to {h}: nothing lies there")))
            }
            _ => Err(wrong("clamp takes three numbers: x, low, high")),
        }
    }

    fn sum<'v>(
        #[starlark(require = pos)] list: Value<'v>,
        heap: Heap<'v>,
    ) -> starlark::Result<Value<'v>> {
        let mut total = heap.alloc(0);
        for item in list.iterate(heap)? {
            if number(item).is_none() {
                return Err(wrong("sum takes a list of numbers"));
            }
            total = total.add(item, heap)?;
        }
        Ok(total)
    }

    /// The language that the file is written in.
    fn version(#[starlark(require = pos)] number: i32) -> starlark::Result<NoneType> {
        if number == 1 {
            return Ok(NoneType);
        }
        Err(Raised::with(
            Diagnostic::error("version", format!("this program reads version 1, not {number}"))
                .help("write version(1), or use a newer program"),
        ))
    }

    /// Seconds since the animation's start.
    fn time(eval: &mut Evaluator) -> starlark::Result<f64> {
        Ok(State::of(eval)?.options.time)
    }

    /// The number of the animation's picture.
    fn frame(eval: &mut Evaluator) -> starlark::Result<i32> {
        Ok(State::of(eval)?.options.frame)
    }
}

pub(super) fn register(builder: &mut GlobalsBuilder) {
    scene_functions(builder);
    builder.set("pi", std::f64::consts::PI);
    builder.set("tau", std::f64::consts::TAU);
}
