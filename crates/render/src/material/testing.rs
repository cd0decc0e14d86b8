// SPDX-License-Identifier: MIT OR Apache-2.0
//! What the tests of materials have in common.

use dioptric_math::{DVec2, DVec3};
use dioptric_scene::{Diagnostic, Value};

use super::Material;
use crate::build::ColorReading;
use crate::pattern::PatternPoint;
use crate::setting::testing::with_args;

/// Any point.
pub(crate) fn point() -> PatternPoint {
    PatternPoint {
        object: DVec3::new(0.3, -0.2, 0.9),
        world: DVec3::new(0.3, -0.2, 0.9),
        uv: DVec2::new(0.25, 0.75),
        object_normal: DVec3::Z,
        world_normal: DVec3::Z,
        lot: 0.5,
    }
}

/// A material from its arguments, colours taken as they are.
pub(crate) fn build<M: Material>(arguments: &[(&str, Value)]) -> Result<M, Diagnostic> {
    with_args(M::SCHEMA, arguments, ColorReading::Raw, M::from_args)
}
