// SPDX-License-Identifier: MIT OR Apache-2.0
//! What the camera is inside of: an aquarium, a glass ball.

use dioptric_geometry::world::Hit;

use crate::integrator::media::Medium;
use crate::material::Optics;
use crate::scene::Scene;

/// The transparent solids around the camera, the innermost last: those that the ray through the middle of
/// the picture leaves before it enters them. The one that it leaves last is the outermost.
///
/// Found once for a picture, from the middle of the lens.
pub(super) fn around_camera(scene: &Scene) -> Vec<Medium> {
    let Some(ray) = scene.camera.ray(0.5, 0.5, [0.5; 2]) else { return Vec::new() };
    let mut hits = Vec::new();
    scene.world.hits(&ray, f64::INFINITY, None, &mut hits);
    let mut left: Vec<Hit> = Vec::new();
    for (i, hit) in hits.iter().enumerate() {
        if hits[..i].iter().all(|h| !h.id.same_object(&hit.id)) {
            left.push(*hit);
        }
    }
    let mut around = Vec::new();
    let mut ior = scene.surroundings.ior;
    for hit in left.iter().rev() {
        let Some(shading) = scene.shading(&ray, hit) else { continue };
        let solid = scene.world.shape(hit.id.object).is_some_and(|s| s.is_solid());
        if !solid || shading.surface.normal.dot(ray.direction) <= 0.0 {
            continue;
        }
        let (inner, absorption) = match shading.finish.optics {
            // Relative to what is around it.
            Optics::Shares { ior: relative, absorption, .. } => (ior * relative, absorption),
            other => match other.bends() {
                Some(known) => known,
                None => continue,
            },
        };
        ior = inner;
        let absorption = scene.extinction(hit.id, absorption);
        let priority = scene.interior(hit.id).priority;
        around.push(Medium { object: hit.id, ior, absorption, priority });
    }
    around
}
