// SPDX-License-Identifier: MIT OR Apache-2.0
//! From cameras' rays to radiances.

mod dielectric;
pub mod direct;
mod front;
mod layered;
mod lit;
pub mod media;
pub mod optics;
pub mod passage;
pub mod path;
mod point;
mod record;
pub mod recorder;
mod resolve;
mod shadow;
mod shine;
mod told;
mod tree;
pub mod view;
pub mod whitted;

use std::sync::atomic::{AtomicBool, Ordering};

use dioptric_geometry::Ray;

use crate::film::Radiance;
use crate::sampling::stream::Stream;
use crate::scene::Scene;
use crate::setting::render::Integrator;
use crate::stats::RayCounts;
use recorder::Recorder;

/// The radiances of camera rays, by the integrator that the scene's settings name; each is the same in every
/// batch. Where the camera sees nothing there is no ray, and nothing is what it brings. Fewer than rays if
/// cancelled meanwhile.
pub fn radiances<R: Recorder>(
    scene: &Scene,
    rays: impl ExactSizeIterator<Item = Option<(Ray, Stream)>>,
    counts: &mut RayCounts,
    recorder: &mut R,
    cancel: &AtomicBool,
) -> Vec<Radiance> {
    match scene.settings.integrator {
        Integrator::Whitted => {
            whitted::Whitted::new(scene, counts, recorder).radiances(rays, cancel)
        }
        Integrator::Path => path::Paths::new(scene, counts, recorder).radiances(rays, cancel),
        other => rays
            .take_while(|_| !cancel.load(Ordering::Relaxed))
            .map(|ray| match ray {
                Some((ray, stream)) => view::radiance(other, scene, &ray, stream, counts, recorder),
                None => Radiance::NOTHING,
            })
            .collect(),
    }
}
