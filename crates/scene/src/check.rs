// SPDX-License-Identifier: MIT OR Apache-2.0
//! Whether a value suits a parameter, and what to say where it does not.

use crate::color;
use crate::description::Description;
use crate::schema::{Category, Param, Schema, Type};
use crate::suggest;
use crate::value::Value;

/// Checks a value against a parameter's type.
///
/// # Errors
/// What was expected and what was found, such as `expected a number above 0, got 0`.
pub fn check(description: &Description, param: &Param, value: &Value) -> Result<(), Mismatch> {
    check_type(description, &param.ty, value)
}

/// Why a value does not suit a parameter.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mismatch {
    /// What was expected and what was found.
    pub message: String,
    /// The remedy, where there is more to say.
    pub help: Option<String>,
}

fn check_type(description: &Description, ty: &Type, value: &Value) -> Result<(), Mismatch> {
    let expected = |got: String, help: Option<String>| {
        Err(Mismatch { message: format!("expected {}, got {got}", ty.describe()), help })
    };
    let in_range = |x: f64, min: f64, max: f64| x.is_finite() && x >= min && x <= max;
    let kind_of = |value: &Value| match value {
        Value::Node(id) => describe_node(description.node(*id).schema),
        Value::Number(x) => x.to_string(),
        Value::Text(t) => format!("\"{t}\""),
        Value::Bool(b) => if *b { "True" } else { "False" }.into(),
        Value::Vec2(v) => format!("({}, {})", v[0], v[1]),
        Value::Vec3(v) => format!("({}, {}, {})", v[0], v[1], v[2]),
        Value::List(items) => format!("a list of {}", items.len()),
    };
    let ok = match (ty, value) {
        (Type::Bool, Value::Bool(_)) | (Type::Text | Type::File, Value::Text(_)) => true,
        (Type::Integer { min, max }, Value::Number(x)) => {
            x.trunc() == *x && in_range(*x, *min as f64, *max as f64)
        }
        (Type::Number { min, max } | Type::NumberPattern { min, max }, Value::Number(x)) => {
            in_range(*x, *min, *max)
        }
        (Type::Positive, Value::Number(x)) => in_range(*x, f64::MIN_POSITIVE, f64::INFINITY),
        (Type::Choice(words), Value::Text(t)) => {
            if words.contains(&&**t) {
                true
            } else {
                let near = suggest::nearest(t, words.iter().copied());
                let help = near.map(|word| format!("did you mean \"{word}\"?"));
                return expected(format!("\"{t}\""), help);
            }
        }
        (Type::Vec2, Value::Vec2(v)) => v.iter().all(|x| x.is_finite()),
        (Type::Vec3 | Type::Scale, Value::Vec3(v)) => v.iter().all(|x| x.is_finite()),
        (Type::Direction, Value::Vec3(v)) => {
            v.iter().all(|x| x.is_finite()) && v.iter().any(|&x| x != 0.0)
        }
        (Type::Scale, Value::Number(x)) => x.is_finite(),
        (Type::Matrix, _) => matrix_numbers(value).is_some(),
        (Type::ColorPattern | Type::NumberPattern { .. }, Value::Node(id)) => {
            description.node(*id).schema.category == Category::Pattern
        }
        (Type::Color | Type::ColorPattern, Value::Bool(_) | Value::Node(_)) => false,
        (Type::Color | Type::ColorPattern, _) => match color::from_value(value) {
            Ok(_) => true,
            Err(why) => return Err(Mismatch { message: why.message, help: Some(why.help) }),
        },
        (Type::Node(category), Value::Node(id)) => {
            description.node(*id).schema.category == *category
        }
        (Type::List(item), _) => {
            for (i, part) in value.items().iter().enumerate() {
                check_type(description, item, part).map_err(|why| Mismatch {
                    message: format!("item {}: {}", i + 1, why.message),
                    ..why
                })?;
            }
            true
        }
        (Type::Pair(first, second), _) => match value.items().as_slice() {
            [a, b] => {
                check_type(description, first, a)?;
                check_type(description, second, b)?;
                true
            }
            _ => false,
        },
        _ => false,
    };
    if ok { Ok(()) } else { expected(kind_of(value), None) }
}

fn describe_node(schema: &Schema) -> String {
    format!("the {} {}", schema.category.name(), schema.kind)
}

/// The numbers of a matrix value, row by row: 9 (3x3), 12 (3x4) or 16 (4x4, last row 0 0 0 1).
#[must_use]
pub fn matrix_numbers(value: &Value) -> Option<Vec<f64>> {
    let mut numbers = Vec::new();
    for item in value.items() {
        for part in item.items() {
            match part {
                Value::Number(x) if x.is_finite() => numbers.push(x),
                _ => return None,
            }
        }
    }
    matches!(numbers.len(), 9 | 12 | 16).then_some(numbers)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn why(ty: Type, value: Value) -> String {
        let why = check_type(&Description::default(), &ty, &value).unwrap_err();
        match why.help {
            Some(help) => format!("{}; {help}", why.message),
            None => why.message,
        }
    }

    #[test]
    fn wrong_values_say_what_was_expected() {
        let number = Value::Number;
        assert_eq!(why(Type::Positive, number(0.0)), "expected a number above 0, got 0");
        assert_eq!(why(Type::UNIT, number(f64::NAN)), "expected a number from 0 to 1, got NaN");
        assert_eq!(
            why(Type::Choice(&["phong", "blinn"]), Value::Text("pong".into())),
            "expected one of \"phong\", \"blinn\", got \"pong\"; did you mean \"phong\"?"
        );
        assert_eq!(
            why(
                Type::List(&Type::ColorPattern),
                Value::List([number(1.0), Value::Bool(true)].into())
            ),
            "item 2: expected a colour or a pattern, got True"
        );
        let stops = Type::List(&Type::Pair(&Type::NUMBER, &Type::ColorPattern));
        let stop = |color: Value| Value::from_items(vec![number(0.5), color]);
        let good = [number(1.0), Value::Text("red".into()), Value::Vec3([0.0; 3])];
        let good = Value::from_items(good.map(stop).into());
        assert_eq!(check_type(&Description::default(), &stops, &good), Ok(()));
        assert_eq!(
            why(stops, stop(Value::Text("red".into()))),
            "item 1: expected a pair (a number, a colour or a pattern), got 0.5"
        );
        assert_eq!(
            why(Type::Color, Value::Text("gren".into())),
            "unknown colour \"gren\"; did you mean \"green\"?"
        );
    }
}
