// SPDX-License-Identifier: MIT OR Apache-2.0
//! The registry of lights. One file and one line each.

use dioptric_math::{DVec3, Spectrum};
use dioptric_scene::{Args, Diagnostic, Schema};

use crate::build::Builder;
use crate::setting::root::Root;

pub mod area;
#[cfg(test)]
mod battery;
pub mod directional;
pub mod disc;
mod panel;
pub mod point;
mod profile;
pub(crate) mod shared;
mod sharp;
pub mod spot;
#[cfg(test)]
pub(crate) mod testing;

pub use sharp::Sharp;
pub(crate) use sharp::Towards;

/// What one light sends to one point, before anything blocks it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightSample {
    /// Unit vector towards the light, in the space of rays.
    pub direction: DVec3,
    /// Distance to the light along it, in the space of rays; infinite for directional lights.
    pub distance: f64,
    /// What arrives, the light's falloff and cone included.
    pub arriving: Spectrum,
}

/// Where a ray passes a light that has a size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightPass {
    /// Distance from the ray's origin, in the space of rays.
    pub distance: f64,
    /// What [`Light::sample`] says to arrive at the origin from there.
    pub arriving: Spectrum,
    /// The density over solid angles with which [`Light::sample`] finds that direction for uniform `u`.
    pub density: f64,
}

/// What can be said of a light at a point without asking for any part of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightView {
    /// Unit vector towards its middle.
    pub direction: DVec3,
    /// Sine of half the angle under which it is seen, from above; 1 where it may be anywhere.
    pub sine: f64,
    /// About what arrives; not 0 unless nothing can.
    pub arriving: Spectrum,
}

/// Where a light is that weakens with distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightPlace {
    /// The middle of a ball around it.
    pub center: DVec3,
    /// The ball's radius.
    pub radius: f64,
    /// What arrives at the distance 1 in the space of rays, where it is strongest.
    pub intensity: Spectrum,
}

/// A light.
pub trait Light: Sized {
    /// The light's manual page and parameters.
    const SCHEMA: &'static Schema;

    /// Builds the light from checked arguments; `root` carries positions to the space of rays.
    ///
    /// # Errors
    /// The arguments make no light.
    fn from_args(args: &Args, builder: &mut Builder, root: &Root) -> Result<Self, Diagnostic>;

    /// What arrives at a point (in the space of rays) from the part of the light that `u` picks,
    /// two numbers in `[0, 1)`; `None` where nothing can arrive. The mean over uniform `u` is the
    /// light's whole effect.
    fn sample(&self, point: DVec3, u: [f64; 2]) -> Option<LightSample>;

    /// How many samples a Whitted picture takes of it: 1 for lights without a size.
    fn samples(&self) -> u32 {
        1
    }

    /// Whether it has no size: [`Self::sample`] is the same for all `u`.
    fn is_sharp(&self) -> bool;

    /// Where a ray from `origin` along the unit vector `direction` passes it; `None` for sharp lights and for
    /// directions that [`Self::sample`] does not find from there.
    fn pass(&self, origin: DVec3, direction: DVec3) -> Option<LightPass>;

    /// What can be said of it at a point; `None` where nothing of it arrives there.
    fn view(&self, point: DVec3) -> Option<LightView>;

    /// The light as many points ask it at once, if they can.
    fn sharp(&self) -> Option<Sharp> {
        None
    }

    /// Where it is, if it weakens with distance.
    fn place(&self) -> Option<LightPlace>;
}

macro_rules! registry {
    ($($variant:ident($ty:ty),)*) => {
        /// Any light, dispatched without a virtual call.
        #[derive(Clone, Debug)]
        pub enum AnyLight {
            $(#[doc = concat!("See [`", stringify!($ty), "`].")] $variant($ty),)*
        }

        /// The schemas of all lights.
        pub static SCHEMAS: &[&Schema] = &[$(<$ty as Light>::SCHEMA,)*];

        impl AnyLight {
            /// Builds the light that a node describes.
            ///
            /// # Errors
            /// The node is no light, or its arguments make none.
            pub fn from_args(args: &Args, builder: &mut Builder, root: &Root) -> Result<Self, Diagnostic> {
                let kind = args.node().schema.kind;
                $(if kind == <$ty as Light>::SCHEMA.kind {
                    return <$ty as Light>::from_args(args, builder, root).map(Self::$variant);
                })*
                Err(args.error_here("internal", format!("{kind} is no light")))
            }

            /// See [`Light::sample`].
            #[must_use]
            pub fn sample(&self, point: DVec3, u: [f64; 2]) -> Option<LightSample> {
                match self { $(Self::$variant(l) => l.sample(point, u),)* }
            }

            /// See [`Light::samples`].
            #[must_use]
            pub fn samples(&self) -> u32 {
                match self { $(Self::$variant(l) => l.samples(),)* }
            }

            /// See [`Light::is_sharp`].
            #[must_use]
            pub fn is_sharp(&self) -> bool {
                match self { $(Self::$variant(l) => l.is_sharp(),)* }
            }

            /// See [`Light::pass`].
            #[must_use]
            pub fn pass(&self, origin: DVec3, direction: DVec3) -> Option<LightPass> {
                match self { $(Self::$variant(l) => l.pass(origin, direction),)* }
            }

            /// See [`Light::view`].
            #[must_use]
            pub fn view(&self, point: DVec3) -> Option<LightView> {
                match self { $(Self::$variant(l) => l.view(point),)* }
            }

            /// See [`Light::sharp`].
            #[must_use]
            pub fn sharp(&self) -> Option<Sharp> {
                match self { $(Self::$variant(l) => l.sharp(),)* }
            }

            /// See [`Light::place`].
            #[must_use]
            pub fn place(&self) -> Option<LightPlace> {
                match self { $(Self::$variant(l) => l.place(),)* }
            }
        }
    };
}

registry! {
    Point(point::Point),
    Directional(directional::Directional),
    Spot(spot::Spot),
    Area(area::Area),
    Disc(disc::Disc),
}
