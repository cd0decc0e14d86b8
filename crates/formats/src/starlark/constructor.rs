// SPDX-License-Identifier: MIT OR Apache-2.0
//! `sphere(...)`: a function for every kind of the vocabulary, and the value that it returns.

use std::fmt;

use allocative::Allocative;
use dioptric_scene::{
    Default, Diagnostic, Node, NodeId, Param, Schema, Span, StackId, Value, args, suggest,
};
use starlark::any::ProvidesStaticType;
use starlark::collections::StarlarkHasher;
use starlark::eval::{Arguments, Evaluator};
use starlark::starlark_simple_value;
use starlark::values::{
    self, NoSerialize, StarlarkPagablePanic, StarlarkValue, ValueLike, starlark_value,
};

use super::convert::convert;
use super::errors::Raised;
use super::state::{Build, State};

/// The function that makes nodes of one kind.
#[derive(Debug, ProvidesStaticType, NoSerialize, StarlarkPagablePanic, Allocative)]
pub(crate) struct Constructor {
    #[allocative(skip)]
    schema: &'static Schema,
    #[allocative(skip)]
    params: Vec<&'static Param>,
    /// How many parameters may be given by position: the kind's own.
    positional: usize,
}

starlark_simple_value!(Constructor);

impl fmt::Display for Constructor {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.schema.kind)
    }
}

#[starlark_value(type = "constructor")]
impl<'v> StarlarkValue<'v> for Constructor {
    fn invoke(
        &self,
        _me: values::Value<'v>,
        arguments: &Arguments<'v, '_>,
        eval: &mut Evaluator<'v, '_, '_>,
    ) -> starlark::Result<values::Value<'v>> {
        let state = State::of(eval)?;
        let (span, stack) = state.place(eval);
        let mut call = Call::default();
        for (i, value) in arguments.positions(eval.heap())?.enumerate() {
            match self.params.get(i).filter(|_| i < self.positional) {
                Some(param) => call.bind(i, param, value),
                None => call.extra_positional += 1,
            }
        }
        for (key, value) in arguments.names_map()? {
            match self.params.iter().position(|param| param.name == key.as_str()) {
                Some(i) => call.bind(i, self.params[i], value),
                None => call.problems.push(Problem::Unknown(key.as_str().into())),
            }
        }
        let mut build = state.build();
        if build.description.nodes.len() >= state.limits().objects {
            return Err(too_many_objects(state.limits().objects));
        }
        let (id, fine) = self.finish(call, &mut build, span, stack);
        drop(build);
        if !fine {
            return Err(Raised::enough());
        }
        Ok(eval.heap().alloc_simple(Handle { id, schema: self.schema }))
    }
}

/// A call while its arguments are bound.
#[derive(Default)]
struct Call {
    name: Option<std::sync::Arc<str>>,
    args: Vec<(u16, Value)>,
    problems: Vec<Problem>,
    extra_positional: usize,
}

