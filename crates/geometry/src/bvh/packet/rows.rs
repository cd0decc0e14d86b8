// SPDX-License-Identifier: MIT OR Apache-2.0
//! Sixteen numbers at once, as the processor has it: one register of AVX-512, two of AVX2, four of SSE2 or NEON.
//!
//! Which of them is found out when the program runs ([`crate::bvh::Lanes::best`]), so that one binary is fast
//! everywhere. Whatever is worked out in rows only rejects what cannot be hit (invariant 2): no bit of a hit depends on
//! which of them it was.

#![allow(unsafe_code)]

use dioptric_math::Vec4;

use crate::bvh::lanes::Test;
use crate::bvh::lanes::plain::Plain;

/// Lanes of a packet.
pub const LANES: usize = 16;

/// A number for each lane, in memory.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
pub struct Row(pub [f32; LANES]);

impl Row {
    /// The same in all lanes.
    pub const fn splat(x: f32) -> Self {
        Self([x; LANES])
    }
}

/// A bit for each lane.
pub type Mask = u16;

/// Sixteen numbers in registers.
pub(crate) trait Rows: Copy {
    /// How one ray tests a node's boxes with the same instructions.
    type One: Test;
    /// The same in all lanes.
    fn splat(x: f32) -> Self;
    /// From memory.
    fn load(row: &Row) -> Self;
    /// To memory.
    fn store(self, row: &mut Row);
    /// Numbers less `minus`, rounded to single precision then.
    fn narrow(numbers: &[f64; LANES], minus: f64) -> Self;
    /// Sums.
    fn add(self, other: Self) -> Self;
    /// Differences.
    fn sub(self, other: Self) -> Self;
    /// Products.
    fn mul(self, other: Self) -> Self;
    /// Quotients.
    fn div(self, other: Self) -> Self;
    /// `self * a + b`, rounded once or twice.
    fn mul_add(self, a: Self, b: Self) -> Self;
    /// `self * a - b`, rounded once or twice.
    fn mul_sub(self, a: Self, b: Self) -> Self;
    /// The smaller ones; `other` where one is NaN.
    fn min(self, other: Self) -> Self;
    /// The larger ones; `other` where one is NaN.
    fn max(self, other: Self) -> Self;
    /// Absolute values.
    fn abs(self) -> Self;
    /// Square roots.
    fn sqrt(self) -> Self;
    /// The numbers themselves, but with their signs at least this large.
    fn away_from_zero(self, least: f32) -> Self;
    /// The smallest number of some lanes, at least one.
    fn least(self, of: Mask) -> f32;
    /// Where `self <= other`; never where one is NaN.
    fn le(self, other: Self) -> Mask;
}

/// Four registers of four.
#[derive(Clone, Copy)]
pub struct Base([Vec4; 4]);

impl Base {
    #[inline(always)]
    fn with(self, other: Self, f: impl Fn(Vec4, Vec4) -> Vec4) -> Self {
        Self(std::array::from_fn(|i| f(self.0[i], other.0[i])))
    }
}

impl Rows for Base {
    type One = Plain;

    #[inline(always)]
    fn least(self, of: Mask) -> f32 {
        let mut row = Row::splat(0.0);
        self.store(&mut row);
        let mut least = f32::INFINITY;
        for (lane, x) in row.0.iter().enumerate() {
            least = if of & 1 << lane != 0 && *x < least { *x } else { least };
        }
        least
    }

    #[inline(always)]
    fn splat(x: f32) -> Self {
        Self([Vec4::splat(x); 4])
    }

    #[inline(always)]
    fn load(row: &Row) -> Self {
        Self(std::array::from_fn(|i| Vec4::from_slice(&row.0[4 * i..4 * i + 4])))
    }

    #[inline(always)]
    fn store(self, row: &mut Row) {
        for (four, out) in self.0.iter().zip(row.0.chunks_exact_mut(4)) {
            four.write_to_slice(out);
        }
    }

    #[inline(always)]
    fn narrow(numbers: &[f64; LANES], minus: f64) -> Self {
        let mut row = Row::splat(0.0);
        for (single, number) in row.0.iter_mut().zip(numbers) {
            *single = (number - minus) as f32;
        }
        Self::load(&row)
    }

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.with(other, |a, b| a + b)
    }

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.with(other, |a, b| a - b)
    }

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.with(other, |a, b| a * b)
    }

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        self.with(other, |a, b| a / b)
    }

    #[inline(always)]
    fn mul_add(self, a: Self, b: Self) -> Self {
        self.mul(a).add(b)
    }

    #[inline(always)]
    fn mul_sub(self, a: Self, b: Self) -> Self {
        self.mul(a).sub(b)
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.with(other, Vec4::min)
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.with(other, Vec4::max)
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.map(Vec4::abs))
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.map(|v| Vec4::from_array(v.to_array().map(f32::sqrt))))
    }

    #[inline(always)]
    fn away_from_zero(self, least: f32) -> Self {
        Self(self.0.map(|v| v.abs().max(Vec4::splat(least)).copysign(v)))
    }

    #[inline(always)]
    fn le(self, other: Self) -> Mask {
        (0..4).fold(0, |mask, i| mask | (self.0[i].cmple(other.0[i]).bitmask() as Mask) << (4 * i))
    }
}

