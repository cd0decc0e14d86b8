// SPDX-License-Identifier: MIT OR Apache-2.0
//! Pictures that take long: kept while they are made, gone on with, made in parts.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, BufReader, BufWriter, Read, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use dioptric::formats::json;
use dioptric::math::random;
use dioptric::render::parts::{self, Part};
use dioptric::render::region::Region;
use dioptric::render::sampling::Antialias;
use dioptric::render::scene::Scene;
use dioptric::render::{Film, RenderSettings};
use dioptric::scene::{Description, Diagnostic, LoadError, Loader, Value as SceneValue};
use serde_json::{Map, Value, json};

use super::failure::Failure;
use super::frames::frame_name;
use super::terminal::note;

/// Options of long renders.
#[derive(Clone, Debug, Default, clap::Args)]
#[command(next_help_heading = "Long renders")]
pub struct LongOptions {
    /// Keeps what has been made in FILE, at intervals and at the end; #### becomes the frame's number.
    #[arg(long, value_name = "FILE")]
    pub checkpoint: Option<String>,
    /// The interval, such as 30s, 10m or 2h.
    #[arg(long, value_name = "TIME", default_value = "60s", value_parser = duration, requires = "checkpoint")]
    checkpoint_every: Duration,
    /// Goes on with what the checkpoint has; begins where there is none.
    #[arg(long, requires = "checkpoint")]
    resume: bool,
    /// Makes only samples A to B of each pixel, counted from 1, for merge; writes a picture only with -o.
    #[arg(long, value_name = "A-B", value_parser = sample_range, requires = "checkpoint")]
    pub sample_range: Option<[u32; 2]>,
}

impl LongOptions {
    /// Whether the picture is kept while it is made.
    pub const fn is_used(&self) -> bool {
        self.checkpoint.is_some()
    }

    /// The samples that are to be made.
    ///
    /// # Errors
    /// There are not so many, or the picture is none of the kind.
    pub fn wanted(&self, settings: &RenderSettings) -> Result<Range<u32>, Failure> {
        if settings.antialias == Antialias::Adaptive {
            return Err(Failure::usage(
                "adaptive pictures are made in one go: --checkpoint cannot keep a part of one",
                "add --antialias sobol",
            ));
        }
        match self.sample_range {
            None => Ok(0..settings.samples),
            Some([_, last]) if last > settings.samples => Err(Failure::usage(
                format!(
                    "--sample-range ends at {last}, but a pixel has {} samples",
                    settings.samples
                ),
                "say with --samples how many the whole picture shall have",
            )),
            Some([first, last]) => Ok(first - 1..last),
        }
    }

    /// The part to go on with, and where it is kept.
    ///
    /// # Errors
    /// There is a checkpoint that cannot be gone on with.
    pub fn open(
        &self,
        identity: Identity,
        frame: i32,
        animated: bool,
        region: Region,
        layers: bool,
    ) -> Result<(Part, Keeper), Failure> {
        let name = self.checkpoint.clone().unwrap_or_default();
        let name = if animated { frame_name(&name, frame) } else { name };
        let path = PathBuf::from(&name);
        let mut part = Part::new(region, layers);
        match fs::metadata(&path) {
            Ok(_) if self.resume => {
                let kept = Kept::read(&name)?;
                kept.identity.check(&name, &identity, "this render", Samples::MayGrow)?;
                kept.check_region(&name, region)?;
                if layers && !kept.part.has_layers() {
                    return Err(Failure::File {
                        message: format!("{name} was made without layers"),
                        help: "render without --layers and --denoise, or begin a new checkpoint"
                            .into(),
                    });
                }
                part = kept.part;
            }
            Ok(_) => {
                return Err(Failure::File {
                    message: format!("{name} is there already"),
                    help: "add --resume to go on with it, or name another file".into(),
                });
            }
            Err(e) if e.kind() == io::ErrorKind::NotFound => {}
            Err(e) => return Err(Failure::input(&name, &e)),
        }
        let keeper = Keeper {
            path,
            text: identity.0.to_string(),
            every: self.checkpoint_every,
            state: Mutex::new((Instant::now(), false)),
        };
        // That it cannot be written is better known now.
        keeper.save(&part, None).map_err(|e| Failure::output(&name, &e))?;
        Ok((part, keeper))
    }
}

