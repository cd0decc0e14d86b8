// SPDX-License-Identifier: MIT OR Apache-2.0
//! How the points of neighbouring pixels complete each other, so that the error of a picture is blue noise: errors of
//! neighbours cancel, and the eye, a filter or a denoiser sees less of them.
//!
//! The idea, that aligned blocks of pixels should share one evenly spread set of points, is that of Ahmed and Wonka,
//! "Screen-Space Blue-Noise Diffusion of Monte Carlo Sampling Error via Hierarchical Ordering of Pixels", ACM TOG 39(6),
//! 2020. They give each pixel a piece of one sequence, as long as the number of its samples, which must be known and a power of
//! two. Here it need not be, and a pixel's samples stay what they are when more are added: pixels are not pieces of the
//! sequence but a further dimension of it.
//!
//! Sobol's first two dimensions are Niederreiter's construction ("Low-discrepancy and low-dispersion sequences", Journal
//! of Number Theory 30, 1988) for the polynomials z and z + 1 over the field of two elements: sample number s, its bits the
//! coefficients of a polynomial, has the digits of that polynomial expanded about z = 0 and about z = 1. To this
//! polynomial we add, for a pixel's two bits at each level of the hierarchy of blocks (the finest is level 1), `(a + b z) / (1 + z +
//! z^2)^level`, whose pole is at a third place. With n samples of each of 4^m pixels of a block, n = 2^k, these are all functions
//! `g / (1 + z + z^2)^m` with deg g < k + 2m. If the first a digits of one dimension and b of the other are 0, where a + b
//! = k + 2m, then z^a (z + 1)^b divides g, so g is 0: the n 4^m points fall one into each of as many equal boxes, for every m and every
//! k. (Two bits a level are what a pole of degree two takes; other pairs of pixels share boxes by at most two.)
//!
//! A pixel's digits are a constant that is added to those of all its samples, before Owen's scrambling, which a whole tile
//! shares. So each pixel by itself has an Owen-scrambled Sobol sequence as before. Blocks are shuffled within each block above them, by
//! other keys in every dimension.

/// Levels of blocks. Tiles of 2^4 pixels a side do not know of each other: noise of longer waves is white, but there is little of
/// it.
const LEVELS: u32 = 4;
const SIDE: u32 = 1 << LEVELS;
const BITS: u32 = 2 * LEVELS;

/// The tile of a pixel, and the pixel's place in it: two bits a level, of the coarsest in the lowest bits.
#[must_use]
pub const fn place([x, y]: [u32; 2]) -> (u64, u16) {
    let tile = ((y / SIDE) as u64) << 32 | (x / SIDE) as u64;
    let (mut code, mut level) = (0, 0);
    while level < LEVELS {
        let (right, down) = (x >> (LEVELS - 1 - level) & 1, y >> (LEVELS - 1 - level) & 1);
        code |= (right | down << 1) << (2 * level);
        level += 1;
    }
    (tile, code as u16)
}

/// The digits of a place in both dimensions, the first ones in the lowest bits.
#[inline(always)]
#[must_use]
pub const fn digits(place: u16, key: u64) -> [u32; 2] {
    DIGITS[(shuffled(place, key) & (DIGITS.len() as u32 - 1)) as usize]
}

/// [`digits`] without looking them up, for loops over many places.
#[inline(always)]
#[must_use]
pub const fn digits_of_many(place: u16, key: u64) -> [u32; 2] {
    sums(shuffled(place, key))
}

/// Shuffles the blocks within each block: a bit depends on itself and on those of blocks around, which are lower.
#[inline(always)]
const fn shuffled(place: u16, key: u64) -> u32 {
    // Bits of the key below make the coarsest bits well mixed, too.
    let low = 32 - BITS;
    let code = (place as u32) << low | (key as u32) & ((1 << low) - 1);
    let code = code.wrapping_mul((key >> 32) as u32 | 1);
    (code ^ code.wrapping_mul(0x6c50_b47c)) >> low
}

static DIGITS: [[u32; 2]; 1 << BITS] = {
    let mut table = [[0; 2]; 1 << BITS];
    let mut code = 0;
    while code < table.len() {
        table[code] = sums(code as u32);
        code += 1;
    }
    table
};

