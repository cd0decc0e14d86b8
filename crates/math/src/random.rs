// SPDX-License-Identifier: MIT OR Apache-2.0
//! Random numbers as pure functions of their key: no state is shared, so nothing depends on order.

/// Mixes all bits of a key (the finaliser of SplitMix64: Steele, Lea and Flood, "Fast splittable
/// pseudorandom number generators", OOPSLA 2014, figure 5).
#[inline(always)]
#[must_use]
pub const fn mix(key: u64) -> u64 {
    let z = key.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// Joins a further word to a key.
#[inline(always)]
#[must_use]
pub const fn join(key: u64, word: u64) -> u64 {
    mix(key ^ mix(word))
}

/// A number in `[0, 1)` with 53 random bits of `key`.
#[inline(always)]
#[must_use]
pub const fn unit(key: u64) -> f64 {
    (key >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
}

/// A generator of numbers, for code that needs them in sequence (SplitMix64).
#[derive(Clone, Debug)]
pub struct Random {
    state: u64,
}

impl Random {
    /// A generator whose whole sequence is fixed by `seed`.
    #[must_use]
    pub const fn new(seed: u64) -> Self {
        Self { state: mix(seed) }
    }

    /// The next 64 random bits.
    pub fn bits(&mut self) -> u64 {
        let out = mix(self.state);
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        out
    }

    /// The next number in `[0, 1)`.
    pub fn unit(&mut self) -> f64 {
        unit(self.bits())
    }

    /// The next number in `[low, high)`.
    pub fn uniform(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_uniform_and_repeat() {
        let mut r = Random::new(7);
        let mut again = Random::new(7);
        let mut bins = [0u32; 16];
        for _ in 0..160_000 {
            let u = r.unit();
            assert_eq!(u, again.unit());
            bins[(u * 16.0) as usize] += 1;
        }
        // 15 degrees of freedom: chi-square below 37.7 in 99.9 % of the cases.
        let chi2: f64 =
            bins.iter().map(|&n| (f64::from(n) - 1e4) * (f64::from(n) - 1e4) / 1e4).sum();
        assert!(chi2 < 37.7, "{chi2}");
    }
}
