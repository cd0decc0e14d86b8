// SPDX-License-Identifier: MIT OR Apache-2.0
//! The stage on which the manual shows an example: camera, lights, floor and settings, as far as the
//! example has none of its own.

use dioptric::formats::{ReadError, ReadOptions, read};
use dioptric::render::vocabulary;
use dioptric::scene::{Category, Description, FolderLoader, LoadError, Loader, Schema};

const SIZE: &str = "render(size = (320, 240), antialias = \"adaptive\", samples = 8, max_samples = 32, \
                    shadows = \"tinted\")";
const CAMERA: &str = "camera(eye = (2.2, 2.6, 5.6), look_at = (0, 0.85, 0), fov = 30)";
const LIGHTS: &str = "light(position = (-4, 7, 6), intensity = 0.7)\n\
                      light(position = (6, 5, 3), intensity = 0.25)";
const AMBIENT: &str = "ambient(0.12)";
const BACKGROUND: &str = "background(gradient(low = (0.8, 0.86, 0.92), high = (0.4, 0.55, 0.78)))";
// The floor fades into the sky instead of shimmering at the horizon.
const FOG: &str = "fog(color = (0.8, 0.86, 0.92), start = 9, distance = 28)";
const FLOOR: &str = "plane(point = (0, 0, 0), material = matte(checker((0.82, 0.82, 0.8), (0.62, 0.63, 0.65), size = (1, 0, 1))), name = \"stage floor\")";
const ACTORS: &str = "sphere(center = (-1.1, 0.7, 0), radius = 0.7, material = plastic(\"crimson\"))\n\
                      box(min = (0.3, 0, -0.5), max = (1.3, 1, 0.5), material = matte(\"seagreen\"))";

/// A text in memory beside the files of a folder.
struct Text<'a> {
    text: String,
    files: &'a FolderLoader,
}

/// The name of the text.
const NAME: &str = "example.star";

impl Loader for Text<'_> {
    fn read(&self, path: &str) -> Result<Vec<u8>, LoadError> {
        if path == NAME { Ok(self.text.clone().into_bytes()) } else { self.files.read(path) }
    }
}

/// The scene of a kind's example.
///
/// # Errors
/// The example is wrong.
pub fn staged(schema: &Schema, files: &FolderLoader) -> Result<Description, ReadError> {
    let read_text = |text: String| {
        let loader = Text { text, files };
        read(NAME, &loader, &vocabulary(), &ReadOptions::default()).map(|r| r.description)
    };
    let own = |category: Category| schema.category == category;
    let mut lines = vec![schema.example];
    // A scene without a camera is not read at all.
    lines.extend(Some(CAMERA).filter(|_| !own(Category::Camera)));
    lines.extend(Some(LIGHTS).filter(|_| !own(Category::Light) && schema.kind != "sky"));
    let lit = read_text(lines.join("\n"))?;
    let has =
        |category: Category| lit.roots.iter().any(|&id| lit.node(id).schema.category == category);
    let has_kind = |kind: &str| lit.roots_of(kind).next().is_some();
    let mut add = |text, wanted: bool| lines.extend(Some(text).filter(|_| wanted));
    add(SIZE, !has_kind("render"));
    add(AMBIENT, !has_kind("ambient"));
    add(BACKGROUND, !has_kind("background") && !has_kind("fog"));
    add(FOG, !has_kind("background") && !has_kind("fog"));
    add(FLOOR, !has_kind("plane"));
    add(ACTORS, !has(Category::Shape));
    read_text(lines.join("\n"))
}
