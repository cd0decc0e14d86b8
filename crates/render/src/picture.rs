// SPDX-License-Identifier: MIT OR Apache-2.0
//! A whole picture of a scene: camera, integrator and job put together.

use dioptric_scene::Diagnostic;
use rayon::ThreadPool;

use crate::film::{Film, FirstHit, Radiance};
use crate::integrator::{
    self,
    recorder::{Recorder, Silent},
};
use crate::job::{self, Control};
use crate::region::Region;
use crate::sampling::{PixelSample, Stream};
use crate::scene::Scene;
use crate::stats::RayCounts;
use dioptric_math::Spectrum;

/// Renders a region of a scene's picture on the threads of `pool`: the same bits for any number of them.
///
/// # Errors
/// There is not enough memory for the film.
pub fn render(
    scene: &Scene,
    region: Region,
    pool: &ThreadPool,
    control: &Control,
) -> Result<Film, Diagnostic> {
    let shoot = |sample: &PixelSample, stream: &mut Stream, counts: &mut RayCounts| {
        shoot(scene, sample, stream, counts, &mut Silent)
    };
    job::render(&scene.settings, region, pool, &shoot, control)
}

/// One camera sample: the ray through its place in the picture, and what it brings.
pub fn shoot<R: Recorder>(
    scene: &Scene,
    sample: &PixelSample,
    stream: &mut Stream,
    counts: &mut RayCounts,
    recorder: &mut R,
) -> Radiance {
    let [width, height] = scene.settings.size.map(f64::from);
    match scene.camera.ray(sample.x / width, sample.y / height, sample.lens) {
        Some(ray) => integrator::radiance(scene, &ray, stream, counts, recorder),
        // The camera sees nothing there (outside of a fisheye's circle).
        None => Radiance { color: Spectrum::ZERO, alpha: 0.0, first: FirstHit::NONE },
    }
}
