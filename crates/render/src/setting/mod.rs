// SPDX-License-Identifier: MIT OR Apache-2.0
//! Settings of the whole scene, each given at most once. One file and one line each.

use dioptric_scene::Schema;

pub mod ambient;
pub mod background;
pub mod develop;
pub mod fog;
pub mod medium;
pub mod overrides;
pub mod render;
pub mod root;
#[cfg(test)]
pub(crate) mod testing;

/// The schemas of all settings.
pub static SCHEMAS: &[&Schema] = &[
    &ambient::SCHEMA,
    &background::SCHEMA,
    &develop::SCHEMA,
    &fog::SCHEMA,
    &medium::SCHEMA,
    &render::SCHEMA,
    &root::SCHEMA,
];
