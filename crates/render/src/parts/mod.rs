// SPDX-License-Identifier: MIT OR Apache-2.0
//! A picture that is made in parts: some samples now, others later or on another machine.
//!
//! A [`Part`] holds films of blocks of samples ([`crate::film::pieces`]). Blocks that are neighbours join, so that a part of
//! all samples holds few, and however the samples were split, putting the parts together gives the same bits. The
//! block that is being made may be there for some pixels only: a part can be kept at any moment and gone on with.

mod file;
mod make;

use std::ops::Range;

use dioptric_scene::Diagnostic;

use crate::film::{Film, pieces::blocks_of};
use crate::region::Region;

pub use file::{Head, read, read_head, write};
pub use make::{Progress, Wanted, render};

/// Some samples of all pixels of a region.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    region: Region,
    layers: bool,
    /// In order, none of them two halves of a larger one.
    blocks: Vec<(Range<u32>, Film)>,
    /// The block that is being made.
    begun: Option<(Range<u32>, Film)>,
}

impl Part {
    /// No samples yet of a region; with `layers` what the camera rays hit first is kept, too.
    #[must_use]
    pub const fn new(region: Region, layers: bool) -> Self {
        Self { region, layers, blocks: Vec::new(), begun: None }
    }

    /// The region of the full picture.
    #[must_use]
    pub const fn region(&self) -> Region {
        self.region
    }

    /// Whether what the camera rays hit first is kept.
    #[must_use]
    pub const fn has_layers(&self) -> bool {
        self.layers
    }

    /// The samples that all pixels have, in order; neighbours joined.
    #[must_use]
    pub fn ranges(&self) -> Vec<Range<u32>> {
        let mut ranges: Vec<Range<u32>> = Vec::new();
        for (block, _) in &self.blocks {
            match ranges.last_mut() {
                Some(last) if last.end == block.start => last.end = block.end,
                _ => ranges.push(block.clone()),
            }
        }
        ranges
    }

    /// The samples of a range that are not there for all pixels.
    #[must_use]
    pub fn missing(&self, wanted: &Range<u32>) -> Vec<Range<u32>> {
        let mut missing = Vec::new();
        let mut from = wanted.start;
        for has in self.ranges() {
            if has.start > from && from < wanted.end {
                missing.push(from..has.start.min(wanted.end));
            }
            from = from.max(has.end);
        }
        if from < wanted.end {
            missing.push(from..wanted.end);
        }
        missing
    }

    /// Whether a block is there for some pixels only.
    #[must_use]
    pub const fn is_begun(&self) -> bool {
        self.begun.is_some()
    }

    /// Leaves out the samples of the block that is there for some pixels only.
    pub fn forget_begun(&mut self) {
        self.begun = None;
    }

    /// Takes the samples of another part of the same region. Those of its block that is not complete are left out.
    ///
    /// # Errors
    /// The samples that both have.
    pub fn merge(&mut self, other: Self) -> Result<(), Range<u32>> {
        for range in other.ranges() {
            for own in self.ranges() {
                let both = range.start.max(own.start)..range.end.min(own.end);
                if !both.is_empty() {
                    return Err(both);
                }
            }
        }
        other.blocks.into_iter().for_each(|(range, film)| self.insert(range, film));
        Ok(())
    }

    /// Puts a block at its place, and halves together.
    fn insert(&mut self, range: Range<u32>, film: Film) {
        let at = self.blocks.partition_point(|(block, _)| block.start < range.start);
        self.blocks.insert(at, (range, film));
        while let Some(left) =
            self.blocks.windows(2).position(|pair| are_halves(&pair[0].0, &pair[1].0))
        {
            let (range, film) = self.blocks.remove(left + 1);
            let (block, sum) = &mut self.blocks[left];
            block.end = range.end;
            sum.join(&film);
        }
    }

    /// All samples added up, those of the block that is not complete, too: the picture so far. Pixels that miss samples of
    /// `wanted` are not finished.
    ///
    /// # Errors
    /// There is not enough memory.
    pub fn film(&self, wanted: &Range<u32>) -> Result<Film, Diagnostic> {
        let mut films = self.blocks.iter().chain(&self.begun).map(|(_, film)| film);
        let mut sum = match films.next() {
            Some(film) => film.try_clone()?,
            None => Film::new(self.region, self.layers)?,
        };
        films.for_each(|film| sum.join(film));
        if !self.missing(wanted).is_empty() {
            sum.all_mut().0.iter_mut().for_each(|pixel| pixel.set_finished(false));
        }
        Ok(sum)
    }
}

/// Whether two blocks are the halves of one.
fn are_halves(left: &Range<u32>, right: &Range<u32>) -> bool {
    left.end == right.start
        && left.len() == right.len()
        && blocks_of(left.start..right.end, 1 << 31).len() == 1
}

#[cfg(test)]
mod tests;
