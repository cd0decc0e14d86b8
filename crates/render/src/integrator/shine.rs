// SPDX-License-Identifier: MIT OR Apache-2.0
//! Highlights: how strong a light's mirror image is on a surface.

use dioptric_math::{DVec3, Spectrum, normalize, powi, unit_power};

use super::point::Point;
use crate::material::{Highlight, HighlightModel};

/// A light's highlight at a point.
#[inline]
pub(super) fn shine(point: &Point, to_light: DVec3, arriving: Spectrum) -> Spectrum {
    match &point.finish.highlight {
        Some(h) => h.color * arriving * strength(h, point.normal, to_light, -point.ray.direction),
        None => Spectrum::ZERO,
    }
}

/// A highlight that is a smaller share of its light is none: nobody could see what its shadow ray costs.
pub(super) const FAINTEST: f64 = 1e-9;

/// How strong a highlight is for a normal, the direction to the light and the one to the viewer.
pub(super) fn strength(
    highlight: &Highlight,
    normal: DVec3,
    to_light: DVec3,
    to_viewer: DVec3,
) -> f64 {
    let base = match highlight.model {
        // r . v with r = 2 (n . l) n - l, without making r.
        HighlightModel::Phong => {
            2.0 * normal.dot(to_light) * normal.dot(to_viewer) - to_light.dot(to_viewer)
        }
        HighlightModel::Blinn => {
            normalize(to_light + to_viewer).map_or(0.0, |half| half.dot(normal))
        }
    };
    let (base, n) = (base.clamp(0.0, 1.0), highlight.exponent);
    if base == 0.0 && n > 0.0 {
        return 0.0;
    }
    let strength = match whole(n) {
        Some(n) => powi(base, n),
        None => unit_power(base, n),
    };
    if strength < FAINTEST { 0.0 } else { strength }
}

/// Most exponents are small whole numbers: squaring is even faster than the power of numbers up to 1.
pub(super) fn whole(n: f64) -> Option<u32> {
    (n.trunc() == n && (0.0..=4096.0).contains(&n)).then_some(n as u32)
}
