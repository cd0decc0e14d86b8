// SPDX-License-Identifier: MIT OR Apache-2.0
//! Every way in which a command ends other than well, what is printed then, and the exit status.

use std::io::ErrorKind;
use std::process::ExitCode;

use dioptric::formats::report;
use dioptric::image::ImageError;
use dioptric::scene::{Diagnostic, Sources, suggest};

use super::terminal::Terminal;

/// Why a command did not end well.
#[derive(Debug)]
pub enum Failure {
    /// The scene is wrong: status 1.
    Scene(Vec<Diagnostic>, Sources),
    /// A file is at fault: status 1.
    File {
        /// What is wrong.
        message: String,
        /// What to do about it.
        help: String,
    },
    /// An argument makes no sense: status 2.
    Usage {
        /// What is wrong.
        message: String,
        /// What to write instead.
        help: String,
    },
    /// The command did its work, and the answer is no (two pictures differ): status 1, already said.
    Negative,
    /// Stopped by Ctrl-C: status 130.
    Interrupted,
    /// Nobody reads what we print any more: that is no fault, status 0.
    BrokenPipe,
}

impl Failure {
    /// The same of a scene whose texts are these.
    pub fn with_sources(self, sources: &Sources) -> Self {
        match self {
            Self::Scene(diagnostics, _) => Self::Scene(diagnostics, sources.clone()),
            other => other,
        }
    }

    /// A file cannot be read.
    pub fn input(path: &str, error: &std::io::Error) -> Self {
        Self::File {
            message: format!("cannot read {path}: {}", reason(error)),
            help: match error.kind() {
                ErrorKind::NotFound => "check the name and the folder".into(),
                ErrorKind::PermissionDenied => "check the file's permissions".into(),
                ErrorKind::IsADirectory => "name a file in it".into(),
                _ => "check that the file is there and readable".into(),
            },
        }
    }

    /// A file cannot be written.
    pub fn output(path: &str, error: &std::io::Error) -> Self {
        if error.kind() == ErrorKind::BrokenPipe {
            return Self::BrokenPipe;
        }
        Self::File {
            message: format!("cannot write {path}: {}", reason(error)),
            help: match error.kind() {
                ErrorKind::NotFound | ErrorKind::NotADirectory => {
                    "make the folder first, or name another with -o".into()
                }
                ErrorKind::IsADirectory => "name a file in it with -o".into(),
                _ => "name another file with -o".into(),
            },
        }
    }

    /// An argument makes no sense.
    pub fn usage(message: impl Into<String>, help: impl Into<String>) -> Self {
        Self::Usage { message: message.into(), help: help.into() }
    }

    /// An argument is none of the valid words.
    pub fn unknown<'a>(what: &str, word: &str, valid: impl Iterator<Item = &'a str>) -> Self {
        let mut valid: Vec<&str> = valid.collect();
        valid.sort_unstable();
        let help = match suggest::nearest(word, valid.iter().copied()) {
            Some(name) => format!("did you mean \"{name}\"?"),
            None if valid.len() > 12 => "dioptric list shows them all".into(),
            None => format!("one of: {}", valid.join(", ")),
        };
        Self::usage(format!("unknown {what} \"{word}\""), help)
    }

    /// A picture cannot be read or written.
    pub fn image(path: &str, error: &ImageError) -> Self {
        Self::File { message: format!("{path}: {}", error.message), help: error.help.clone() }
    }

    /// Says on standard error what is wrong, and returns the exit status.
    pub fn report(self, terminal: &Terminal) -> ExitCode {
        match self {
            Self::Scene(diagnostics, sources) => {
                terminal.complain(&diagnostics, &sources);
                ExitCode::from(1)
            }
            Self::File { message, help } => {
                terminal.complain(&[said("file", message, help)], &Sources::default());
                ExitCode::from(1)
            }
            Self::Usage { message, help } => {
                terminal.complain(&[said("usage", message, help)], &Sources::default());
                ExitCode::from(2)
            }
            Self::Negative => ExitCode::from(1),
            Self::Interrupted => ExitCode::from(130),
            Self::BrokenPipe => ExitCode::SUCCESS,
        }
    }
}

fn said(code: &'static str, message: String, help: String) -> Diagnostic {
    Diagnostic::error(code, message).help(help)
}

/// The reason in lower case without the number that the system gives it.
fn reason(error: &std::io::Error) -> String {
    match error.kind() {
        ErrorKind::NotFound => "no such file or folder".into(),
        ErrorKind::PermissionDenied => "permission denied".into(),
        ErrorKind::IsADirectory => "it is a folder".into(),
        ErrorKind::NotADirectory => "its folder is a file".into(),
        ErrorKind::StorageFull => "the disk is full".into(),
        _ => error.to_string(),
    }
}

/// Prints diagnostics, and their count where there are several.
pub fn diagnostics_text(diagnostics: &[Diagnostic], sources: &Sources, color: bool) -> String {
    let mut text = report::render(diagnostics, sources, color);
    if diagnostics.len() > 1
        && let Some(summary) = report::summary(diagnostics)
    {
        text.push_str(&format!("\n{summary}\n"));
    }
    text
}
