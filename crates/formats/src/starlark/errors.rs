// SPDX-License-Identifier: MIT OR Apache-2.0
//! Errors of the evaluator in our words, with our places.

use std::collections::HashSet;
use std::fmt;

use dioptric_scene::{Diagnostic, FileId, Span, Vocabulary, suggest};
use starlark::ErrorKind;
use starlark::analysis::AstModuleLint;
use starlark::environment::Globals;
use starlark::errors::Frame;
use starlark::syntax::AstModule;

use super::rephrase;
use super::state::{State, Stop};

/// One of our own errors on its way through the evaluator. Without a diagnostic: enough errors were
/// recorded to stop.
#[derive(Debug)]
pub(crate) struct Raised(Option<Box<Diagnostic>>);

impl Raised {
    pub(crate) fn with(diagnostic: Diagnostic) -> starlark::Error {
        starlark::Error::new_other(Self(Some(Box::new(diagnostic))))
    }

    pub(crate) fn error(code: &'static str, message: impl Into<String>) -> starlark::Error {
        Self::with(Diagnostic::error(code, message))
    }

    pub(crate) fn enough() -> starlark::Error {
        starlark::Error::new_other(Self(None))
    }
}

impl fmt::Display for Raised {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.0.as_ref().map_or("too many errors", |diagnostic| &diagnostic.message))
    }
}

impl std::error::Error for Raised {}

/// The error as a diagnostic with its place and the calls that led there; nothing where all that is
/// to say was recorded before.
pub(crate) fn diagnose(error: &starlark::Error, state: &State) -> Option<Diagnostic> {
    let mut diagnostic = message(error, state)?;
    // Where calls are too deep, the last of them says more than the step that no longer fitted.
    let last = error.call_stack().frames.last().and_then(|frame| frame.location.as_ref());
    let deep = matches!(error.kind(), ErrorKind::StackOverflow(_));
    if diagnostic.labels.is_empty()
        && let Some(place) = last.filter(|_| deep).or(error.span())
    {
        diagnostic = diagnostic.at(state.span(place), "");
    }
    Some(with_callers(diagnostic, &error.call_stack().frames, state))
}

fn with_callers(mut diagnostic: Diagnostic, frames: &[Frame], state: &State) -> Diagnostic {
    let mut spans: Vec<(Span, &str)> = Vec::new();
    for frame in frames.iter().rev() {
        let span = frame.location.as_ref().map_or(Span::NONE, |place| state.span(place));
        let known = diagnostic.labels.iter().map(|label| label.span).any(|s| s == span)
            || spans.iter().any(|(s, _)| *s == span);
        if span.is_some() && !known && spans.len() < 4 {
            spans.push((span, &frame.name));
        }
    }
    let inside = diagnostic.labels.first().map(|label| label.span);
    for (i, (span, name)) in spans.into_iter().enumerate() {
        // The innermost frame is the call that failed: its argument or itself is shown already.
        let covers = inside.is_some_and(|inner| {
            span.file == inner.file && span.start <= inner.start && inner.end <= span.end
        });
        if i > 0 || !covers {
            diagnostic = diagnostic.at(span, format!("{name} called from here"));
        }
    }
    diagnostic
}

fn message(error: &starlark::Error, state: &State) -> Option<Diagnostic> {
    let limits = state.limits();
    match state.stopped() {
        Some(Stop::Steps) => {
            return Some(
                Diagnostic::error(
                    "too-many-steps",
                    format!("the scene takes more than {} steps", limits.steps),
                )
                .help("is there a loop that does not end? --max-steps raises the limit"),
            );
        }
        Some(Stop::Memory) => return Some(out_of_memory(limits.memory)),
        None => {}
    }
    let (code, inner) = match error.kind() {
        ErrorKind::StackOverflow(_) => {
            return Some(
                Diagnostic::error(
                    "too-deep",
                    format!("functions call one another more than {} deep", limits.depth),
                )
                .help("does a function call itself without end? --max-depth raises the limit"),
            );
        }
        ErrorKind::Fail(inner) => ("fail", inner),
        ErrorKind::Value(inner) => ("wrong-value", inner),
        ErrorKind::Function(inner) => ("wrong-call", inner),
        ErrorKind::Scope(inner) => ("unknown-name", inner),
        ErrorKind::Parser(inner) => ("syntax", inner),
        ErrorKind::Native(inner) | ErrorKind::Other(inner) => ("evaluation", inner),
        ErrorKind::Freeze(inner) | ErrorKind::Internal(inner) => ("internal", inner),
        _ => {
            return Some(Diagnostic::error(
                "evaluation",
                plain(&error.without_diagnostic().to_string()),
            ));
        }
    };
    match inner.downcast_ref::<Raised>() {
        Some(Raised(diagnostic)) => diagnostic.as_deref().cloned(),
        None if code == "fail" => Some(Diagnostic::error("fail", inner.to_string().trim())),
        None => Some(rephrase::rephrase(code, &plain(&inner.to_string()), state)),
    }
}

/// The error for a limit on memory that is passed.
pub(crate) fn out_of_memory(limit: usize) -> Diagnostic {
    Diagnostic::error(
        "too-much-memory",
        format!("the scene needs more than {} MiB while it is read", limit >> 20),
    )
    .help("--max-memory raises the limit")
}

/// One sentence that begins small and has no full stop, with quotes instead of backticks.
fn plain(text: &str) -> String {
    let text = text.lines().next().unwrap_or_default().trim().trim_end_matches('.');
    let text = text.strip_prefix("Parse error: ").unwrap_or(text).replace('`', "\"");
    let mut chars = text.chars();
    match chars.next() {
        Some(first) if chars.clone().next().is_some_and(char::is_lowercase) => {
            first.to_lowercase().chain(chars).collect()
        }
        _ => text,
    }
}

/// All names that a file uses and nobody made, with the nearest that there is. `own` are the names
/// that the file, `file`, makes at top level.
pub(crate) fn unknown_names(
    ast: &AstModule,
    globals: &Globals,
    vocabulary: &Vocabulary,
    own: &[String],
    file: FileId,
) -> Vec<Diagnostic> {
    let known: HashSet<String> = globals.names().map(|name| name.as_str().to_string()).collect();
    let kinds = vocabulary.iter().map(|schema| schema.kind);
    let others = globals.names().map(|name| name.as_str());
    let candidates: Vec<&str> = own.iter().map(String::as_str).chain(kinds).chain(others).collect();
    let mut found = Vec::new();
    for lint in ast.lint(Some(&known)) {
        if lint.short_name != "using-undefined" {
            continue;
        }
        let name = lint.location.source_span();
        let place = lint.location.span;
        let span = Span { file, start: place.begin().get(), end: place.end().get() };
        let error = Diagnostic::error("unknown-name", format!("there is no {name}")).at(span, "");
        found.push(match suggest::nearest(name, candidates.iter().copied()) {
            Some(near) => error.help(format!("did you mean \"{near}\"?")),
            None => error.help("`dioptric list` shows all shapes, materials and functions"),
        });
    }
    found.sort_by_key(|d| d.labels.first().map(|label| label.span.start));
    found
}
