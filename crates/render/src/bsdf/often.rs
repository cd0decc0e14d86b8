// SPDX-License-Identifier: MIT OR Apache-2.0
//! Directions of light that several facets have scattered: by the cosine where facets are rough, flatter where
//! they are not, as then only grazing light meets a second one.

use std::f64::consts::PI;

use dioptric_math::{DVec3, sin_cos};

/// A direction above the surface with [`density`]; `None` for one within it.
#[inline]
pub(super) fn direction(alpha: f64, u: [f64; 2]) -> Option<DVec3> {
    let flat = flatter(alpha);
    let z = if u[0] < flat {
        let x = u[0] / flat;
        alpha * x / (1.0 + alpha - x)
    } else {
        ((u[0] - flat) / (1.0 - flat)).sqrt()
    };
    let r = (1.0 - z * z).max(0.0).sqrt();
    let (s, c) = sin_cos(2.0 * PI * u[1]);
    (z > 0.0).then_some(DVec3::new(r * c, r * s, z))
}

/// Its density over solid angles for a cosine, at least 0: partly `z / pi`, partly
/// `alpha (1 + alpha) / (2 pi (z + alpha)^2)`.
#[inline]
pub(super) fn density(alpha: f64, z: f64) -> f64 {
    let flat = flatter(alpha);
    let k = z + alpha;
    (2.0 * (1.0 - flat) * z + flat * alpha * (1.0 + alpha) / (k * k)) * (0.5 / PI)
}

/// The chance of a direction that is flatter than by the cosine.
#[inline]
fn flatter(alpha: f64) -> f64 {
    (1.0 - alpha) * (1.0 - alpha)
}
