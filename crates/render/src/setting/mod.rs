// SPDX-License-Identifier: MIT OR Apache-2.0
//! Settings of the whole scene, each given at most once. One file and one line each.

use dioptric_scene::Schema;

pub mod develop;
pub mod overrides;
pub mod render;
pub mod root;

/// The schemas of all settings.
pub static SCHEMAS: &[&Schema] = &[&develop::SCHEMA, &render::SCHEMA, &root::SCHEMA];
