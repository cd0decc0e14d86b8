// SPDX-License-Identifier: MIT OR Apache-2.0
//! Where bytes come from: the only way in which scenes, pictures and models are read.
//!
//! A stranger's scene must be safe to open, so a [`FolderLoader`] reads regular files below one
//! folder and nowhere else, unless the user allows another place. Symbolic links are followed and
//! judged by where they lead.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{Cursor, ErrorKind, Read};
use std::path::{Component, Path, PathBuf};

use crate::diagnostic::Diagnostic;
use crate::suggest;

/// Gives the bytes of a file that a scene names. Paths use `/` and are relative to the scene's folder.
pub trait Loader: Send + Sync {
    /// The whole file.
    ///
    /// # Errors
    /// It is not there, not allowed, too large or cannot be read.
    fn read(&self, path: &str) -> Result<Vec<u8>, LoadError>;

    /// The file from its start, for readers that need not have all of it at once: meshes.
    ///
    /// # Errors
    /// As [`Self::read`]; what goes wrong later is told by the reader.
    fn open(&self, path: &str) -> Result<Box<dyn Read + '_>, LoadError> {
        Ok(Box::new(Cursor::new(self.read(path)?)))
    }
}

/// Why a file could not be had. `path` is the one that the scene wrote.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LoadError {
    /// There is no such file.
    NotFound {
        /// The file asked for.
        path: String,
        /// A file of the same folder with nearly this name.
        nearest: Option<String>,
    },
    /// It lies outside the folders that may be read.
    Outside {
        /// The file asked for.
        path: String,
    },
    /// It is larger than the loader's limit.
    TooLarge {
        /// The file asked for.
        path: String,
        /// The limit in bytes.
        limit: u64,
    },
    /// Anything else, in words: `it is a folder`, `permission denied`.
    Unreadable {
        /// The file asked for.
        path: String,
        /// What stands in the way.
        why: String,
    },
}

impl LoadError {
    /// The error as a message without a place; whoever asked for the file adds where.
    #[must_use]
    pub fn diagnostic(&self) -> Diagnostic {
        match self {
            Self::NotFound { path, nearest } => {
                let error = Diagnostic::error("file-not-found", format!("there is no file {path}"));
                match nearest {
                    Some(name) => error.help(format!("did you mean {name}?")),
                    None => {
                        error.help("paths are relative to the folder of the file that names them")
                    }
                }
            }
            Self::Outside { path } => Diagnostic::error(
                "file-outside",
                format!("{path} lies outside the scene's folder and is not read"),
            )
            .help("move it there, or allow its folder with --allow DIR"),
            Self::TooLarge { path, limit } => Diagnostic::error(
                "file-too-large",
                format!("{path} is larger than the limit of {} MiB", limit >> 20),
            )
            .help("raise the limit with --max-memory"),
            Self::Unreadable { path, why } => {
                Diagnostic::error("file-unreadable", format!("{path} cannot be read: {why}"))
            }
        }
    }
}

/// Reads files of one folder and below, and of the folders in an allow list.
#[derive(Clone, Debug)]
pub struct FolderLoader {
    root: PathBuf,
    allowed: Vec<PathBuf>,
    max_bytes: u64,
}

impl FolderLoader {
    /// A loader of `root` and below; files of up to 1 GiB.
    #[must_use]
    pub fn new(root: impl Into<PathBuf>) -> Self {
        let root: PathBuf = root.into();
        let root = if root.as_os_str().is_empty() { PathBuf::from(".") } else { root };
        Self { root, allowed: Vec::new(), max_bytes: 1 << 30 }
    }

    /// Allows another folder and all below it.
    #[must_use]
    pub fn allow(mut self, folder: impl Into<PathBuf>) -> Self {
        self.allowed.push(folder.into());
        self
    }

    /// Sets the largest file that is read, in bytes.
    #[must_use]
    pub const fn max_bytes(mut self, bytes: u64) -> Self {
        self.max_bytes = bytes;
        self
    }

