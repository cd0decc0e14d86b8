// SPDX-License-Identifier: MIT OR Apache-2.0
//! The values that arguments can have.

use std::sync::Arc;

use crate::description::NodeId;

/// A value as it was written: checked against a schema's type, not yet interpreted.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A truth value.
    Bool(bool),
    /// A number; whole numbers too, exact up to 2^53.
    Number(f64),
    /// Text.
    Text(Arc<str>),
    /// Two numbers.
    Vec2([f64; 2]),
    /// Three numbers.
    Vec3([f64; 3]),
    /// Any other list.
    List(Arc<[Value]>),
    /// Another node of the same description.
    Node(NodeId),
}

impl From<bool> for Value {
    fn from(b: bool) -> Self {
        Self::Bool(b)
    }
}

impl From<f64> for Value {
    fn from(x: f64) -> Self {
        Self::Number(x)
    }
}

impl From<&str> for Value {
    fn from(text: &str) -> Self {
        Self::Text(text.into())
    }
}

impl From<[f64; 2]> for Value {
    fn from(v: [f64; 2]) -> Self {
        Self::Vec2(v)
    }
}

impl From<[f64; 3]> for Value {
    fn from(v: [f64; 3]) -> Self {
        Self::Vec3(v)
    }
}

impl From<NodeId> for Value {
    fn from(id: NodeId) -> Self {
        Self::Node(id)
    }
}

impl From<Vec<Value>> for Value {
    fn from(items: Vec<Value>) -> Self {
        Self::from_items(items)
    }
}

impl Value {
    /// The word for messages: `a number`.
    #[must_use]
    pub const fn describe(&self) -> &'static str {
        match self {
            Self::Bool(_) => "a truth value",
            Self::Number(_) => "a number",
            Self::Text(_) => "text",
            Self::Vec2(_) => "two numbers",
            Self::Vec3(_) => "three numbers",
            Self::List(_) => "a list",
            Self::Node(_) => "a node",
        }
    }

    /// The list of values that this is: vectors give their numbers, anything else itself alone.
    #[must_use]
    pub fn items(&self) -> Vec<Value> {
        match self {
            Self::Vec2(v) => v.iter().map(|&x| Self::Number(x)).collect(),
            Self::Vec3(v) => v.iter().map(|&x| Self::Number(x)).collect(),
            Self::List(items) => items.to_vec(),
            other => vec![other.clone()],
        }
    }

    /// The most compact value for a list of values: two or three plain numbers become a vector.
    #[must_use]
    pub fn from_items(items: Vec<Value>) -> Self {
        match items.as_slice() {
            [Self::Number(x), Self::Number(y)] => Self::Vec2([*x, *y]),
            [Self::Number(x), Self::Number(y), Self::Number(z)] => Self::Vec3([*x, *y, *z]),
            _ => Self::List(items.into()),
        }
    }

    /// Calls `f` for every node that this value refers to, in order.
    pub fn for_each_node(&self, f: &mut impl FnMut(NodeId)) {
        match self {
            Self::Node(id) => f(*id),
            Self::List(items) => items.iter().for_each(|v| v.for_each_node(f)),
            _ => {}
        }
    }
}
