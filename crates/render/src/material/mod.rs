// SPDX-License-Identifier: MIT OR Apache-2.0
//! The registry of materials: how surfaces answer light. One file and one line each.

use dioptric_math::Spectrum;
use dioptric_scene::{Args, Diagnostic, Schema};

use crate::build::Builder;
use crate::pattern::PatternPoint;

pub use dressed::{Bump, Dressed, NormalMap, Relief};
pub(crate) use highlight::{FAINTEST, whole};
pub use highlight::{Highlight, HighlightModel};
pub(crate) use interior::{ANISOTROPY, SCATTERING};
pub use interior::{Interior, Scattering};
pub use layers::{COAT_IOR, Layers};
pub use reflectance::{Conductor, Reflectance};
pub(crate) use shared::absorption;

#[cfg(test)]
mod battery;
pub mod blend;
pub mod clear;
mod dressed;
pub mod glass;
mod glasses;
pub mod glow;
mod highlight;
mod interior;
mod layers;
pub mod matte;
pub mod metal;
mod metal_data;
mod metal_lanes;
pub mod mirror;
pub mod patched;
pub mod phong;
pub mod plastic;
pub mod principled;
mod reflectance;
mod shared;
#[cfg(test)]
pub(crate) mod testing;
pub mod velvet;
pub mod volume;

/// What is seen in or through a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Optics {
    /// Nothing: only the own colour.
    Opaque,
    /// `own + w * mirrored`; the mirrored ray spread by `roughness` (0 is sharp).
    Mirror {
        /// The weight w, by the angle.
        reflect: Reflectance,
        /// Spread: the GGX alpha; 0 is a perfect mirror.
        roughness: f64,
        /// Whether the mirror lies over the own colour and takes from it what it reflects:
        /// `(1 - w) * own + w * mirrored`, as lacquer does. Whitted just adds it.
        covers: bool,
    },
    /// The report's transparency: `share * own + (1 - share) * seen`, by fixed shares, without
    /// Fresnel. The ray is bent on entering and leaving the object; inside, total internal
    /// reflection is followed. The whole passage counts as one bounce.
    Shares {
        /// The share of the surface's own colour, 0 to 1.
        own: f64,
        /// Index of refraction of the inside relative to the outside.
        ior: f64,
        /// Colour that multiplies what is seen; white for none.
        tint: Spectrum,
        /// Absorbed per unit of the file's length inside, per lane (Beer and Lambert).
        absorption: Spectrum,
    },
    /// A dielectric: reflected and refracted rays weighted by Fresnel's equations, with the media
    /// that the ray is in.
    Dielectric {
        /// Index of refraction.
        ior: f64,
        /// Multiplies the ray that is reflected outside.
        reflect: Spectrum,
        /// Multiplies the ray that is refracted into it.
        transmit: Spectrum,
        /// Absorbed per unit of the file's length inside, per lane.
        absorption: Spectrum,
        /// Spread of both rays: the GGX alpha.
        roughness: f64,
    },
    /// Fuzz over a coat over metal, glass or a dull ground, in shares. Its colour is [`Finish::base`].
    Layered(Layers),
}

impl Optics {
    /// Its index of refraction, and what it absorbs per unit of the file's length, if it bends rays by Fresnel's equations.
    #[inline]
    #[must_use]
    pub fn bends(&self) -> Option<(f64, Spectrum)> {
        match self {
            Self::Dielectric { ior, absorption, .. } => Some((*ior, *absorption)),
            Self::Layered(layers) if layers.clear() > 0.0 => Some((layers.ior, Spectrum::ZERO)),
            _ => None,
        }
    }
}

/// A surface's answer at one point. Whitted's pictures and paths (see [`crate::bsdf`]) are both made from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Finish {
    /// The pattern's or constant base colour, for `why` and the albedo layer.
    pub base: Spectrum,
    /// Multiplies the ambient light.
    pub ambient: Spectrum,
    /// Multiplies `n . l` and the light's colour.
    pub diffuse: Spectrum,
    /// How rough the diffuse surface is in small, 0 (Lambert's) to 1; for paths only: see [`crate::bsdf::Bsdf`].
    pub unevenness: f64,
    /// The highlight.
    pub highlight: Option<Highlight>,
    /// Light of its own.
    pub emission: Spectrum,
    /// Whether there is anything at all: rays go on through what is not.
    pub present: bool,
    /// What is seen in or through it.
    pub optics: Optics,
    /// How much of a shadow it casts where the scene's shadows are tinted: the light that passes, 0
    /// for opaque. Counted once for each passage: where a shadow ray enters a solid, or where it
    /// crosses an open surface.
    pub shadow_pass: Spectrum,
}

impl Finish {
    /// No surface at all.
    pub const HOLE: Self =
        Self { present: false, shadow_pass: Spectrum::ONE, ..Self::matte(Spectrum::ZERO) };

