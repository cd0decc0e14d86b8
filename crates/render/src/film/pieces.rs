// SPDX-License-Identifier: MIT OR Apache-2.0
//! Sums that can be split: samples are added up pair by pair, by their numbers.
//!
//! Sums of floating-point numbers depend on the order. Here the order follows from the samples' numbers alone: the
//! numbers are cut into blocks k 2^j to (k + 1) 2^j; a block's sum is the sum of its two halves' sums; and what is no
//! whole block is a row of the largest blocks that it has, added from the left. So parts of a pixel's samples that
//! were added up apart, kept as such rows and put together, give the bits of all of them added up at once. Roundoff
//! grows with the logarithm of the number of samples, too, not with the number.

use std::ops::Range;

/// Something that can be added up.
pub trait Join: Copy {
    /// Adds the sum of later samples.
    fn join(&mut self, later: &Self);
}

/// The sum of the samples from a first one on: a row of the largest blocks.
#[derive(Clone, Debug)]
pub struct Pieces<T> {
    /// The number of the sample that comes next.
    next: u32,
    /// Samples and sum of each block, the first ones first.
    blocks: Vec<(u32, T)>,
}

impl<T: Join> Pieces<T> {
    /// Nothing yet.
    #[must_use]
    pub fn new() -> Self {
        // One of each size, and one that has just come.
        Self { next: 0, blocks: Vec::with_capacity(34) }
    }

    /// Begins anew with sample `first`.
    pub fn start(&mut self, first: u32) {
        self.next = first;
        self.blocks.clear();
    }

    /// Adds the sum of the next `count` samples: a block. (Where it is none, as the first samples of an adaptive
    /// picture may be, it stays a term of its own, always.)
    pub fn push(&mut self, count: u32, value: T) {
        let (mut count, mut value) = (count, value);
        self.next += count;
        while let Some((before, sum)) = self.blocks.last()
            && *before == count
            && self.next.is_multiple_of(2 * count)
        {
            let mut sum = *sum;
            sum.join(&value);
            (count, value) = (2 * count, sum);
            self.blocks.pop();
        }
        self.blocks.push((count, value));
    }

    /// The sum of all.
    #[must_use]
    pub fn sum(&self) -> Option<T> {
        let mut values = self.blocks.iter().map(|(_, value)| *value);
        let first = values.next()?;
        Some(values.fold(first, |mut sum, value| {
            sum.join(&value);
            sum
        }))
    }
}

impl<T: Join> Default for Pieces<T> {
    fn default() -> Self {
        Self::new()
    }
}

/// The largest blocks of which a range is made, in order, none larger than `most`, a power of two.
#[must_use]
pub fn blocks_of(range: Range<u32>, most: u32) -> Vec<Range<u32>> {
    let mut blocks = Vec::new();
    let Range { mut start, end } = range;
    while start < end {
        let aligned = if start == 0 { 1 << 31 } else { 1 << start.trailing_zeros() };
        let fitting = 1 << (end - start).ilog2();
        let size: u32 = most.min(aligned).min(fitting);
        blocks.push(start..start + size);
        start += size;
    }
    blocks
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sum that shows how it came about.
    #[derive(Clone, Copy, Debug, PartialEq)]
    struct Number(f64);

    impl Join for Number {
        fn join(&mut self, later: &Self) {
            self.0 += later.0;
        }
    }

    fn value(i: u32) -> Number {
        Number(1.0 / f64::from(3 * i + 1) * if i.is_multiple_of(5) { -1e6 } else { 1.0 })
    }

    fn whole(range: Range<u32>) -> Pieces<Number> {
        let mut pieces = Pieces::new();
        pieces.start(range.start);
        range.for_each(|i| pieces.push(1, value(i)));
        pieces
    }

    #[test]
    fn parts_put_together_are_the_whole_bit_for_bit() {
        let mut sequential_differs = false;
        for n in 1..70 {
            let sum = whole(0..n).sum().unwrap();
            sequential_differs |= sum.0 != (0..n).map(|i| value(i).0).sum::<f64>();
            for cut in 0..=n {
                let mut joined = Pieces::new();
                for part in [0..cut, cut..n] {
                    for (count, value) in whole(part).blocks {
                        joined.push(count, value);
                    }
                }
                assert_eq!(joined.sum(), Some(sum), "{n} cut at {cut}");
            }
        }
        assert!(sequential_differs, "the test must be able to fail");
    }

    #[test]
    fn ranges_are_rows_of_aligned_blocks() {
        assert_eq!(blocks_of(0..7, 64), [0..4, 4..6, 6..7]);
        assert_eq!(blocks_of(3..20, 64), [3..4, 4..8, 8..16, 16..20]);
        assert_eq!(blocks_of(0..32, 8), [0..8, 8..16, 16..24, 24..32]);
        assert_eq!(blocks_of(5..5, 8), []);
        for (count, _) in whole(3..20).blocks.iter().zip(blocks_of(3..20, 64)).map(|(b, r)| {
            assert_eq!(b.0 as usize, r.len());
            b
        }) {
            assert!(count.is_power_of_two());
        }
    }
}
