// SPDX-License-Identifier: MIT OR Apache-2.0
//! Small convex outlines: a point is inside of all their edges' lines, or outside of one.

use dioptric_math::{DVec3, Vec4, normalize};

use super::super::sheared::Shear;
use super::{Room, Spread, encloses};

/// One in the last place but three of an f32, relative: more than all roundings of one height over an edge, from
/// numbers rounded to f32 (at most 9 of 2^-24 each).
const ROUNDING: f32 = 1.0 / (1u32 << 20) as f32;

/// The edges' half planes, four at a time: `x p.x + y p.y + z p.z + offset` is how far a point of the plane lies
/// inside of an edge.
///
/// The rounding bound: the coefficients are at most 1 (and each 2^-24 of itself off), those of a point `|p|`, so
/// three products, three sums and the roundings to f32 leave an error below `2^-20 (|p| + size)`, the components of
/// `p` added up; underflow adds nothing that counts as [`Spread`] wants `size > 1e-18`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Halves<const GROUPS: usize> {
    groups: [[Vec4; 4]; GROUPS],
    /// How far the edges must be, at a point that has no size itself.
    margin: f32,
}

impl<const GROUPS: usize> Halves<GROUPS> {
    /// For where there is [`Room::NONE`].
    pub const NONE: Self = Self { groups: [[Vec4::ZERO; 4]; GROUPS], margin: 0.0 };

    /// For corners relative to a point of the plane, counterclockwise around `normal`; `None` where the outline
    /// is not convex, has too many corners or next to nothing inside.
    pub fn new(corners: &[DVec3], normal: DVec3, spread: Spread) -> Option<(Room, Self)> {
        let n = corners.len();
        if !(3..=4 * GROUPS).contains(&n) {
            return None;
        }
        let mut groups = Self::NONE.groups;
        let size = spread.size;
        let slack = size * f64::from(2.0 * ROUNDING) + 16.0 * spread.off;
        let middle = corners.iter().sum::<DVec3>() / n as f64;
        for lane in 0..4 * GROUPS {
            let i = lane % n;
            let (a, b) = (*corners.get(i)?, *corners.get((i + 1) % n)?);
            let inward = normalize(normal.cross(b - a))?;
            let offset = -inward.dot(a);
            let height = |p: DVec3| inward.dot(p) + offset;
            // Its own ends too: a line that does not go through them is none of the edge.
            let tolerance = 1e-9 * size;
            let is_side = height(b).abs() <= tolerance
                && inward.dot(normal).abs() <= 1e-9
                && corners.iter().all(|&p| height(p) >= -tolerance);
            if !is_side || !(height(middle) > 4.0 * slack) {
                return None;
            }
            let group = groups.get_mut(lane / 4)?;
            for (row, x) in group.iter_mut().zip([inward.x, inward.y, inward.z, offset]) {
                row[lane % 4] = x as f32;
            }
        }
        // Outlines that go around twice have nothing inside.
        if !encloses(corners, &Shear::new(middle, normal)) {
            return None;
        }
        // 1e-9 size of tolerance are in what the larger power of two leaves.
        let margin = (slack + size * f64::from(2.0 * ROUNDING)) as f32;
        Some((Room::new(spread, slack), Self { groups, margin }))
    }

    /// Whether a point of the plane, for which there is [`Room`], is clearly inside or clearly outside.
    #[inline]
    pub fn encloses(&self, p: DVec3) -> Option<bool> {
        let p = p.as_vec3();
        let margin = self.margin + p.abs().element_sum() * (2.0 * ROUNDING);
        let (margin, outer) = (Vec4::splat(margin), Vec4::splat(-margin));
        let (px, py, pz) = (Vec4::splat(p.x), Vec4::splat(p.y), Vec4::splat(p.z));
        let mut inside = true;
        for [x, y, z, offset] in &self.groups {
            let height = *x * px + *y * py + *z * pz + *offset;
            if height.cmplt(outer).any() {
                return Some(false);
            }
            inside &= height.cmpgt(margin).all();
        }
        inside.then_some(true)
    }
}
