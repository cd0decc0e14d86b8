// SPDX-License-Identifier: MIT OR Apache-2.0
//! What is known while a scene is evaluated: the description so far, places, params, limits.

use std::cell::{Cell, RefCell, RefMut};
use std::collections::HashMap;

use dioptric_scene::{FileId, Span, StackFrame, StackId};
use starlark::any::ProvidesStaticType;
use starlark::codemap::{CodeMap, CodeMapId, FileSpan};
use starlark::errors::Frame;
use starlark::eval::Evaluator;

use super::errors::Raised;
use crate::build::Build;
use crate::options::{Limits, ParamInfo, ReadOptions};

/// Bytes of printed text that are kept.
const MAX_PRINTED: usize = 1 << 20;

/// The state of one reading, shared by all files of the scene.
#[derive(Debug, ProvidesStaticType)]
pub(crate) struct State {
    pub options: ReadOptions,
    build: RefCell<Build>,
    places: RefCell<Places>,
    params: RefCell<Vec<ParamInfo>>,
    printed: RefCell<Vec<String>>,
    printed_bytes: Cell<usize>,
    steps: Cell<u64>,
    stopped: Cell<Option<Stop>>,
}

/// The limit that ended the evaluation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stop {
    Steps,
    Memory,
}

/// The evaluator's places and ours.
#[derive(Debug, Default)]
struct Places {
    files: Vec<(CodeMapId, FileId)>,
    /// Call stacks by the places of their calls, innermost first.
    stacks: HashMap<Vec<(CodeMapId, u32, u32)>, StackId>,
    frames: HashMap<StackFrame, StackId>,
}

impl State {
    pub(crate) fn new(options: &ReadOptions) -> Self {
        Self {
            options: options.clone(),
            build: RefCell::default(),
            places: RefCell::default(),
            params: RefCell::default(),
            printed: RefCell::default(),
            printed_bytes: Cell::new(0),
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

    /// The description. No caller calls back into the scene while it holds this.
    pub(crate) fn build(&self) -> RefMut<'_, Build> {
        self.build.borrow_mut()
    }

    /// The description, the params that were asked for, the lines that were printed.
    pub(crate) fn into_parts(self) -> (Build, Vec<ParamInfo>, Vec<String>) {
        (self.build.into_inner(), self.params.into_inner(), self.printed.into_inner())
    }

    /// Notes a param, once.
    pub(crate) fn add_param(&self, info: ParamInfo) {
        let mut params = self.params.borrow_mut();
        if !params.iter().any(|known| known.name == info.name) {
            params.push(info);
        }
    }

    /// Keeps a line that the scene prints, up to a bound.
    pub(crate) fn print(&self, line: &str) {
        let bytes = self.printed_bytes.get();
        if bytes > MAX_PRINTED {
            return;
        }
        self.printed_bytes.set(bytes + line.len() + 1);
        let more = self.printed_bytes.get() > MAX_PRINTED;
        let line = if more { "... (more was printed)" } else { line };
        self.printed.borrow_mut().push(line.into());
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
            return true;
        }
        self.is_memory_full(heap_bytes)
    }

    /// Whether the evaluation has to stop because its values and the nodes take too much memory.
    pub(crate) fn is_memory_full(&self, heap_bytes: usize) -> bool {
        let full = heap_bytes.saturating_add(self.build().bytes) > self.limits().memory;
        if full {
            self.stopped.set(Some(Stop::Memory));
        }
        full
    }

    pub(crate) fn stopped(&self) -> Option<Stop> {
        self.stopped.get()
    }

    /// Adds a file's text; `code` is the evaluator's name for it.
    pub(crate) fn add_file(&self, name: &str, code: &CodeMap) -> FileId {
        let file = self.build().description.sources.add(name, code.source());
        self.places.borrow_mut().files.push((code.id(), file));
        file
    }

    /// A place of the evaluator as ours; [`Span::NONE`] for functions that no scene's text made.
    pub(crate) fn span(&self, place: &FileSpan) -> Span {
        let id = place.file.id();
        match self.places.borrow().files.iter().find(|(code, _)| *code == id) {
            Some(&(_, file)) => {
                Span { file, start: place.span.begin().get(), end: place.span.end().get() }
            }
            None => Span::NONE,
        }
    }

    /// Where the function that runs was called, and the calls above that.
    pub(crate) fn place(&self, eval: &Evaluator) -> (Span, StackId) {
        let Some(here) = eval.call_stack_top_location() else { return (Span::NONE, StackId::TOP) };
        let span = self.span(&here);
        // A small function of a loaded file may have been inlined into its caller: then the stack
        // has no level for it, and only the whole call stack knows.
        if span.file != FileId(0) {
            return (span, self.intern_callers(eval));
        }
        let depth = eval.call_stack_count();
        if depth <= 2 {
            return (span, StackId::TOP);
        }
        let key: Vec<_> = (1..depth - 1)
            .filter_map(|n| eval.call_stack_nth_location(n))
            .map(|place| (place.file.id(), place.span.begin().get(), place.span.end().get()))
            .collect();
        if let Some(&stack) = self.places.borrow().stacks.get(&key) {
            return (span, stack);
        }
        let stack = self.intern_callers(eval);
        self.places.borrow_mut().stacks.insert(key, stack);
        (span, stack)
    }

    /// The id of the call stack without its innermost call.
    fn intern_callers(&self, eval: &Evaluator) -> StackId {
        let frames = eval.call_stack().into_frames();
        let callers: &[Frame] = frames.split_last().map_or(&[], |(_, callers)| callers);
        let mut parent = StackId::TOP;
        for frame in callers {
            let span = frame.location.as_ref().map_or(Span::NONE, |place| self.span(place));
            let frame = StackFrame { function: frame.name.as_str().into(), span, parent };
            let mut places = self.places.borrow_mut();
            parent = *places.frames.entry(frame).or_insert_with_key(|frame| {
                let stacks = &mut self.build().description.stacks;
                stacks.push(frame.clone());
                StackId(stacks.len() as u32 - 1)
            });
        }
        parent
    }
}
