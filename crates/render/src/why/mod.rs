// SPDX-License-Identifier: MIT OR Apache-2.0
//! Why a pixel has its colour: every ray behind it, from the integrator itself.
//!
//! The JSON of a [`Pixel`] is documented in the manual (`why.md`). Reading only it, a program can redo
//! every sum: a node's `value` is the sum of its terms and of each child's weight times its value;
//! `linear` is the sum of each sample's weight times its ray's value, rounded to f32.

mod paths;

use serde::Serialize;

use crate::film::{FilmPixel, PixelSum};
use crate::integrator::recorder::{Node, TreeRecorder};
use crate::job::{samples_of_pixel, stages};
use crate::picture::{Camera, shoot};
use crate::sampling::{pixel_sample, pixel_weights};
use crate::scene::Scene;
use crate::setting::render::Integrator;
use crate::stats::RayCounts;

pub use paths::{Group, Paths};

/// Version of the JSON's form.
pub const SCHEMA_VERSION: u32 = 1;

/// One pixel, explained.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Pixel {
    /// [`SCHEMA_VERSION`].
    pub schema: u32,
    /// Column and row from the top left of the full picture, from 0.
    pub pixel: [u32; 2],
    /// All samples.
    pub samples: Vec<Sample>,
    /// What the samples brought together; only where paths of light are followed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub paths: Option<Paths>,
    /// The pixel's linear value, each lane an f32 as in an EXR file.
    pub linear: [f64; 3],
    /// How much of the pixel is covered, 0 to 1.
    pub alpha: f64,
    /// The steps from linear light to the picture's values.
    pub develop: Vec<Step>,
    /// The pixel of an 8-bit picture.
    pub rgb8: [u8; 3],
    /// Rays cast for it.
    pub rays: RayCounts,
}

/// One sample of a pixel.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Sample {
    /// How much it counts; all weights of a pixel add up to 1.
    pub weight: f64,
    /// Where it lies, in pixels from the top left of the full picture.
    pub position: [f64; 2],
    /// The camera's ray; nothing where the camera sees nothing, which is black.
    pub ray: Option<Node>,
}

/// One step of developing.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Step {
    /// `exposure`, a tone curve, an encoding, ...
    pub step: &'static str,
    /// The values after it.
    pub value: [f64; 3],
}

/// Explains a pixel of the full picture; `None` for a place outside of it.
#[must_use]
pub fn explain(scene: &Scene, x: u32, y: u32) -> Option<Pixel> {
    let settings = &scene.settings;
    if x >= settings.size[0] || y >= settings.size[1] {
        return None;
    }
    let count = samples_of_pixel(settings, [x, y], &Camera { scene });
    let weights = pixel_weights(settings, [x, y], count);
    let mut film = FilmPixel::default();
    let mut sum = PixelSum::new(false);
    let mut rays = RayCounts::default();
    let mut samples = Vec::with_capacity(weights.len());
    for stage in stages(settings, count) {
        sum.start(stage.start, &film, None);
        for (index, &weight) in stage.clone().zip(&weights[stage.start as usize..]) {
            let (place, stream) = pixel_sample(settings, [x, y], index);
            let mut recorder = TreeRecorder::default();
            let radiance = shoot(scene, &place, stream, &mut rays, &mut recorder);
            sum.add(place.weight, &radiance);
            let position = [place.x, place.y];
            samples.push(Sample { weight, position, ray: recorder.into_root() });
        }
        (film, _) = sum.finish();
    }
    let [r, g, b, alpha] = film.rgba();
    let linear = [r, g, b];
    let develop =
        scene.develop.steps(linear).into_iter().map(|(step, value)| Step { step, value }).collect();
    Some(Pixel {
        schema: SCHEMA_VERSION,
        pixel: [x, y],
        paths: (settings.integrator == Integrator::Path).then(|| paths::add_up(&samples)),
        samples,
        linear: linear.map(f64::from),
        alpha: f64::from(alpha),
        develop,
        rgb8: scene.develop.to_u8(linear),
        rays,
    })
}
