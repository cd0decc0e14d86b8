// SPDX-License-Identifier: MIT OR Apache-2.0
//! The transparent objects that a ray is inside of, innermost last.

use dioptric_geometry::HitId;
use dioptric_math::{Spectrum, exp};

/// One transparent object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Medium {
    /// A hit on it: which object of which instance.
    pub object: HitId,
    /// Its index of refraction.
    pub ior: f64,
    /// What it absorbs per unit of the file.
    pub absorption: Spectrum,
}

/// How many objects may be nested around a ray; deeper ones are not remembered.
const CAPACITY: usize = 16;

/// A small stack, cheap to copy along a tree of rays.
#[derive(Clone, Copy, Debug)]
pub struct MediumStack {
    items: [Option<Medium>; CAPACITY],
    len: usize,
    /// Index of refraction outside of all objects.
    around: f64,
}

impl MediumStack {
    /// Outside of everything, in a space with this index of refraction.
    #[must_use]
    pub const fn outside(around: f64) -> Self {
        Self { items: [None; CAPACITY], len: 0, around }
    }

    /// The innermost object.
    #[must_use]
    pub fn top(&self) -> Option<&Medium> {
        self.items[..self.len].last().and_then(Option::as_ref)
    }

    /// Index of refraction where the ray is.
    #[must_use]
    pub fn ior(&self) -> f64 {
        self.top().map_or(self.around, |m| m.ior)
    }

    /// Whether the ray is inside this object.
    #[must_use]
    pub fn contains(&self, object: &HitId) -> bool {
        self.items[..self.len].iter().flatten().any(|m| m.object.same_object(object))
    }

    /// With one more object around the ray.
    #[must_use]
    pub fn entered(mut self, medium: Medium) -> Self {
        if self.len < CAPACITY {
            self.items[self.len] = Some(medium);
            self.len += 1;
        }
        self
    }

    /// Without the innermost entry of this object.
    #[must_use]
    pub fn left(mut self, object: &HitId) -> Self {
        let found = (0..self.len)
            .rev()
            .find(|&i| self.items[i].is_some_and(|m| m.object.same_object(object)));
        if let Some(i) = found {
            self.items.copy_within(i + 1..self.len, i);
            self.len -= 1;
        }
        self
    }
}

/// What is left of light after a distance in an absorbing medium (Beer and Lambert). A lane that
/// absorbs nothing stays 1 over an infinite distance.
#[must_use]
pub fn absorbed(absorption: Spectrum, distance: f64) -> Spectrum {
    if absorption == Spectrum::ZERO {
        return Spectrum::ONE;
    }
    let lane = |a: f64| if a > 0.0 { exp(-a * distance) } else { 1.0 };
    Spectrum::from(absorption.to_array().map(lane))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn medium(object: u32, ior: f64) -> Medium {
        Medium { object: HitId { instance: 0, object, part: 0 }, ior, absorption: Spectrum::ZERO }
    }

    #[test]
    fn leaving_in_any_order_restores_the_outer_medium() {
        let both = MediumStack::outside(1.0).entered(medium(1, 1.5)).entered(medium(2, 1.33));
        assert_eq!(both.ior(), 1.33);
        assert_eq!(both.left(&medium(2, 0.0).object).ior(), 1.5);
        assert_eq!(both.left(&medium(1, 0.0).object).ior(), 1.33);
        assert_eq!(both.left(&medium(3, 0.0).object).ior(), 1.33);
        assert_eq!(both.left(&medium(1, 0.0).object).left(&medium(2, 0.0).object).ior(), 1.0);
    }

    #[test]
    fn a_full_stack_forgets_instead_of_failing() {
        let mut stack = MediumStack::outside(1.0);
        for i in 0..100 {
            stack = stack.entered(medium(i, 1.5));
        }
        assert!(stack.contains(&medium(0, 0.0).object) && !stack.contains(&medium(99, 0.0).object));
    }
}
