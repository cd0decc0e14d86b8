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

/// The middles of the cells of an n x n grid in the unit square.
pub(crate) fn grid(n: u32) -> impl Iterator<Item = [f64; 2]> {
    let at = move |i: u32| (f64::from(i) + 0.5) / f64::from(n);
    (0..n * n).map(move |i| [at(i % n), at(i / n)])
}
