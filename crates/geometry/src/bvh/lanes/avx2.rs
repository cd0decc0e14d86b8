// SPDX-License-Identifier: MIT OR Apache-2.0
//! Eight boxes with AVX2 and FMA.

use std::arch::x86_64::{
    __m256, _CMP_LE_OQ, _mm256_cmp_ps, _mm256_fmsub_ps, _mm256_load_ps, _mm256_max_ps,
    _mm256_min_ps, _mm256_movemask_ps, _mm256_set1_ps, _mm256_setzero_ps, _mm256_storeu_ps,
};

use super::{BoxRay, Entries, Node, Test, WIDTH};

pub(in super::super) struct Avx2;

/// A ray, a register for each number.
#[derive(Clone, Copy)]
pub(in super::super) struct Spread {
    near: [__m256; 3],
    far: [__m256; 3],
    inverse: [__m256; 3],
    /// Which planes are the near ones.
    first: [usize; 3],
}

/// The distances to the near and the far planes, before they are put together with the limit.
///
/// # Safety
/// The processor has AVX2 and FMA.
#[inline(always)]
pub(super) unsafe fn slabs(node: &Node, ray: &Spread) -> (__m256, __m256) {
    let t = |axis: usize, side: usize, origin: &[__m256; 3]| {
        // SAFETY: `first` is 2 * axis or one more, so the plane is one of six; nodes are aligned to 64
        // bytes and a plane has 32. The caller answers for the instruction set.
        unsafe {
            let plane = node.planes.get_unchecked(ray.first[axis] ^ side);
            _mm256_fmsub_ps(_mm256_load_ps(plane.as_ptr()), ray.inverse[axis], origin[axis])
        }
    };
    // SAFETY: the caller answers for the instruction set.
    unsafe {
        let near = _mm256_max_ps(
            _mm256_max_ps(t(0, 0, &ray.near), t(1, 0, &ray.near)),
            // Second, so that -0 becomes 0.
            _mm256_max_ps(t(2, 0, &ray.near), _mm256_setzero_ps()),
        );
        let far =
            _mm256_min_ps(_mm256_min_ps(t(0, 1, &ray.far), t(1, 1, &ray.far)), t(2, 1, &ray.far));
        (near, far)
    }
}

/// # Safety
/// The processor has AVX2 and FMA.
#[inline(always)]
pub(super) unsafe fn spread(ray: &BoxRay) -> Spread {
    // SAFETY: the caller answers for the instruction set.
    let all =
        |x: [f32; 3]| unsafe { [_mm256_set1_ps(x[0]), _mm256_set1_ps(x[1]), _mm256_set1_ps(x[2])] };
    Spread {
        near: all(ray.near),
        far: all(ray.far),
        inverse: all(ray.inverse),
        first: [ray.negative[0] & 1, 2 | (ray.negative[1] & 1), 4 | (ray.negative[2] & 1)],
    }
}

impl Test for Avx2 {
    type Spread = Spread;

    #[inline(always)]
    unsafe fn spread(ray: &BoxRay) -> Spread {
        // SAFETY: the caller answers for the instruction set.
        unsafe { spread(ray) }
    }

    #[inline(always)]
    unsafe fn enter(node: &Node, ray: &Spread, limit: f32) -> (Entries, u32) {
        // SAFETY: the caller answers for the instruction set; the array has the size of a register.
        unsafe {
            let (near, far) = slabs(node, ray);
            let far = _mm256_min_ps(far, _mm256_set1_ps(limit));
            let entered = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(near, far));
            let mut entries = [0.0; WIDTH];
            _mm256_storeu_ps(entries.as_mut_ptr(), near);
            (entries, entered as u32)
        }
    }
}
