// SPDX-License-Identifier: MIT OR Apache-2.0
//! Which of several surfaces at one place a ray has hit.

use dioptric_geometry::world::Hit;
use dioptric_geometry::{Departure, Ray};

use super::media::{Inside, Media};
use super::point::coincide;
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
    departure: impl FnOnce() -> Option<Departure>,
    hit: Hit,
    inside: Inside,
    spare: &mut Spare,
) -> Option<(Hit, Shading<'a>)> {
    let shading = scene.shading_in(ray, &hit, |finish| match spare.pop() {
        Some(mut answer) => {
            *answer = finish;
            answer
        }
        None => Box::new(finish),
    })?;
    if let Some(around) = media.top(inside).filter(|m| !m.object.same_object(&hit.id)) {
        let id = around.object;
        let departure = departure();
        let departure = departure.as_ref();
        if let Some(exit) =
            scene.world.closest_of(ray, f64::INFINITY, departure, id.instance, id.object)
        {
            let at_exit = scene.shading(ray, &exit)?;
            if coincide(ray, (&hit, &shading), (&exit, &at_exit)) {
                return Some((exit, at_exit));
            }
        }
    }
    Some((hit, shading))
}
