// SPDX-License-Identifier: MIT OR Apache-2.0
//! Rays that look for trouble with a flat outline.

use dioptric_math::random::Random;
use dioptric_math::{DVec3, normalize, pow};

use crate::bounds::Bounds;
use crate::ray::LocalRay;

pub(crate) fn direction(r: &mut Random) -> DVec3 {
    let mut one = || r.uniform(-1.0, 1.0);
    normalize(DVec3::new(one(), one(), one())).unwrap_or(DVec3::X)
}

/// A ray to a point at or near an edge, a corner or anywhere about a ring, from anywhere, at any angle.
pub(crate) fn trouble(ring: &[DVec3], normal: DVec3, error: f64, r: &mut Random) -> LocalRay {
    let bounds = Bounds::of(ring.iter().copied());
    let size = bounds.size().max_element();
    let i = (r.bits() % ring.len() as u64) as usize;
    let (a, b) = (ring[i], ring[(i + 1) % ring.len()]);
    let target = match r.bits() % 4 {
        0 => a,
        1 => a + (b - a) * r.unit(),
        2 => bounds.center() + (a - bounds.center()) * r.uniform(0.0, 1.5),
        _ => bounds.min + bounds.size() * DVec3::new(r.unit(), r.unit(), r.unit()),
    };
    // From nothing over the sizes where filters change their minds to plainly beside.
    let tiny = size * pow(10.0, r.uniform(-17.0, -1.0));
    let target = if r.bits().is_multiple_of(3) { target } else { target + direction(r) * tiny };
    let mut away = direction(r);
    if r.bits().is_multiple_of(3) {
        // Along the plane, almost.
        let up = away.dot(normal);
        away += normal * (up * pow(10.0, r.uniform(-14.0, 0.0)) - up);
    }
    let reach = size * pow(10.0, r.uniform(-8.0, 6.0));
    let origin = target + away * reach;
    let length = [1.0, 1e-3, 1e200, 1e-200][(r.bits() % 4) as usize];
    let error = if r.bits().is_multiple_of(2) { 0.0 } else { error };
    let t_max = if r.bits().is_multiple_of(4) { reach / length } else { f64::INFINITY };
    LocalRay { origin, direction: -away * length, error, t_max, leaving: None }
}