/// The registers of x86-64's extensions. Their methods may run only where [`crate::bvh::Lanes`] said that the processor has
/// them: in functions that enable the same features.
#[cfg(target_arch = "x86_64")]
pub mod x86 {
    use super::{LANES, Mask, Row, Rows};
    use std::arch::x86_64::*;

    /// Two registers of eight.
    #[derive(Clone, Copy)]
    pub struct Avx2(__m256, __m256);

    /// One register of sixteen.
    #[derive(Clone, Copy)]
    pub struct Avx512(__m512);

    // SAFETY, for every block in these two implementations: the intrinsics need nothing but the features, and
    // the walks that use these types are instantiated in functions with those features only, which are called
    // after `Lanes` found them. Rows are aligned to 64 bytes and 64 bytes long.
    impl Rows for Avx2 {
        type One = crate::bvh::lanes::avx2::Avx2;

        #[inline(always)]
        fn least(self, of: Mask) -> f32 {
            unsafe {
                let bits = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
                let (low, high) = (i32::from(of & 255), i32::from(of >> 8));
                let (low, high) = (_mm256_set1_epi32(low), _mm256_set1_epi32(high));
                let low = _mm256_cmpeq_epi32(_mm256_and_si256(low, bits), bits);
                let high = _mm256_cmpeq_epi32(_mm256_and_si256(high, bits), bits);
                let all = _mm256_set1_ps(f32::INFINITY);
                let least = _mm256_min_ps(
                    _mm256_blendv_ps(all, self.0, _mm256_castsi256_ps(low)),
                    _mm256_blendv_ps(all, self.1, _mm256_castsi256_ps(high)),
                );
                let four =
                    _mm_min_ps(_mm256_castps256_ps128(least), _mm256_extractf128_ps::<1>(least));
                let two = _mm_min_ps(four, _mm_movehl_ps(four, four));
                _mm_cvtss_f32(_mm_min_ss(two, _mm_movehdup_ps(two)))
            }
        }

        #[inline(always)]
        fn splat(x: f32) -> Self {
            let v = unsafe { _mm256_set1_ps(x) };
            Self(v, v)
        }

        #[inline(always)]
        fn load(row: &Row) -> Self {
            let p = row.0.as_ptr();
            unsafe { Self(_mm256_load_ps(p), _mm256_load_ps(p.add(8))) }
        }

        #[inline(always)]
        fn store(self, row: &mut Row) {
            let p = row.0.as_mut_ptr();
            unsafe {
                _mm256_store_ps(p, self.0);
                _mm256_store_ps(p.add(8), self.1);
            }
        }

        #[inline(always)]
        fn narrow(numbers: &[f64; LANES], minus: f64) -> Self {
            let p = numbers.as_ptr();
            unsafe {
                let minus = _mm256_set1_pd(minus);
                let a = _mm256_cvtpd_ps(_mm256_sub_pd(_mm256_loadu_pd(p), minus));
                let b = _mm256_cvtpd_ps(_mm256_sub_pd(_mm256_loadu_pd(p.add(4)), minus));
                let c = _mm256_cvtpd_ps(_mm256_sub_pd(_mm256_loadu_pd(p.add(8)), minus));
                let d = _mm256_cvtpd_ps(_mm256_sub_pd(_mm256_loadu_pd(p.add(12)), minus));
                Self(_mm256_set_m128(b, a), _mm256_set_m128(d, c))
            }
        }

        #[inline(always)]
        fn add(self, o: Self) -> Self {
            unsafe { Self(_mm256_add_ps(self.0, o.0), _mm256_add_ps(self.1, o.1)) }
        }

        #[inline(always)]
        fn sub(self, o: Self) -> Self {
            unsafe { Self(_mm256_sub_ps(self.0, o.0), _mm256_sub_ps(self.1, o.1)) }
        }

        #[inline(always)]
        fn mul(self, o: Self) -> Self {
            unsafe { Self(_mm256_mul_ps(self.0, o.0), _mm256_mul_ps(self.1, o.1)) }
        }

        #[inline(always)]
        fn div(self, o: Self) -> Self {
            unsafe { Self(_mm256_div_ps(self.0, o.0), _mm256_div_ps(self.1, o.1)) }
        }

        #[inline(always)]
        fn mul_add(self, a: Self, b: Self) -> Self {
            unsafe { Self(_mm256_fmadd_ps(self.0, a.0, b.0), _mm256_fmadd_ps(self.1, a.1, b.1)) }
        }

        #[inline(always)]
        fn mul_sub(self, a: Self, b: Self) -> Self {
            unsafe { Self(_mm256_fmsub_ps(self.0, a.0, b.0), _mm256_fmsub_ps(self.1, a.1, b.1)) }
        }

        #[inline(always)]
        fn min(self, o: Self) -> Self {
            unsafe { Self(_mm256_min_ps(self.0, o.0), _mm256_min_ps(self.1, o.1)) }
        }

