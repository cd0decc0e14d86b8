// SPDX-License-Identifier: MIT OR Apache-2.0
//! Material and light parameters that are a constant or a pattern.

use std::sync::Arc;

use dioptric_math::{Spectrum, luminance};

use crate::pattern::{AnyPattern, PatternPoint};

/// A colour: constant, or from a pattern.
#[derive(Clone, Debug)]
pub enum ColorInput {
    /// The same everywhere, in linear light.
    Constant(Spectrum),
    /// A pattern's value.
    Pattern(Arc<AnyPattern>),
}

impl ColorInput {
    /// The colour at a point.
    #[must_use]
    pub fn eval(&self, point: &PatternPoint) -> Spectrum {
        match self {
            Self::Constant(c) => *c,
            Self::Pattern(p) => p.eval(point),
        }
    }
}

/// A number: constant, or the luminance of a pattern.
#[derive(Clone, Debug)]
pub enum NumberInput {
    /// The same everywhere.
    Constant(f64),
    /// A pattern's luminance, never decoded: data, not colour.
    Pattern(Arc<AnyPattern>),
}

impl NumberInput {
    /// The number at a point.
    #[must_use]
    pub fn eval(&self, point: &PatternPoint) -> f64 {
        match self {
            Self::Constant(x) => *x,
            Self::Pattern(p) => luminance(p.eval(point)),
        }
    }

    /// Whether it is the constant 0: nothing to do.
    #[must_use]
    pub fn is_zero(&self) -> bool {
        matches!(self, Self::Constant(x) if *x == 0.0)
    }
}
