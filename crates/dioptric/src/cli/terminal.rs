// SPDX-License-Identifier: MIT OR Apache-2.0
//! Standard output and standard error: what may be coloured, and printing that survives closed pipes.

use std::io::{IsTerminal, Read, Write};

use clap::ValueEnum;
use dioptric::scene::{Diagnostic, Sources};

use super::failure::{Failure, diagnostics_text};

/// When to colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ColorChoice {
    /// On a terminal, unless NO_COLOR is set.
    Auto,
    /// Always.
    Always,
    /// Never.
    Never,
}

/// What the two standard streams can show.
#[derive(Clone, Copy, Debug)]
pub struct Terminal {
    /// Colour on standard output.
    pub stdout_color: bool,
    /// Colour on standard error.
    pub stderr_color: bool,
    /// A progress bar on standard error.
    pub progress: bool,
}

impl Terminal {
    /// Asks the streams and the environment.
    pub fn new(choice: ColorChoice) -> Self {
        let set = |name: &str| std::env::var_os(name).is_some_and(|v| !v.is_empty());
        let dumb = std::env::var_os("TERM").is_some_and(|v| v == "dumb");
        let plain = set("NO_COLOR") || dumb;
        let color = |is_terminal: bool| match choice {
            ColorChoice::Auto => is_terminal && !plain,
            ColorChoice::Always => true,
            ColorChoice::Never => false,
        };
        let stderr = std::io::stderr().is_terminal();
        Self {
            stdout_color: color(std::io::stdout().is_terminal()),
            stderr_color: color(stderr),
            progress: stderr && !dumb,
        }
    }

    /// Prints diagnostics on standard error.
    pub fn complain(&self, diagnostics: &[Diagnostic], sources: &Sources) {
        if !diagnostics.is_empty() {
            note(&diagnostics_text(diagnostics, sources, self.stderr_color));
        }
    }
}

/// Writes to standard error. Where that is closed there is nobody to tell.
pub fn note(text: &str) {
    let _ = std::io::stderr().lock().write_all(text.as_bytes());
}

/// Writes to standard output.
///
/// # Errors
/// It is closed, or full.
pub fn print(bytes: &[u8]) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    out.write_all(bytes).and_then(|()| out.flush()).map_err(|e| Failure::output("-", &e))
}

/// All of standard input.
///
/// # Errors
/// It cannot be read.
pub fn read_stdin() -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    std::io::stdin().lock().read_to_end(&mut bytes)?;
    Ok(bytes)
}