/// The most samples of a block: few enough for a tile to be done soon, enough for few films to be kept.
pub fn block_size(samples: u32) -> u32 {
    (samples.next_power_of_two() / 8).clamp(16, 4096)
}

/// Writes a part again and again.
pub struct Keeper {
    path: PathBuf,
    text: String,
    every: Duration,
    /// When it was written last, and whether that failed.
    state: Mutex<(Instant, bool)>,
}

impl Keeper {
    /// Writes where the interval has passed.
    pub fn watch(&self, progress: &parts::Progress<'_>) {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        if state.0.elapsed() < self.every {
            return;
        }
        let begun = (progress.block, progress.job.film);
        if let Err(error) = self.save(progress.part, Some(begun))
            && !std::mem::replace(&mut state.1, true)
        {
            note(&format!("warning: cannot write {}: {error}; going on\n", self.path.display()));
        }
        state.0 = Instant::now();
    }

    /// Writes in one step: a reader, or who comes after a crash, finds the old bytes or the new ones.
    ///
    /// # Errors
    /// The disk is full, or the file cannot be written.
    pub fn save(&self, part: &Part, begun: Option<(&Range<u32>, &Film)>) -> io::Result<()> {
        replace(&self.path, |file| parts::write(part, begun, &self.text, file))
    }

    /// The file's name.
    pub fn name(&self) -> String {
        self.path.display().to_string()
    }
}

/// Replaces a file by what `write` writes, safely on the disk before the old one goes.
pub fn replace(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    let mut name = path.file_name().unwrap_or_default().to_os_string();
    name.push(".new");
    let new = path.with_file_name(name);
    let written = File::create(&new).and_then(|file| {
        let mut out = BufWriter::with_capacity(1 << 20, file);
        write(&mut out)?;
        out.flush()?;
        out.get_ref().sync_all()?;
        fs::rename(&new, path)
    });
    if written.is_err() {
        let _ = fs::remove_file(&new);
        return written;
    }
    // The folder's entry, too; where folders cannot be opened (Windows) the rename itself must do.
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if let Ok(folder) = File::open(folder) {
        let _ = folder.sync_all();
    }
    Ok(())
}

/// A part that was read from a file.
pub struct Kept {
    /// What it belongs to.
    pub identity: Identity,
    /// Its samples.
    pub part: Part,
}

impl Kept {
    /// Reads a file.
    ///
    /// # Errors
    /// It is not there, no part, or damaged.
    pub fn read(name: &str) -> Result<Self, Failure> {
        let file = File::open(name).map_err(|e| Failure::input(name, &e))?;
        let bytes = file.metadata().map_err(|e| Failure::input(name, &e))?;
        if bytes.is_dir() {
            return Err(Failure::input(name, &io::ErrorKind::IsADirectory.into()));
        }
        let mut file = BufReader::with_capacity(1 << 20, file);
        let wrong = |e: Diagnostic| Failure::File {
            message: format!("cannot use {name}: {}", e.message),
            help: e.help.unwrap_or_default(),
        };
        let (head, part) = parts::read(&mut file, bytes.len()).map_err(wrong)?;
        let identity = serde_json::from_str(&head.text).ok().filter(Value::is_object);
        let identity = identity.map(Identity).ok_or_else(|| Failure::File {
            message: format!("cannot use {name}: its text makes no sense"),
            help: "name a file that render --checkpoint has written".into(),
        })?;
        Ok(Self { identity, part })
    }

    fn check_region(&self, name: &str, region: Region) -> Result<(), Failure> {
        let own = self.part.region();
        if own == region {
            return Ok(());
        }
        Err(Failure::File {
            message: format!("{name} is of another part of the picture: {}", shown(own)),
            help: format!("this render is of {}; name another file", shown(region)),
        })
    }
}

