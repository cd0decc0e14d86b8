// SPDX-License-Identifier: MIT OR Apache-2.0
//! From a camera's ray to radiance.

mod dielectric;
pub mod direct;
pub mod media;
pub mod optics;
pub mod passage;
mod point;
pub mod recorder;
mod shadow;
pub mod view;
pub mod whitted;

use dioptric_geometry::Ray;

use crate::film::Radiance;
use crate::sampling::stream::Stream;
use crate::scene::Scene;
use crate::setting::render::Integrator;
use crate::stats::RayCounts;
use recorder::Recorder;

/// The radiance of one camera ray, by the integrator that the scene's settings name.
pub fn radiance<R: Recorder>(
    scene: &Scene,
    ray: &Ray,
    stream: &mut Stream,
    counts: &mut RayCounts,
    recorder: &mut R,
) -> Radiance {
    match scene.settings.integrator {
        Integrator::Whitted => whitted::Whitted::new(scene, stream, counts, recorder).radiance(ray),
        other => view::radiance(other, scene, ray, stream, counts, recorder),
    }
}
