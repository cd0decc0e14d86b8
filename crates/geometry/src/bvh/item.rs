// SPDX-License-Identifier: MIT OR Apache-2.0
//! What a tree is built over: boxes in single precision with the numbers of what they hold.

use dioptric_math::{DVec3, Vec4};

use crate::bounds::Bounds;

/// A box in single precision, about the tree's centre. The fourth numbers mean nothing.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Box32 {
    pub(super) min: Vec4,
    pub(super) max: Vec4,
}

impl Box32 {
    pub(super) const EMPTY: Self = Self { min: Vec4::INFINITY, max: Vec4::NEG_INFINITY };

    /// One step further out than the nearest f32, which also covers the subtraction's rounding.
    pub(super) fn around(b: &Bounds, center: DVec3) -> Self {
        let [x, y, z] = (b.min - center).to_array().map(|x| (x as f32).next_down());
        let min = Vec4::new(x, y, z, 0.0);
        let [x, y, z] = (b.max - center).to_array().map(|x| (x as f32).next_up());
        Self { min, max: Vec4::new(x, y, z, 0.0) }
    }

    pub(super) fn is_finite(&self) -> bool {
        // Also false where a corner is NaN.
        self.min.is_finite() && self.max.is_finite()
    }

    #[inline(always)]
    pub(super) fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// The largest coordinate.
    pub(super) fn largest(&self) -> f64 {
        f64::from(self.min.abs().max(self.max.abs()).truncate().max_element())
    }

    /// The box's middle; halves first, so that it cannot overflow.
    #[inline(always)]
    pub(super) fn center(&self) -> Vec4 {
        self.min * 0.5 + self.max * 0.5
    }

    /// Half the surface, in f64 so that few scales overflow; 0 where empty.
    #[inline(always)]
    pub(super) fn half_area(&self) -> f64 {
        let [x, y, z, _] = (self.max - self.min).max(Vec4::ZERO).to_array().map(f64::from);
        x * y + y * z + z * x
    }
}

/// What a tree is built over: a box about the tree's centre, and a number; eight words, so that memory for them
/// need not be cleared.
pub(crate) type Item = [f32; 8];

/// The number is kept among the coordinates; with this bit it is one that no sum takes long with.
const NUMBER: u32 = 1 << 30;

/// Makes an item. The box is finite and not empty, `number` below [`Bvh::MAX_ITEMS`] or anything for one that
/// stands alone.
#[inline(always)]
pub(crate) fn item(min: [f32; 3], max: [f32; 3], number: u32) -> Item {
    let number = f32::from_bits(number & (NUMBER - 1) | NUMBER);
    [min[0], min[1], min[2], number, max[0], max[1], max[2], 0.0]
}

/// The item of a box; `None` where the box is empty, or not finite in single precision.
pub(crate) fn item_around(bounds: &Bounds, center: DVec3, number: u32) -> Option<Item> {
    let b = Box32::around(bounds, center);
    (!bounds.is_empty() && b.is_finite())
        .then(|| item(b.min.truncate().to_array(), b.max.truncate().to_array(), number))
}

/// The number of an item.
#[inline(always)]
pub(crate) fn number(item: &Item) -> u32 {
    item[3].to_bits() & (NUMBER - 1)
}

/// The largest extent of an item along an axis.
#[inline(always)]
pub(crate) fn extent(item: &Item) -> f32 {
    (item[4] - item[0]).max(item[5] - item[1]).max(item[6] - item[2])
}

#[inline(always)]
pub(super) fn box_of(item: &Item) -> Box32 {
    let [a, b, c, d, e, f, g, h] = *item;
    Box32 { min: Vec4::new(a, b, c, d), max: Vec4::new(e, f, g, h) }
}