/// A region in words.
pub fn shown(Region { x, y, width, height }: Region) -> String {
    format!("{width} x {height} pixels from {x},{y}")
}

/// How two parts may differ in their numbers of samples.
#[derive(Clone, Copy, PartialEq)]
pub enum Samples {
    /// Not at all.
    MustAgree,
    /// One may have more, where samples do not depend on how many there will be.
    MayGrow,
}

/// What a part belongs to: the scene, the settings and the program, as JSON.
#[derive(Clone, Debug, PartialEq)]
pub struct Identity(pub Value);

impl Identity {
    /// Of a picture of a scene; `picture` is what its file needs besides.
    pub fn new(
        description: &Description,
        files: u64,
        scene: &Scene,
        camera: Option<&str>,
        picture: Value,
    ) -> Self {
        let mut bare = description.clone();
        bare.roots.retain(|&id| !["render", "develop"].contains(&description.node(id).schema.kind));
        let hash = random::join(hash(json::write(&bare).as_bytes()), files);
        let values: Map<String, Value> = scene
            .settings
            .to_values()
            .into_iter()
            .map(|(name, value)| (name.to_string(), plain(&value)))
            .collect();
        Self(json!({
            "program": dioptric::VERSION,
            "scene": format!("{hash:016x}"),
            "camera": camera,
            "render": values,
            "picture": picture,
        }))
    }

    /// Whether two are parts of the same picture.
    ///
    /// # Errors
    /// They are not, and why.
    pub fn check(
        &self,
        name: &str,
        other: &Self,
        other_name: &str,
        samples: Samples,
    ) -> Result<(), Failure> {
        let refuse = |what: String| {
            Err(Failure::File {
                message: format!("{name} and {other_name} do not belong together: {what}"),
                help: "parts must be of one scene, with the same settings, by the same version of the program"
                    .into(),
            })
        };
        for (key, what) in [
            ("program", "another version of the program"),
            ("scene", "another scene"),
            ("camera", "another camera"),
        ] {
            if self.0[key] != other.0[key] {
                let text = |v: &Value| v.as_str().map_or_else(|| v.to_string(), Into::into);
                return refuse(match key {
                    "scene" => what.into(),
                    _ => format!("{what} ({} and {})", text(&self.0[key]), text(&other.0[key])),
                });
            }
        }
        let (own, theirs) = (&self.0["render"], &other.0["render"]);
        let sequence = own["antialias"] == "sobol" && samples == Samples::MayGrow;
        let names = [own, theirs].into_iter().filter_map(Value::as_object).flat_map(Map::keys);
        for key in names {
            let may_differ = sequence && ["samples", "max_samples"].contains(&key.as_str());
            if own[key] != theirs[key] && !may_differ {
                return refuse(format!("{key} is {} and {}", own[key], theirs[key]));
            }
        }
        Ok(())
    }
}

/// A setting as JSON.
fn plain(value: &SceneValue) -> Value {
    match value {
        SceneValue::Bool(b) => json!(b),
        SceneValue::Number(n) => json!(n),
        SceneValue::Text(text) => json!(text.as_ref()),
        SceneValue::Vec2(v) => json!(v),
        SceneValue::Vec3(v) => json!(v),
        other => json!(format!("{other:?}")),
    }
}

/// A number that says which bytes these are.
pub fn hash(bytes: &[u8]) -> u64 {
    let mut chunks = bytes.chunks_exact(8);
    let mut sum = random::join(0, bytes.len() as u64);
    for chunk in &mut chunks {
        sum = random::join(sum, chunk.try_into().map_or(0, u64::from_le_bytes));
    }
    chunks.remainder().iter().fold(sum, |sum, byte| random::join(sum, u64::from(*byte)))
}

/// Notes what the scene reads besides itself: pictures and meshes.
pub struct HashingLoader<'a> {
    inner: &'a dyn Loader,
    files: Mutex<BTreeMap<String, u64>>,
}