    fn is_allowed(&self, real: &Path) -> bool {
        std::iter::once(&self.root)
            .chain(&self.allowed)
            .filter_map(|folder| folder.canonicalize().ok())
            .any(|folder| real.starts_with(folder))
    }

    fn nearest_file(&self, full: &Path, path: &str) -> Option<String> {
        let (folder, name) = path.rsplit_once('/').map_or(("", path), |(f, n)| (f, n));
        let mut names: Vec<String> = std::fs::read_dir(full.parent()?)
            .ok()?
            .take(10_000)
            .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
            .collect();
        names.sort();
        let near = suggest::nearest(name, names.iter().map(String::as_str))?;
        Some(if folder.is_empty() { near.to_string() } else { format!("{folder}/{near}") })
    }
}

impl FolderLoader {
    /// The file, if it may be read, and how large it is.
    fn file(&self, path: &str) -> Result<(File, u64), LoadError> {
        let unreadable = |why: &str| LoadError::Unreadable { path: path.into(), why: why.into() };
        let outside = || LoadError::Outside { path: path.into() };
        let full = self.root.join(path);
        let real = match full.canonicalize() {
            Ok(real) => real,
            // Whether something outside exists is not told.
            Err(_) if leads_out(path) && self.allowed.is_empty() => return Err(outside()),
            Err(error) if error.kind() == ErrorKind::NotFound => {
                let inside = full.parent().and_then(|f| f.canonicalize().ok());
                let inside = inside.is_some_and(|folder| self.is_allowed(&folder));
                let nearest = if inside { self.nearest_file(&full, path) } else { None };
                return Err(LoadError::NotFound { path: path.into(), nearest });
            }
            Err(error) => return Err(unreadable(words(error.kind()))),
        };
        if !self.is_allowed(&real) {
            return Err(outside());
        }
        let meta = real.metadata().map_err(|e| unreadable(words(e.kind())))?;
        if !meta.is_file() {
            return Err(unreadable(if meta.is_dir() { "it is a folder" } else { "it is no file" }));
        }
        if meta.len() > self.max_bytes {
            return Err(self.too_large(path));
        }
        let file = File::open(&real).map_err(|e| unreadable(words(e.kind())))?;
        Ok((file, meta.len()))
    }

    fn too_large(&self, path: &str) -> LoadError {
        LoadError::TooLarge { path: path.into(), limit: self.max_bytes }
    }
}

impl Loader for FolderLoader {
    fn read(&self, path: &str) -> Result<Vec<u8>, LoadError> {
        let (file, _) = self.file(path)?;
        let mut bytes = Vec::new();
        file.take(self.max_bytes.saturating_add(1)).read_to_end(&mut bytes).map_err(|e| {
            LoadError::Unreadable { path: path.into(), why: words(e.kind()).into() }
        })?;
        if bytes.len() as u64 > self.max_bytes { Err(self.too_large(path)) } else { Ok(bytes) }
    }

    fn open(&self, path: &str) -> Result<Box<dyn Read + '_>, LoadError> {
        // What is appended while it is read is not read.
        let (file, length) = self.file(path)?;
        Ok(Box::new(file.take(length)))
    }
}

/// Whether a path as written climbs above where it starts, or starts at the root of the disk.
fn leads_out(path: &str) -> bool {
    let mut depth = 0i64;
    for part in Path::new(path).components() {
        match part {
            Component::Normal(_) => depth += 1,
            Component::ParentDir => depth -= 1,
            Component::CurDir => {}
            Component::RootDir | Component::Prefix(_) => return true,
        }
        if depth < 0 {
            return true;
        }
    }
    false
}