/// The digits of `1 / (1 + z + z^2)^level` expanded about 0; the same about 1, where z is 1 + t.
const SERIES: [u32; LEVELS as usize + 1] = {
    let mut all = [1; LEVELS as usize + 1];
    let mut level = 1;
    while level < all.len() {
        // 1 / (1 + z + z^2) = (1 + z) / (1 + z^3).
        let mut digits: u32 = all[level - 1];
        digits ^= digits << 1;
        let mut step = 3;
        while step < 32 {
            digits ^= digits << step;
            step *= 2;
        }
        all[level] = digits;
        level += 1;
    }
    all
};

/// The digits of the function that a code stands for.
#[inline(always)]
const fn sums(code: u32) -> [u32; 2] {
    let (mut ones, mut zs, mut bit) = (0, 0, 0);
    while bit < BITS {
        let series = SERIES[(LEVELS - bit / 2) as usize];
        ones ^= (code >> bit & 1).wrapping_neg() & series;
        zs ^= (code >> (bit + 1) & 1).wrapping_neg() & series;
        bit += 2;
    }
    let about_0 = ones ^ zs << 1;
    [about_0, about_0 ^ zs]
}

#[cfg(test)]
mod tests {
    use super::super::sobol::{at, pascal};
    use super::*;
    use dioptric_math::random::mix;

    /// Every block of 4^m pixels with 2^k samples of each is a net, wherever the block and the samples begin (at a
    /// multiple of their number), whatever the key.
    #[test]
    fn blocks_of_pixels_are_nets_together() {
        for (seed, corner) in [(1, [0, 0]), (2, [8, 24]), (3, [64, 1000])] {
            for (m, k) in [(0, 5), (1, 0), (1, 1), (1, 4), (2, 0), (2, 1), (2, 3), (3, 0), (3, 2)] {
                let (side, n) = (1 << m, 1 << k);
                let corner = corner.map(|c: u32| c / side * side);
                for first in [0, n, 5 * n] {
                    let bits = k + 2 * m;
                    let mut points = Vec::new();
                    for (x, y) in (0..side).flat_map(|y| (0..side).map(move |x| (x, y))) {
                        let (_, place) = place([corner[0] + x, corner[1] + y]);
                        points.extend((first..first + n).map(|s| at(s, place, mix(seed))));
                    }
                    for columns in (0..=bits).map(|c| 1u32 << c) {
                        let rows = (1 << bits) / columns;
                        let mut seen = vec![false; points.len()];
                        for [x, y] in &points {
                            let column = (x * f64::from(columns)) as u32;
                            let row = (y * f64::from(rows)) as u32;
                            let cell = &mut seen[(row * columns + column) as usize];
                            assert!(!*cell, "{m} {k} from {first}: {columns} columns");
                            *cell = true;
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn digits_are_those_of_the_expansion() {
        // 1 / (1 + z + z^2) = 1 + z + z^3 + z^4 + z^6 + ...
        assert_eq!(SERIES[1], 0b011_011_011_011_011_011_011_011_011_011_011u64 as u32);
        // Times what it was divided by it is 1 again.
        for (level, mut x) in SERIES.into_iter().enumerate() {
            for _ in 0..level {
                x ^= x << 1 ^ x << 2;
            }
            assert_eq!(x, 1);
        }
        // About 1: Pascal's triangle takes coefficients of z to those of t.
        assert_eq!([0b01, 0b10, 0b11].map(pascal), [0b01, 0b11, 0b10]);
        for place in 0..1 << BITS {
            assert_eq!(digits(place, mix(7)), digits_of_many(place, mix(7)));
        }
    }

    #[test]
    fn every_pixel_of_a_tile_has_a_place_of_its_own() {
        let mut seen = vec![false; 1 << BITS];
        for (x, y) in (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x, y))) {
            let (tile, place) = place([2 * SIDE + x, SIDE + y]);
            let there = shuffled(place, mix(3)) as usize;
            assert!(tile == (1 << 32 | 2) && !seen[there]);
            seen[there] = true;
        }
    }
}
