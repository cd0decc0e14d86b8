// SPDX-License-Identifier: MIT OR Apache-2.0
//! Files that a command will write: tried before the work begins, replaced in one step when it is done.

use std::fs::{self, OpenOptions};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

use super::failure::Failure;
use super::terminal;

/// Where a result goes.
#[derive(Clone, Debug)]
pub enum Output {
    /// `-`.
    Stdout,
    /// A file.
    File(PathBuf),
}

impl Output {
    /// The output that was asked for, after trying whether it can be written. Nothing is changed yet:
    /// work that fails or is stopped leaves an older file as it was.
    ///
    /// # Errors
    /// It is a folder, its folder is missing, or writing is not permitted.
    pub fn new(path: &str) -> Result<Self, Failure> {
        if path == "-" {
            return Ok(Self::Stdout);
        }
        let output = PathBuf::from(path);
        try_to_write(&output).map_err(|e| Failure::output(path, &e))?;
        Ok(Self::File(output))
    }

    /// Whether it is standard output.
    pub const fn is_stdout(&self) -> bool {
        matches!(self, Self::Stdout)
    }

    /// Writes the whole result. A reader of the file sees the old bytes or the new ones, never half.
    ///
    /// # Errors
    /// The disk is full, or what was possible before no longer is.
    pub fn write(&self, bytes: &[u8]) -> Result<(), Failure> {
        match self {
            Self::Stdout => terminal::print(bytes),
            Self::File(path) => {
                replace(path, bytes).map_err(|e| Failure::output(&path.display().to_string(), &e))
            }
        }
    }
}

impl std::fmt::Display for Output {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Stdout => f.write_str("standard output"),
            Self::File(path) => path.display().fmt(f),
        }
    }
}

fn try_to_write(path: &Path) -> io::Result<()> {
    match fs::metadata(path) {
        Ok(meta) if meta.is_dir() => Err(ErrorKind::IsADirectory.into()),
        Ok(meta) if meta.is_file() => OpenOptions::new().write(true).open(path).map(drop),
        // A pipe or device: opening it could wait for a reader.
        Ok(_) => Ok(()),
        Err(e) if e.kind() == ErrorKind::NotFound => {
            OpenOptions::new().write(true).create_new(true).open(path)?;
            fs::remove_file(path)
        }
        Err(e) => Err(e),
    }
}

fn replace(path: &Path, bytes: &[u8]) -> io::Result<()> {
    if fs::metadata(path).is_ok_and(|meta| !meta.is_file()) {
        return OpenOptions::new().write(true).open(path)?.write_all(bytes);
    }
    // A link's target is replaced, not the link.
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
    let mut name = target.file_name().unwrap_or_default().to_os_string();
    name.push(format!(".{}.part", std::process::id()));
    let part = target.with_file_name(name);
    let written = fs::write(&part, bytes).and_then(|()| fs::rename(&part, &target));
    if written.is_err() {
        let _ = fs::remove_file(&part);
    }
    written
}