/// The same words on every system, so that messages can be compared.
fn words(kind: ErrorKind) -> &'static str {
    match kind {
        ErrorKind::NotFound => "it is not there",
        ErrorKind::PermissionDenied => "permission denied",
        ErrorKind::NotADirectory => "part of its path is no folder",
        ErrorKind::IsADirectory => "it is a folder",
        ErrorKind::InvalidInput | ErrorKind::InvalidFilename => "its name is not valid",
        _ => "the system refused",
    }
}

/// Files in memory, for tests and for programs that make scenes.
#[derive(Clone, Debug, Default)]
pub struct MemoryLoader {
    files: BTreeMap<String, Vec<u8>>,
}

impl MemoryLoader {
    /// A loader without files.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a file.
    #[must_use]
    pub fn with(mut self, path: impl Into<String>, bytes: impl Into<Vec<u8>>) -> Self {
        self.files.insert(path.into(), bytes.into());
        self
    }
}

impl Loader for MemoryLoader {
    fn read(&self, path: &str) -> Result<Vec<u8>, LoadError> {
        if leads_out(path) {
            return Err(LoadError::Outside { path: path.into() });
        }
        self.files.get(path).cloned().ok_or_else(|| LoadError::NotFound {
            path: path.into(),
            nearest: suggest::nearest(path, self.files.keys().map(String::as_str)).map(Into::into),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A folder of its own for one test, removed at the end.
    struct Folder(PathBuf);

    impl Folder {
        fn new(name: &str) -> Self {
            let path = std::env::temp_dir().join(format!("dioptric-{name}-{}", std::process::id()));
            std::fs::create_dir_all(path.join("scene/maps")).unwrap();
            std::fs::write(path.join("scene/maps/sky.png"), b"sky").unwrap();
            std::fs::write(path.join("secret.txt"), b"secret").unwrap();
            Self(path)
        }
    }

    impl Drop for Folder {
        fn drop(&mut self) {
            let _ = std::fs::remove_dir_all(&self.0);
        }
    }

    #[test]
    fn only_the_folder_and_allowed_places_are_read() {
        let folder = Folder::new("loader");
        let loader = FolderLoader::new(folder.0.join("scene"));
        assert_eq!(loader.read("maps/sky.png").unwrap(), b"sky");
        assert_eq!(loader.read("maps/../maps/sky.png").unwrap(), b"sky");
        let mut opened = Vec::new();
        loader.open("maps/sky.png").unwrap().read_to_end(&mut opened).unwrap();
        assert_eq!(opened, b"sky");
        assert!(matches!(loader.open("../secret.txt"), Err(LoadError::Outside { .. })));
        let secret = folder.0.join("secret.txt");
        for path in ["../secret.txt", "../nothing", secret.to_str().unwrap(), "/nothing"] {
            assert_eq!(loader.read(path), Err(LoadError::Outside { path: path.into() }));
        }
        let allowed = loader.clone().allow(&folder.0);
        assert_eq!(allowed.read("../secret.txt").unwrap(), b"secret");
        assert_eq!(
            loader.read("maps/sky.pgn"),
            Err(LoadError::NotFound {
                path: "maps/sky.pgn".into(),
                nearest: Some("maps/sky.png".into())
            })
        );
        assert!(matches!(loader.read("maps"), Err(LoadError::Unreadable { .. })));
        assert!(matches!(loader.read("a\0b"), Err(LoadError::Unreadable { .. })));
        assert!(matches!(
            loader.max_bytes(2).read("maps/sky.png"),
            Err(LoadError::TooLarge { limit: 2, .. })
        ));
    }

    #[cfg(unix)]
    #[test]
    fn links_that_lead_out_are_refused() {
        let folder = Folder::new("links");
        let link = folder.0.join("scene/link.txt");
        std::os::unix::fs::symlink(folder.0.join("secret.txt"), &link).unwrap();
        let loader = FolderLoader::new(folder.0.join("scene"));
        assert!(matches!(loader.read("link.txt"), Err(LoadError::Outside { .. })));
    }
}
