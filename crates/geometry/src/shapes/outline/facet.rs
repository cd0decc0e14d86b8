// SPDX-License-Identifier: MIT OR Apache-2.0
//! A flat part with an outline: where rays pass its plane, and what its filter knows of that. All that most rays
//! need lies together in memory.

use dioptric_math::DVec3;
use dioptric_math::bounds::gamma;

use super::super::convex::plane_root;
use crate::ray::LocalRay;

/// A plane and a filter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Facet<F> {
    /// A point of the plane.
    pub point: DVec3,
    /// Its unit normal.
    pub normal: DVec3,
    /// Bounds the rounding of heights over the plane.
    pub error: f64,
    pub room: Room,
    /// Is asked about points relative to `point`.
    pub filter: F,
}

impl<F> Facet<F> {
    /// Where a ray that does not leave it passes the plane, judged as by [`LocalRay::accept`], and whether it is
    /// inside there, if the filter knows.
    #[inline]
    pub fn pass(
        &self,
        ray: &LocalRay,
        encloses: impl FnOnce(&F, DVec3) -> Option<bool>,
    ) -> Option<(f64, Option<bool>)> {
        let offset = ray.origin - self.point;
        let rate = ray.direction.dot(self.normal);
        let t = plane_root(ray, offset.dot(self.normal), rate, self.error)?;
        let known = if t > 0.0 && self.room.is_enough(offset, ray.direction, t, rate) {
            encloses(&self.filter, offset + ray.direction * t)
        } else {
            None
        };
        Some((t, known))
    }
}

/// The corners' extent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Spread {
    /// A bound on their distance from the plane's point, as the sum of the components.
    pub size: f64,
    /// How far they lie off the plane.
    pub off: f64,
}

impl Spread {
    /// Of corners given relative to a point of the plane. `None` where no filter should be made: numbers that
    /// could leave the range of f32.
    pub fn of(corners: &[DVec3], normal: DVec3) -> Option<Self> {
        let (mut size, mut off) = (0.0_f64, 0.0_f64);
        for p in corners {
            size = size.max(p.abs().element_sum());
            off = off.max(p.dot(normal).abs());
        }
        let off = off + gamma(8) * size;
        (size > 1e-18 && size < 1e18 && off <= size).then_some(Self { size, off })
    }
}

/// How precisely a filter must be asked.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Room {
    /// What does not depend on the ray in the error of a hit.
    base: f64,
    /// Errors up to this do no harm.
    slack: f64,
}

impl Room {
    /// Never enough.
    pub const NONE: Self = Self { base: 0.0, slack: 0.0 };

    pub fn new(spread: Spread, slack: f64) -> Self {
        Self { base: spread.off + gamma(64) * spread.size, slack }
    }

    /// Whether the error of a hit (see the module; sums of components bound lengths) is below the slack. The last
    /// term keeps numbers out that are hardly any. NaN is not enough.
    #[inline]
    fn is_enough(&self, offset: DVec3, direction: DVec3, t: f64, rate: f64) -> bool {
        let step = direction.abs().element_sum();
        let reach = offset.abs().element_sum() + step * t;
        step * (self.base + gamma(64) * reach) + 1e-260 < rate.abs() * self.slack
    }
}
