// SPDX-License-Identifier: MIT OR Apache-2.0
//! From light to the bytes of a display without computing a power for each: in which of 256 intervals does it lie?

use crate::transfer::{Encoding, quantize_8};

/// The intervals of light that become each byte, for one encoding: `quantize_8(encoding.encode(light))` for light from
/// 0 to 1, the same byte always.
pub(crate) struct ByteScale {
    encoding: Encoding,
    /// The light from which on the byte is at least `i + 1`, but for rounding; infinite where there is no such byte.
    limits: [f64; 256],
    /// The byte of the least light in each of [`CELLS`] equal parts of 0 to 1, and of 1, but for rounding.
    starts: Vec<u8>,
}

/// So many that in most of them the byte grows by at most one.
const CELLS: usize = 4096;

/// How near to a limit, relative to it, light must lie for the encoding itself to be asked. Powers are exact to about
/// 1e-15, so there is room to spare.
const DOUBT: f64 = 1e-9;

impl ByteScale {
    pub(crate) fn new(encoding: Encoding) -> Self {
        let mut limits = [f64::INFINITY; 256];
        for (i, limit) in limits.iter_mut().enumerate().take(255) {
            *limit = encoding.decode((i as f64 + 0.5) / 255.0);
        }
        let start =
            |cell| limits.partition_point(|limit| *limit <= cell as f64 / CELLS as f64) as u8;
        let starts = (0..=CELLS).map(start).collect();
        Self { encoding, limits, starts }
    }

    /// The byte of light; light outside of 0 to 1 and NaN are clamped as [`quantize_8`] does.
    pub(crate) fn byte(&self, light: f64) -> u8 {
        if !(0.0..=1.0).contains(&light) {
            return quantize_8(self.encoding.encode(light));
        }
        let start = self.starts.get((light * CELLS as f64) as usize).copied().unwrap_or(0);
        // A cell may start in doubt, too: from one byte lower, what follows is right in any case.
        let mut byte = start.saturating_sub(1);
        while self.limits[usize::from(byte)] <= light {
            byte += 1;
        }
        let near = |limit: f64| (light - limit).abs() <= DOUBT * limit;
        let below = byte.checked_sub(1).is_some_and(|b| near(self.limits[usize::from(b)]));
        if below || near(self.limits[usize::from(byte)]) {
            return quantize_8(self.encoding.encode(light));
        }
        byte
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dioptric_math::random::Random;

    #[test]
    fn every_byte_is_the_encodings() {
        let mut random = Random::new(1);
        for encoding in [Encoding::Srgb, Encoding::Raw, Encoding::Gamma] {
            let scale = ByteScale::new(encoding);
            let same = |light: f64| {
                assert_eq!(scale.byte(light), quantize_8(encoding.encode(light)), "{light:e}");
            };
            for i in 0..100_000 {
                same(random.unit());
                same(f64::from(i) * 1e-5);
                same(random.unit() * 1e-3);
            }
            // The numbers around each limit and each cell's start, one by one.
            let limits = scale.limits.iter().take(255).copied();
            for limit in limits.chain((0..=CELLS).map(|cell| cell as f64 / CELLS as f64)) {
                for steps in 0..50 {
                    same(f64::from_bits(limit.to_bits() + steps));
                    same(f64::from_bits(limit.to_bits().saturating_sub(steps)));
                }
                for share in [1.0 + 0.9e-9, 1.0 - 0.9e-9, 1.0 + 1.1e-9, 1.0 - 1.1e-9] {
                    same(limit * share);
                }
            }
            for strange in [-0.0, -1.0, 1.5, f64::NAN, f64::INFINITY, -f64::INFINITY, 5e-324] {
                same(strange);
            }
        }
    }
}
