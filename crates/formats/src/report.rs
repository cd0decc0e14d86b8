// SPDX-License-Identifier: MIT OR Apache-2.0
//! Diagnostics as text for a terminal: message, place, the line itself, a caret, the remedy.
//!
//! ```text
//! error[unknown-argument]: sphere has no argument "raduis"
//!  --> scene.star:3:20
//!   |
//! 3 | sphere((0, 0, 0), raduis = 1)
//!   |                   ^^^^^^
//!   = help: did you mean "radius"?
//! ```

use annotate_snippets::{AnnotationKind, Group, Level, Renderer, Snippet};
use dioptric_scene::{Diagnostic, FileId, Severity, Sources, Span};

/// All diagnostics in order, with an empty line between them; nothing for none.
///
/// `color` asks for terminal colours. Control characters of the scene never reach the terminal.
#[must_use]
pub fn render(diagnostics: &[Diagnostic], sources: &Sources, color: bool) -> String {
    let renderer = if color { Renderer::styled() } else { Renderer::plain() };
    let mut text = String::new();
    for diagnostic in diagnostics {
        if !text.is_empty() {
            text.push('\n');
        }
        text.push_str(&renderer.render(&[group(diagnostic, sources)]));
        text.push('\n');
    }
    text
}

/// The counts in words, `2 errors and 1 warning`; nothing for none.
#[must_use]
pub fn summary(diagnostics: &[Diagnostic]) -> Option<String> {
    let count = |severity, word: &str| {
        let n = diagnostics.iter().filter(|d| d.severity == severity).count();
        (n > 0).then(|| format!("{n} {word}{}", if n == 1 { "" } else { "s" }))
    };
    match (count(Severity::Error, "error"), count(Severity::Warning, "warning")) {
        (Some(errors), Some(warnings)) => Some(format!("{errors} and {warnings}")),
        (one, other) => one.or(other),
    }
}

fn group<'a>(diagnostic: &Diagnostic, sources: &'a Sources) -> Group<'a> {
    let level = match diagnostic.severity {
        Severity::Error => Level::ERROR,
        Severity::Warning => Level::WARNING,
    };
    let title = level.primary_title(printable(&diagnostic.message)).id(diagnostic.code);
    let mut group = Group::with_title(title);
    for file in files(diagnostic) {
        let Some(source) = sources.get(file) else { continue };
        let mut snippet = Snippet::source(source.text.as_ref()).path(printable(&source.name));
        for (i, label) in diagnostic.labels.iter().enumerate() {
            if label.span.file != file {
                continue;
            }
            let kind = if i == 0 { AnnotationKind::Primary } else { AnnotationKind::Context };
            let annotation = kind.span(first_line(label.span, &source.text));
            snippet = snippet.annotation(if label.text.is_empty() {
                annotation
            } else {
                annotation.label(printable(&label.text))
            });
        }
        group = group.element(snippet);
    }
    match &diagnostic.help {
        Some(help) => group.element(Level::HELP.message(printable(help))),
        None => group,
    }
}

/// The texts that a diagnostic points into, the main one first.
fn files(diagnostic: &Diagnostic) -> Vec<FileId> {
    let mut files: Vec<FileId> = Vec::new();
    for label in &diagnostic.labels {
        if !files.contains(&label.span.file) {
            files.push(label.span.file);
        }
    }
    files
}

/// The part of a span that is on its first line, moved to whole characters inside the text.
fn first_line(span: Span, text: &str) -> std::ops::Range<usize> {
    let floor = |at: u32| {
        let mut at = (at as usize).min(text.len());
        while !text.is_char_boundary(at) {
            at -= 1;
        }
        at
    };
    let (start, end) = (floor(span.start), floor(span.end.max(span.start)));
    let line_end = text[start..end].find('\n').map_or(end, |i| start + i);
    start..line_end
}

/// The text without characters that could steer a terminal.
fn printable(text: &str) -> String {
    text.chars().map(|c| if c.is_control() && c != '\n' { '\u{fffd}' } else { c }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_shows_place_line_caret_and_remedy() {
        let mut sources = Sources::default();
        let file = sources.add("scene.star", "# é\n\nsphere((0, 0, 0), raduis = 1)\ntree()\n");
        let at = |start, end| Span { file, start, end };
        let diagnostics = [
            Diagnostic::error("unknown-argument", "sphere has no argument \"raduis\"")
                .at(at(24, 30), "")
                .at(at(36, 42), "called from here")
                .help("did you mean \"radius\"?"),
            Diagnostic::warning("no-light", "nothing lights the scene\u{1b}[2J"),
        ];
        assert_eq!(
            render(&diagnostics, &sources, false),
            "\
error[unknown-argument]: sphere has no argument \"raduis\"
 --> scene.star:3:19
  |
3 | sphere((0, 0, 0), raduis = 1)
  |                   ^^^^^^
4 | tree()
  | ------ called from here
  |
  = help: did you mean \"radius\"?

warning[no-light]: nothing lights the scene\u{fffd}[2J
"
        );
        assert_eq!(summary(&diagnostics).as_deref(), Some("1 error and 1 warning"));
        assert_eq!(summary(&[]), None);
        assert!(render(&diagnostics, &sources, true).contains("\u{1b}["));
    }

    #[test]
    fn impossible_spans_are_brought_inside() {
        let mut sources = Sources::default();
        let file = sources.add("a", "é\nb");
        for (start, end) in [(1, 2), (0, 900), (900, 901), (3, 1), (2, 3)] {
            let error = Diagnostic::error("x", "y").at(Span { file, start, end }, "");
            assert!(render(&[error], &sources, false).contains(" --> a:"), "{start}..{end}");
        }
    }
}
