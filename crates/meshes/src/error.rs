// SPDX-License-Identifier: MIT OR Apache-2.0
//! What is wrong with a mesh file, where, and the remedy.

use std::fmt;

/// Where in a file something is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// A line of text, the first is 1.
    Line(u64),
    /// A byte of binary data, counted from 0 at the start of the file.
    Byte(u64),
    /// The file as a whole.
    File,
}

/// Why a mesh could not be read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MeshError {
    /// The name of the file.
    pub file: String,
    /// Where in it.
    pub place: Place,
    /// What was expected and what is there, one sentence without a full stop.
    pub message: String,
    /// The remedy.
    pub help: String,
    /// Whether the file may be right, but takes more memory than is allowed.
    pub is_too_large: bool,
}

/// The remedy where there is no better one.
const EXPORT_AGAIN: &str = "the file is damaged or cut off: export or download it again";

impl MeshError {
    pub(crate) fn new(place: Place, message: impl Into<String>) -> Self {
        Self {
            file: String::new(),
            place,
            message: message.into(),
            help: EXPORT_AGAIN.into(),
            is_too_large: false,
        }
    }

    pub(crate) fn too_large(place: Place, message: impl Into<String>) -> Self {
        let error = Self::new(place, message).help("raise the limit with --max-memory");
        Self { is_too_large: true, ..error }
    }

    pub(crate) fn help(self, help: impl Into<String>) -> Self {
        Self { help: help.into(), ..self }
    }

    pub(crate) fn in_file(self, file: &str) -> Self {
        Self { file: file.into(), ..self }
    }
}

impl fmt::Display for MeshError {
    /// File, place and message in one line; the remedy is for whoever has room for it.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.file)?;
        match self.place {
            Place::Line(n) => write!(f, ", line {n}: {}", self.message),
            Place::Byte(n) => write!(f, ", byte {n}: {}", self.message),
            Place::File => write!(f, ": {}", self.message),
        }
    }
}

impl std::error::Error for MeshError {}
