// SPDX-License-Identifier: MIT OR Apache-2.0
//! How much work a picture was: rays by kind. A ray is one query of the BVH.

use serde::Serialize;

/// Rays by kind.
#[derive(Clone, Copy, Default, Debug, PartialEq, Eq, Serialize)]
pub struct RayCounts {
    /// From the camera.
    pub camera: u64,
    /// Towards lights.
    pub shadow: u64,
    /// Reflected at surfaces.
    pub reflect: u64,
    /// Refracted at surfaces, and straight on through transparent ones.
    pub refract: u64,
    /// Within a transparent object, on the way to its exit.
    pub inside: u64,
}

impl RayCounts {
    /// Adds the counts of other work.
    pub fn add(&mut self, other: &Self) {
        self.camera += other.camera;
        self.shadow += other.shadow;
        self.reflect += other.reflect;
        self.refract += other.refract;
        self.inside += other.inside;
    }

    /// Rays of all kinds.
    #[must_use]
    pub fn total(&self) -> u64 {
        self.camera + self.shadow + self.reflect + self.refract + self.inside
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_is_added_and_counted() {
        let one = RayCounts { camera: 1, shadow: 10, reflect: 100, refract: 1000, inside: 10000 };
        let mut sum = one;
        sum.add(&one);
        assert_eq!(sum.total(), 22222);
    }
}