/// What can be wrong with a call besides the values.
enum Problem {
    Unknown(Box<str>),
    Twice(&'static str),
    Value(&'static str, String),
}

impl Call {
    fn bind(&mut self, index: usize, param: &'static Param, value: values::Value) {
        if value.is_none() {
            return; // as if it had not been written, so that functions can pass options on
        }
        if self.args.iter().any(|(i, _)| usize::from(*i) == index) {
            self.problems.push(Problem::Twice(param.name));
            return;
        }
        match convert(value) {
            Ok(value) => self.args.push((index as u16, value)),
            Err(got) => {
                let why = format!("expected {}, got {got}", param.ty.describe());
                self.problems.push(Problem::Value(param.name, why));
            }
        }
    }
}

impl Constructor {
    pub(crate) fn new(schema: &'static Schema) -> Self {
        Self { schema, params: schema.all_params().collect(), positional: schema.params.len() }
    }

    /// Checks the call and adds its node, faulty or not, so that evaluation can go on and find more
    /// errors. False where there are enough errors.
    fn finish(
        &self,
        mut call: Call,
        build: &mut Build,
        span: Span,
        stack: StackId,
    ) -> (NodeId, bool) {
        call.args.retain(|(i, value)| {
            let param = self.params[usize::from(*i)];
            match args::check(&build.description, param, value) {
                Ok(()) => true,
                Err(why) => {
                    call.problems.push(Problem::Value(param.name, why));
                    false
                }
            }
        });
        let complete = self
            .params
            .iter()
            .enumerate()
            .filter(|(_, param)| param.default == Default::Required)
            .all(|(i, _)| call.args.iter().any(|(bound, _)| usize::from(*bound) == i));
        if let Some(at) =
            call.args.iter().position(|(i, _)| self.params[usize::from(*i)].name == "name")
            && let (_, Value::Text(text)) = call.args.remove(at)
        {
            call.name = Some(text);
        }
        call.args.sort_unstable_by_key(|(i, _)| *i);
        let fine = complete && call.problems.is_empty() && call.extra_positional == 0;
        let (problems, extra) = (call.problems, call.extra_positional);
        let id = build.add_node(Node {
            schema: self.schema,
            name: call.name,
            span,
            stack,
            args: call.args.into(),
        });
        if fine { (id, true) } else { (id, self.report(build, id, problems, extra)) }
    }

    fn report(&self, build: &mut Build, id: NodeId, problems: Vec<Problem>, extra: usize) -> bool {
        let kind = self.schema.kind;
        let scene = &build.description;
        let mut errors = Vec::new();
        if extra > 0 {
            let (takes, got) = (self.positional, self.positional + extra);
            let plural = if takes == 1 { "argument" } else { "arguments" };
            let message = format!("{kind} takes {takes} {plural} without a name, got {got}");
            errors.push(
                Diagnostic::error("too-many-arguments", message)
                    .at(scene.positional_span(id, takes), "")
                    .help(format!("{kind} takes {}", self.names())),
            );
        }
        let mut mentioned = Vec::new();
        for problem in problems {
            errors.push(match problem {
                Problem::Unknown(key) => {
                    let names = self.params.iter().map(|param| param.name);
                    let nearest = suggest::nearest(&key, names);
                    mentioned.extend(nearest);
                    Diagnostic::error(
                        "unknown-argument",
                        format!("{kind} has no argument \"{key}\""),
                    )
                    .at(scene.key_span(id, &key), "")
                    .help(match nearest {
                        Some(name) => format!("did you mean \"{name}\"?"),
                        None => format!("{kind} takes {}", self.names()),
                    })
                }
                Problem::Twice(name) => {
                    let message = format!("{name} of {kind} is given twice");
                    Diagnostic::error("repeated-argument", message)
                        .at(scene.key_span(id, name), "")
                        .help("an argument without a name took its place: write all names")
                }
                Problem::Value(name, why) => {
                    mentioned.push(name);
                    Diagnostic::error("wrong-value", format!("{name} of {kind}: {why}"))
                        .at(scene.argument_span(id, name), "")
                }
            });
        }
        let node = scene.node(id);
        for (i, param) in self.params.iter().enumerate() {
            let written = node.args.iter().any(|(bound, _)| usize::from(*bound) == i);
            // A misspelt or wrong argument was meant to be this one: one message is enough.
            if param.default == Default::Required && !written && !mentioned.contains(&param.name) {
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

    fn names(&self) -> String {
        self.params.iter().map(|param| param.name).collect::<Vec<_>>().join(", ")
    }
}

fn too_many_objects(limit: usize) -> starlark::Error {
    Raised::with(
        Diagnostic::error("too-many-objects", format!("the scene makes more than {limit} objects"))
            .help("--max-objects raises the limit"),
    )
}

/// What a constructor returns: an immutable name for its node.
#[derive(Clone, Debug, ProvidesStaticType, NoSerialize, StarlarkPagablePanic, Allocative)]
pub(crate) struct Handle {
    #[allocative(skip)]
    pub id: NodeId,
    #[allocative(skip)]
    pub schema: &'static Schema,
}

starlark_simple_value!(Handle);

impl fmt::Display for Handle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "<{}>", self.schema.kind)
    }
}

#[starlark_value(type = "node")]
impl<'v> StarlarkValue<'v> for Handle {
    fn equals(&self, other: values::Value<'v>) -> starlark::Result<bool> {
        Ok(other.downcast_ref::<Self>().is_some_and(|other| other.id == self.id))
    }

    fn write_hash(&self, hasher: &mut StarlarkHasher) -> starlark::Result<()> {
        std::hash::Hash::hash(&self.id, hasher);
        Ok(())
    }
}