        #[inline(always)]
        fn max(self, o: Self) -> Self {
            unsafe { Self(_mm256_max_ps(self.0, o.0), _mm256_max_ps(self.1, o.1)) }
        }

        #[inline(always)]
        fn abs(self) -> Self {
            unsafe {
                let sign = _mm256_set1_ps(-0.0);
                Self(_mm256_andnot_ps(sign, self.0), _mm256_andnot_ps(sign, self.1))
            }
        }

        #[inline(always)]
        fn sqrt(self) -> Self {
            unsafe { Self(_mm256_sqrt_ps(self.0), _mm256_sqrt_ps(self.1)) }
        }

        #[inline(always)]
        fn away_from_zero(self, least: f32) -> Self {
            unsafe {
                let (sign, least) = (_mm256_set1_ps(-0.0), _mm256_set1_ps(least));
                let low = _mm256_max_ps(_mm256_andnot_ps(sign, self.0), least);
                let high = _mm256_max_ps(_mm256_andnot_ps(sign, self.1), least);
                Self(
                    _mm256_or_ps(_mm256_and_ps(sign, self.0), low),
                    _mm256_or_ps(_mm256_and_ps(sign, self.1), high),
                )
            }
        }

        #[inline(always)]
        fn le(self, o: Self) -> Mask {
            unsafe {
                let low = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(self.0, o.0));
                let high = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(self.1, o.1));
                (low | high << 8) as Mask
            }
        }
    }

    impl Rows for Avx512 {
        type One = crate::bvh::lanes::avx512::Avx512;

        #[inline(always)]
        fn least(self, of: Mask) -> f32 {
            unsafe { _mm512_mask_reduce_min_ps(of, self.0) }
        }

        #[inline(always)]
        fn splat(x: f32) -> Self {
            unsafe { Self(_mm512_set1_ps(x)) }
        }

        #[inline(always)]
        fn load(row: &Row) -> Self {
            unsafe { Self(_mm512_load_ps(row.0.as_ptr())) }
        }

        #[inline(always)]
        fn store(self, row: &mut Row) {
            unsafe { _mm512_store_ps(row.0.as_mut_ptr(), self.0) }
        }

        #[inline(always)]
        fn narrow(numbers: &[f64; LANES], minus: f64) -> Self {
            let p = numbers.as_ptr();
            unsafe {
                let minus = _mm512_set1_pd(minus);
                let a = _mm512_cvtpd_ps(_mm512_sub_pd(_mm512_loadu_pd(p), minus));
                let b = _mm512_cvtpd_ps(_mm512_sub_pd(_mm512_loadu_pd(p.add(8)), minus));
                Self(_mm512_insertf32x8::<1>(_mm512_castps256_ps512(a), b))
            }
        }

        #[inline(always)]
        fn add(self, o: Self) -> Self {
            unsafe { Self(_mm512_add_ps(self.0, o.0)) }
        }

        #[inline(always)]
        fn sub(self, o: Self) -> Self {
            unsafe { Self(_mm512_sub_ps(self.0, o.0)) }
        }

        #[inline(always)]
        fn mul(self, o: Self) -> Self {
            unsafe { Self(_mm512_mul_ps(self.0, o.0)) }
        }

        #[inline(always)]
        fn div(self, o: Self) -> Self {
            unsafe { Self(_mm512_div_ps(self.0, o.0)) }
        }

        #[inline(always)]
        fn mul_add(self, a: Self, b: Self) -> Self {
            unsafe { Self(_mm512_fmadd_ps(self.0, a.0, b.0)) }
        }

        #[inline(always)]
        fn mul_sub(self, a: Self, b: Self) -> Self {
            unsafe { Self(_mm512_fmsub_ps(self.0, a.0, b.0)) }
        }

        #[inline(always)]
        fn min(self, o: Self) -> Self {
            unsafe { Self(_mm512_min_ps(self.0, o.0)) }
        }

        #[inline(always)]
        fn max(self, o: Self) -> Self {
            unsafe { Self(_mm512_max_ps(self.0, o.0)) }
        }

        #[inline(always)]
        fn abs(self) -> Self {
            unsafe { Self(_mm512_abs_ps(self.0)) }
        }

        #[inline(always)]
        fn sqrt(self) -> Self {
            unsafe { Self(_mm512_sqrt_ps(self.0)) }
        }

        #[inline(always)]
        fn away_from_zero(self, least: f32) -> Self {
            unsafe {
                let size = _mm512_max_ps(_mm512_abs_ps(self.0), _mm512_set1_ps(least));
                let sign =
                    _mm512_and_si512(_mm512_castps_si512(self.0), _mm512_set1_epi32(i32::MIN));
                let bits = _mm512_or_si512(_mm512_castps_si512(size), sign);
                Self(_mm512_castsi512_ps(bits))
            }
        }

        #[inline(always)]
        fn le(self, o: Self) -> Mask {
            unsafe { _mm512_cmp_ps_mask::<_CMP_LE_OQ>(self.0, o.0) }
        }
    }
}
