// SPDX-License-Identifier: MIT OR Apache-2.0
//! The registry of patterns: colours and numbers that vary over surfaces. One file and one line each.

use dioptric_math::{DVec2, DVec3, Spectrum};
use dioptric_scene::{Args, Diagnostic, Schema};

use crate::build::Builder;

pub mod checker;

/// Where a pattern is asked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PatternPoint {
    /// The point in the object's own space, before its transforms.
    pub object: DVec3,
    /// The point in the space of the scene's root.
    pub world: DVec3,
    /// The surface coordinates of the shape.
    pub uv: DVec2,
    /// The unit shading normal in the object's own space, outward (mappings use it).
    pub object_normal: DVec3,
    /// The unit shading normal in the space of the scene's root, outward.
    pub world_normal: DVec3,
}

/// The space in which a pattern lives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Space {
    /// The object's own space: the pattern moves with the object.
    Object,
    /// The space of the scene's root.
    World,
    /// Surface coordinates `(u, v, 0)`.
    Uv,
}

impl Space {
    /// The words of the `space` parameter.
    pub const NAMES: &'static [&'static str] = &["object", "world", "uv"];

    /// The space with this name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        match name {
            "object" => Some(Self::Object),
            "world" => Some(Self::World),
            "uv" => Some(Self::Uv),
            _ => None,
        }
    }

    /// The point's coordinates in this space.
    #[must_use]
    pub fn of(self, point: &PatternPoint) -> DVec3 {
        match self {
            Self::Object => point.object,
            Self::World => point.world,
            Self::Uv => point.uv.extend(0.0),
        }
    }
}

/// A pattern.
pub trait Pattern: Sized {
    /// The pattern's manual page and parameters.
    const SCHEMA: &'static Schema;

    /// Builds the pattern from checked arguments.
    ///
    /// # Errors
    /// The arguments make no pattern.
    fn from_args(args: &Args, builder: &mut Builder) -> Result<Self, Diagnostic>;

    /// The value at a point, in linear light; a number pattern gives the same in all lanes.
    fn eval(&self, point: &PatternPoint) -> Spectrum;
}

macro_rules! registry {
    ($($variant:ident($ty:ty),)*) => {
        /// Any pattern, dispatched without a virtual call.
        #[derive(Clone, Debug)]
        pub enum AnyPattern {
            $(#[doc = concat!("See [`", stringify!($ty), "`].")] $variant($ty),)*
        }

        /// The schemas of all patterns.
        pub static SCHEMAS: &[&Schema] = &[$(<$ty as Pattern>::SCHEMA,)*];

        impl AnyPattern {
            /// Builds the pattern that a node describes.
            ///
            /// # Errors
            /// The node is no pattern, or its arguments make none.
            pub fn from_args(args: &Args, builder: &mut Builder) -> Result<Self, Diagnostic> {
                let kind = args.node().schema.kind;
                $(if kind == <$ty as Pattern>::SCHEMA.kind {
                    return <$ty as Pattern>::from_args(args, builder).map(Self::$variant);
                })*
                Err(args.error_here("internal", format!("{kind} is no pattern")))
            }

            /// See [`Pattern::eval`].
            #[must_use]
            pub fn eval(&self, point: &PatternPoint) -> Spectrum {
                match self { $(Self::$variant(p) => p.eval(point),)* }
            }
        }
    };
}

registry! {
    Checker(checker::Checker),
}
