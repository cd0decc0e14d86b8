// SPDX-License-Identifier: MIT OR Apache-2.0
//! Axis-aligned boxes.

use dioptric_math::DVec3;

/// All points `p` with `min <= p <= max`; empty where some `min > max`; may be infinite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Smallest corner.
    pub min: DVec3,
    /// Largest corner.
    pub max: DVec3,
}

impl Bounds {
    /// No point at all.
    pub const EMPTY: Self = Self { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY };
    /// All of space.
    pub const EVERYTHING: Self = Self { min: DVec3::NEG_INFINITY, max: DVec3::INFINITY };

    /// The smallest box around some points.
    #[must_use]
    pub fn of(points: impl IntoIterator<Item = DVec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, |b, p| Self { min: b.min.min(p), max: b.max.max(p) })
    }

    /// The smallest box around both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// The points in both.
    #[must_use]
    pub fn intersection(self, other: Self) -> Self {
        Self { min: self.min.max(other.min), max: self.max.min(other.max) }
    }

    /// Whether it holds no point (NaN counts as none).
    #[must_use]
    pub fn is_empty(&self) -> bool {
        !(self.min.x <= self.max.x && self.min.y <= self.max.y && self.min.z <= self.max.z)
    }

    /// Whether all corners are finite.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        self.min.is_finite() && self.max.is_finite()
    }

    /// The middle of a finite box.
    #[must_use]
    pub fn center(&self) -> DVec3 {
        self.min * 0.5 + self.max * 0.5
    }

    /// Edge lengths.
    #[must_use]
    pub fn size(&self) -> DVec3 {
        self.max - self.min
    }

    /// The eight corners of a finite box.
    #[must_use]
    pub fn corners(&self) -> [DVec3; 8] {
        std::array::from_fn(|i| {
            DVec3::new(
                if i & 1 == 0 { self.min.x } else { self.max.x },
                if i & 2 == 0 { self.min.y } else { self.max.y },
                if i & 4 == 0 { self.min.z } else { self.max.z },
            )
        })
    }
}

/// Where a tree over boxes has its origin: in the middle of them all, or where most of them are, if that is far from there
/// because of a huge one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Middle {
    sum: DVec3,
    count: f64,
}

impl Middle {
    /// Of no boxes.
    pub const NONE: Self = Self { sum: DVec3::ZERO, count: 0.0 };

    /// Adds a box that is finite and not empty.
    #[inline]
    pub fn add(&mut self, b: &Bounds) {
        self.sum += b.center();
        self.count += 1.0;
    }

    /// Adds the sums of what follows.
    pub fn and(self, other: Self) -> Self {
        Self { sum: self.sum + other.sum, count: self.count + other.count }
    }

    /// The place for boxes within `bounds`; 0 without any.
    pub fn of(&self, bounds: &Bounds) -> DVec3 {
        if bounds.is_empty() {
            return DVec3::ZERO;
        }
        let (mean, middle) = (self.sum / self.count, bounds.center());
        // False where the sum is too large for a number.
        let far = (mean - middle).abs().max_element() > 0.25 * bounds.size().max_element();
        if far && mean.is_finite() { mean } else { middle }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn trees_begin_where_most_boxes_are() {
        let around = |boxes: &[Bounds]| {
            let mut middle = Middle::NONE;
            boxes.iter().for_each(|b| middle.add(b));
            middle.of(&boxes.iter().fold(Bounds::EMPTY, |all, b| all.union(*b)))
        };
        let cube =
            |x: f64, half: f64| Bounds { min: DVec3::X * x - half, max: DVec3::X * x + half };
        let mut boxes: Vec<_> = (0..100).map(|i| cube(f64::from(i), 0.5)).collect();
        boxes.push(cube(100.0, 0.5));
        assert_eq!(around(&boxes), DVec3::X * 50.0);
        boxes.push(cube(-1e6, 1e6));
        assert!((around(&boxes).x + 1e6 / 102.0).abs() < 100.0);
        assert_eq!(around(&[cube(1e308, 1.0), cube(1e308, 1.0)]), DVec3::X * 1e308);
        assert_eq!(around(&[]), DVec3::ZERO);
    }
}
