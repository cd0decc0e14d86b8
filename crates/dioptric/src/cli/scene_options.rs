// SPDX-License-Identifier: MIT OR Apache-2.0
//! Which scene, with which values for its params, and how much it may use: what every command that
//! reads a scene takes.

use std::fs::File;
use std::io::{self, ErrorKind, Read};
use std::path::{Path, PathBuf};

use dioptric::formats::{Limits, ReadOptions, Reading, read};
use dioptric::render::compile::Options;
use dioptric::render::vocabulary;
use dioptric::scene::{FolderLoader, LoadError, Loader, Sources};

use super::failure::Failure;
use super::terminal::{self, Terminal};

/// A scene and how to read it.
#[derive(Clone, Debug, clap::Args)]
pub struct SceneOptions {
    /// The scene file (.star, .json, .nff), or - for standard input.
    pub scene: String,
    /// The format of a scene on standard input: star, json or nff.
    #[arg(long, value_name = "FORMAT", help_heading = "Scene")]
    from: Option<String>,
    /// Sets a param of the scene.
    #[arg(long, value_name = "NAME=VALUE", value_parser = assignment, help_heading = "Scene")]
    set: Vec<(String, String)>,
    /// Which camera to use of several.
    #[arg(long, value_name = "NAME", help_heading = "Scene")]
    camera: Option<String>,
    /// What time() gives in the scene, in seconds; without it, the frame over the rate.
    #[arg(long, value_name = "SECONDS", help_heading = "Scene")]
    time: Option<f64>,
    /// What frame() gives in the scene.
    #[arg(long, value_name = "N", default_value_t = 0, help_heading = "Scene")]
    pub frame: i32,
    /// Frames of a second, for time().
    #[arg(long, value_name = "RATE", default_value_t = 25.0, value_parser = rate, help_heading = "Scene")]
    fps: f64,
    /// Lets the scene read files of another folder, too.
    #[arg(long, value_name = "DIR", help_heading = "Limits")]
    allow: Vec<PathBuf>,
    /// Steps that the scene's program may take [default: 100 million].
    #[arg(long, value_name = "N", help_heading = "Limits")]
    max_steps: Option<u64>,
    /// Functions that may wait for one another [default: 1000].
    #[arg(long, value_name = "N", help_heading = "Limits")]
    max_depth: Option<usize>,
    /// Objects that the scene may have [default: 10 million].
    #[arg(long, value_name = "N", help_heading = "Limits")]
    max_objects: Option<usize>,
    /// Memory that reading the scene, and its meshes, may take, in MiB, or such as 8G [default: 4G].
    #[arg(long, value_name = "MIB", value_parser = bytes, help_heading = "Limits")]
    max_memory: Option<u64>,
}

/// A scene that was read, with what is needed to compile it.
pub struct ReadScene {
    /// The scene and its params.
    pub reading: Reading,
    /// Gives the pictures that it names.
    pub loader: SceneLoader,
}

/// The scene's own text, whether from a file or standard input, and the files of its folder.
pub struct SceneLoader {
    name: String,
    bytes: Vec<u8>,
    folder: FolderLoader,
}

impl Loader for SceneLoader {
    fn read(&self, path: &str) -> Result<Vec<u8>, LoadError> {
        if path == self.name { Ok(self.bytes.clone()) } else { self.folder.read(path) }
    }

    fn open(&self, path: &str) -> Result<Box<dyn Read + '_>, LoadError> {
        self.folder.open(path)
    }
}

impl SceneOptions {
    /// Reads the scene; warnings and what it prints go to standard error.
    ///
    /// # Errors
    /// The file is not there, or the scene is wrong.
    pub fn read(&self, terminal: &Terminal) -> Result<ReadScene, Failure> {
        self.read_for(terminal, false)
    }

