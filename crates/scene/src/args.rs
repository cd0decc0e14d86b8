// SPDX-License-Identifier: MIT OR Apache-2.0
//! Typed access to the arguments of a node, for the code that builds the real thing from it.
//!
//! Readers check every value against its schema first ([`check`]); the accessors here check again
//! and return a [`Diagnostic`] with the argument's place, so no caller can panic on a description
//! that a program made.

use crate::color;
use crate::description::{Description, Node, NodeId};
use crate::diagnostic::Diagnostic;
use crate::schema::{Category, Default, Param, Schema, Type};
use crate::source::Span;
use crate::value::Value;

/// The arguments of one node, defaults filled in.
#[derive(Clone, Copy, Debug)]
pub struct Args<'a> {
    /// The scene.
    pub description: &'a Description,
    /// The node.
    pub id: NodeId,
}

impl<'a> Args<'a> {
    /// The arguments of node `id`.
    #[must_use]
    pub const fn new(description: &'a Description, id: NodeId) -> Self {
        Self { description, id }
    }

    /// The node itself.
    #[must_use]
    pub fn node(&self) -> &'a Node {
        self.description.node(self.id)
    }

    /// An error about one argument, at its place.
    #[must_use]
    pub fn error(&self, name: &str, code: &'static str, message: impl Into<String>) -> Diagnostic {
        Diagnostic::error(code, message).at(self.description.argument_span(self.id, name), "")
    }

    /// An error about the whole call.
    #[must_use]
    pub fn error_here(&self, code: &'static str, message: impl Into<String>) -> Diagnostic {
        Diagnostic::error(code, message).at(self.node().span, "")
    }

    /// Whether the argument was written.
    #[must_use]
    pub fn is_written(&self, name: &str) -> bool {
        self.node().arg(name).is_some()
    }

    /// The value as written, else its default, else nothing.
    ///
    /// # Errors
    /// The parameter is unknown to the schema, required and absent, or of the wrong type.
    pub fn value(&self, name: &str) -> Result<Option<Value>, Diagnostic> {
        let node = self.node();
        let kind = node.schema.kind;
        let Some((_, param)) = node.schema.param(name) else {
            return Err(self.error_here("internal", format!("{kind} has no parameter {name}")));
        };
        if let Some(value) = node.arg(name) {
            check(self.description, param, value).map_err(|why| {
                self.error(name, "wrong-value", format!("{name} of {kind}: {why}"))
            })?;
            return Ok(Some(value.clone()));
        }
        Ok(match param.default {
            Default::Required => {
                return Err(self
                    .error_here(
                        "missing-argument",
                        format!("{kind} needs {name}, {}", param.ty.describe()),
                    )
                    .help(format!("write {name} = ...")));
            }
            Default::Absent => None,
            Default::Bool(b) => Some(Value::Bool(b)),
            Default::Number(x) => Some(Value::Number(x)),
            Default::Vec2(v) => Some(Value::Vec2(v)),
            Default::Vec3(v) => Some(Value::Vec3(v)),
            Default::Text(t) => Some(Value::Text(t.into())),
        })
    }

    fn required(&self, name: &str) -> Result<Value, Diagnostic> {
        self.value(name)?.ok_or_else(|| {
            self.error_here("missing-argument", format!("{} needs {name}", self.node().schema.kind))
        })
    }

    fn mismatch(&self, name: &str, expected: &str, value: &Value) -> Diagnostic {
        self.error(
            name,
            "wrong-type",
            format!("{name}: expected {expected}, got {}", value.describe()),
        )
    }

    /// A number.
    ///
    /// # Errors
    /// It is absent without a default, or no number in the schema's range.
    pub fn number(&self, name: &str) -> Result<f64, Diagnostic> {
        match self.required(name)? {
            Value::Number(x) => Ok(x),
            other => Err(self.mismatch(name, "a number", &other)),
        }
    }

    /// A number that may be absent.
    ///
    /// # Errors
    /// It is there, but no number in the schema's range.
    pub fn optional_number(&self, name: &str) -> Result<Option<f64>, Diagnostic> {
        if self.value(name)?.is_none() { Ok(None) } else { self.number(name).map(Some) }
    }

    /// A whole number.
    ///
    /// # Errors
    /// As [`Self::number`].
    pub fn integer(&self, name: &str) -> Result<i64, Diagnostic> {
        self.number(name).map(|x| x as i64)
    }

    /// A truth value.
    ///
    /// # Errors
    /// It is absent without a default, or no truth value.
    pub fn bool(&self, name: &str) -> Result<bool, Diagnostic> {
        match self.required(name)? {
            Value::Bool(b) => Ok(b),
            other => Err(self.mismatch(name, "True or False", &other)),
        }
    }

    /// Text, a word or a path.
    ///
    /// # Errors
    /// It is absent without a default, or no text.
    pub fn text(&self, name: &str) -> Result<std::sync::Arc<str>, Diagnostic> {
        match self.required(name)? {
            Value::Text(t) => Ok(t),
            other => Err(self.mismatch(name, "text", &other)),
        }
    }

    /// Two numbers.
    ///
    /// # Errors
    /// It is absent without a default, or not two numbers.
    pub fn vec2(&self, name: &str) -> Result<[f64; 2], Diagnostic> {
        match self.required(name)? {
            Value::Vec2(v) => Ok(v),
            other => Err(self.mismatch(name, "two numbers (x, y)", &other)),
        }
    }

    /// Three numbers; one number where the schema says [`Type::Scale`].
    ///
    /// # Errors
    /// It is absent without a default, or not three numbers.
    pub fn vec3(&self, name: &str) -> Result<[f64; 3], Diagnostic> {
        match self.required(name)? {
            Value::Vec3(v) => Ok(v),
            Value::Number(x) => Ok([x; 3]),
            other => Err(self.mismatch(name, "three numbers (x, y, z)", &other)),
        }
    }

    /// A colour as it was written; whoever calls decodes it as the scene's settings say.
    ///
    /// # Errors
    /// It is absent without a default, or no colour.
    pub fn color(&self, name: &str) -> Result<[f64; 3], Diagnostic> {
        let value = self.required(name)?;
        color::from_value(&value).map_err(|why| {
            self.error(name, "wrong-color", format!("{name}: {}", why.message)).help(why.help)
        })
    }

    /// A node that may be absent.
    ///
    /// # Errors
    /// It is there, but no node.
    pub fn optional_node(&self, name: &str) -> Result<Option<NodeId>, Diagnostic> {
        match self.value(name)? {
            None => Ok(None),
            Some(Value::Node(id)) => Ok(Some(id)),
            Some(other) => Err(self.mismatch(name, "a node", &other)),
        }
    }

    /// A list of nodes; absent means none.
    ///
    /// # Errors
    /// An item is no node.
    pub fn nodes(&self, name: &str) -> Result<Vec<NodeId>, Diagnostic> {
        let Some(value) = self.value(name)? else { return Ok(Vec::new()) };
        value
            .items()
            .iter()
            .map(|item| match item {
                Value::Node(id) => Ok(*id),
                other => Err(self.mismatch(name, "a list of nodes", other)),
            })
            .collect()
    }

    /// The items of a list; absent means none.
    ///
    /// # Errors
    /// As [`Self::value`].
    pub fn list(&self, name: &str) -> Result<Vec<Value>, Diagnostic> {
        Ok(self.value(name)?.map(|v| v.items()).unwrap_or_default())
    }
}

