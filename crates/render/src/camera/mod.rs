// SPDX-License-Identifier: MIT OR Apache-2.0
//! The registry of cameras. One file and one line each.

use dioptric_geometry::world::{Bundle, Query, Sixteen};
use dioptric_geometry::{Contacts, Ray};
use dioptric_scene::{Args, Diagnostic, Schema};

use crate::setting::root::Root;

#[cfg(test)]
mod battery;
pub mod fisheye;
mod frame;
pub mod orthographic;
pub mod panorama;
pub mod perspective;
#[cfg(test)]
pub(crate) mod testing;

/// A camera.
pub trait Camera: Sized {
    /// The camera's manual page and parameters.
    const SCHEMA: &'static Schema;

    /// Builds the camera from checked arguments; `root` carries it to the space of rays and `aspect`
    /// is width over height of the full picture.
    ///
    /// # Errors
    /// The arguments make no camera.
    fn from_args(args: &Args, root: &Root, aspect: f64) -> Result<Self, Diagnostic>;

    /// The ray through a point of the picture: `x` and `y` in `[0, 1]` from its top left corner to
    /// its bottom right one; `lens` is two numbers in `[0, 1)` that pick a point of the lens. The
    /// direction is a unit vector. `None` where the camera sees nothing.
    fn ray(&self, x: f64, y: f64, lens: [f64; 2]) -> Option<Ray>;

    /// Whether `lens` matters.
    fn has_lens(&self) -> bool {
        false
    }

    /// Sixteen rays, the same bits as [`Self::ray`] gives for each; a bit for each that there is.
    fn rays(&self, places: &Places, rays: &mut Bundle) -> u16 {
        one_by_one(self, places, rays)
    }
}

/// Sixteen rays, each by itself.
fn one_by_one(camera: &impl Camera, places: &Places, rays: &mut Bundle) -> u16 {
    rays.free();
    let mut seen = 0;
    for lane in 0..Bundle::LANES {
        let [x, y] = [places.x[lane], places.y[lane]];
        if let Some(ray) = camera.ray(x, y, places.lens[lane]) {
            rays.set(lane, &Query::new(ray, f64::INFINITY, None, Contacts::CROSSED));
            seen |= 1 << lane;
        }
    }
    seen
}

/// Sixteen points of the picture and of the lens: see [`Camera::ray`].
#[derive(Clone, Debug)]
pub struct Places {
    /// From the left edge at 0 to the right one at 1.
    pub x: Sixteen,
    /// From the top at 0 to the bottom at 1.
    pub y: Sixteen,
    /// What picks the point of the lens.
    pub lens: [[f64; 2]; Bundle::LANES],
}

impl Places {
    /// The top left corner, and the middle of the lens.
    pub const CORNER: Self =
        Self { x: [0.0; Bundle::LANES], y: [0.0; Bundle::LANES], lens: [[0.5; 2]; Bundle::LANES] };
}

macro_rules! registry {
    ($($variant:ident($ty:ty),)*) => {
        /// Any camera, dispatched without a virtual call.
        #[derive(Clone, Debug)]
        pub enum AnyCamera {
            $(#[doc = concat!("See [`", stringify!($ty), "`].")] $variant($ty),)*
        }

        /// The schemas of all cameras.
        pub static SCHEMAS: &[&Schema] = &[$(<$ty as Camera>::SCHEMA,)*];

        impl AnyCamera {
            /// Builds the camera that a node describes.
            ///
            /// # Errors
            /// The node is no camera, or its arguments make none.
            pub fn from_args(args: &Args, root: &Root, aspect: f64) -> Result<Self, Diagnostic> {
                let kind = args.node().schema.kind;
                $(if kind == <$ty as Camera>::SCHEMA.kind {
                    return <$ty as Camera>::from_args(args, root, aspect).map(Self::$variant);
                })*
                Err(args.error_here("internal", format!("{kind} is no camera")))
            }

            /// See [`Camera::ray`].
            #[must_use]
            pub fn ray(&self, x: f64, y: f64, lens: [f64; 2]) -> Option<Ray> {
                match self { $(Self::$variant(c) => c.ray(x, y, lens),)* }
            }

            /// See [`Camera::rays`].
            pub fn rays(&self, places: &Places, rays: &mut Bundle) -> u16 {
                match self { $(Self::$variant(c) => c.rays(places, rays),)* }
            }

            /// See [`Camera::has_lens`].
            #[must_use]
            pub fn has_lens(&self) -> bool {
                match self { $(Self::$variant(c) => c.has_lens(),)* }
            }
        }
    };
}

registry! {
    Perspective(perspective::Perspective),
    Orthographic(orthographic::Orthographic),
    Fisheye(fisheye::Fisheye),
    Panorama(panorama::Panorama),
}
