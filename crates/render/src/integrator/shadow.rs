// SPDX-License-Identifier: MIT OR Apache-2.0
//! What lies between a point and a light, and how much of the light each thing lets pass.

use dioptric_geometry::world::{Hit, Query};
use dioptric_geometry::{Contacts, HitId, Ray, SurfacePoint};
use dioptric_math::{DVec3, Spectrum};

use super::media::absorbed;
use super::point::touches_at;
use crate::material::{Finish, Optics};
use crate::scene::Scene;

/// Where a way to a light begins.
pub(super) struct Start<'a> {
    pub ray: &'a Ray,
    /// What it leaves; nothing in the midst of a medium.
    pub from: Option<HitId>,
    pub contacts: Contacts,
}

impl<'a> Start<'a> {
    /// Of a question what lies between.
    pub fn of(query: &'a Query) -> Self {
        let from = query.departure().map(|d| d.from);
        Self { ray: &query.ray, from, contacts: query.contacts() }
    }

    /// Whether a surface only touches the point that is left.
    pub fn stays_off(&self, hit: &Hit, surface: &SurfacePoint) -> bool {
        self.stays_off_at(hit, surface.normal, surface.error)
    }

    /// The same of a surface with this normal, whose point has an error within this bound.
    fn stays_off_at(&self, hit: &Hit, normal: DVec3, error: f64) -> bool {
        let own = self.from.is_some_and(|from| hit.id.same_object(&from));
        !own && !self.contacts.crosses(&hit.id) && touches_at(self.ray, hit.t, normal, error)
    }
}

impl Scene {
    /// What passes of a light before `distance`, by the passages that are [`World::hits`]: what things let through where
    /// shadows are tinted, else all or nothing.
    ///
    /// [`World::hits`]: dioptric_geometry::World::hits
    pub(super) fn passes<'a>(
        &self,
        start: &Start,
        distance: f64,
        tinted: bool,
        hits: impl Iterator<Item = &'a Hit> + Clone,
    ) -> Spectrum {
        let mut passed = Spectrum::ONE;
        self.passages(start, distance, hits, |_, factor| {
            passed *= if tinted { factor } else { Spectrum::ZERO };
            passed != Spectrum::ZERO
        });
        passed
    }

    /// The answer of a polygon's material that is the same everywhere, with the polygon's normal and a bound on the errors of
    /// its points: all that a way to a light needs of it.
    #[inline(always)]
    fn plain_pane(&self, hit: &Hit) -> Option<(&Finish, DVec3, f64)> {
        let (normal, error) = self.world.pane(&hit.id)?;
        Some((self.uniform(hit.id)?, normal, error))
    }

    /// Calls `each` with every passage through a surface that is there before `distance`, nearest first, and the share
    /// of light that passes there, until it returns false. The product of all shares is the light's
    /// visibility where shadows are tinted.
    ///
    /// A solid counts once, where the ray enters it, or leaves it if it starts inside; where it leaves, with
    /// the absorption of the way through. An open surface counts each time.
    pub(super) fn passages<'a>(
        &self,
        start: &Start,
        distance: f64,
        hits: impl Iterator<Item = &'a Hit> + Clone,
        mut each: impl FnMut(&Hit, Spectrum) -> bool,
    ) {
        let ray = start.ray;
        for (i, hit) in hits.clone().enumerate().filter(|(_, h)| h.t < distance) {
            if let Some((finish, normal, error)) = self.plain_pane(hit) {
                if !finish.present || start.stays_off_at(hit, normal, error) {
                    continue;
                }
                if !each(hit, finish.shadow_pass) {
                    return;
                }
                continue;
            }
            let Some(shading) = self.shading(ray, hit) else { continue };
            if start.stays_off(hit, &shading.surface) {
                continue;
            }
            let finish = &shading.finish;
            if !finish.present {
                continue;
            }
            let solid = self.world.shape(hit.id.object).is_some_and(|s| s.is_solid());
            let enters = shading.surface.normal.dot(ray.direction) < 0.0;
            let passed = if !solid || enters {
                finish.shadow_pass
            } else {
                let before = hits.clone().take(i);
                let entry = before.filter(|h| h.id.same_object(&hit.id)).last();
                // The way out costs nothing more, unless it is through another part, which is opaque.
                let counted = entry.is_some() && finish.shadow_pass != Spectrum::ZERO;
                let surface = if counted { Spectrum::ONE } else { finish.shadow_pass };
                surface * self.absorbed_inside(hit.id, finish, hit.t - entry.map_or(0.0, |h| h.t))
            };
            if !each(hit, passed) {
                break;
            }
        }
    }

    /// What a way inside of an object leaves of light, `t` in the space of rays.
    fn absorbed_inside(&self, id: HitId, finish: &Finish, t: f64) -> Spectrum {
        match finish.optics {
            Optics::Shares { absorption, .. } | Optics::Dielectric { absorption, .. } => {
                absorbed(self.extinction(id, absorption), t / self.root.scale())
            }
            Optics::Opaque | Optics::Mirror { .. } | Optics::Layered(_) => Spectrum::ONE,
        }
    }
}