/// Checks a value against a parameter's type.
///
/// # Errors
/// What was expected and what was found, such as `expected a number above 0, got 0`.
pub fn check(description: &Description, param: &Param, value: &Value) -> Result<(), String> {
    check_type(description, &param.ty, value)
}

fn check_type(description: &Description, ty: &Type, value: &Value) -> Result<(), String> {
    let expected = |got: String| Err(format!("expected {}, got {got}", ty.describe()));
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
                let hint = crate::suggest::nearest(t, words.iter().copied())
                    .map(|w| format!(" (did you mean \"{w}\"?)"))
                    .unwrap_or_default();
                return expected(format!("\"{t}\"{hint}"));
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
        (Type::Color | Type::ColorPattern, _) => match color::from_value(value) {
            Ok(_) => true,
            Err(why) => return Err(format!("{} ({})", why.message, why.help)),
        },
        (Type::Node(category), Value::Node(id)) => {
            description.node(*id).schema.category == *category
        }
        (Type::List(item), _) => {
            for (i, part) in value.items().iter().enumerate() {
                check_type(description, item, part)
                    .map_err(|why| format!("item {}: {why}", i + 1))?;
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
    if ok { Ok(()) } else { expected(kind_of(value)) }
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

/// Bytes `[start, end)` of a text.
type Run = (usize, usize);

/// One argument in the text of a call.
pub(crate) struct Part {
    /// Its name, where it is written.
    pub key: Option<Run>,
    /// Its value.
    pub value: Run,
}

/// Finds the arguments in the text of a call, `sphere(center = (0, 0, 0), radius = 1)`, or of the
/// JSON `{"kind": "sphere", "radius": 1}`. A lexical scan that knows strings, comments and brackets,
/// nothing more; empty where the text is no call.
pub(crate) fn find_parts(text: &str) -> Vec<Part> {
    let Some(open) = text.find(['(', '{']) else { return Vec::new() };
    let mut pieces: Vec<Run> = Vec::new();
    let (mut depth, mut start) = (0usize, open + 1);
    let bytes = text.as_bytes();
    let mut i = open;
    while i < bytes.len() {
        match bytes[i] {
            b'(' | b'[' | b'{' => depth += 1,
            b')' | b']' | b'}' => {
                depth = depth.saturating_sub(1);
                if depth == 0 {
                    pieces.push((start, i));
                    break;
                }
            }
            b',' if depth == 1 => {
                pieces.push((start, i));
                start = i + 1;
            }
            quote @ (b'"' | b'\'') => {
                i += 1;
                while i < bytes.len() && bytes[i] != quote {
                    i += if bytes[i] == b'\\' { 2 } else { 1 };
                }
            }
            b'#' if bytes[open] == b'(' => {
                while i < bytes.len() && bytes[i] != b'\n' {
                    i += 1;
                }
            }
            _ => {}
        }
        i += 1;
    }
    if depth != 0 {
        return Vec::new();
    }
    let mut parts = Vec::new();
    for (start, end) in pieces.into_iter().map(|piece| trim(bytes, piece)) {
        let Some(piece) = text.get(start..end).filter(|piece| !piece.is_empty()) else { continue };
        parts.push(match split_key(piece) {
            Some((key, value)) => Part {
                key: Some((start + key.0, start + key.1)),
                value: trim(bytes, (start + value, end)),
            },
            None => Part { key: None, value: (start, end) },
        });
    }
    parts
}

/// Leaves out white space and comments at both ends.
fn trim(bytes: &[u8], (mut start, mut end): Run) -> Run {
    while start < end && (bytes[start].is_ascii_whitespace() || bytes[start] == b'#') {
        if bytes[start] == b'#' {
            while start < end && bytes[start] != b'\n' {
                start += 1;
            }
        } else {
            start += 1;
        }
    }
    while start < end && bytes[end - 1].is_ascii_whitespace() {
        end -= 1;
    }
    (start, end)
}

/// The value of one argument in the text of a call; positional arguments count in the schema's order.
pub(crate) fn find_argument(text: &str, name: &str, schema: &Schema) -> Option<Run> {
    let (position, _) = schema.param(name)?;
    let parts = find_parts(text);
    let named = parts.iter().find(|p| p.key.is_some_and(|(s, e)| &text[s..e] == name));
    let value = match named {
        Some(part) => part.value,
        None => parts.iter().filter(|p| p.key.is_none()).nth(position)?.value,
    };
    Some(value)
}

/// `radius = 1` or `"radius": 1`: where the key is and where the value begins.
fn split_key(piece: &str) -> Option<(Run, usize)> {
    let quoted = piece.starts_with('"');
    let start = usize::from(quoted);
    let rest = &piece[start..];
    let length = rest.find(|c: char| !(c.is_alphanumeric() || c == '_'))?;
    let after = &rest[length..];
    let after = if quoted { after.strip_prefix('"')? } else { after };
    let value = after.trim_start().strip_prefix(if quoted { ':' } else { '=' })?;
    (length > 0 && !value.starts_with('='))
        .then_some(((start, start + length), piece.len() - value.len()))
}

/// Convenience for tests and programs: a node without a place.
#[must_use]
pub fn make_node(schema: &'static Schema, args: &[(&str, Value)]) -> Option<Node> {
    let mut indexed = Vec::new();
    let mut name = None;
    for (key, value) in args {
        match (*key, value) {
            ("name", Value::Text(text)) => name = Some(text.clone()),
            _ => indexed.push((u16::try_from(schema.param(key)?.0).ok()?, value.clone())),
        }
    }
    indexed.sort_by_key(|(i, _)| *i);
    Some(Node { schema, name, span: Span::NONE, stack: crate::StackId::TOP, args: indexed.into() })
}

#[cfg(test)]
mod tests {
    use super::*;

    static BALL: Schema = Schema {
        kind: "ball",
        category: Category::Shape,
        summary: "",
        doc: "",
        params: &[
            Param::required("center", Type::Vec3, ""),
            Param::new("radius", Type::Positive, Default::Number(1.0), ""),
        ],
        example: "",
    };

    fn found<'a>(text: &'a str, name: &str) -> Option<&'a str> {
        find_argument(text, name, &BALL).map(|(s, e)| &text[s..e])
    }

    #[test]
    fn arguments_are_found_in_the_text_of_a_call() {
        assert_eq!(found("ball((1, 2, 3), radius = 0.5)", "center"), Some("(1, 2, 3)"));
        assert_eq!(found("ball((1, 2, 3), radius = 0.5)", "radius"), Some("0.5"));
        assert_eq!(found("ball((1, 2, 3), 7 )", "radius"), Some("7"));
        assert_eq!(found("ball(name = \"a, radius = 3\", radius=-1)", "radius"), Some("-1"));
        assert_eq!(found("ball( # radius = 1,\n radius = 2)", "radius"), Some("2"));
        assert_eq!(found(r#"{"kind": "ball", "radius": [1]}"#, "radius"), Some("[1]"));
        assert_eq!(found("ball(", "radius"), None);
        assert_eq!(found("ball(center = f(radius = 1))", "radius"), None);
        assert_eq!(found("ball(1 == 1, x = 2)", "center"), Some("1 == 1"));
        let text = "ball(1, raduis = 2)";
        let keys: Vec<_> =
            find_parts(text).iter().map(|p| p.key.map(|(s, e)| &text[s..e])).collect();
        assert_eq!(keys, [None, Some("raduis")]);
    }

    #[test]
    fn wrong_values_say_what_was_expected() {
        let mut scene = Description::default();
        let id = scene.push(make_node(&BALL, &[("radius", Value::Number(0.0))]).unwrap());
        let args = Args::new(&scene, id);
        assert_eq!(
            args.number("radius").unwrap_err().message,
            "radius of ball: expected a number above 0, got 0"
        );
        assert_eq!(
            args.vec3("center").unwrap_err().message,
            "ball needs center, three numbers (x, y, z)"
        );
        assert!(check_type(&scene, &Type::UNIT, &Value::Number(f64::NAN)).is_err());
        assert_eq!(
            check_type(&scene, &Type::Choice(&["phong", "blinn"]), &Value::Text("pong".into()))
                .unwrap_err(),
            "expected one of \"phong\", \"blinn\", got \"pong\" (did you mean \"phong\"?)"
        );
        let stops = Type::List(&Type::Pair(&Type::NUMBER, &Type::ColorPattern));
        let stop = |color: Value| Value::from_items(vec![Value::Number(0.5), color]);
        let good = [Value::Number(1.0), Value::Text("red".into()), Value::Vec3([0.0; 3])];
        let good = Value::from_items(good.map(stop).into());
        assert_eq!(check_type(&scene, &stops, &good), Ok(()));
        assert_eq!(
            check_type(&scene, &stops, &stop(Value::Text("red".into()))).unwrap_err(),
            "item 1: expected a pair (a number, a colour or a pattern), got 0.5"
        );
    }
}