    /// Reads a scene of which only the shapes count: it needs no camera.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn read_shapes(&self, terminal: &Terminal) -> Result<ReadScene, Failure> {
        self.read_for(terminal, true)
    }

    fn read_for(&self, terminal: &Terminal, shapes_alone: bool) -> Result<ReadScene, Failure> {
        let limits = self.limits();
        let (loader, prefix) = self.loader(&limits)?;
        let options = ReadOptions {
            set: self.set.clone(),
            camera: self.camera.clone(),
            time: self.time.unwrap_or(f64::from(self.frame) / self.fps),
            frame: self.frame,
            limits,
            shapes_alone,
        };
        let name = loader.name.clone();
        let shown = |sources: &Sources| self.renamed(sources, &prefix, &name);
        match read(&name, &loader, &vocabulary(), &options) {
            Ok(mut reading) => {
                print_lines(&reading.printed);
                reading.description.sources = shown(&reading.description.sources);
                terminal.complain(&reading.warnings, &reading.description.sources);
                Ok(ReadScene { reading, loader })
            }
            Err(error) => {
                print_lines(&error.printed);
                Err(Failure::Scene(error.diagnostics, shown(&error.sources)))
            }
        }
    }

    /// The same scene at another frame.
    pub fn at_frame(&self, frame: i32) -> Self {
        Self { frame, ..self.clone() }
    }

    /// The stem of the scene's name, for the picture's.
    pub fn stem(&self) -> String {
        let stem = Path::new(&self.scene).file_stem().filter(|_| self.scene != "-");
        stem.map_or_else(|| "stdin".into(), |s| s.to_string_lossy().into_owned())
    }

    /// The camera that was asked for.
    pub fn camera(&self) -> Option<&str> {
        self.camera.as_deref()
    }

    /// The most objects that the scene may have.
    pub fn max_objects(&self) -> usize {
        self.limits().objects
    }

    /// Bytes that all meshes of the scene may take.
    pub fn max_mesh_bytes(&self) -> u64 {
        self.max_memory.unwrap_or(Options::default().max_mesh_bytes)
    }

    fn limits(&self) -> Limits {
        let usual = Limits::default();
        Limits {
            steps: self.max_steps.unwrap_or(usual.steps),
            depth: self.max_depth.unwrap_or(usual.depth),
            objects: self.max_objects.unwrap_or(usual.objects),
            memory: self
                .max_memory
                .map_or(usual.memory, |n| usize::try_from(n).unwrap_or(usize::MAX)),
            ..usual
        }
    }

    /// The loader, and the scene's folder as the user wrote it, with a slash at its end.
    fn loader(&self, limits: &Limits) -> Result<(SceneLoader, String), Failure> {
        let most = limits.source as u64 + 1;
        let (name, bytes, folder) = if self.scene == "-" {
            let mut bytes = Vec::new();
            let got = io::stdin().lock().take(most).read_to_end(&mut bytes);
            got.map_err(|e| Failure::input("standard input", &e))?;
            (format!("stdin.{}", self.stdin_format(&bytes)?), bytes, PathBuf::from("."))
        } else {
            let path = Path::new(&self.scene);
            let bytes = read_up_to(path, most).map_err(|e| self.unreadable(&e))?;
            let name = path.file_name().map(|n| n.to_string_lossy().into_owned());
            (name.unwrap_or_default(), bytes, path.parent().unwrap_or(Path::new("")).to_path_buf())
        };
        let prefix = match folder.to_string_lossy() {
            empty if empty.is_empty() || self.scene == "-" => String::new(),
            folder => format!("{}/", folder.trim_end_matches('/')),
        };
        let mut files = FolderLoader::new(folder);
        for allowed in &self.allow {
            files = files.allow(allowed);
        }
        if let Some(bytes) = self.max_memory {
            files = files.max_bytes(bytes);
        }
        Ok((SceneLoader { name, bytes, folder: files }, prefix))
    }

    fn unreadable(&self, error: &io::Error) -> Failure {
        let failure = Failure::input(&self.scene, error);
        let path = Path::new(&self.scene);
        let (Failure::File { message, .. }, ErrorKind::NotFound) = (&failure, error.kind()) else {
            return failure;
        };
        let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        let folder = path.parent().unwrap_or(Path::new(""));
        match FolderLoader::new(folder).read(&name) {
            Err(LoadError::NotFound { nearest: Some(near), .. }) => Failure::File {
                message: message.clone(),
                help: format!("did you mean {}?", folder.join(near).display()),
            },
            _ => failure,
        }
    }

    fn stdin_format(&self, bytes: &[u8]) -> Result<&str, Failure> {
        const FORMATS: [&str; 3] = ["star", "json", "nff"];
        match &self.from {
            Some(format) if FORMATS.contains(&format.as_str()) => Ok(format),
            Some(format) => Err(Failure::unknown("format", format, FORMATS.into_iter())),
            // No scene in Starlark begins with a brace, every one in JSON does.
            None if bytes.trim_ascii_start().starts_with(b"{") => Ok("json"),
            None => Ok("star"),
        }
    }

    /// The texts under the names by which the user knows them: from the present folder.
    fn renamed(&self, sources: &Sources, prefix: &str, main: &str) -> Sources {
        let mut renamed = Sources::default();
        for (_, source) in sources.iter() {
            let name = if self.scene == "-" && source.name == main {
                "<stdin>".into()
            } else if Path::new(&source.name).is_absolute() {
                source.name.clone()
            } else {
                format!("{prefix}{}", source.name)
            };
            renamed.add(name, source.text.clone());
        }
        renamed
    }
}

