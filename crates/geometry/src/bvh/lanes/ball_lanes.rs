// SPDX-License-Identifier: MIT OR Apache-2.0
//! Eight balls about a ray with AVX2 and FMA; see [`crate::bvh::balls`] for the errors.

use std::arch::x86_64::{
    __m256, _mm256_add_ps, _mm256_fmadd_ps, _mm256_fmsub_ps, _mm256_fnmadd_ps, _mm256_load_ps,
    _mm256_max_ps, _mm256_mul_ps, _mm256_set1_ps, _mm256_setzero_ps, _mm256_sqrt_ps, _mm256_sub_ps,
};

use super::{BallRay, Balls};

/// Where the ray enters balls.
pub(super) struct Entered {
    /// At the earliest.
    pub from: __m256,
    /// At the latest, if it hits them for certain.
    pub to: __m256,
    /// Above 0 where it does.
    pub chord: __m256,
}

/// # Safety
/// The processor has AVX2 and FMA.
#[inline(always)]
pub(super) unsafe fn entered(apart: &Apart, balls: &Balls, ray: &BallRay) -> Entered {
    // SAFETY: the caller answers for the instruction set; rows are aligned to their 32 bytes.
    unsafe {
        let Apart { along, square, room } = *apart;
        let (zero, slack) = (_mm256_setzero_ps(), _mm256_set1_ps(ray.slack));
        let inverse = _mm256_set1_ps(ray.inverse);
        let rooms =
            _mm256_mul_ps(_mm256_mul_ps(room, room), _mm256_set1_ps(1.0 + BallRay::SQUARES));
        let chord = _mm256_max_ps(_mm256_sub_ps(rooms, square), zero);
        let chord = _mm256_sqrt_ps(_mm256_mul_ps(chord, inverse));
        let from = _mm256_fnmadd_ps(chord, _mm256_set1_ps(1.0 + BallRay::CHORD), along);
        let radii = _mm256_load_ps(balls.radii.as_ptr());
        let less = _mm256_fmsub_ps(radii, _mm256_set1_ps(BallRay::RADII), slack);
        let less = _mm256_max_ps(less, zero);
        let least =
            _mm256_mul_ps(_mm256_mul_ps(less, less), _mm256_set1_ps(1.0 - BallRay::SQUARES));
        let chord = _mm256_mul_ps(_mm256_sub_ps(least, square), inverse);
        let half = _mm256_sqrt_ps(_mm256_max_ps(chord, zero));
        let to = _mm256_fnmadd_ps(half, _mm256_set1_ps(1.0 - BallRay::CHORD), along);
        Entered { from: _mm256_sub_ps(from, slack), to: _mm256_add_ps(to, slack), chord }
    }
}

/// How balls lie about a ray.
#[derive(Clone, Copy)]
pub(super) struct Apart {
    /// How far along the ray the centres are.
    pub along: __m256,
    /// The squares of their distances from it.
    pub square: __m256,
    /// The radii, and what all may be off by.
    pub room: __m256,
}

/// # Safety
/// The processor has AVX2 and FMA.
#[inline(always)]
pub(super) unsafe fn apart(balls: &Balls, ray: &BallRay) -> Apart {
    // SAFETY: the caller answers for the instruction set; rows are aligned to their 32 bytes.
    unsafe {
        let [x, y, z] = &balls.centers;
        let x = _mm256_sub_ps(_mm256_load_ps(x.as_ptr()), _mm256_set1_ps(ray.origin[0]));
        let y = _mm256_sub_ps(_mm256_load_ps(y.as_ptr()), _mm256_set1_ps(ray.origin[1]));
        let z = _mm256_sub_ps(_mm256_load_ps(z.as_ptr()), _mm256_set1_ps(ray.origin[2]));
        let [dx, dy, dz] = [
            _mm256_set1_ps(ray.direction[0]),
            _mm256_set1_ps(ray.direction[1]),
            _mm256_set1_ps(ray.direction[2]),
        ];
        let along = _mm256_fmadd_ps(x, dx, _mm256_fmadd_ps(y, dy, _mm256_mul_ps(z, dz)));
        let along = _mm256_mul_ps(along, _mm256_set1_ps(ray.inverse));
        let x = _mm256_fnmadd_ps(along, dx, x);
        let y = _mm256_fnmadd_ps(along, dy, y);
        let z = _mm256_fnmadd_ps(along, dz, z);
        let square = _mm256_fmadd_ps(x, x, _mm256_fmadd_ps(y, y, _mm256_mul_ps(z, z)));
        let room = _mm256_add_ps(_mm256_load_ps(balls.radii.as_ptr()), _mm256_set1_ps(ray.slack));
        Apart { along, square, room }
    }
}
