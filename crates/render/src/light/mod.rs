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
mod shared;
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

    /// The light as many points ask it at once, if they can.
    fn sharp(&self) -> Option<Sharp> {
        None
    }
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

            /// See [`Light::sharp`].
            #[must_use]
            pub fn sharp(&self) -> Option<Sharp> {
                match self { $(Self::$variant(l) => l.sharp(),)* }
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
