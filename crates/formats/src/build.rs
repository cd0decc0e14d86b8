// SPDX-License-Identifier: MIT OR Apache-2.0
//! A description while it is read: its nodes, which of them enter the scene, and what is wrong.

use dioptric_scene::validate::{self, MAX_NESTING};
use dioptric_scene::{Description, Diagnostic, Node, NodeId, StackId, Value};

use crate::options::ReadOptions;

/// Errors after which reading stops.
const MAX_ERRORS: usize = 20;
/// Places of calls that a message shows besides its own.
const MAX_CALLERS: usize = 4;

/// The description so far.
#[derive(Debug, Default)]
pub(crate) struct Build {
    pub description: Description,
    pub diagnostics: Vec<Diagnostic>,
    /// Nodes that are in the scene unless something consumes them.
    entered: Vec<NodeId>,
    /// By node: whether another node holds it, and how deep it is nested.
    uses: Vec<Use>,
    /// Bytes of all nodes.
    pub bytes: usize,
    /// Whether new nodes only define: they do not enter the scene by themselves.
    pub only_define: bool,
}

#[derive(Clone, Copy, Debug, Default)]
struct Use {
    consumed: bool,
    depth: u8,
}

impl Build {
    /// Adds a node; what it refers to is consumed.
    pub(crate) fn add_node(&mut self, node: Node) -> NodeId {
        self.bytes += size_of::<Node>() + size_of_val(&*node.args);
        let mut depth = 0;
        for (_, value) in &node.args {
            self.bytes += owned_bytes(value);
            value.for_each_node(&mut |id| {
                if let Some(inner) = self.uses.get_mut(id.0 as usize) {
                    inner.consumed = true;
                    depth = depth.max(inner.depth.saturating_add(1));
                }
            });
        }
        let (span, stack, kind) = (node.span, node.stack, node.schema.kind);
        let enters = !self.only_define && node.schema.category.enters_scene();
        let id = self.description.push(node);
        self.uses.push(Use { consumed: false, depth });
        if enters {
            self.entered.push(id);
        }
        if usize::from(depth) > MAX_NESTING {
            let message =
                format!("{kind} holds things within things, more than {MAX_NESTING} deep");
            let error = Diagnostic::error("too-nested", message)
                .at(span, "")
                .help("put the parts side by side in fewer groups");
            let error = self.called_from(error, stack);
            self.record(error);
        }
        id
    }

    /// Keeps an error unless one of its kind was found at its place; false where there are too many.
    pub(crate) fn record(&mut self, diagnostic: Diagnostic) -> bool {
        let same = |d: &Diagnostic| {
            d.code == diagnostic.code
                && d.labels.first().map(|l| l.span) == diagnostic.labels.first().map(|l| l.span)
        };
        if diagnostic.labels.is_empty() || !self.diagnostics.iter().any(same) {
            self.diagnostics.push(diagnostic);
        }
        self.diagnostics.len() < MAX_ERRORS
    }

    /// Adds the places of the calls that led to a node's call, innermost first.
    pub(crate) fn called_from(&self, mut error: Diagnostic, mut stack: StackId) -> Diagnostic {
        let mut shown = 0;
        while let Some(frame) = self.description.stacks.get(stack.0 as usize) {
            if shown == MAX_CALLERS {
                break;
            }
            if !error.labels.iter().any(|label| label.span == frame.span) {
                error = error.at(frame.span, format!("{} called from here", frame.function));
                shown += 1;
            }
            stack = frame.parent;
        }
        error
    }

    /// Finds the roots, chooses the camera and checks the scene as a whole.
    pub(crate) fn finish(&mut self, options: &ReadOptions) {
        let uses = &self.uses;
        self.entered.retain(|id| !uses.get(id.0 as usize).is_some_and(|u| u.consumed));
        self.description.roots = std::mem::take(&mut self.entered);
        if !self.diagnostics.is_empty() {
            return;
        }
        match validate::choose_camera(&mut self.description, options.camera.as_deref()) {
            Ok(()) => {
                let mut found = validate::validate(&self.description);
                if options.shapes_alone {
                    found.retain(|d| !["no-camera", "no-light"].contains(&d.code));
                }
                self.diagnostics.extend(found);
            }
            Err(error) => self.diagnostics.push(error),
        }
    }
}

/// Bytes that a value holds outside itself.
fn owned_bytes(value: &Value) -> usize {
    match value {
        Value::Text(text) => text.len() + 16,
        Value::List(items) => {
            16 + size_of_val::<[Value]>(items) + items.iter().map(owned_bytes).sum::<usize>()
        }
        _ => 0,
    }
}