    /// Whether paths find nothing but Lambert's surface there, and not a black one.
    #[inline(always)]
    #[must_use]
    pub fn is_matte(&self) -> bool {
        matches!(self.optics, Optics::Opaque)
            && self.unevenness == 0.0
            && self.highlight.is_none_or(|h| h.image)
            && self.diffuse.max_element() > 0.0
    }

    /// A surface that only has ambient and diffuse light of one colour.
    #[must_use]
    pub const fn matte(color: Spectrum) -> Self {
        Self {
            base: color,
            ambient: color,
            diffuse: color,
            unevenness: 0.0,
            highlight: None,
            emission: Spectrum::ZERO,
            present: true,
            optics: Optics::Opaque,
            shadow_pass: Spectrum::ZERO,
        }
    }
}

/// A material.
pub trait Material: Sized {
    /// The material's manual page and parameters.
    const SCHEMA: &'static Schema;

    /// Builds the material from checked arguments.
    ///
    /// # Errors
    /// The arguments make no material.
    fn from_args(args: &Args, builder: &mut Builder) -> Result<Self, Diagnostic>;

    /// The answer at a point in Whitted's model.
    fn finish(&self, point: &PatternPoint) -> Finish;

    /// Adds what bends the normal there of the materials that it is made of.
    fn relief<'a>(&'a self, _point: &PatternPoint, _relief: &mut Relief<'a>) {}

    /// Whether it may answer differently at the same point: see [`PatternPoint::lot`].
    fn is_by_lot(&self) -> bool {
        false
    }

    /// Whether rays may pass it as if it were not there.
    fn has_holes(&self) -> bool {
        false
    }

    /// Whether it lets no light pass anywhere: [`Finish::shadow_pass`] is always 0.
    fn is_opaque(&self) -> bool {
        true
    }

    /// Whether it may shine by itself somewhere: [`Finish::emission`] is not always 0.
    fn may_shine(&self) -> bool {
        false
    }

    /// What its inside does to light, besides absorbing it.
    fn interior(&self) -> Interior {
        Interior::PLAIN
    }
}

macro_rules! registry {
    ($($variant:ident($ty:ty),)*) => {
        /// Any material, dispatched without a virtual call.
        #[derive(Clone, Debug)]
        pub enum AnyMaterial {
            $(#[doc = concat!("See [`", stringify!($ty), "`].")] $variant($ty),)*
        }

        /// The schemas of all materials.
        pub static SCHEMAS: &[&Schema] = &[$(<$ty as Material>::SCHEMA,)*];

        impl AnyMaterial {
            /// Builds the material that a node describes.
            ///
            /// # Errors
            /// The node is no material, or its arguments make none.
            pub fn from_args(args: &Args, builder: &mut Builder) -> Result<Self, Diagnostic> {
                let kind = args.node().schema.kind;
                $(if kind == <$ty as Material>::SCHEMA.kind {
                    return <$ty as Material>::from_args(args, builder).map(Self::$variant);
                })*
                Err(args.error_here("internal", format!("{kind} is no material")))
            }

            /// See [`Material::finish`].
            #[must_use]
            pub fn finish(&self, point: &PatternPoint) -> Finish {
                match self { $(Self::$variant(m) => m.finish(point),)* }
            }

            /// See [`Material::is_opaque`].
            #[must_use]
            pub fn is_opaque(&self) -> bool {
                match self { $(Self::$variant(m) => m.is_opaque(),)* }
            }

            /// See [`Material::may_shine`].
            #[must_use]
            pub fn may_shine(&self) -> bool {
                match self { $(Self::$variant(m) => m.may_shine(),)* }
            }

            /// See [`Material::interior`].
            #[must_use]
            pub fn interior(&self) -> Interior {
                match self { $(Self::$variant(m) => m.interior(),)* }
            }

            /// See [`Material::relief`].
            pub fn relief<'a>(&'a self, point: &PatternPoint, relief: &mut Relief<'a>) {
                match self { $(Self::$variant(m) => m.relief(point, relief),)* }
            }

            /// See [`Material::is_by_lot`].
            #[must_use]
            pub fn is_by_lot(&self) -> bool {
                match self { $(Self::$variant(m) => m.is_by_lot(),)* }
            }

            /// See [`Material::has_holes`].
            #[must_use]
            pub fn has_holes(&self) -> bool {
                match self { $(Self::$variant(m) => m.has_holes(),)* }
            }
        }
    };
}

registry! {
    Matte(matte::Matte),
    Phong(phong::Phong),
    Clear(clear::Clear),
    Glass(glass::Glass),
    Mirror(mirror::Mirror),
    Metal(metal::Metal),
    Plastic(plastic::Plastic),
    Principled(principled::Principled),
    Velvet(velvet::Velvet),
    Glow(glow::Glow),
    Patched(patched::Patched),
    Volume(volume::Volume),
    Blend(blend::Blend),
}
