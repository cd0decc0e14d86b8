// SPDX-License-Identifier: MIT OR Apache-2.0
//! Eight numbers side by side, or four and four, for builders of trees: sums, minima and maxima only, which are the
//! same on every instruction set.

use dioptric_math::Vec4;

/// Eight numbers. Safe to use where the processor has the instruction set of the type.
pub(crate) trait Eight: Copy {
    /// The same number eight times.
    ///
    /// # Safety
    /// The processor has the instruction set.
    unsafe fn splat(x: f32) -> Self;

    /// Numbers from memory.
    ///
    /// # Safety
    /// The processor has the instruction set.
    unsafe fn load(from: &[f32; 8]) -> Self;

    /// Numbers to memory.
    ///
    /// # Safety
    /// The processor has the instruction set.
    unsafe fn store(self, to: &mut [f32; 8]);

    /// The smaller ones; no number is NaN.
    ///
    /// # Safety
    /// The processor has the instruction set.
    unsafe fn min(self, other: Self) -> Self;

    /// The larger ones; no number is NaN.
    ///
    /// # Safety
    /// The processor has the instruction set.
    unsafe fn max(self, other: Self) -> Self;

    /// The first four.
    ///
    /// # Safety
    /// The processor has the instruction set.
    unsafe fn low(self) -> Vec4;

    /// The last four.
    ///
    /// # Safety
    /// The processor has the instruction set.
    unsafe fn high(self) -> Vec4;

    /// Four numbers, and four more.
    ///
    /// # Safety
    /// The processor has the instruction set.
    unsafe fn of(low: Vec4, high: Vec4) -> Self;
}

/// For every processor.
#[derive(Clone, Copy)]
pub(crate) struct Halves(Vec4, Vec4);

impl Eight for Halves {
    #[inline(always)]
    unsafe fn splat(x: f32) -> Self {
        Self(Vec4::splat(x), Vec4::splat(x))
    }

    #[inline(always)]
    unsafe fn load(&[a, b, c, d, e, f, g, h]: &[f32; 8]) -> Self {
        Self(Vec4::new(a, b, c, d), Vec4::new(e, f, g, h))
    }

    #[inline(always)]
    unsafe fn store(self, to: &mut [f32; 8]) {
        let ([a, b, c, d], [e, f, g, h]) = (self.0.to_array(), self.1.to_array());
        *to = [a, b, c, d, e, f, g, h];
    }

    #[inline(always)]
    unsafe fn min(self, other: Self) -> Self {
        Self(self.0.min(other.0), self.1.min(other.1))
    }

    #[inline(always)]
    unsafe fn max(self, other: Self) -> Self {
        Self(self.0.max(other.0), self.1.max(other.1))
    }

    #[inline(always)]
    unsafe fn low(self) -> Vec4 {
        self.0
    }

    #[inline(always)]
    unsafe fn high(self) -> Vec4 {
        self.1
    }

    #[inline(always)]
    unsafe fn of(low: Vec4, high: Vec4) -> Self {
        Self(low, high)
    }
}

/// For processors with AVX.
#[cfg(target_arch = "x86_64")]
pub(crate) use avx::Register;

#[cfg(target_arch = "x86_64")]
mod avx {
    use std::arch::x86_64::{
        __m256, _mm256_castps256_ps128, _mm256_extractf128_ps, _mm256_loadu_ps, _mm256_max_ps,
        _mm256_min_ps, _mm256_set_m128, _mm256_set1_ps, _mm256_storeu_ps,
    };

    use dioptric_math::Vec4;

    use super::Eight;

    #[derive(Clone, Copy)]
    pub(crate) struct Register(__m256);

    // SAFETY, of every function here: the caller answers for the instruction set, and arrays have the size of
    // a register.
    impl Eight for Register {
        #[inline(always)]
        unsafe fn splat(x: f32) -> Self {
            // SAFETY: as above.
            Self(unsafe { _mm256_set1_ps(x) })
        }

        #[inline(always)]
        unsafe fn load(from: &[f32; 8]) -> Self {
            // SAFETY: as above.
            Self(unsafe { _mm256_loadu_ps(from.as_ptr()) })
        }

        #[inline(always)]
        unsafe fn store(self, to: &mut [f32; 8]) {
            // SAFETY: as above.
            unsafe { _mm256_storeu_ps(to.as_mut_ptr(), self.0) }
        }

        #[inline(always)]
        unsafe fn min(self, other: Self) -> Self {
            // SAFETY: as above.
            Self(unsafe { _mm256_min_ps(self.0, other.0) })
        }

        #[inline(always)]
        unsafe fn max(self, other: Self) -> Self {
            // SAFETY: as above.
            Self(unsafe { _mm256_max_ps(self.0, other.0) })
        }

        #[inline(always)]
        unsafe fn low(self) -> Vec4 {
            // SAFETY: as above.
            unsafe { _mm256_castps256_ps128(self.0) }.into()
        }

        #[inline(always)]
        unsafe fn high(self) -> Vec4 {
            // SAFETY: as above.
            unsafe { _mm256_extractf128_ps::<1>(self.0) }.into()
        }

        #[inline(always)]
        unsafe fn of(low: Vec4, high: Vec4) -> Self {
            // SAFETY: as above.
            Self(unsafe { _mm256_set_m128(high.into(), low.into()) })
        }
    }
}
