// SPDX-License-Identifier: MIT OR Apache-2.0
//! Texts that scenes are read from, and places in them.

use std::sync::Arc;

/// Which text a place is in: an index into [`Sources`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct FileId(pub u32);

/// A run of bytes `[start, end)` in one text, or [`Span::NONE`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Span {
    /// The text.
    pub file: FileId,
    /// First byte.
    pub start: u32,
    /// One past the last byte.
    pub end: u32,
}

impl Span {
    /// No place: the thing was made by a program, not read from a text.
    pub const NONE: Self = Self { file: FileId(u32::MAX), start: 0, end: 0 };

    /// Whether this is a place in a text at all.
    #[must_use]
    pub const fn is_some(&self) -> bool {
        self.file.0 != u32::MAX
    }
}

/// One text: the name that messages print, and its contents.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Source {
    /// The file's name as the user wrote it, or `<stdin>`.
    pub name: String,
    /// The whole text.
    pub text: Arc<str>,
}

/// All texts that a scene came from, in the order in which they were first read.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Sources {
    files: Vec<Source>,
}

impl Sources {
    /// Adds a text and returns its id.
    pub fn add(&mut self, name: impl Into<String>, text: impl Into<Arc<str>>) -> FileId {
        self.files.push(Source { name: name.into(), text: text.into() });
        FileId(self.files.len() as u32 - 1)
    }

    /// The text with this id.
    #[must_use]
    pub fn get(&self, file: FileId) -> Option<&Source> {
        self.files.get(file.0 as usize)
    }

    /// All texts in order.
    pub fn iter(&self) -> impl Iterator<Item = (FileId, &Source)> {
        self.files.iter().enumerate().map(|(i, s)| (FileId(i as u32), s))
    }

    /// The text that a span covers.
    #[must_use]
    pub fn text(&self, span: Span) -> Option<&str> {
        self.get(span.file)?.text.get(span.start as usize..span.end as usize)
    }

    /// File name, line and column of a span's start, both counted from 1; columns count characters.
    #[must_use]
    pub fn locate(&self, span: Span) -> Option<Location<'_>> {
        let source = self.get(span.file)?;
        let before = source.text.get(..span.start as usize)?;
        let line_start = before.rfind('\n').map_or(0, |i| i + 1);
        Some(Location {
            file: &source.name,
            line: 1 + before.bytes().filter(|&b| b == b'\n').count(),
            column: 1 + before[line_start..].chars().count(),
        })
    }
}

/// A place as people read it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Location<'a> {
    /// The file's name.
    pub file: &'a str,
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_and_columns_count_characters_from_one() {
        let mut sources = Sources::default();
        let file = sources.add("a.star", "é = 1\nsphere()\n");
        let span = Span { file, start: 7, end: 13 };
        assert_eq!(sources.text(span), Some("sphere"));
        assert_eq!(sources.locate(span), Some(Location { file: "a.star", line: 2, column: 1 }));
        assert_eq!(sources.locate(Span { file, start: 3, end: 4 }).unwrap().column, 3);
        assert_eq!(sources.locate(Span::NONE), None);
        assert_eq!(sources.locate(Span { file, start: 900, end: 901 }), None);
    }
}
