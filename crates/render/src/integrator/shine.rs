// SPDX-License-Identifier: MIT OR Apache-2.0
//! Highlights: how strong a light's mirror image is on a surface.

use dioptric_math::{DVec3, Spectrum};

use super::point::Point;

/// A light's highlight at a point.
#[inline]
pub(super) fn shine(point: &Point, to_light: DVec3, arriving: Spectrum) -> Spectrum {
    match &point.finish.highlight {
        Some(h) => h.color * arriving * h.strength(point.normal, to_light, -point.ray.direction),
        None => Spectrum::ZERO,
    }
}
