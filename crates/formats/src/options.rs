// SPDX-License-Identifier: MIT OR Apache-2.0
//! What a user may say about how a scene is read: overrides, the camera, the time, limits.

use dioptric_scene::{Span, Value};

/// Options of [`crate::read`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReadOptions {
    /// `--set NAME=VALUE`: values for the scene's `param`s, as text.
    pub set: Vec<(String, String)>,
    /// `--camera NAME`: which camera to use of a scene that has several.
    pub camera: Option<String>,
    /// What `time()` gives, in seconds.
    pub time: f64,
    /// What `frame()` gives.
    pub frame: i32,
    /// Where reading stops.
    pub limits: Limits,
    /// Whether the scene is read for its shapes alone, so that it needs neither camera nor light.
    pub shapes_alone: bool,
}

/// Where reading a scene stops with an error instead of going on.
///
/// The limits count work, never time: a scene that is read here is read everywhere. The limit on
/// memory is tested every 1000 steps and where text or lists are joined or repeated; it is passed by
/// a single step at most, such as a `join` of many long texts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Calls and turns of loops: 100 million. `--max-steps`.
    pub steps: u64,
    /// Functions that wait for one another: 1000, at most 50000. `--max-depth`.
    pub depth: usize,
    /// Nodes of the scene: 10 million. `--max-objects`.
    pub objects: usize,
    /// Bytes of values and nodes while reading: 4 GiB. `--max-memory`.
    pub memory: usize,
    /// Bytes of one scene file's text: 256 MiB.
    pub source: usize,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            steps: 100_000_000,
            depth: 1000,
            objects: 10_000_000,
            memory: 4 << 30,
            source: 256 << 20,
        }
    }
}

/// A `param` of the scene, for lists, for controls of a live view and for `--set`.
#[derive(Clone, Debug, PartialEq)]
pub struct ParamInfo {
    /// Its name.
    pub name: String,
    /// What the scene says about it; may be empty.
    pub doc: String,
    /// Its value without `--set`; its type fixes what may be set.
    pub default: Value,
    /// The value that was used.
    pub value: Value,
    /// Smallest valid number.
    pub min: Option<f64>,
    /// Largest valid number.
    pub max: Option<f64>,
    /// The valid values, if there are only some.
    pub choices: Vec<Value>,
    /// Where the scene asks for it.
    pub span: Span,
}
