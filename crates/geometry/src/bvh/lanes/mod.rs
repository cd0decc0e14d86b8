// SPDX-License-Identifier: MIT OR Apache-2.0
//! Tests of eight boxes at once, one way for each instruction set. They only reject (invariant 2), so
//! no bit of a hit depends on which is used.

#[cfg(target_arch = "x86_64")]
pub(super) mod avx2;
#[cfg(target_arch = "x86_64")]
pub(super) mod avx512;
pub(super) mod plain;

use super::{BoxRay, Node, WIDTH};

/// Instruction sets that the queries know, worst first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Lanes {
    /// What the program was compiled for.
    #[default]
    Plain,
    /// AVX2 and FMA.
    Avx2,
    /// AVX-512 (F, VL and DQ).
    Avx512,
}

impl Lanes {
    /// The best that this processor has.
    #[must_use]
    pub fn best() -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            let avx2 = is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma");
            let avx512 = is_x86_feature_detected!("avx512f")
                && is_x86_feature_detected!("avx512vl")
                && is_x86_feature_detected!("avx512dq");
            if avx2 && avx512 {
                return Self::Avx512;
            }
            if avx2 {
                return Self::Avx2;
            }
        }
        Self::Plain
    }

    /// This one, or the best below it that this processor has.
    #[must_use]
    pub fn or_less(self) -> Self {
        self.min(Self::best())
    }
}

/// Where a ray enters each of a node's boxes, at least 0; only meant where the mask says so.
pub(super) type Entries = [f32; WIDTH];

/// The test of a node's boxes on one instruction set.
pub(super) trait Test {
    /// The ray, spread over the lanes.
    type Spread: Copy;

    /// Spreads a ray.
    ///
    /// # Safety
    /// The processor has the instruction set.
    unsafe fn spread(ray: &BoxRay) -> Self::Spread;

    /// Where the ray enters the boxes, and a bit for each box that it enters at `limit` or before.
    ///
    /// # Safety
    /// The processor has the instruction set.
    unsafe fn enter(node: &Node, ray: &Self::Spread, limit: f32) -> (Entries, u32);
}
