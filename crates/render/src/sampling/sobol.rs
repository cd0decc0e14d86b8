// SPDX-License-Identifier: MIT OR Apache-2.0
//! The first two dimensions of Sobol's sequence, Owen-scrambled: any 2^k samples that begin at a
//! multiple of 2^k fall one into each of 2^k equal boxes, for every shape of box whose sides are
//! powers of two (a (0, 2)-sequence).
//!
//! Numbers for further needs (lens, lights, ...) are the same two dimensions again, scrambled and
//! shuffled with other keys, as in Burley, "Practical Hash-based Owen Scrambling", JCGT 9(4), 2020.
//! Scrambling uses the hash of Laine and Karras, "Stratified Sampling for Stochastic Transparency",
//! EGSR 2011, section 3.1, on reversed bits: in it a bit depends on lower bits only, so in the
//! reversed number it depends on higher bits only, which is what Owen's scrambling means.

use super::screen;

/// A hash in which every bit depends only on itself, on lower bits and on the key.
#[inline(always)]
const fn scramble_upwards(x: u32, key: u32) -> u32 {
    let x = x.wrapping_add(key);
    let x = x ^ x.wrapping_mul(0x6c50_b47c);
    let x = x ^ x.wrapping_mul(0xb82f_1e52);
    let x = x ^ x.wrapping_mul(0xc7af_e638);
    x ^ x.wrapping_mul(0x8d22_f6e6)
}

/// Multiplies the vector of bits of `i` by Pascal's triangle modulo 2, the second dimension's matrix
/// of directions (Sobol 1967; its directions are v(0) = 1/2, v(k+1) = v(k) xor v(k)/2).
///
/// The triangle of size 2n is made of three triangles of size n, `[[P, P], [0, P]]`, so five steps do
/// for 32 bits: each adds the upper halves of all blocks to their lower halves.
#[inline(always)]
#[must_use]
pub const fn pascal(i: u32) -> u32 {
    let i = i ^ ((i & 0xaaaa_aaaa) >> 1);
    let i = i ^ ((i & 0xcccc_cccc) >> 2);
    let i = i ^ ((i & 0xf0f0_f0f0) >> 4);
    let i = i ^ ((i & 0xff00_ff00) >> 8);
    i ^ (i >> 16)
}

/// Point `index` of the scrambled sequence that `key` picks, in `[0, 1)` with 32 bits each.
#[cfg(test)]
pub(crate) const fn pair(index: u32, key: u64) -> [f64; 2] {
    at(index, 0, key)
}

/// Point `index` of a pixel of the tile that `key` picks (see [`screen`]), in `[0, 1)` with 32 bits each.
#[inline(always)]
#[must_use]
pub const fn at(index: u32, place: u16, key: u64) -> [f64; 2] {
    let more = further(key);
    moved(index, screen::digits(place, more), [key, more])
}

/// [`at`] for loops over many.
#[inline(always)]
#[must_use]
pub const fn at_of_many(index: u32, place: u16, key: u64) -> [f64; 2] {
    let more = further(key);
    moved(index, screen::digits_of_many(place, more), [key, more])
}

/// More bits from those of a key that are random already.
#[inline(always)]
const fn further(key: u64) -> u64 {
    (key ^ key >> 32).wrapping_mul(0xd605_bbb5_8c8a_bbfd)
}

#[inline(always)]
const fn moved(index: u32, [dx, dy]: [u32; 2], [key, more]: [u64; 2]) -> [f64; 2] {
    // Shuffling scrambles the index's bits from the top: blocks of 2^k aligned indices stay together. (Half the work of
    // scrambling does as well here: variances of functions of four dimensions were the same within 2 %.)
    let turned =
        index.reverse_bits().wrapping_add(key as u32).wrapping_mul((more >> 32) as u32 | 1);
    let index = (turned ^ turned.wrapping_mul(0x6c50_b47c)).reverse_bits();
    // The first dimension of point i is the reversed i, so scrambling's first reversal cancels out.
    let x = scramble_upwards(index ^ dx, (key >> 32) as u32).reverse_bits();
    let y = scramble_upwards(pascal(index) ^ dy, more as u32).reverse_bits();
    [unit(x), unit(y)]
}

#[inline(always)]
const fn unit(bits: u32) -> f64 {
    bits as f64 * (1.0 / 4_294_967_296.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use dioptric_math::random;

    #[test]
    fn pascal_equals_the_direction_numbers() {
        let mut directions = [1u32 << 31; 32];
        for k in 1..32 {
            directions[k] = directions[k - 1] ^ (directions[k - 1] >> 1);
        }
        for n in 0..2000u32 {
            let i = n.wrapping_mul(0x9e37_79b9);
            let slow =
                (0..32).filter(|k| i >> k & 1 == 1).fold(0, |sum, k: usize| sum ^ directions[k]);
            assert_eq!(pascal(i).reverse_bits(), slow);
        }
    }

    #[test]
    fn aligned_blocks_are_nets() {
        for key in [1, 2, 0xdead_beef_0123_4567] {
            for k in 0..=8u32 {
                let n = 1u32 << k;
                for start in [0, n, 6 * n] {
                    let points: Vec<_> = (start..start + n).map(|i| pair(i, key)).collect();
                    for columns in (0..=k).map(|c| 1u32 << c) {
                        let rows = n / columns;
                        let mut seen = vec![false; n as usize];
                        for [x, y] in &points {
                            let column = (x * f64::from(columns)) as u32;
                            let row = (y * f64::from(rows)) as u32;
                            let cell = &mut seen[(row * columns + column) as usize];
                            assert!(
                                !*cell,
                                "key {key}, {n} points from {start}, {columns} columns"
                            );
                            *cell = true;
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn keys_make_points_uniform() {
        // One point of many sequences: 8 x 8 boxes, chi-square with 63 degrees of freedom.
        for index in [0, 1, 5, 1000] {
            let mut bins = [0u32; 64];
            for key in 0..64_000 {
                let [x, y] = pair(index, random::mix(key));
                bins[(y * 8.0) as usize * 8 + (x * 8.0) as usize] += 1;
            }
            let chi2: f64 =
                bins.iter().map(|&n| (f64::from(n) - 1e3) * (f64::from(n) - 1e3) / 1e3).sum();
            assert!(chi2 < 103.4, "index {index}: {chi2}"); // 0.1 % of the cases are above
        }
    }
}
