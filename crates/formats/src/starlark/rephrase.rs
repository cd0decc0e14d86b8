// SPDX-License-Identifier: MIT OR Apache-2.0
//! The evaluator's messages that newcomers meet most, in words for people who write scenes.

use dioptric_scene::Diagnostic;

use super::state::State;

/// A part of a message, what to say instead (`None`: leave it), and the remedy.
type Phrase = (&'static str, Option<&'static str>, &'static str);

const PHRASES: &[Phrase] = &[
    (
        "reserved keyword \"while\"",
        Some("the scene language has no while"),
        "write for i in range(1000): and leave it with break",
    ),
    (
        "reserved keyword \"import\"",
        Some("the scene language has no import"),
        "write load(\"file.star\", \"name\"); sin, pi and their like are always there",
    ),
    (
        "reserved keyword \"class\"",
        Some("the scene language has no class"),
        "write a function with def, or struct(a = 1, b = 2) for a record",
    ),
    ("reserved keyword", None, "the word has a meaning in Python; give the variable another name"),
    ("expected new indentation block", None, "indent the lines that belong to for, if or def"),
    ("expected symbol ')'", None, "is a bracket before this not closed, or a comma missing?"),
    ("expected symbol ']'", None, "is a bracket before this not closed, or a comma missing?"),
    (
        "unfinished string literal",
        Some("the text is not closed"),
        "close it with the quote it began with",
    ),
    (
        "positional argument after non positional",
        Some("an argument without a name comes after one with a name"),
        "write its name: name = ...",
    ),
    ("repeated named argument", Some("the argument is given twice"), "remove one of them"),
    (
        "mutates an iterable",
        Some("the list changes while a loop runs over it"),
        "loop over a copy: for x in list(xs)",
    ),
    (
        "types \"string\" and \"int\"",
        Some("text and a number cannot be joined like that"),
        "turn the number into text with str(...), or write f\"text {number}\"",
    ),
    (
        "types \"string\" and \"float\"",
        Some("text and a number cannot be joined like that"),
        "turn the number into text with str(...), or write f\"text {number}\"",
    ),
    (
        "not supported on type \"node\"",
        Some("an object cannot be changed, read or called once it is made"),
        "keep what you need in variables, and write all arguments in the call that makes it",
    ),
    (
        "not supported for type \"node\"",
        Some("an object cannot be changed, read or called once it is made"),
        "keep what you need in variables, and write all arguments in the call that makes it",
    ),
    ("\"NoneType\"", None, "a function that returns nothing gives None"),
    ("division by zero", Some("division by zero"), ""),
];

/// The message with this code and text, said for people.
pub(super) fn rephrase(code: &'static str, text: &str, state: &State) -> Diagnostic {
    // The evaluator calls a function of a file `file.star.name`.
    let mut text = text.to_string();
    for (_, source) in state.build().description.sources.iter() {
        text = text.replace(&format!("{}.", source.name), "");
    }
    if let Some(name) = between(&text, "local variable \"", "\" referenced before assignment") {
        return Diagnostic::error("unassigned", format!("{name} is used before it has a value"))
            .help(format!(
                "{name} is assigned in this file, which hides any function of that name: \
                 give the variable another name, or assign it earlier"
            ));
    }
    if let Some(index) = between(&text, "index \"", "\" is out of bound") {
        return Diagnostic::error("wrong-value", format!("the list has no item {index}"))
            .help("a list of n items has the items 0 to n - 1");
    }
    for (part, instead, help) in PHRASES {
        if text.contains(part) {
            let error = Diagnostic::error(code, instead.map_or(text.as_str(), |instead| instead));
            return if help.is_empty() { error } else { error.help(*help) };
        }
    }
    Diagnostic::error(code, text)
}

fn between<'a>(text: &'a str, before: &str, after: &str) -> Option<&'a str> {
    Some(text.strip_prefix(before)?.split_once(after)?.0)
}
