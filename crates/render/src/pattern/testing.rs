// SPDX-License-Identifier: MIT OR Apache-2.0
//! For the tests of patterns: nodes from a few words, points, and colours.

use dioptric_math::{DVec2, DVec3, Spectrum};
use dioptric_scene::args::make_node;
use dioptric_scene::{Args, Description, Diagnostic, MemoryLoader, NodeId, Value};

use super::{AnyPattern, PatternPoint, SCHEMAS};
use crate::build::{Builder, ColorReading};

/// A scene that patterns are added to, with raw colours unless `reading` says otherwise.
pub(crate) struct Bench {
    pub(crate) scene: Description,
    pub(crate) reading: ColorReading,
    pub(crate) files: MemoryLoader,
}

impl Default for Bench {
    fn default() -> Self {
        Self {
            scene: Description::default(),
            reading: ColorReading::Raw,
            files: MemoryLoader::new(),
        }
    }
}

impl Bench {
    /// Adds a node.
    pub(crate) fn node(&mut self, kind: &str, args: &[(&str, Value)]) -> NodeId {
        let schema = SCHEMAS.iter().find(|s| s.kind == kind).expect(kind);
        self.scene.push(make_node(schema, args).expect(kind))
    }

    /// Adds a transform.
    pub(crate) fn transform(&mut self, kind: &str, args: &[(&str, Value)]) -> NodeId {
        let schema = dioptric_geometry::TRANSFORM_SCHEMAS.iter().find(|s| s.kind == kind);
        self.scene.push(make_node(schema.expect(kind), args).expect(kind))
    }

    /// A builder of this scene.
    pub(crate) fn builder(&self) -> Builder<'_> {
        Builder::new(&self.scene, self.reading, &self.files)
    }

    /// Builds the pattern of a node.
    pub(crate) fn build(&self, id: NodeId) -> Result<AnyPattern, Diagnostic> {
        let mut builder = self.builder();
        AnyPattern::from_args(&Args::new(&self.scene, id), &mut builder)
    }
}

/// Builds one pattern.
pub(crate) fn try_pattern(kind: &str, args: &[(&str, Value)]) -> Result<AnyPattern, Diagnostic> {
    let mut bench = Bench::default();
    let id = bench.node(kind, args);
    bench.build(id)
}

/// Builds one pattern that must be right.
pub(crate) fn pattern(kind: &str, args: &[(&str, Value)]) -> AnyPattern {
    try_pattern(kind, args).unwrap_or_else(|e| panic!("{kind}: {}", e.message))
}

/// The same point in all spaces.
pub(crate) fn at(x: f64, y: f64, z: f64) -> PatternPoint {
    let p = DVec3::new(x, y, z);
    let n = dioptric_math::normalize(p).unwrap_or(DVec3::Y);
    PatternPoint {
        object: p,
        world: p,
        uv: DVec2::new(x, y),
        object_normal: n,
        world_normal: n,
        lot: 0.5,
    }
}

/// A grey.
pub(crate) fn grey(x: f64) -> Spectrum {
    Spectrum::splat(x)
}

/// A number as a value.
pub(crate) fn n(x: f64) -> Value {
    Value::Number(x)
}

/// A word as a value.
pub(crate) fn t(text: &str) -> Value {
    Value::Text(text.into())
}

/// Three numbers as a value.
pub(crate) fn v(x: f64, y: f64, z: f64) -> Value {
    Value::Vec3([x, y, z])
}
