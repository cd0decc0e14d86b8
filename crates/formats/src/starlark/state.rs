// SPDX-License-Identifier: MIT OR Apache-2.0
//! What is known while a scene is evaluated: the description so far, the errors, the limits.

use std::cell::{Cell, RefCell, RefMut};
use std::collections::HashMap;

use dioptric_scene::{
    Description, Diagnostic, FileId, Node, NodeId, Span, StackFrame, StackId, Value,
};
use starlark::any::ProvidesStaticType;
use starlark::codemap::{CodeMap, CodeMapId, FileSpan};
use starlark::eval::Evaluator;

use super::errors::Raised;
use crate::options::{Limits, ParamInfo, ReadOptions};

/// Errors after which reading stops.
const MAX_ERRORS: usize = 20;
/// Bytes of printed text that are kept.
const MAX_PRINTED: usize = 1 << 20;
/// Places of calls that a message shows besides its own.
const MAX_CALLERS: usize = 4;

/// The state of one reading, shared by all files of the scene.
#[derive(Debug, ProvidesStaticType)]
pub(crate) struct State {
    pub options: ReadOptions,
    build: RefCell<Build>,
    steps: Cell<u64>,
    stopped: Cell<Option<Stop>>,
}

/// The limit that ended the evaluation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stop {
    Steps,
    Memory,
}

/// The part of the state that grows.
#[derive(Debug, Default)]
pub(crate) struct Build {
    pub description: Description,
    pub diagnostics: Vec<Diagnostic>,
    pub params: Vec<ParamInfo>,
    pub printed: Vec<String>,
    printed_bytes: usize,
    /// Nodes that are in the scene unless something consumes them.
    entered: Vec<NodeId>,
    /// By node: whether another node holds it.
    consumed: Vec<bool>,
    /// Bytes of all nodes.
    node_bytes: usize,
    /// How many `load`s are running their files' top level.
    pub loading: u32,
    files: Vec<(CodeMapId, FileId)>,
    stacks: HashMap<Vec<(CodeMapId, u32, u32)>, StackId>,
    frames: HashMap<StackFrame, StackId>,
}

impl State {
    pub(crate) fn new(options: &ReadOptions) -> Self {
        Self {
            options: options.clone(),
            build: RefCell::default(),
            steps: Cell::new(0),
            stopped: Cell::new(None),
        }
    }

    /// The state of the evaluation that calls.
    pub(crate) fn of<'a>(eval: &Evaluator<'_, 'a, '_>) -> starlark::Result<&'a Self> {
        eval.extra
            .and_then(|extra| extra.downcast_ref::<Self>())
            .ok_or_else(|| Raised::error("internal", "the scene is evaluated without its state"))
    }

    pub(crate) fn limits(&self) -> &Limits {
        &self.options.limits
    }

    /// The description and what belongs to it. No caller calls back into the scene while it holds this.
    pub(crate) fn build(&self) -> RefMut<'_, Build> {
        self.build.borrow_mut()
    }

    pub(crate) fn into_build(self) -> Build {
        self.build.into_inner()
    }

    /// Counts a thousand steps; true where the evaluation has to stop.
    pub(crate) fn count_steps(&self, heap_bytes: usize) -> bool {
        if self.stopped.get().is_some() {
            // The error is on its way; a second one would replace it.
            return false;
        }
        self.steps.set(self.steps.get() + 1000);
        let limits = self.limits();
        if self.steps.get() > limits.steps {
            self.stopped.set(Some(Stop::Steps));
        } else if heap_bytes.saturating_add(self.build().node_bytes) > limits.memory {
            self.stopped.set(Some(Stop::Memory));
        }
        self.stopped.get().is_some()
    }

    pub(crate) fn stopped(&self) -> Option<Stop> {
        self.stopped.get()
    }

    /// Where the function that runs was called, and the calls above that.
    pub(crate) fn place(&self, eval: &Evaluator) -> (Span, StackId) {
        let Some(here) = eval.call_stack_top_location() else { return (Span::NONE, StackId::TOP) };
        let mut build = self.build();
        let span = build.span(&here);
        let depth = eval.call_stack_count();
        // A small function of a loaded file may have been inlined into its caller: then the stack
        // has no level for it, and only the whole call stack knows.
        if span.file != FileId(0) {
            let frames = eval.call_stack().into_frames();
            let callers = frames.split_last().map_or(&[][..], |(_, callers)| callers);
            return (span, build.intern(callers));
        }
        if depth <= 2 {
            return (span, StackId::TOP);
        }
        let key: Vec<_> = (1..depth - 1)
            .filter_map(|n| eval.call_stack_nth_location(n))
            .map(|place| (place.file.id(), place.span.begin().get(), place.span.end().get()))
            .collect();
        if let Some(&stack) = build.stacks.get(&key) {
            return (span, stack);
        }
        let frames = eval.call_stack().into_frames();
        let callers = frames.split_last().map_or(&[][..], |(_, callers)| callers);
        let stack = build.intern(callers);
        build.stacks.insert(key, stack);
        (span, stack)
    }
}

