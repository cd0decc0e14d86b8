// SPDX-License-Identifier: MIT OR Apache-2.0
//! Typed access to the arguments of a node, for the code that builds the real thing from it.
//!
//! Readers check every value against its schema first ([`check`]); the accessors here check again
//! and return a [`Diagnostic`] with the argument's place, so no caller can panic on a description
//! that a program made.

pub use crate::check::{check, matrix_numbers};
use crate::color;
use crate::description::{Description, Node, NodeId};
use crate::diagnostic::Diagnostic;
use crate::schema::{Default, Schema};
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
                let message = format!("{name} of {kind}: {}", why.message);
                Diagnostic { help: why.help, ..self.error(name, "wrong-value", message) }
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
    use crate::schema::{Category, Param, Type};

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
    }
}
