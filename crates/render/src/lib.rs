// SPDX-License-Identifier: MIT OR Apache-2.0
//! From a [`dioptric_scene::Description`] to light: patterns, materials, lights, cameras, sampling,
//! integrators, film and `why`.
//!
//! The way of the data: [`compile`](build) turns a description into an immutable [`Scene`]; a job
//! asks the sampler for samples of a pixel, the camera for a ray, the integrator for its radiance,
//! and adds it to the film. `why` runs the same integrator with a recorder that keeps everything.
//!
//! The crate reads no files (bytes come through a `Loader`), prints nothing, ends no process and
//! starts no threads but those of the pool it is given.

#![forbid(unsafe_code)]

pub mod bsdf;
pub mod build;
mod bulk;
pub mod bump;
pub mod camera;
pub mod compile;
pub mod film;
pub mod filter;
pub mod guide;
pub mod input;
pub mod integrator;
pub mod job;
mod lanes;
pub mod light;
pub mod manifold;
pub mod material;
pub mod noise;
mod observer;
pub mod parts;
pub mod pattern;
pub mod picture;
pub mod region;
pub mod sampling;
pub mod scene;
pub mod setting;
pub mod source;
#[cfg(test)]
mod statistics;
pub mod stats;
pub mod texture;
pub mod vocabulary;
pub mod wavelength;
pub mod why;

pub use film::{Film, FirstHit, Radiance};
pub use filter::Filter;
pub use input::{ColorInput, NumberInput};
pub use job::Control;
pub use picture::render;
pub use region::Region;
pub use setting::render::RenderSettings;
pub use stats::RayCounts;
pub use vocabulary::vocabulary;
