// SPDX-License-Identifier: MIT OR Apache-2.0
//! `param("name", default)`: values of a scene that can be set from outside.

use dioptric_scene::{Diagnostic, Value, color};
use starlark::environment::GlobalsBuilder;
use starlark::eval::Evaluator;
use starlark::starlark_module;
use starlark::values;
use starlark::values::float::UnpackFloat;
use starlark::values::none::NoneOr;

use super::convert::{convert, items, to_starlark};
use super::errors::Raised;
use super::state::State;
use crate::options::ParamInfo;

#[starlark_module]
fn param_function(builder: &mut GlobalsBuilder) {
    /// The value of `--set name=value`, else the default.
    fn param<'v>(
        name: &str,
        default: values::Value<'v>,
        #[starlark(require = named, default = NoneOr::None)] min: NoneOr<UnpackFloat>,
        #[starlark(require = named, default = NoneOr::None)] max: NoneOr<UnpackFloat>,
        #[starlark(require = named, default = NoneOr::None)] choices: NoneOr<values::Value<'v>>,
        #[starlark(require = named, default = "")] doc: &str,
        eval: &mut Evaluator<'v, '_, '_>,
    ) -> starlark::Result<values::Value<'v>> {
        let state = State::of(eval)?;
        let (span, _) = state.place(eval);
        let wrong = |message: String| Raised::error("wrong-parameter", message);
        let plain = |value: values::Value| match convert(value) {
            Ok(Value::Node(_)) => Err(wrong(format!("the parameter {name} cannot be a node"))),
            Ok(value) => Ok(value),
            Err(got) => Err(wrong(format!("the parameter {name} cannot be {got}"))),
        };
        let choices = match choices {
            NoneOr::None => Vec::new(),
            NoneOr::Other(list) => match items(list) {
                Some(list) => list.iter().map(|item| plain(*item)).collect::<Result<_, _>>()?,
                None => {
                    return Err(wrong(format!("choices of the parameter {name}: expected a list")));
                }
            },
        };
        let bound = |bound: NoneOr<UnpackFloat>| bound.into_option().map(|b| b.0);
        let mut info = ParamInfo {
            name: name.into(),
            doc: doc.into(),
            default: plain(default)?,
            value: Value::Bool(false),
            min: bound(min),
            max: bound(max),
            choices,
            span,
        };
        let set = state.options.set.iter().rfind(|(key, _)| key == name);
        info.value = match set {
            None => info.default.clone(),
            Some((_, text)) => parse(text, &info.default).map_err(|expected| {
                let message = format!("--set {name}={text}: expected {expected}");
                Raised::with(Diagnostic::error("wrong-setting", message))
            })?,
        };
        if let Err(why) = check(&info) {
            let origin =
                if set.is_some() { format!("--set {name}") } else { format!("default of {name}") };
            return Err(Raised::with(Diagnostic::error(
                "wrong-setting",
                format!("{origin}: {why}"),
            )));
        }
        // A whole default stays an integer in the scene, so that range(param("n", 5)) works.
        let value = match set {
            None => default,
            Some((_, text)) => {
                let whole = default.unpack_i32().is_some() && text.trim().parse::<i64>().is_ok();
                to_starlark(&info.value, whole, eval.heap())
            }
        };
        state.add_param(info);
        Ok(value)
    }
}

pub(super) fn register(builder: &mut GlobalsBuilder) {
    param_function(builder);
}

/// The value that a text means for a parameter with this default; what was expected where it is none.
fn parse(text: &str, default: &Value) -> Result<Value, String> {
    let text = text.trim();
    let number = |text: &str| text.trim().parse::<f64>().ok().filter(|x| x.is_finite());
    let list = |text: &str| -> Option<Vec<f64>> {
        let text = text.strip_prefix(['(', '[']).unwrap_or(text);
        let text = text.strip_suffix([')', ']']).unwrap_or(text);
        text.split(',').map(number).collect()
    };
    match default {
        Value::Bool(_) => match text.to_ascii_lowercase().as_str() {
            "true" | "yes" | "on" | "1" => Ok(Value::Bool(true)),
            "false" | "no" | "off" | "0" => Ok(Value::Bool(false)),
            _ => Err("true or false".into()),
        },
        Value::Number(_) => number(text).map(Value::Number).ok_or_else(|| "a number".into()),
        Value::Text(_) => Ok(Value::Text(text.into())),
        Value::Vec2(_) => match list(text).as_deref() {
            Some(&[x, y]) => Ok(Value::Vec2([x, y])),
            _ => Err("two numbers x,y".into()),
        },
        Value::Vec3(_) => match list(text).as_deref() {
            Some(&[x, y, z]) => Ok(Value::Vec3([x, y, z])),
            _ => color::from_value(&Value::Text(text.into()))
                .map(Value::Vec3)
                .map_err(|_| "three numbers x,y,z or a colour".into()),
        },
        Value::List(_) => match list(text) {
            Some(numbers) => Ok(Value::List(numbers.into_iter().map(Value::Number).collect())),
            None => Err("numbers with commas between them".into()),
        },
        Value::Node(_) => Err("nothing: nodes cannot be set".into()),
    }
}

fn check(info: &ParamInfo) -> Result<(), String> {
    if let Value::Number(x) = info.value {
        let (min, max) = (info.min.unwrap_or(f64::NEG_INFINITY), info.max.unwrap_or(f64::INFINITY));
        if !(x >= min && x <= max) {
            let expected = match (info.min, info.max) {
                (Some(min), Some(max)) => format!("a number from {min} to {max}"),
                (Some(min), None) => format!("a number of at least {min}"),
                (None, Some(max)) => format!("a number of at most {max}"),
                (None, None) => "a number".into(),
            };
            return Err(format!("expected {expected}, got {x}"));
        }
    }
    if !info.choices.is_empty() && !info.choices.contains(&info.value) {
        let words: Vec<String> = info.choices.iter().map(word).collect();
        return Err(format!("expected one of {}, got {}", words.join(", "), word(&info.value)));
    }
    Ok(())
}

fn word(value: &Value) -> String {
    match value {
        Value::Bool(b) => b.to_string(),
        Value::Number(x) => x.to_string(),
        Value::Text(text) => format!("\"{text}\""),
        other => {
            let items: Vec<String> = other.items().iter().map(word).collect();
            format!("({})", items.join(", "))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_type_of_the_default_decides_what_a_text_means() {
        let text = |t: &str| Value::Text(t.into());
        assert_eq!(parse(" 2.5 ", &Value::Number(1.0)), Ok(Value::Number(2.5)));
        assert_eq!(parse("off", &Value::Bool(true)), Ok(Value::Bool(false)));
        assert_eq!(parse("1", &text("a")), Ok(text("1")));
        assert_eq!(parse("1,2,3", &Value::Vec3([0.0; 3])), Ok(Value::Vec3([1.0, 2.0, 3.0])));
        assert_eq!(parse("(1, 2)", &Value::Vec2([0.0; 2])), Ok(Value::Vec2([1.0, 2.0])));
        assert_eq!(parse("red", &Value::Vec3([0.0; 3])), Ok(Value::Vec3([1.0, 0.0, 0.0])));
        for (wrong, default) in [
            ("x", Value::Number(1.0)),
            ("nan", Value::Number(1.0)),
            ("inf", Value::Number(1.0)),
            ("maybe", Value::Bool(true)),
            ("1,2", Value::Vec3([0.0; 3])),
            ("", Value::Vec2([0.0; 2])),
        ] {
            assert!(parse(wrong, &default).is_err(), "{wrong}");
        }
    }
}