fn read_up_to(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let file = File::open(path)?;
    if file.metadata()?.is_dir() {
        return Err(ErrorKind::IsADirectory.into());
    }
    file.take(most).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// What the scene printed; control characters cannot steer the terminal.
fn print_lines(lines: &[String]) {
    for line in lines {
        let plain: String = line
            .chars()
            .map(|c| if c.is_control() && c != '\t' { '\u{fffd}' } else { c })
            .collect();
        terminal::note(&format!("{plain}\n"));
    }
}

fn assignment(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((name, value)) if !name.trim().is_empty() => {
            Ok((name.trim().into(), value.trim().into()))
        }
        _ => Err("write NAME=VALUE, such as fog=False".into()),
    }
}

fn rate(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|r: &f64| r.is_finite() && *r > 0.0)
        .ok_or_else(|| "write a number above 0".into())
}

/// Bytes from a number of MiB, or from one with K, M or G (of 1024) behind it.
fn bytes(text: &str) -> Result<u64, String> {
    let split = text.find(|c: char| !c.is_ascii_digit()).unwrap_or(text.len());
    let (digits, unit) = text.split_at(split);
    let shift = match unit.trim_end_matches(['B', 'b', 'i']) {
        "K" | "k" => 10,
        "" | "M" | "m" => 20,
        "G" | "g" => 30,
        _ => return Err("write an amount of memory, such as 512 (MiB) or 8G".into()),
    };
    digits
        .parse::<u64>()
        .ok()
        .and_then(|n| n.checked_mul(1 << shift))
        .ok_or_else(|| "write an amount of memory, such as 512 (MiB) or 8G".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_have_units() {
        assert_eq!(bytes("512M"), Ok(512 << 20));
        assert_eq!(bytes("8GiB"), Ok(8 << 30));
        assert_eq!(bytes("100"), Ok(100 << 20));
        assert_eq!(bytes("64K"), Ok(65536));
        for wrong in ["", "M", "-1", "1T", "99999999999999999999G", "1.5G"] {
            assert!(bytes(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn assignments_split_at_the_first_sign() {
        assert_eq!(assignment("a = b=c"), Ok(("a".into(), "b=c".into())));
        assert!(assignment("fog").is_err() && assignment("=1").is_err());
    }
}