impl<'a> HashingLoader<'a> {
    /// Reads by `inner`.
    pub const fn new(inner: &'a dyn Loader) -> Self {
        Self { inner, files: Mutex::new(BTreeMap::new()) }
    }

    /// A number that says which files were read.
    pub fn hash(&self) -> u64 {
        let files = self.files.lock().unwrap_or_else(PoisonError::into_inner);
        files.iter().fold(0, |sum, (name, content)| {
            random::join(random::join(sum, hash(name.as_bytes())), *content)
        })
    }
}

impl Loader for HashingLoader<'_> {
    fn read(&self, path: &str) -> Result<Vec<u8>, LoadError> {
        let bytes = self.inner.read(path)?;
        let mut files = self.files.lock().unwrap_or_else(PoisonError::into_inner);
        files.insert(path.into(), hash(&bytes));
        Ok(bytes)
    }

    fn open(&self, path: &str) -> Result<Box<dyn Read + '_>, LoadError> {
        // Read by itself first: what a mesh's reader leaves out, or how it cuts the file, must not matter.
        let (mut file, mut sum, mut buffer) = (self.inner.open(path)?, 0, vec![0; 1 << 20]);
        while let Ok(n @ 1..) = file.read(&mut buffer) {
            // However the system cuts it: byte by byte would be slow, so what was got is filled up.
            let mut length = n;
            while length < buffer.len()
                && let Ok(more @ 1..) = file.read(&mut buffer[length..])
            {
                length += more;
            }
            sum = random::join(sum, hash(&buffer[..length]));
        }
        let mut files = self.files.lock().unwrap_or_else(PoisonError::into_inner);
        files.insert(path.into(), sum);
        drop(files);
        self.inner.open(path)
    }
}

/// `90`, `90s`, `10m` or `2h`.
pub fn duration(text: &str) -> Result<Duration, String> {
    let split = text.find(|c: char| c.is_ascii_alphabetic()).unwrap_or(text.len());
    let (number, unit) = text.split_at(split);
    let factor = match unit {
        "" | "s" => 1.0,
        "m" | "min" => 60.0,
        "h" => 3600.0,
        _ => return Err("write a time such as 30s, 10m or 2h".into()),
    };
    let seconds = number.trim().parse::<f64>().ok().map(|n| n * factor);
    seconds
        .filter(|s| *s >= 0.0)
        .and_then(|s| Duration::try_from_secs_f64(s).ok())
        .ok_or_else(|| "write a time such as 30s, 10m or 2h".into())
}

/// `A-B`, counted from 1.
fn sample_range(text: &str) -> Result<[u32; 2], String> {
    let number = |t: &str| t.trim().parse::<u32>().ok().filter(|n| *n > 0);
    text.split_once('-')
        .and_then(|(first, last)| number(first).zip(number(last)))
        .filter(|(first, last)| first <= last)
        .map(|(first, last)| [first, last])
        .ok_or_else(|| "write FIRST-LAST, counted from 1, such as 1-32".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_and_ranges_are_read_or_explained() {
        assert_eq!(duration("90"), Ok(Duration::from_secs(90)));
        assert_eq!(duration("1.5m"), Ok(Duration::from_secs(90)));
        assert_eq!(duration("2h"), Ok(Duration::from_secs(7200)));
        for wrong in ["", "s", "-1s", "1d", "nan", "1e300h"] {
            assert!(duration(wrong).is_err(), "{wrong}");
        }
        assert_eq!(sample_range("1-32"), Ok([1, 32]));
        for wrong in ["0-3", "3-1", "5", "a-b", "1-", "-5"] {
            assert!(sample_range(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn other_bytes_have_other_numbers() {
        let texts: [&[u8]; 6] = [b"", b"\0", b"a", b"12345678", b"12345678\0", b"87654321"];
        let hashes: std::collections::BTreeSet<u64> = texts.iter().map(|t| hash(t)).collect();
        assert_eq!(hashes.len(), texts.len());
    }
}
