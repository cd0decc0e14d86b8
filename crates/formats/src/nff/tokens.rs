// SPDX-License-Identifier: MIT OR Apache-2.0
//! Words and numbers between white space; `#` begins a comment that lasts to the end of its line.

use dioptric_scene::{Diagnostic, FileId, Span};

/// Why an entity is given up: an error to record, or nothing where enough were recorded.
pub(super) type Stop = Option<Box<Diagnostic>>;

pub(super) fn stop(diagnostic: Diagnostic) -> Stop {
    Some(Box::new(diagnostic))
}

/// The tokens of a text that are left.
pub(super) struct Tokens<'a> {
    text: &'a str,
    file: FileId,
    /// Where the next token is looked for.
    at: usize,
    /// The end of the last token.
    end: usize,
}

impl<'a> Tokens<'a> {
    pub(super) const fn new(text: &'a str, file: FileId) -> Self {
        Self { text, file, at: 0, end: 0 }
    }

    /// The next token; it stays.
    fn peek(&mut self) -> Option<(&'a str, Span)> {
        loop {
            let rest = self.text.get(self.at..)?;
            let start = self.at + rest.find(|c: char| !c.is_ascii_whitespace())?;
            let rest = &self.text[start..];
            if rest.starts_with('#') {
                self.at = start + rest.find('\n').unwrap_or(rest.len());
                continue;
            }
            let length =
                rest.find(|c: char| c.is_ascii_whitespace() || c == '#').unwrap_or(rest.len());
            self.at = start;
            let span = Span { file: self.file, start: start as u32, end: (start + length) as u32 };
            return Some((&rest[..length], span));
        }
    }

    /// Takes the next token.
    pub(super) fn next(&mut self) -> Option<(&'a str, Span)> {
        let (token, span) = self.peek()?;
        self.at = span.end as usize;
        self.end = self.at;
        Some((token, span))
    }

    /// From the start of a span to the last token that was taken.
    pub(super) const fn since(&self, start: Span) -> Span {
        Span { end: self.end as u32, ..start }
    }

    /// Takes the next token if it is one of these words.
    pub(super) fn take_one_of(&mut self, words: &[&'static str]) -> Option<&'static str> {
        let (token, _) = self.peek()?;
        let word = words.iter().copied().find(|word| *word == token)?;
        self.next();
        Some(word)
    }

    /// Whether the next token is a number.
    pub(super) fn number_follows(&mut self) -> bool {
        self.peek().is_some_and(|(token, _)| token.parse::<f64>().is_ok())
    }

    /// Goes on to the next word, after an error.
    pub(super) fn skip_numbers(&mut self) {
        while self.peek().is_some_and(|(token, _)| !token.starts_with(char::is_alphabetic)) {
            self.next();
        }
    }

    /// Takes `N` numbers; `what` says what they are for.
    pub(super) fn numbers<const N: usize>(&mut self, what: &str) -> Result<[f64; N], Stop> {
        let mut numbers = [0.0; N];
        for number in &mut numbers {
            let Some((token, span)) = self.peek() else {
                let end = self.text.len() as u32;
                let span = Span { file: self.file, start: end, end };
                return Err(stop(
                    Diagnostic::error("syntax", "the file ends too early").at(span, "").help(what),
                ));
            };
            match token.parse::<f64>() {
                Ok(x) if x.is_finite() => *number = x,
                _ => {
                    let message = format!("expected a number, got {token}");
                    return Err(stop(Diagnostic::error("syntax", message).at(span, "").help(what)));
                }
            }
            self.next();
        }
        Ok(numbers)
    }

    /// Takes a whole number.
    pub(super) fn count(&mut self, what: &str) -> Result<u32, Stop> {
        if let Some((token, _)) = self.peek()
            && let Ok(count) = token.parse()
        {
            self.next();
            return Ok(count);
        }
        let [number] = self.numbers(what)?;
        let message = format!("expected a whole number, got {number}");
        let span = Span { file: self.file, start: self.end as u32, end: self.end as u32 };
        Err(stop(Diagnostic::error("syntax", message).at(span, "").help(what)))
    }
}
