// SPDX-License-Identifier: MIT OR Apache-2.0
//! Values of the scene language as values of the description, and back.

use dioptric_scene::Value;
use starlark::values::float::UnpackFloat;
use starlark::values::list::ListRef;
use starlark::values::tuple::{AllocTuple, TupleRef};
use starlark::values::{self, Heap, UnpackValue, ValueLike};

use super::constructor::{Constructor, Handle};

/// Lists in lists that a value may have; no parameter takes more than three.
const MAX_NESTING: usize = 16;

/// The value for a description; what was found instead, in words, where there is none.
pub(crate) fn convert(value: values::Value) -> Result<Value, String> {
    convert_nested(value, 0)
}

fn convert_nested(value: values::Value, nesting: usize) -> Result<Value, String> {
    if let Some(number) = number(value) {
        return Ok(Value::Number(number));
    }
    if let Some(handle) = value.downcast_ref::<Handle>() {
        return Ok(Value::Node(handle.id));
    }
    if let Some(items) = items(value) {
        match items {
            [x, y] => {
                if let (Some(x), Some(y)) = (number(*x), number(*y)) {
                    return Ok(Value::Vec2([x, y]));
                }
            }
            [x, y, z] => {
                if let (Some(x), Some(y), Some(z)) = (number(*x), number(*y), number(*z)) {
                    return Ok(Value::Vec3([x, y, z]));
                }
            }
            _ => {}
        }
        if nesting == MAX_NESTING {
            return Err(format!("lists in lists, {MAX_NESTING} deep"));
        }
        let items: Result<Vec<_>, _> =
            items.iter().map(|item| convert_nested(*item, nesting + 1)).collect();
        return Ok(Value::List(items?.into()));
    }
    if let Some(text) = value.unpack_str() {
        return Ok(Value::Text(text.into()));
    }
    if let Some(truth) = value.unpack_bool() {
        return Ok(Value::Bool(truth));
    }
    Err(match value.downcast_ref::<Constructor>() {
        Some(kind) => format!("the function {kind} itself; call it: {kind}(...)"),
        None => match value.get_type() {
            "NoneType" => "None".into(),
            "range" => "a range; write list(range(...))".into(),
            "native_function" => "a function; call it with (...)".into(),
            other => format!("a {other}"),
        },
    })
}

/// A number, whole or not.
pub(crate) fn number(value: values::Value) -> Option<f64> {
    match UnpackFloat::unpack_value(value) {
        Ok(Some(UnpackFloat(number))) => Some(number),
        _ => None,
    }
}

/// The items of a list or tuple.
pub(crate) fn items<'v>(value: values::Value<'v>) -> Option<&'v [values::Value<'v>]> {
    if let Some(tuple) = TupleRef::from_value(value) {
        return Some(tuple.content());
    }
    ListRef::from_value(value).map(|list| list.content())
}

/// A description's value for the scene; whole numbers become integers if `whole`.
pub(crate) fn to_starlark<'v>(value: &Value, whole: bool, heap: Heap<'v>) -> values::Value<'v> {
    let number = |x: f64| {
        if whole && x.trunc() == x && x.abs() < 9e15 { heap.alloc(x as i64) } else { heap.alloc(x) }
    };
    match value {
        Value::Bool(b) => values::Value::new_bool(*b),
        Value::Number(x) => number(*x),
        Value::Text(text) => heap.alloc(&**text),
        Value::Vec2(v) => heap.alloc(AllocTuple(v.map(number))),
        Value::Vec3(v) => heap.alloc(AllocTuple(v.map(number))),
        Value::List(items) => {
            heap.alloc(AllocTuple(items.iter().map(|item| to_starlark(item, whole, heap))))
        }
        Value::Node(_) => values::Value::new_none(),
    }
}
