// SPDX-License-Identifier: MIT OR Apache-2.0
//! What the tests of lights have in common.

use dioptric_scene::{Diagnostic, Value};

use super::Light;
use crate::build::ColorReading;
use crate::setting::root::Root;
use crate::setting::testing::with_args;

/// A light from its arguments, colours taken as they are.
pub(crate) fn build<L: Light>(arguments: &[(&str, Value)], root: &Root) -> Result<L, Diagnostic> {
    with_args(L::SCHEMA, arguments, ColorReading::Raw, |args, builder| {
        L::from_args(args, builder, root)
    })
}