impl Build {
    /// Adds a file's text; `code` is the evaluator's name for it.
    pub(crate) fn add_file(&mut self, name: &str, code: &CodeMap) -> FileId {
        let file = self.description.sources.add(name, code.source());
        self.files.push((code.id(), file));
        file
    }

    /// A place of the evaluator as ours; [`Span::NONE`] for functions that are not in a scene's text.
    pub(crate) fn span(&self, place: &FileSpan) -> Span {
        let id = place.file.id();
        match self.files.iter().find(|(code, _)| *code == id) {
            Some(&(_, file)) => {
                Span { file, start: place.span.begin().get(), end: place.span.end().get() }
            }
            None => Span::NONE,
        }
    }

    /// The id of a call stack, outermost call first.
    fn intern(&mut self, frames: &[starlark::errors::Frame]) -> StackId {
        let mut parent = StackId::TOP;
        for frame in frames {
            let span = frame.location.as_ref().map_or(Span::NONE, |place| self.span(place));
            let frame = StackFrame { function: frame.name.as_str().into(), span, parent };
            parent = match self.frames.get(&frame) {
                Some(&id) => id,
                None => {
                    let id = StackId(self.description.stacks.len() as u32);
                    self.description.stacks.push(frame.clone());
                    self.frames.insert(frame, id);
                    id
                }
            };
        }
        parent
    }

    /// Adds a node; what it refers to is consumed.
    pub(crate) fn add_node(&mut self, node: Node) -> NodeId {
        self.node_bytes += size_of::<Node>() + size_of_val(&*node.args);
        for (_, value) in &node.args {
            self.node_bytes += owned_bytes(value);
            let consumed = &mut self.consumed;
            value.for_each_node(&mut |id| {
                if let Some(flag) = consumed.get_mut(id.0 as usize) {
                    *flag = true;
                }
            });
        }
        let enters = self.loading == 0 && node.schema.category.enters_scene();
        let id = self.description.push(node);
        self.consumed.push(false);
        if enters {
            self.entered.push(id);
        }
        id
    }

    /// Makes the nodes that nothing consumed the roots of the description.
    pub(crate) fn finish_roots(&mut self) {
        let consumed = &self.consumed;
        self.entered.retain(|id| !consumed.get(id.0 as usize).is_some_and(|&c| c));
        self.description.roots = std::mem::take(&mut self.entered);
    }

    /// Keeps an error unless one of its kind was found at its place; false where there are too many.
    pub(crate) fn record(&mut self, diagnostic: Diagnostic) -> bool {
        let same = |d: &Diagnostic| {
            d.code == diagnostic.code
                && d.labels.first().map(|l| l.span) == diagnostic.labels.first().map(|l| l.span)
        };
        if !self.diagnostics.iter().any(same) {
            self.diagnostics.push(diagnostic);
        }
        self.diagnostics.len() < MAX_ERRORS
    }

    /// Keeps a line that the scene prints, up to a bound.
    pub(crate) fn print(&mut self, line: &str) {
        if self.printed_bytes > MAX_PRINTED {
            return;
        }
        self.printed_bytes += line.len() + 1;
        let more = self.printed_bytes > MAX_PRINTED;
        self.printed.push(if more { "... (more was printed)".into() } else { line.into() });
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
