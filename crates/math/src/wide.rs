// SPDX-License-Identifier: MIT OR Apache-2.0
//! The same loops over arrays, compiled for wider vectors where the processor has them.
//!
//! Sums, products, quotients and square roots of `f64` are correctly rounded one by one in registers of any width, and
//! nothing here is ever fused: so the bits are the same whichever way is taken.

#![allow(unsafe_code)]

/// Work on arrays, in plain loops.
///
/// [`Self::run`] must be `#[inline(always)]`, and so must be what it calls, closures included: only what is inlined is
/// compiled for the wider vectors.
pub trait Kernel {
    /// What comes of it.
    type Output;

    /// Does the work.
    fn run(self) -> Self::Output;
}

/// Does some work with the widest vectors that the processor has.
#[inline]
pub fn wide<K: Kernel>(kernel: K) -> K::Output {
    #[cfg(target_arch = "x86_64")]
    {
        if is_x86_feature_detected!("avx512f")
            && is_x86_feature_detected!("avx512vl")
            && is_x86_feature_detected!("avx512dq")
        {
            // SAFETY: the processor has these features.
            return unsafe { wide_avx512(kernel) };
        }
        if is_x86_feature_detected!("avx2") {
            // SAFETY: the processor has this feature.
            return unsafe { wide_avx2(kernel) };
        }
    }
    kernel.run()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,avx512f,avx512vl,avx512dq")]
fn wide_avx512<K: Kernel>(kernel: K) -> K::Output {
    kernel.run()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn wide_avx2<K: Kernel>(kernel: K) -> K::Output {
    kernel.run()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    struct Lengths<'a>([&'a [f64; 16]; 3], &'a mut [f64; 16]);

    impl Kernel for Lengths<'_> {
        type Output = ();

        #[inline(always)]
        fn run(self) {
            let Self([x, y, z], out) = self;
            for i in 0..16 {
                out[i] = 1.0 / (x[i] * x[i] + y[i] * y[i] + z[i] * z[i]).sqrt();
            }
        }
    }

    #[test]
    fn every_width_gives_the_same_bits() {
        let mut random = Random::new(5);
        for _ in 0..100 {
            let v = [0; 3].map(|_| std::array::from_fn(|_| random.uniform(-3.0, 3.0)));
            let (mut one, mut other) = ([0.0; 16], [0.0; 16]);
            Lengths([&v[0], &v[1], &v[2]], &mut one).run();
            wide(Lengths([&v[0], &v[1], &v[2]], &mut other));
            assert_eq!(one.map(f64::to_bits), other.map(f64::to_bits));
        }
    }
}
