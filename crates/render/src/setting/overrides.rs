// SPDX-License-Identifier: MIT OR Apache-2.0
//! A setting of the scene with some of its arguments replaced by the caller's (`--samples 16`).
//!
//! The replaced arguments are checked by the same schema and the same code as written ones.

use dioptric_scene::{Args, Description, Diagnostic, Node, NodeId, Schema, Span, StackId, Value};

/// A setting's arguments: the scene's, where it has that setting, and the caller's above them.
pub struct Overridden {
    description: Description,
    id: NodeId,
    replaced: Vec<&'static str>,
}

impl Overridden {
    /// The setting of `schema`'s kind in a scene, with `replaced` arguments.
    ///
    /// # Errors
    /// A replaced argument that the setting does not have.
    pub fn new(
        scene: &Description,
        schema: &'static Schema,
        replaced: &[(&str, Value)],
    ) -> Result<Self, Diagnostic> {
        let mut node = match scene.roots_of(schema.kind).next() {
            Some(id) => scene.node(id).clone(),
            None => Node {
                schema,
                name: None,
                span: Span::NONE,
                stack: StackId::TOP,
                args: Box::default(),
            },
        };
        let mut args = node.args.into_vec();
        let mut names = Vec::new();
        for (name, value) in replaced {
            let Some((index, param)) = schema.param(name) else {
                return Err(Diagnostic::error(
                    "unknown-argument",
                    format!("{} has no parameter {name}", schema.kind),
                ));
            };
            let index = index as u16; // schemas have a handful of parameters
            args.retain(|(i, _)| *i != index);
            args.push((index, value.clone()));
            names.push(param.name);
        }
        args.sort_by_key(|(i, _)| *i);
        node.args = args.into();
        let mut description =
            Description { sources: scene.sources.clone(), ..Description::default() };
        let id = description.push(node);
        Ok(Self { description, id, replaced: names })
    }

    /// The arguments. Settings take no nodes, so the scene's other nodes are not needed.
    #[must_use]
    pub fn args(&self) -> Args<'_> {
        Args::new(&self.description, self.id)
    }

    /// An error about these arguments, without its place where the caller's arguments are at fault:
    /// the scene's text has nothing to do with them.
    #[must_use]
    pub fn explain(&self, mut error: Diagnostic) -> Diagnostic {
        let mentioned = |name: &&str| error.message.starts_with(&format!("{name} of "));
        if self.replaced.iter().any(mentioned) {
            error.labels.clear();
        }
        error
    }
}
