// SPDX-License-Identifier: MIT OR Apache-2.0
//! What `why` is told of a path's contributions.
//!
//! A contribution has a path class in Heckbert's notation ("Adaptive Radiosity Textures for Bidirectional Ray Tracing",
//! SIGGRAPH 1990): from the light L over surfaces that scatter (D) or are sharp (S), and media that scatter (V), to the
//! eye E.

use dioptric_geometry::HitId;
use dioptric_math::Spectrum;
use serde_json::{Value, json};

use crate::scene::Scene;

/// The surfaces that a path has gone over, a bit each: 1 where it was sharp.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Trail {
    sharp: u64,
    /// The same: 1 where it was no surface but a medium.
    volume: u64,
    count: u32,
}

impl Trail {
    /// One surface more.
    pub fn then(self, sharp: bool) -> Self {
        let bit = if sharp && self.count < u64::BITS { 1 << self.count } else { 0 };
        Self { sharp: self.sharp | bit, count: self.count + 1, ..self }
    }

    /// One turn in a medium more.
    pub fn then_volume(self) -> Self {
        let bit = if self.count < u64::BITS { 1 << self.count } else { 0 };
        Self { volume: self.volume | bit, count: self.count + 1, ..self }
    }

    /// The class of light that arrives by this trail: `LDSE` is scattered first, then mirrored to the eye. What lies
    /// more than 64 surfaces away is written as scattering.
    pub fn class(self) -> String {
        let letter = |i: u32| match i {
            _ if i >= u64::BITS => 'D',
            _ if self.sharp >> i & 1 == 1 => 'S',
            _ if self.volume >> i & 1 == 1 => 'V',
            _ => 'D',
        };
        let surfaces = (0..self.count).rev().map(letter);
        std::iter::once('L').chain(surfaces).chain(std::iter::once('E')).collect()
    }
}

/// Where light came from.
#[derive(Clone, Copy, Debug)]
pub(super) enum What {
    /// A source, by its number.
    Light(u32),
    /// A glowing object.
    Object(HitId),
    /// The background.
    Sky,
    /// Fog.
    Fog,
}

/// A contribution.
#[derive(Clone, Copy, Debug)]
pub(super) struct Told {
    pub name: &'static str,
    what: What,
    trail: Trail,
    /// Its share of all ways to find the same light.
    weight: f64,
    unshadowed: Spectrum,
}

impl Told {
    /// Light that the path met on its way.
    pub fn seen(what: What, trail: Trail, weight: f64) -> Self {
        let name = match what {
            What::Sky => "background",
            What::Fog => "fog",
            What::Light(_) | What::Object(_) => "emission",
        };
        Self { name, what, trail, weight, unshadowed: Spectrum::ZERO }
    }

    /// Light of a source that was asked.
    pub fn asked(what: What, trail: Trail, weight: f64, unshadowed: Spectrum) -> Self {
        Self { name: "light", what, trail, weight, unshadowed }
    }

    /// Its label and details for [`Self::seen`].
    pub fn of_path(&self, scene: &Scene) -> (Option<String>, Value) {
        let detail = json!({"class": self.trail.class(), "found_by": "path", "share": self.weight});
        (self.label(scene), detail)
    }

    /// Its label and details for [`Self::asked`].
    pub fn of_source(
        &self,
        scene: &Scene,
        visibility: Spectrum,
        blocker: Option<HitId>,
    ) -> (Option<String>, Value) {
        let detail = json!({
            "class": self.trail.class(),
            "found_by": "light",
            "share": self.weight,
            "unshadowed": self.unshadowed.to_array(),
            "visibility": visibility.to_array(),
            "blocker": blocker.map(|id| scene.object_label(id)),
        });
        (self.label(scene), detail)
    }

    fn label(&self, scene: &Scene) -> Option<String> {
        match self.what {
            What::Light(source) => scene.sources.label(scene, source),
            What::Object(id) => Some(scene.object_label(id)),
            What::Sky | What::Fog => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn classes_are_read_from_the_light_to_the_eye() {
        let trail = Trail::default();
        assert_eq!(trail.class(), "LE");
        assert_eq!(trail.then(true).then(false).class(), "LDSE");
        assert_eq!(trail.then_volume().then(true).then_volume().class(), "LVSVE");
        let long = (0..70).fold(trail, |trail, _| trail.then(true));
        assert_eq!(long.class(), format!("L{}{}E", "D".repeat(6), "S".repeat(64)));
    }
}
