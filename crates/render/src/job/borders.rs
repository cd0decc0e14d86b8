// SPDX-License-Identifier: MIT OR Apache-2.0
//! What is known of the pixels along the edges of tiles, until the tiles beside are there: an eighth of all pixels.

use dioptric_scene::Diagnostic;

use super::adaptive::Summary;
use crate::film::filled;
use crate::region::Region;

/// Summaries of the pixels that lie beside another tile.
pub(super) struct Borders {
    around: Region,
    side: u32,
    /// Of the first and the last row of each row of tiles, one after the other, then the same by columns.
    rows: Vec<Summary>,
    columns: Vec<Summary>,
}

/// Whether a pixel is in the first or last row or column of a tile of this side.
pub(super) fn is_outer(side: u32, pixel: [u32; 2]) -> bool {
    pixel.iter().any(|c| c % side == 0 || c % side == side - 1)
}

impl Borders {
    /// For all tiles of a region.
    ///
    /// # Errors
    /// There is not enough memory.
    pub fn new(around: Region) -> Result<Self, Diagnostic> {
        let Region { x, y, width, height } = around;
        let side = around.tile_side();
        let lines = |length: u32, start: u32, count: u32| {
            let height = 2 * (start.saturating_add(count - 1) / side - start / side + 1);
            filled(&Region { x: 0, y: 0, width: length, height })
        };
        Ok(Self { around, side, rows: lines(width, y, height)?, columns: lines(height, x, width)? })
    }

    /// The summary of a pixel that is kept here.
    pub fn get(&self, pixel: [u32; 2]) -> Option<&Summary> {
        match self.index(pixel)? {
            (true, i) => self.rows.get(i),
            (false, i) => self.columns.get(i),
        }
    }

    /// Keeps a pixel's summary, if it is one of those that are kept here.
    pub fn set(&mut self, pixel: [u32; 2], summary: &Summary) {
        let slot = match self.index(pixel) {
            Some((true, i)) => self.rows.get_mut(i),
            Some((false, i)) => self.columns.get_mut(i),
            None => None,
        };
        if let Some(slot) = slot {
            *slot = *summary;
        }
    }

    /// Which of the lines from `start` on a coordinate is on.
    fn line(&self, at: u32, start: u32) -> Option<usize> {
        let line = 2 * (at / self.side - start / self.side) as usize;
        match at % self.side {
            0 => Some(line),
            within if within == self.side - 1 => Some(line + 1),
            _ => None,
        }
    }

    /// Whether a pixel is on a row, and where it stands among rows or columns.
    fn index(&self, [x, y]: [u32; 2]) -> Option<(bool, usize)> {
        let Region { x: left, y: top, width, height } = self.around;
        self.around.index(x, y)?;
        match self.line(y, top) {
            Some(row) => Some((true, row * width as usize + (x - left) as usize)),
            None => self
                .line(x, left)
                .map(|column| (false, column * height as usize + (y - top) as usize)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{FirstHit, Radiance};
    use dioptric_math::Spectrum;

    #[test]
    fn pixels_beside_other_tiles_are_kept() {
        for around in [
            Region { x: 5, y: 30, width: 70, height: 37 },
            Region { x: 0, y: 0, width: 600, height: 500 },
        ] {
            let side = around.tile_side();
            let mut borders = Borders::new(around).unwrap();
            let summary = |[x, y]: [u32; 2]| {
                let first = FirstHit { object: x + 1000 * y, ..FirstHit::NONE };
                let mut summary = Summary::default();
                summary.add(&Radiance { color: Spectrum::ONE, alpha: 1.0, first });
                summary
            };
            for pixel in around.pixels() {
                borders.set(pixel, &summary(pixel));
            }
            for [x, y] in around.pixels() {
                let on_line = [x, y].iter().any(|c| [0, side - 1].contains(&(c % side)));
                assert_eq!(is_outer(side, [x, y]), on_line);
                let kept = borders.get([x, y]).map(|s| !s.differs(&summary([x, y]), 1.0));
                assert_eq!(kept, on_line.then_some(true), "{x},{y}");
            }
            assert!(borders.get([around.x + around.width, around.y]).is_none());
        }
    }
}
