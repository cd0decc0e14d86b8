// SPDX-License-Identifier: MIT OR Apache-2.0
//! From the arguments of one call, in whatever format, to a checked node.
//!
//! A call with mistakes still becomes a node, so that reading goes on and finds more of them; a
//! description with errors is never handed out.

use std::sync::Arc;

use dioptric_scene::check::{Mismatch, check};
use dioptric_scene::{
    Default, Diagnostic, Node, NodeId, Param, Schema, Span, StackId, Value, suggest,
};

use crate::build::Build;

/// A schema, with its parameters in one list.
#[derive(Debug)]
pub(crate) struct Kind {
    pub schema: &'static Schema,
    pub params: Vec<&'static Param>,
    /// How many parameters may be given by position: the kind's own.
    pub positional: usize,
}

/// The arguments of a call while they are bound to parameters.
#[derive(Default)]
pub(crate) struct Call {
    args: Vec<(u16, Value)>,
    problems: Vec<Problem>,
    /// Arguments without a name beyond those that the kind takes.
    pub extra_positional: usize,
}

/// What can be wrong with an argument.
enum Problem {
    Unknown(Box<str>),
    Twice(&'static str),
    Value(&'static str, Mismatch),
}

impl Kind {
    pub(crate) fn new(schema: &'static Schema) -> Self {
        Self { schema, params: schema.all_params().collect(), positional: schema.params.len() }
    }

    /// Binds an argument by name. The value is what was found instead, in words, where it is none.
    pub(crate) fn bind_named(&self, call: &mut Call, key: &str, value: Result<Value, String>) {
        match self.params.iter().position(|param| param.name == key) {
            Some(index) => self.bind(call, index, value),
            None => call.problems.push(Problem::Unknown(key.into())),
        }
    }

    /// Binds an argument to the parameter with this index.
    pub(crate) fn bind(&self, call: &mut Call, index: usize, value: Result<Value, String>) {
        let Some(param) = self.params.get(index) else { return };
        if call.args.iter().any(|(i, _)| usize::from(*i) == index) {
            call.problems.push(Problem::Twice(param.name));
            return;
        }
        match value {
            Ok(value) => call.args.push((index as u16, value)),
            Err(got) => {
                let message = format!("expected {}, got {got}", param.ty.describe());
                call.problems.push(Problem::Value(param.name, Mismatch { message, help: None }));
            }
        }
    }

    /// Checks the call and adds its node, faulty or not. False where there are enough errors.
    pub(crate) fn finish(
        &self,
        mut call: Call,
        build: &mut Build,
        span: Span,
        stack: StackId,
    ) -> (NodeId, bool) {
        let Call { args, problems, .. } = &mut call;
        args.retain(|(i, value)| {
            let Some(param) = self.params.get(usize::from(*i)) else { return false };
            let result = check(&build.description, param, value);
            if let Err(why) = &result {
                problems.push(Problem::Value(param.name, why.clone()));
            }
            result.is_ok()
        });
        let written = |name: &str| {
            let written = |(i, _): &(u16, Value)| {
                self.params.get(usize::from(*i)).is_some_and(|p| p.name == name)
            };
            call.args.iter().position(written)
        };
        let required = |param: &&&Param| param.default == Default::Required;
        let complete = self.params.iter().filter(required).all(|p| written(p.name).is_some());
        let mut name: Option<Arc<str>> = None;
        if let Some(at) = written("name")
            && let (_, Value::Text(text)) = call.args.remove(at)
        {
            name = Some(text);
        }
        call.args.sort_unstable_by_key(|(i, _)| *i);
        let fine = complete && call.problems.is_empty() && call.extra_positional == 0;
        let (problems, extra) = (call.problems, call.extra_positional);
        let node = Node { schema: self.schema, name, span, stack, args: call.args.into() };
        let id = build.add_node(node);
        if fine { (id, true) } else { (id, self.report(build, id, problems, extra)) }
    }

    fn report(&self, build: &mut Build, id: NodeId, problems: Vec<Problem>, extra: usize) -> bool {
        let kind = self.schema.kind;
        let scene = &build.description;
        let node = scene.node(id);
        let mut errors = Vec::new();
        if extra > 0 {
            let (takes, got) = (self.positional, self.positional + extra);
            let plural = if takes == 1 { "argument" } else { "arguments" };
            let message = format!("{kind} takes {takes} {plural} without a name, got {got}");
            errors.push(
                Diagnostic::error("too-many-arguments", message)
                    .at(scene.positional_span(id, takes), "")
                    .help(self.takes()),
            );
        }
        // A misspelt or wrong argument was meant to be this one: one message is enough.
        let mut mentioned = Vec::new();
        for problem in problems {
            errors.push(match problem {
                Problem::Unknown(key) => {
                    let nearest = suggest::nearest(&key, self.params.iter().map(|p| p.name));
                    mentioned.extend(nearest);
                    let message = format!("{kind} has no argument \"{key}\"");
                    Diagnostic::error("unknown-argument", message)
                        .at(scene.key_span(id, &key), "")
                        .help(match nearest {
                            Some(name) => format!("did you mean \"{name}\"?"),
                            None => self.takes(),
                        })
                }
                Problem::Twice(name) => {
                    let message = format!("{name} of {kind} is given twice");
                    Diagnostic::error("repeated-argument", message)
                        .at(scene.key_span(id, name), "")
                        .help("an argument without a name may have taken its place")
                }
                Problem::Value(name, why) => {
                    mentioned.push(name);
                    let message = format!("{name} of {kind}: {}", why.message);
                    let error = Diagnostic::error("wrong-value", message)
                        .at(scene.argument_span(id, name), "");
                    Diagnostic { help: why.help, ..error }
                }
            });
        }
        for param in &self.params {
            let missing = param.default == Default::Required && node.arg(param.name).is_none();
            if missing && !mentioned.contains(&param.name) {
                let message = format!("{kind} needs {}, {}", param.name, param.ty.describe());
                errors.push(
                    Diagnostic::error("missing-argument", message)
                        .at(node.span, "")
                        .help(format!("write {} = ...", param.name)),
                );
            }
        }
        let stack = node.stack;
        let mut go_on = true;
        for error in errors {
            let error = build.called_from(error, stack);
            go_on &= build.record(error);
        }
        go_on
    }

    fn takes(&self) -> String {
        let names: Vec<&str> = self.params.iter().map(|param| param.name).collect();
        format!("{} takes {}", self.schema.kind, names.join(", "))
    }
}
