// SPDX-License-Identifier: MIT OR Apache-2.0
//! Which of several surfaces a ray has hit: holes are passed, and of surfaces at one place one counts.

use dioptric_geometry::Ray;
use dioptric_geometry::world::{Hit, Query};

use super::media::{Inside, Media};
use super::point::{coincide, touches};
use crate::material::Finish;
use crate::scene::{Scene, Shading};

/// Boxes for answers that are used again.
pub(super) type Spare = Vec<Box<Finish>>;

/// The hit that counts, and what is needed to shade it. Inside of a transparent object its own surface comes before
/// any other that coincides with it: the exit belongs to the object that was entered.
#[inline(always)]
pub(super) fn resolve<'a>(
    scene: &'a Scene,
    media: &Media,
    ray: &Ray,
    query: impl Fn() -> Query,
    hit: Hit,
    inside: Inside,
    spare: &mut Spare,
) -> Option<(Hit, Shading<'a>)> {
    let mut hit = hit;
    let mut shading = scene.shading_in(ray, &hit, |finish| match spare.pop() {
        Some(mut answer) => {
            *answer = finish;
            answer
        }
        None => Box::new(finish),
    })?;
    if !shading.finish.present {
        (hit, shading) = scene.behind_hole(&query(), &hit)?;
    }
    if let Some(around) = media.top(inside).filter(|m| !m.object.same_object(&hit.id)) {
        let id = around.object;
        let departure = query().departure();
        let departure = departure.as_ref();
        if let Some(exit) =
            scene.world.closest_of(ray, f64::INFINITY, departure, id.instance, id.object)
        {
            let at_exit = scene.shading(ray, &exit)?;
            if at_exit.finish.present && coincide(ray, (&hit, &shading), (&exit, &at_exit)) {
                return Some((exit, at_exit));
            }
        }
    }
    Some((hit, shading))
}

impl Scene {
    /// What a ray meets that has met a hole: the first thing behind it that is there. The ray stays the same one, so
    /// that whatever was known of its origin and direction holds for what it meets.
    #[cold]
    pub(super) fn behind_hole(&self, query: &Query, hole: &Hit) -> Option<(Hit, Shading<'_>)> {
        let (ray, departure, contacts) = (&query.ray, query.departure(), query.contacts());
        let mut hits = Vec::new();
        self.world.hits(ray, query.t_max, departure.as_ref(), &mut hits);
        for hit in hits.into_iter().filter(|hit| hit.t >= hole.t) {
            let Some(shading) = self.shading(ray, &hit).filter(|s| s.finish.present) else {
                continue;
            };
            // What touches the origin is met or not as for any ray.
            let own = departure.is_some_and(|d| d.from.same_object(&hit.id));
            let left = departure.is_some() && !own && !contacts.crosses(&hit.id);
            if !(left && touches(ray, &hit, &shading.surface)) {
                return Some((hit, shading));
            }
        }
        None
    }
}
