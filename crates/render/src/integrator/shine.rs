// SPDX-License-Identifier: MIT OR Apache-2.0
//! Highlights: how strong a light's mirror image is on a surface.

use dioptric_math::{DVec3, Spectrum};

use crate::material::Finish;

/// A light's highlight at a point.
#[inline]
pub(super) fn shine(
    finish: &Finish,
    [normal, viewer]: [DVec3; 2],
    to_light: DVec3,
    arriving: Spectrum,
) -> Spectrum {
    match &finish.highlight {
        Some(h) => h.color * arriving * h.strength(normal, to_light, viewer),
        None => Spectrum::ZERO,
    }
}
