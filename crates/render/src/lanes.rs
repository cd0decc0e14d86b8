// SPDX-License-Identifier: MIT OR Apache-2.0
//! Sixteen numbers or vectors side by side, and how one of them is read, set and marked.

use dioptric_geometry::world::{Bundle, Sixteen};
use dioptric_math::DVec3;

pub(crate) const LANES: usize = Bundle::LANES;

/// A vector or a colour of each of sixteen points.
pub(crate) type Vectors = [Sixteen; 3];

pub(crate) const ZERO: Vectors = [[0.0; LANES]; 3];

/// Sets one vector of sixteen.
#[inline(always)]
pub(crate) fn put(of: &mut Vectors, lane: usize, value: DVec3) {
    let lane = lane % LANES;
    (of[0][lane], of[1][lane], of[2][lane]) = (value.x, value.y, value.z);
}

/// One vector of sixteen.
#[inline(always)]
pub(crate) const fn get(of: &Vectors, lane: usize) -> DVec3 {
    let lane = lane % LANES;
    DVec3::new(of[0][lane], of[1][lane], of[2][lane])
}

/// 1 where a lane's bit is set, 0 elsewhere.
#[inline(always)]
pub(crate) fn flags(lanes: u16) -> Sixteen {
    let mut flags = [0.0; LANES];
    for (i, flag) in flags.iter_mut().enumerate() {
        *flag = if lanes >> i & 1 != 0 { 1.0 } else { 0.0 };
    }
    flags
}

/// A bit for each number that is not 0.
#[inline(always)]
pub(crate) fn bits(flags: &Sixteen) -> u16 {
    let mut bits = 0;
    for (i, flag) in flags.iter().enumerate() {
        bits |= u16::from(*flag != 0.0) << i;
    }
    bits
}
