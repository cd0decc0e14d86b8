// SPDX-License-Identifier: MIT OR Apache-2.0
//! The tree that every format reads into and writes from.

use std::sync::Arc;

use crate::locate;
use crate::schema::Schema;
use crate::source::{Sources, Span};
use crate::value::Value;

/// A node's index in its [`Description`]; children come before their parents.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct NodeId(pub u32);

/// A call stack's index in its [`Description`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct StackId(pub u32);

impl StackId {
    /// Made at top level: no calls above the node's own.
    pub const TOP: Self = Self(u32::MAX);
}

/// One call above the one that made a node: the function's name and the place of the call. Frames
/// form a tree that points upwards, so that a million nodes made in one loop share one.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct StackFrame {
    /// The function that was called.
    pub function: Arc<str>,
    /// Where it was called.
    pub span: Span,
    /// The frame above, or [`StackId::TOP`].
    pub parent: StackId,
}

/// One thing of the scene. Kept small (about 64 bytes besides the arguments): scenes have millions.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    /// Its kind.
    pub schema: &'static Schema,
    /// Its name, if it was given one.
    pub name: Option<Arc<str>>,
    /// The text that made it.
    pub span: Span,
    /// The calls that led there.
    pub stack: StackId,
    /// The arguments that were written, sorted by the index into [`Schema::all_params`]; `name` is
    /// not among them.
    pub args: Box<[(u16, Value)]>,
}

impl Node {
    /// The argument with this name, if it was written.
    #[must_use]
    pub fn arg(&self, name: &str) -> Option<&Value> {
        let (index, _) = self.schema.param(name)?;
        self.args.iter().find(|(i, _)| usize::from(*i) == index).map(|(_, v)| v)
    }
}

/// A whole scene as plain data.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Description {
    /// The texts it came from.
    pub sources: Sources,
    /// All nodes; a node refers only to nodes before it.
    pub nodes: Vec<Node>,
    /// The nodes that are in the scene by themselves, in the order of the text.
    pub roots: Vec<NodeId>,
    /// Call stacks that nodes refer to.
    pub stacks: Vec<StackFrame>,
}

impl Description {
    /// Adds a node (not yet a root) and returns its id.
    pub fn push(&mut self, node: Node) -> NodeId {
        self.nodes.push(node);
        NodeId(self.nodes.len() as u32 - 1)
    }

    /// The node with this id. Ids come only from [`Self::push`] of the same description.
    #[must_use]
    pub fn node(&self, id: NodeId) -> &Node {
        &self.nodes[id.0 as usize]
    }

    /// The roots of one kind, in order.
    pub fn roots_of<'a>(&'a self, kind: &'a str) -> impl Iterator<Item = NodeId> + 'a {
        self.roots.iter().copied().filter(move |&id| self.node(id).schema.kind == kind)
    }

    /// What to call a node in messages and `why`: its name, else its kind and line, else its kind and number.
    #[must_use]
    pub fn label(&self, id: NodeId) -> String {
        let node = self.node(id);
        if let Some(name) = &node.name {
            return name.to_string();
        }
        match self.sources.locate(node.span) {
            Some(place) => format!("{} (line {})", node.schema.kind, place.line),
            None => format!("{} #{}", node.schema.kind, id.0),
        }
    }

    /// The place of one argument's value inside the call that made a node, found by reading the
    /// call's text again (storing a span for each argument would double the memory of large scenes);
    /// the whole call where it is not found.
    #[must_use]
    pub fn argument_span(&self, id: NodeId, name: &str) -> Span {
        let schema = self.node(id).schema;
        self.span_in_call(id, |text| locate::find_argument(text, name, schema))
    }

    /// The place of an argument's name in the call that made a node, valid name or not; the whole
    /// call where it is not found.
    #[must_use]
    pub fn key_span(&self, id: NodeId, key: &str) -> Span {
        self.span_in_call(id, |text| {
            let mut keys = locate::find_parts(text).into_iter().filter_map(|part| part.key);
            keys.find(|&(start, end)| text.get(start..end) == Some(key))
        })
    }

    /// The place of the positional argument `index` of the call that made a node; the whole call
    /// where it is not found.
    #[must_use]
    pub fn positional_span(&self, id: NodeId, index: usize) -> Span {
        self.span_in_call(id, |text| {
            let parts = locate::find_parts(text);
            parts.into_iter().filter(|part| part.key.is_none()).nth(index).map(|part| part.value)
        })
    }

    fn span_in_call(&self, id: NodeId, find: impl Fn(&str) -> Option<(usize, usize)>) -> Span {
        let span = self.node(id).span;
        match self.sources.text(span).and_then(find) {
            Some((start, end)) => Span {
                file: span.file,
                start: span.start + start as u32,
                end: span.start + end as u32,
            },
            None => span,
        }
    }
}
