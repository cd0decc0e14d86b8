// SPDX-License-Identifier: MIT OR Apache-2.0
//! Tests of eight boxes, triangles or balls at once, one way for each instruction set. They only reject
//! (invariant 2), so no bit of a hit depends on which is used.

#[cfg(target_arch = "x86_64")]
pub(crate) mod avx2;
#[cfg(target_arch = "x86_64")]
pub(crate) mod avx512;
#[cfg(target_arch = "x86_64")]
mod ball_lanes;
pub(crate) mod eight;
pub(crate) mod plain;

use dioptric_math::DVec3;

use super::balls::{BallRay, Balls};
use super::triangles::{Aim, Packet, Sight};
use super::{BoxRay, Child, Node, WIDTH};

/// Instruction sets that the queries know, worst first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Lanes {
    /// What the program was compiled for.
    #[default]
    Plain,
    /// AVX2, FMA and the bit manipulations that came with them.
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
            let avx2 = is_x86_feature_detected!("avx2")
                && is_x86_feature_detected!("fma")
                && is_x86_feature_detected!("bmi1")
                && is_x86_feature_detected!("bmi2")
                && is_x86_feature_detected!("lzcnt")
                && is_x86_feature_detected!("popcnt");
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

/// What is to be run on some instruction set.
pub(crate) trait Job {
    /// What comes of it.
    type Output;

    /// Runs it; `#[inline(always)]`, so that it is compiled for the instruction set.
    ///
    /// # Safety
    /// The processor has the instruction set of `T`.
    unsafe fn run<T: Test>(self) -> Self::Output;
}

impl Lanes {
    /// Runs a job on this instruction set.
    ///
    /// # Safety
    /// The processor has it.
    #[inline(always)]
    pub(crate) unsafe fn run<J: Job>(self, job: J) -> J::Output {
        match self {
            #[cfg(target_arch = "x86_64")]
            // SAFETY: the caller answers for the instruction set.
            Self::Avx512 => unsafe { run_avx512(job) },
            #[cfg(target_arch = "x86_64")]
            // SAFETY: as above.
            Self::Avx2 => unsafe { run_avx2(job) },
            _ => run_plain(job),
        }
    }
}

/// On its own, or whoever asks would make room on the stack for it, whatever the instruction set is.
#[inline(never)]
fn run_plain<J: Job>(job: J) -> J::Output {
    // SAFETY: there is no instruction set to answer for.
    unsafe { job.run::<plain::Plain>() }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt,avx512f,avx512vl,avx512dq")]
fn run_avx512<J: Job>(job: J) -> J::Output {
    // SAFETY: the features of this function.
    unsafe { job.run::<avx512::Avx512>() }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
fn run_avx2<J: Job>(job: J) -> J::Output {
    // SAFETY: the features of this function.
    unsafe { job.run::<avx2::Avx2>() }
}

/// Where a ray enters each of a node's boxes, at least 0; only meant where the mask says so.
pub(crate) type Entries = [f32; WIDTH];

/// The test of a node's boxes on one instruction set.
pub(crate) trait Test {
    /// The ray, spread over the lanes.
    type Spread: Copy;
    /// Eight numbers side by side.
    type Eight: eight::Eight;

    /// Spreads a ray that goes through these nodes.
    ///
    /// # Safety
    /// The processor has the instruction set.
    unsafe fn spread(ray: &BoxRay, nodes: &[Node]) -> Self::Spread;

    /// Where the ray enters the boxes of a node, and a bit for each box that it enters at `limit` or before.
    ///
    /// # Safety
    /// The processor has the instruction set, the ray was spread for these nodes, and the index is below their number.
    unsafe fn enter(nodes: &[Node], index: usize, ray: &Self::Spread, limit: f32)
    -> (Entries, u32);

    /// The only child that is entered, when there is one.
    ///
    /// # Safety
    /// The processor has the instruction set.
    #[inline(always)]
    unsafe fn only(node: &Node, entered: u32) -> Child {
        node.children[entered.trailing_zeros() as usize % WIDTH]
    }

    /// Which triangles the line may pass, with depths within those of `depths`.
    ///
    /// # Safety
    /// The processor has the instruction set.
    unsafe fn triangles(packet: &Packet, aim: &Aim, margin: f32, depths: [f32; 2]) -> Sight;

    /// Which balls the ray may hit at `limit` or before, in units of its scaled direction.
    ///
    /// # Safety
    /// The processor has the instruction set.
    unsafe fn balls(balls: &Balls, ray: &BallRay, limit: f32) -> Sight;
}

/// A vector, its numbers read one by one. It was written so a moment ago, and a processor that is made to read
/// them together must wait until they are in the cache.
#[inline(always)]
pub(crate) fn apart(v: &DVec3) -> DVec3 {
    // SAFETY: they are references.
    unsafe {
        DVec3::new(
            std::ptr::read_volatile(&v.x),
            std::ptr::read_volatile(&v.y),
            std::ptr::read_volatile(&v.z),
        )
    }
}
