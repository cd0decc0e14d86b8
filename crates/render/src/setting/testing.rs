// SPDX-License-Identifier: MIT OR Apache-2.0
//! What the tests of settings, lights and cameras have in common.

use dioptric_math::{DAffine3, DVec3};
use dioptric_scene::args::make_node;
use dioptric_scene::{Args, Description, MemoryLoader, NodeId, Schema, Value};

use super::root::Root;
use crate::build::{Builder, ColorReading};

/// Calls `f` with the arguments of a node that has these.
pub(crate) fn with_args<T>(
    schema: &'static Schema,
    arguments: &[(&str, Value)],
    reading: ColorReading,
    f: impl FnOnce(&Args, &mut Builder) -> T,
) -> T {
    let mut scene = Description::default();
    let id = scene.push(make_node(schema, arguments).expect("known parameters"));
    with_node(&scene, id, reading, f)
}

/// Calls `f` with the arguments of a node of a scene without files.
pub(crate) fn with_node<T>(
    scene: &Description,
    id: NodeId,
    reading: ColorReading,
    f: impl FnOnce(&Args, &mut Builder) -> T,
) -> T {
    f(&Args::new(scene, id), &mut Builder::new(scene, reading, &MemoryLoader::new()))
}

/// A root that changes nothing, y up.
pub(crate) fn plain_root() -> Root {
    Root::new(DAffine3::IDENTITY, DVec3::Y).expect("the identity has an inverse")
}

/// A root that scales by `factor`.
pub(crate) fn scaled_root(factor: f64) -> Root {
    Root::new(DAffine3::from_scale(DVec3::splat(factor)), DVec3::Y).expect("not 0")
}
