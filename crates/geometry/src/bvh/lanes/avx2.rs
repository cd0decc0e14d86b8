// SPDX-License-Identifier: MIT OR Apache-2.0
//! Eight boxes or triangles with AVX2 and FMA.

use std::arch::x86_64::{
    __m256, _CMP_GE_OQ, _CMP_LE_OQ, _mm256_and_ps, _mm256_cmp_ps, _mm256_fmsub_ps,
    _mm256_fnmadd_ps, _mm256_load_ps, _mm256_max_ps, _mm256_min_ps, _mm256_movemask_ps,
    _mm256_mul_ps, _mm256_or_ps, _mm256_set1_ps, _mm256_setzero_ps, _mm256_storeu_ps,
    _mm256_sub_ps,
};

use super::{Aim, BoxRay, Entries, Node, Packet, Test, WIDTH};

pub(crate) struct Avx2;

/// A ray, a register for each number.
#[derive(Clone, Copy)]
pub(crate) struct Spread {
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

    type Aimed = Aimed;

    #[inline(always)]
    unsafe fn aim(aim: &Aim) -> Aimed {
        // SAFETY: the caller answers for the instruction set.
        unsafe { spread_aim(aim) }
    }

    #[inline(always)]
    unsafe fn triangles(packet: &Packet, aim: &Aimed, margin: f32, depths: [f32; 2]) -> u32 {
        // SAFETY: the caller answers for the instruction set.
        unsafe {
            let Seen { least, most, low, high } = see(packet, aim);
            let positive = _mm256_cmp_ps::<_CMP_GE_OQ>(least, _mm256_set1_ps(-margin));
            let negative = _mm256_cmp_ps::<_CMP_LE_OQ>(most, _mm256_set1_ps(margin));
            let starts = _mm256_cmp_ps::<_CMP_LE_OQ>(low, _mm256_set1_ps(depths[0]));
            let ends = _mm256_cmp_ps::<_CMP_GE_OQ>(high, _mm256_set1_ps(depths[1]));
            let within = _mm256_or_ps(positive, negative);
            _mm256_movemask_ps(_mm256_and_ps(within, _mm256_and_ps(starts, ends))) as u32
        }
    }
}

/// A line among triangles, a register for each number.
#[derive(Clone, Copy)]
pub(crate) struct Aimed {
    origin: [__m256; 3],
    slope: [__m256; 2],
    axes: [usize; 3],
}

/// The least and the greatest of the edge functions, and of the depths of the corners.
pub(super) struct Seen {
    pub least: __m256,
    pub most: __m256,
    pub low: __m256,
    pub high: __m256,
}

/// # Safety
/// The processor has AVX2 and FMA.
#[inline(always)]
pub(super) unsafe fn spread_aim(aim: &Aim) -> Aimed {
    // SAFETY: the caller answers for the instruction set.
    unsafe {
        Aimed {
            origin: [
                _mm256_set1_ps(aim.origin[0]),
                _mm256_set1_ps(aim.origin[1]),
                _mm256_set1_ps(aim.origin[2]),
            ],
            slope: [_mm256_set1_ps(aim.slope[0]), _mm256_set1_ps(aim.slope[1])],
            axes: aim.axes,
        }
    }
}

/// # Safety
/// The processor has AVX2 and FMA.
#[inline(always)]
pub(super) unsafe fn see(packet: &Packet, aim: &Aimed) -> Seen {
    let corner = |corner: usize| {
        // SAFETY: there are three corners, and `axes` are 0, 1 and 2 in some order; packets are aligned to 64 bytes and a row of
        // numbers has 32. The caller answers for the instruction set.
        unsafe {
            let offset = |i: usize| {
                let row = packet.corners.get_unchecked(corner).get_unchecked(aim.axes[i]);
                _mm256_sub_ps(_mm256_load_ps(row.as_ptr()), aim.origin[i])
            };
            let depth = offset(2);
            let x = _mm256_fnmadd_ps(aim.slope[0], depth, offset(0));
            let y = _mm256_fnmadd_ps(aim.slope[1], depth, offset(1));
            (x, y, depth)
        }
    };
    let (a, b, c) = (corner(0), corner(1), corner(2));
    // SAFETY: the caller answers for the instruction set.
    unsafe {
        let edge = |p: (__m256, __m256, __m256), q: (__m256, __m256, __m256)| {
            _mm256_fmsub_ps(p.0, q.1, _mm256_mul_ps(p.1, q.0))
        };
        let (u, v, w) = (edge(c, b), edge(a, c), edge(b, a));
        Seen {
            least: _mm256_min_ps(_mm256_min_ps(u, v), w),
            most: _mm256_max_ps(_mm256_max_ps(u, v), w),
            low: _mm256_min_ps(_mm256_min_ps(a.2, b.2), c.2),
            high: _mm256_max_ps(_mm256_max_ps(a.2, b.2), c.2),
        }
    }
}
