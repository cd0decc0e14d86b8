// SPDX-License-Identifier: MIT OR Apache-2.0
//! What can go wrong with a picture: one error type that says what is the matter and what to do.

use std::fmt;

/// The class of an [`ImageError`], for programs that decide by it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ErrorKind {
    /// The bytes are no picture of a known format, or use a feature that is not read.
    Unsupported,
    /// The file breaks off or contradicts itself.
    Corrupt,
    /// The picture is larger than the limit that the caller set.
    TooLarge,
    /// The request makes no sense: sizes that differ, an unknown name, a size of zero.
    Invalid,
}

/// A fault in reading, writing or comparing pictures.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ImageError {
    /// The class of the fault.
    pub kind: ErrorKind,
    /// What is wrong, in one line without a full stop.
    pub message: String,
    /// What to do about it, in one line without a full stop.
    pub help: String,
}

impl ImageError {
    /// An error of a class with its message and its remedy.
    #[must_use]
    pub fn new(kind: ErrorKind, message: impl Into<String>, help: impl Into<String>) -> Self {
        Self { kind, message: message.into(), help: help.into() }
    }

    pub(crate) fn unsupported(message: impl Into<String>, help: impl Into<String>) -> Self {
        Self::new(ErrorKind::Unsupported, message, help)
    }

    pub(crate) fn invalid(message: impl Into<String>, help: impl Into<String>) -> Self {
        Self::new(ErrorKind::Invalid, message, help)
    }

    /// A file of `format` that cannot be read to its end, for the reason that its reader gave.
    pub(crate) fn corrupt(format: &str, reason: impl fmt::Display) -> Self {
        Self::new(
            ErrorKind::Corrupt,
            format!("the {format} file is damaged: {reason}"),
            "export the picture again, or open it in another program to see if it is complete",
        )
    }
}

impl fmt::Display for ImageError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} ({})", self.message, self.help)
    }
}

impl std::error::Error for ImageError {}
