// SPDX-License-Identifier: MIT OR Apache-2.0
//! Readers and writers of scenes, one module a format, chosen by the file's extension.
//!
//! A reader turns bytes into a [`Description`], guided by a [`Vocabulary`]: this crate knows no
//! shape, material or setting. Files come through a [`Loader`]; everything that is wrong comes back
//! as [`Diagnostic`]s, which [`report::render`] turns into text. No reader panics or runs without
//! bound, whatever it is given: [`Limits`] are checked while reading.

#![deny(unsafe_code)]

pub mod json;
pub mod report;

mod build;
mod call;
mod depth;
mod nff;
mod options;
mod starlark;

use dioptric_scene::{Description, Diagnostic, Loader, Severity, Sources, Vocabulary};

use build::Build;
pub use options::{Limits, ParamInfo, ReadOptions};
pub use starlark::functions;

/// A scene that was read.
#[derive(Clone, Debug)]
pub struct Reading {
    /// The scene.
    pub description: Description,
    /// Warnings; no errors.
    pub warnings: Vec<Diagnostic>,
    /// The scene's `param`s in the order in which it asked for them.
    pub params: Vec<ParamInfo>,
    /// What the scene printed, a line each.
    pub printed: Vec<String>,
}

/// Why a scene could not be read.
#[derive(Clone, Debug)]
pub struct ReadError {
    /// The texts that the diagnostics point into.
    pub sources: Sources,
    /// At least one error; warnings too.
    pub diagnostics: Vec<Diagnostic>,
    /// What the scene printed before it failed.
    pub printed: Vec<String>,
}

impl ReadError {
    fn new(sources: Sources, diagnostic: Diagnostic) -> Self {
        Self { sources, diagnostics: vec![diagnostic], printed: Vec::new() }
    }
}

/// Reads the scene file `path`, which `loader` finds, in the format of its extension.
///
/// # Errors
/// The file cannot be had, is in no known format, or is wrong; with all errors that were found.
pub fn read(
    path: &str,
    loader: &dyn Loader,
    vocabulary: &Vocabulary,
    options: &ReadOptions,
) -> Result<Reading, ReadError> {
    let fail = |diagnostic| ReadError::new(Sources::default(), diagnostic);
    let extension = path.rsplit_once('.').map_or("", |(_, extension)| extension);
    let reader = match extension.to_ascii_lowercase().as_str() {
        "star" => starlark::read,
        "json" => json::read,
        "nff" => nff::read,
        _ => {
            return Err(fail(
                Diagnostic::error("unknown-format", format!("{path} is in no known scene format"))
                    .help(format!("the name must end in one of {}", EXTENSIONS.join(", "))),
            ));
        }
    };
    let bytes = loader.read(path).map_err(|error| fail(error.diagnostic()))?;
    let text = decode(path, bytes, options)?;
    reader(path, text, loader, vocabulary, options)
}

/// The extensions of the formats that [`read`] knows.
pub const EXTENSIONS: &[&str] = &[".star", ".json", ".nff"];

/// The text of a scene file, with the reasons why it is none.
fn decode(path: &str, bytes: Vec<u8>, options: &ReadOptions) -> Result<String, ReadError> {
    if bytes.len() > options.limits.source {
        return Err(ReadError::new(
            Sources::default(),
            Diagnostic::error(
                "file-too-large",
                format!(
                    "{path} is {} MiB long, more than the limit of {} MiB for a scene's text",
                    bytes.len() >> 20,
                    options.limits.source >> 20
                ),
            )
            .help("make repeated things with a loop"),
        ));
    }
    let text = String::from_utf8(bytes).map_err(|error| {
        let good = error.utf8_error().valid_up_to();
        let line = 1 + error.as_bytes()[..good].iter().filter(|&&b| b == b'\n').count();
        ReadError::new(
            Sources::default(),
            Diagnostic::error("not-text", format!("{path} is not UTF-8 text (line {line})"))
                .help("save the file as UTF-8"),
        )
    })?;
    Ok(match text.strip_prefix('\u{feff}') {
        Some(rest) => rest.to_string(),
        None => text,
    })
}

/// The result of a finished reading: an error if one of its diagnostics is.
fn conclude(
    build: Build,
    params: Vec<ParamInfo>,
    printed: Vec<String>,
) -> Result<Reading, ReadError> {
    let Build { description, diagnostics, .. } = build;
    if diagnostics.iter().any(|d| d.severity == Severity::Error) {
        Err(ReadError { sources: description.sources, diagnostics, printed })
    } else {
        Ok(Reading { description, warnings: diagnostics, params, printed })
    }
}
