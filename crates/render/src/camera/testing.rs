// SPDX-License-Identifier: MIT OR Apache-2.0
//! What the tests of cameras have in common.

use dioptric_scene::{Diagnostic, Value};

use super::Camera;
use crate::build::ColorReading;
use crate::setting::root::Root;
use crate::setting::testing::with_args;

/// A camera from its arguments.
pub(crate) fn build<C: Camera>(
    arguments: &[(&str, Value)],
    root: &Root,
    aspect: f64,
) -> Result<C, Diagnostic> {
    with_args(C::SCHEMA, arguments, ColorReading::Raw, |args, _| C::from_args(args, root, aspect))
}
