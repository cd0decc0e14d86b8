// SPDX-License-Identifier: MIT OR Apache-2.0
//! Places that send light, for ways that do not lead there straight on.

use dioptric_geometry::world::Hit;
use dioptric_geometry::{HitId, SurfacePoint};
use dioptric_math::{DVec3, Spectrum};

use super::emitter::Emitter;
use super::patch::{Found, Met};
use super::{NONE, Shining, Sources};
use crate::scene::Scene;

/// A place of a glowing object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Unit vector towards it.
    pub direction: DVec3,
    /// How far it is.
    pub distance: f64,
    /// Its unit normal, on either side.
    pub normal: DVec3,
    /// What it sends.
    pub radiance: Spectrum,
    /// The density over solid angles with which it is found.
    pub density: f64,
    /// Its source's number in [`Sources`].
    pub source: u32,
}

impl Sources {
    /// The glowing objects, or parts of them, that send the most to a point: their emitters, with each its share. At most
    /// `most`.
    #[must_use]
    pub fn brightest(&self, point: DVec3, most: usize) -> Vec<(u32, f64)> {
        let emitters = (0..).map_while(|i| Some((i, self.choice.emitter(i)?)));
        let glowing =
            emitters.filter(|(_, e)| matches!(e, Emitter::Glow(glow) if glow.patch.has_places()));
        let mut all: Vec<(u32, f64)> = glowing.map(|(i, e)| (i, e.weight(point, None))).collect();
        all.retain(|(_, weight)| *weight > 0.0);
        all.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        all.truncate(most);
        let sum: f64 = all.iter().map(|(_, weight)| weight).sum();
        all.iter().map(|(i, weight)| (*i, weight / sum)).collect()
    }

    /// A place of an emitter of [`Self::brightest`], as a point sees it, for uniform `u`.
    #[must_use]
    pub fn place(&self, scene: &Scene, emitter: u32, point: DVec3, u: [f64; 2]) -> Option<Place> {
        let Emitter::Glow(glow) = self.choice.emitter(emitter)? else { return None };
        let found = glow.patch.place(point, u)?;
        let radiance = glow.radiance(scene, point, &found);
        let Found { direction, distance, normal, density, .. } = found;
        let source = *self.source_of.get(emitter as usize)?;
        let usable = density > 0.0 && density < f64::INFINITY && radiance.is_finite();
        usable.then_some(Place { direction, distance, normal, radiance, density, source })
    }

    /// The emitter that a ray hit, and the density with which [`Self::place`] finds that place of it as `point` sees it
    /// along the unit vector `direction`.
    #[must_use]
    pub fn density_of_place(
        &self,
        point: DVec3,
        hit: &Hit,
        surface: &SurfacePoint,
        direction: DVec3,
    ) -> Option<(u32, f64)> {
        let emitter = match self.objects.get(hit.id.object as usize)? {
            _ if hit.id.instance != HitId::NO_INSTANCE => NONE,
            Shining::Not => NONE,
            Shining::Whole(emitter) => *emitter,
            Shining::Parts(first) => *self.parts.get(*first as usize + hit.id.part as usize)?,
        };
        let Emitter::Glow(glow) = self.choice.emitter(emitter)? else { return None };
        let distance = (surface.point - point).length();
        let met = Met { direction, distance, normal: surface.normal };
        Some((emitter, glow.patch.density_of_place(point, &met)))
    }

    /// How far a ray may go that must not reach a place at this distance, with this normal.
    #[must_use]
    pub fn short_of(
        &self,
        emitter: u32,
        from: DVec3,
        direction: DVec3,
        distance: f64,
        normal: DVec3,
    ) -> f64 {
        match self.choice.emitter(emitter) {
            Some(Emitter::Glow(glow)) => {
                glow.reach.short_of(glow.rounding, from, &direction, distance, normal)
            }
            _ => distance,
        }
    }
}
