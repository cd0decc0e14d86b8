// SPDX-License-Identifier: MIT OR Apache-2.0
//! Rectangles of pixels of the full picture: crops and tiles.

use dioptric_scene::Diagnostic;

/// Side of a tile in pixels: small enough to share work evenly, large enough to make little fuss.
pub const TILE: u32 = 32;

/// Of fewer pixels than this tiles are half as wide and high, so that many threads share them evenly, too.
const SMALL: u64 = 1 << 18;

/// A rectangle of pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Region {
    /// First column.
    pub x: u32,
    /// First row, from the top.
    pub y: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

impl Region {
    /// The whole of a picture.
    #[must_use]
    pub const fn full(size: [u32; 2]) -> Self {
        Self { x: 0, y: 0, width: size[0], height: size[1] }
    }

    /// A crop of a picture of this size.
    ///
    /// # Errors
    /// It is empty or not wholly inside the picture.
    pub fn crop(size: [u32; 2], [x, y, width, height]: [u32; 4]) -> Result<Self, Diagnostic> {
        let region = Self { x, y, width, height };
        let inside = |start: u32, length: u32, size: u32| {
            length > 0 && start.checked_add(length).is_some_and(|end| end <= size)
        };
        if inside(x, width, size[0]) && inside(y, height, size[1]) {
            return Ok(region);
        }
        let message = format!(
            "the crop {x},{y},{width},{height} does not lie inside the picture of {} x {} pixels",
            size[0], size[1]
        );
        Err(Diagnostic::error("wrong-crop", message)
            .help("give its left column, top row, width and height"))
    }

    /// Number of pixels.
    #[must_use]
    pub fn area(&self) -> u64 {
        u64::from(self.width) * u64::from(self.height)
    }

    /// Where a pixel of the full picture stands in this region, counted row by row.
    #[must_use]
    pub fn index(&self, x: u32, y: u32) -> Option<usize> {
        let (column, row) = (x.checked_sub(self.x)?, y.checked_sub(self.y)?);
        (column < self.width && row < self.height)
            .then(|| row as usize * self.width as usize + column as usize)
    }

    /// The pixels, row by row from the top left.
    pub fn pixels(&self) -> impl Iterator<Item = [u32; 2]> + use<> {
        let Self { x, y, width, height } = *self;
        (0..height).flat_map(move |row| (0..width).map(move |column| [x + column, y + row]))
    }

    /// This region and the pixels around it that a picture of this size has.
    #[must_use]
    pub fn grown(&self, size: [u32; 2]) -> Self {
        let grow = |start: u32, length: u32, size: u32| {
            let first = start.saturating_sub(1);
            (first, start.saturating_add(length).saturating_add(1).min(size).saturating_sub(first))
        };
        let (x, width) = grow(self.x, self.width, size[0]);
        let (y, height) = grow(self.y, self.height, size[1]);
        Self { x, y, width, height }
    }

    /// The side of the tiles of which this region is made.
    pub(crate) fn tile_side(&self) -> u32 {
        if self.area() < SMALL { TILE / 2 } else { TILE }
    }

    /// The tiles of which this region is made, row by row. Their edges lie where those of the full
    /// picture's tiles do.
    #[must_use]
    pub fn tiles(&self) -> Vec<Self> {
        let side = self.tile_side();
        let cut = |start: u32, length: u32| {
            let end = start.saturating_add(length);
            let mut parts = Vec::new();
            let mut from = start;
            while from < end {
                let to = (from / side).saturating_add(1).saturating_mul(side).min(end);
                parts.push((from, to - from));
                from = to;
            }
            parts
        };
        let columns = cut(self.x, self.width);
        cut(self.y, self.height)
            .into_iter()
            .flat_map(|(y, height)| {
                columns.iter().map(move |&(x, width)| Self { x, y, width, height })
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_cover_every_pixel_once() {
        for region in [
            Region { x: 0, y: 0, width: 1, height: 1 },
            Region { x: 5, y: 30, width: 70, height: 33 },
            Region::full([64, 48]),
            Region { x: 7, y: 1, width: 600, height: 500 },
        ] {
            let mut seen = vec![0; region.area() as usize];
            for tile in region.tiles() {
                assert!(tile.width <= TILE && tile.height <= TILE && tile.area() > 0);
                for [x, y] in tile.pixels() {
                    seen[region.index(x, y).unwrap()] += 1;
                }
            }
            assert!(seen.iter().all(|&n| n == 1), "{region:?}");
        }
    }

    #[test]
    fn crops_lie_inside() {
        let size = [100, 50];
        assert!(Region::crop(size, [0, 0, 100, 50]).is_ok());
        for crop in [[0, 0, 101, 50], [100, 0, 1, 1], [0, 0, 0, 1], [u32::MAX, 0, 2, 1]] {
            assert!(Region::crop(size, crop).is_err(), "{crop:?}");
        }
        assert_eq!(
            Region::crop(size, [90, 40, 20, 10]).unwrap_err().message,
            "the crop 90,40,20,10 does not lie inside the picture of 100 x 50 pixels"
        );
    }

    #[test]
    fn growing_stops_at_the_pictures_edges() {
        let grown = |x, y, width, height| Region { x, y, width, height }.grown([100, 50]);
        assert_eq!(grown(0, 0, 100, 50), Region::full([100, 50]));
        assert_eq!(grown(0, 9, 1, 1), Region { x: 0, y: 8, width: 2, height: 3 });
        assert_eq!(grown(99, 49, 1, 1), Region { x: 98, y: 48, width: 2, height: 2 });
    }
}
