// SPDX-License-Identifier: MIT OR Apache-2.0
//! A whole picture of a scene: camera, integrator and job put together.

use std::sync::atomic::AtomicBool;

use dioptric_geometry::Ray;
use dioptric_scene::Diagnostic;
use rayon::ThreadPool;

use crate::film::{Film, Radiance};
use crate::integrator::{
    self,
    path::Paths,
    recorder::{Recorder, Silent},
    whitted::Whitted,
};
use crate::job::{self, Control, Shoot, Shot};
use crate::noise::{self, Goal, Reached};
use crate::parts::{self, Part, Wanted};
use crate::region::Region;
use crate::sampling::{PixelSample, Stream};
use crate::scene::Scene;
use crate::setting::render::Integrator;
use crate::stats::RayCounts;

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
    job::render(&scene.settings, region, pool, &Camera { scene }, control)
}

/// Makes the samples of a range that a part of a scene's picture misses: see [`parts::render`].
///
/// # Errors
/// There is not enough memory.
pub fn render_part(
    scene: &Scene,
    wanted: &Wanted,
    part: &mut Part,
    pool: &ThreadPool,
    control: &Control,
    watch: &(dyn Fn(&parts::Progress<'_>) + Sync),
) -> Result<bool, Diagnostic> {
    parts::render(&scene.settings, wanted, part, pool, &Camera { scene }, control, watch)
}

/// Renders a region of a scene's picture until its error is small enough: see [`noise::render`].
///
/// # Errors
/// There is not enough memory.
pub fn render_until(
    scene: &Scene,
    goal: &Goal,
    region: Region,
    pool: &ThreadPool,
    control: &Control,
    go_on: &dyn Fn(u64) -> bool,
) -> Result<(Film, Reached), Diagnostic> {
    noise::render(&scene.settings, goal, region, pool, &Camera { scene }, control, go_on)
}

/// Shoots a scene's samples.
#[derive(Clone, Copy)]
pub struct Camera<'a> {
    /// What is seen.
    pub scene: &'a Scene,
}

impl Shoot for Camera<'_> {
    fn shoot(
        &self,
        shots: &[Shot],
        counts: &mut RayCounts,
        cancel: &AtomicBool,
        out: &mut Vec<Radiance>,
    ) {
        let scene = self.scene;
        match scene.settings.integrator {
            Integrator::Whitted => {
                return Whitted::new(scene, counts, &mut Silent).shoot(shots, cancel, out);
            }
            Integrator::Path => {
                return Paths::new(scene, counts, &mut Silent).shoot(shots, cancel, out);
            }
            _ => {}
        }
        let rays = shots.iter().map(|shot| camera_ray(scene, &shot.sample, shot.stream));
        out.extend(integrator::radiances(scene, rays, counts, &mut Silent, cancel));
    }
}

/// One camera sample by itself: the same bits as in any batch.
pub fn shoot<R: Recorder>(
    scene: &Scene,
    sample: &PixelSample,
    stream: Stream,
    counts: &mut RayCounts,
    recorder: &mut R,
) -> Radiance {
    let rays = std::iter::once(camera_ray(scene, sample, stream));
    let radiances = integrator::radiances(scene, rays, counts, recorder, &AtomicBool::new(false));
    radiances.first().copied().unwrap_or(Radiance::NOTHING)
}

/// The ray through a sample's place in the picture, and the numbers that are left for its way; `None` where the
/// camera sees nothing (outside of a fisheye's circle).
fn camera_ray(scene: &Scene, sample: &PixelSample, mut stream: Stream) -> Option<(Ray, Stream)> {
    let (x, y, lens) = place(scene, sample, &mut stream);
    Some((scene.camera.ray(x, y, lens)?, stream))
}

/// A sample's place in the picture, and on the lens.
#[inline]
pub(crate) fn place(
    scene: &Scene,
    sample: &PixelSample,
    stream: &mut Stream,
) -> (f64, f64, [f64; 2]) {
    let [width, height] = scene.settings.size.map(f64::from);
    let lens = if scene.camera.has_lens() {
        stream.next_2d()
    } else {
        stream.skip();
        [0.5; 2]
    };
    (sample.x / width, sample.y / height, lens)
}
