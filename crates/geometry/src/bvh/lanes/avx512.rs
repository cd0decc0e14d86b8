// SPDX-License-Identifier: MIT OR Apache-2.0
//! Eight boxes or triangles with AVX-512: masks in registers of their own, and more room for the ray.

use std::arch::x86_64::{
    _CMP_GE_OQ, _CMP_GT_OQ, _CMP_LE_OQ, _CMP_NGT_UQ, _CMP_NLT_UQ, _mm256_add_ps,
    _mm256_castsi256_ps, _mm256_cmp_ps_mask, _mm256_cmple_epi32_mask, _mm256_cvtsi256_si32,
    _mm256_load_si256, _mm256_mask_cmp_ps_mask, _mm256_maskz_compress_epi32, _mm256_mul_ps,
    _mm256_set1_ps, _mm256_setzero_ps, _mm256_storeu_ps, _mm256_sub_ps,
};

use super::avx2::{self, Closer, Ranges, Spread};
use super::ball_lanes::{Apart, Entered, apart, entered};
use super::{Aim, BallRay, Balls, BoxRay, Child, Entries, Node, Packet, Sight, Test, WIDTH, eight};

pub(crate) struct Avx512;

impl Test for Avx512 {
    type Spread = Spread;
    type Eight = eight::Register;

    #[inline(always)]
    unsafe fn spread(ray: &BoxRay, nodes: &[Node]) -> Spread {
        // SAFETY: the caller answers for the instruction set, which contains AVX2 and FMA.
        unsafe { avx2::spread(ray, nodes) }
    }

    #[inline(always)]
    unsafe fn enter(_: &[Node], index: usize, ray: &Spread, limit: f32) -> (Entries, u32) {
        // SAFETY: as above; the array has the size of a register.
        unsafe {
            let (near, far) = avx2::slabs(index, ray, limit);
            let entered = _mm256_cmple_epi32_mask(near, far);
            let mut entries = [0.0; WIDTH];
            _mm256_storeu_ps(entries.as_mut_ptr(), _mm256_castsi256_ps(near));
            (entries, u32::from(entered))
        }
    }

    #[inline(always)]
    unsafe fn only(node: &Node, entered: u32) -> Child {
        // SAFETY: as above; a node's children are eight words, aligned to their size. This is sooner known than the number
        // of the bit and then what lies there.
        unsafe {
            let children = _mm256_load_si256(std::ptr::from_ref(&node.children).cast());
            let first = _mm256_maskz_compress_epi32(entered as u8, children);
            Child(_mm256_cvtsi256_si32(first) as u32)
        }
    }

    #[inline(always)]
    unsafe fn triangles(packet: &Packet, aim: &Aim, margin: f32, depths: [f32; 2]) -> Sight {
        // SAFETY: as above.
        unsafe {
            let seen = avx2::see(packet, aim);
            let Ranges { least, most, low, high } = seen.ranges();
            let positive = _mm256_cmp_ps_mask::<_CMP_GE_OQ>(least, _mm256_set1_ps(-margin));
            let negative = _mm256_cmp_ps_mask::<_CMP_LE_OQ>(most, _mm256_set1_ps(margin));
            let within = positive | negative;
            let starts =
                _mm256_mask_cmp_ps_mask::<_CMP_LE_OQ>(within, low, _mm256_set1_ps(depths[0]));
            let kept =
                _mm256_mask_cmp_ps_mask::<_CMP_GE_OQ>(starts, high, _mm256_set1_ps(depths[1]));
            let mut sight = Sight::unknown(0);
            if kept == 0 {
                return sight;
            }
            let closer = seen.closer(aim, low, high);
            let Closer { margin, depth, slack, .. } = closer;
            let minus = _mm256_sub_ps(_mm256_setzero_ps(), margin);
            let positive = _mm256_mask_cmp_ps_mask::<_CMP_GE_OQ>(kept, least, minus);
            let negative = _mm256_mask_cmp_ps_mask::<_CMP_LE_OQ>(kept, most, margin);
            let minus = _mm256_sub_ps(_mm256_setzero_ps(), slack);
            // Not `>=`: NaN is no reason to reject.
            let ahead = _mm256_mask_cmp_ps_mask::<_CMP_NLT_UQ>(positive, depth, minus);
            let behind = _mm256_mask_cmp_ps_mask::<_CMP_NGT_UQ>(negative, depth, slack);
            let kept = ahead | behind;
            sight.kept = u32::from(kept);
            let passed = closer.passed(low, high);
            _mm256_storeu_ps(sight.from.as_mut_ptr(), passed.from);
            _mm256_storeu_ps(sight.to.as_mut_ptr(), passed.to);
            let minus = _mm256_sub_ps(_mm256_setzero_ps(), passed.twice);
            let within = _mm256_cmp_ps_mask::<_CMP_GE_OQ>(least, passed.twice)
                | _mm256_cmp_ps_mask::<_CMP_LE_OQ>(most, minus);
            let certain = _mm256_set1_ps(aim.certain);
            let sure = _mm256_mask_cmp_ps_mask::<_CMP_GT_OQ>(kept & within, passed.from, certain);
            sight.sure = u32::from(sure);
            sight
        }
    }

    #[inline(always)]
    unsafe fn balls(balls: &Balls, ray: &BallRay, limit: f32) -> Sight {
        // SAFETY: as above; the array has the size of a register.
        unsafe {
            let apart = apart(balls, ray);
            let Apart { along, square, room } = apart;
            let near = _mm256_cmp_ps_mask::<_CMP_LE_OQ>(square, _mm256_mul_ps(room, room));
            let end = _mm256_add_ps(along, room);
            let kept = _mm256_mask_cmp_ps_mask::<_CMP_GE_OQ>(near, end, _mm256_setzero_ps());
            let mut sight = Sight::unknown(0);
            if kept == 0 {
                return sight;
            }
            let Entered { from, to, chord } = entered(&apart, balls, ray);
            _mm256_storeu_ps(sight.from.as_mut_ptr(), from);
            _mm256_storeu_ps(sight.to.as_mut_ptr(), to);
            let kept = _mm256_mask_cmp_ps_mask::<_CMP_LE_OQ>(kept, from, _mm256_set1_ps(limit));
            sight.kept = u32::from(kept);
            let slack = _mm256_set1_ps(ray.slack);
            let ahead = _mm256_mask_cmp_ps_mask::<_CMP_GT_OQ>(kept, from, slack);
            let sure = _mm256_mask_cmp_ps_mask::<_CMP_GT_OQ>(ahead, chord, _mm256_setzero_ps());
            sight.sure = u32::from(sure);
            sight
        }
    }
}
