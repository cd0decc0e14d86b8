// SPDX-License-Identifier: MIT OR Apache-2.0
//! The registry of shapes: one line each. From it come the enum, its dispatch, the table of schemas
//! and the list over which the batteries of tests run. Shapes that are made from files and lists (meshes and
//! pools) stand in their own list: they have no schema of numbers.

use std::sync::Arc;

use dioptric_math::DVec3;
use dioptric_scene::{Args, Diagnostic, Schema};

use crate::bounds::Bounds;
use crate::mesh::Mesh;
use crate::pool::{Cones, Cylinders, Spheres};
use crate::ray::LocalRay;
use crate::shape::{Crossing, Described, LocalSurface, Root, Shape, SurfacePoint};

pub mod cone;
mod convex;
pub mod csg;
pub mod cuboid;
pub mod cylinder;
pub mod disc;
mod frame;
pub(crate) mod frustum;
mod outline;
pub mod plane;
pub mod polygon;
pub mod rectangle;
mod roots;
mod sheared;
pub mod sphere;
pub mod tetrahedron;
pub mod torus;
pub mod triangle;

macro_rules! registry {
    (
        described { $($variant:ident($ty:ty),)* }
        bulk { $($bulk:ident($bulk_ty:ty, $kind:literal),)* }
    ) => {
        /// Any shape, dispatched without a virtual call. Large ones are boxed, so that a sphere stays small.
        #[derive(Clone, Debug)]
        pub enum AnyShape {
            $(#[doc = concat!("A `", stringify!($ty), "`.")] $variant($ty),)*
            $(#[doc = concat!("A `", stringify!($bulk_ty), "`.")] $bulk($bulk_ty),)*
        }

        /// The schemas of all shapes.
        pub static SCHEMAS: &[&Schema] = &[$(<$ty as Described>::SCHEMA,)*];

        impl AnyShape {
            /// Builds the shape that a node describes; `None` where the node is no shape of this registry
            /// (a group, for one).
            ///
            /// # Errors
            /// The arguments do not make a shape.
            pub fn from_args(args: &Args) -> Result<Option<Self>, Diagnostic> {
                let kind = args.node().schema.kind;
                $(if kind == <$ty as Described>::SCHEMA.kind {
                    return <$ty as Described>::from_args(args).map(|s| Some(Self::$variant(s)));
                })*
                Ok(None)
            }

            /// What scenes call such a shape.
            #[must_use]
            pub fn kind(&self) -> &'static str {
                match self {
                    $(Self::$variant(_) => <$ty as Described>::SCHEMA.kind,)*
                    $(Self::$bulk(_) => $kind,)*
                }
            }

            /// See [`Shape::memory_bytes`].
            #[must_use]
            pub fn memory_bytes(&self) -> usize {
                match self {
                    $(Self::$variant(s) => s.memory_bytes(),)*
                    $(Self::$bulk(s) => s.memory_bytes(),)*
                }
            }

            /// See [`Shape::bounds`].
            #[must_use]
            pub fn bounds(&self) -> Bounds {
                match self {
                    $(Self::$variant(s) => s.bounds(),)*
                    $(Self::$bulk(s) => s.bounds(),)*
                }
            }

            /// See [`Shape::is_solid`].
            #[must_use]
            pub fn is_solid(&self) -> bool {
                match self {
                    $(Self::$variant(s) => s.is_solid(),)*
                    $(Self::$bulk(s) => s.is_solid(),)*
                }
            }

            /// See [`Shape::is_convex`].
            #[must_use]
            pub fn is_convex(&self) -> bool {
                match self {
                    $(Self::$variant(s) => s.is_convex(),)*
                    $(Self::$bulk(s) => s.is_convex(),)*
                }
            }

            /// Whether it lies in a plane: a straight line passes it at most once, and a ray that leaves it hits it no
            /// more.
            #[inline]
            #[must_use]
            pub const fn is_flat(&self) -> bool {
                matches!(
                    self,
                    Self::Triangle(_)
                        | Self::Polygon(_)
                        | Self::Rectangle(_)
                        | Self::Disc(_)
                        | Self::Plane(_)
                )
            }

            /// See [`Shape::intersect`].
            #[inline]
            #[must_use]
            pub fn intersect(&self, ray: &LocalRay) -> Option<Root> {
                match self {
                    $(Self::$variant(s) => s.intersect(ray),)*
                    $(Self::$bulk(s) => s.intersect(ray),)*
                }
            }

            /// See [`Shape::blocks`].
            #[inline]
            #[must_use]
            pub fn blocks(&self, ray: &LocalRay) -> Option<Root> {
                match self {
                    $(Self::$variant(s) => s.blocks(ray),)*
                    $(Self::$bulk(s) => s.blocks(ray),)*
                }
            }

            /// See [`Shape::crossings`].
            pub fn crossings(&self, ray: &LocalRay, out: &mut Vec<Crossing>) {
                match self {
                    $(Self::$variant(s) => s.crossings(ray, out),)*
                    $(Self::$bulk(s) => s.crossings(ray, out),)*
                }
            }

            /// See [`Shape::surface`].
            #[must_use]
            pub fn surface(&self, point: DVec3, part: u32) -> LocalSurface {
                match self {
                    $(Self::$variant(s) => s.surface(point, part),)*
                    $(Self::$bulk(s) => s.surface(point, part),)*
                }
            }

            /// [`Self::surface_point`], inlined where that is short: what is written to memory as a whole and read
            /// at once makes the processor wait.
            #[inline(always)]
            #[must_use]
            pub fn surface_point_inline(&self, point: DVec3, part: u32) -> SurfacePoint {
                match self {
                    Self::Rectangle(s) => s.surface_point(point, part),
                    Self::Sphere(s) => s.surface_point(point, part),
                    other => other.surface_point(point, part),
                }
            }

            /// See [`Shape::surface_point`].
            #[must_use]
            pub fn surface_point(&self, point: DVec3, part: u32) -> SurfacePoint {
                match self {
                    $(Self::$variant(s) => s.surface_point(point, part),)*
                    $(Self::$bulk(s) => s.surface_point(point, part),)*
                }
            }
        }
    };
}

registry! {
    described {
    Sphere(sphere::Sphere),
    Plane(Box<plane::Plane>),
    Cuboid(Box<cuboid::Cuboid>),
    Rectangle(Box<rectangle::Rectangle>),
    Disc(Box<disc::Disc>),
    Cylinder(Box<cylinder::Cylinder>),
    Cone(Box<cone::Cone>),
    Triangle(Box<triangle::Triangle>),
    Polygon(Box<polygon::Polygon>),
    Tetrahedron(Box<tetrahedron::Tetrahedron>),
    Torus(Box<torus::Torus>),
    Union(Box<csg::Union>),
    Intersection(Box<csg::Intersection>),
    Difference(Box<csg::Difference>),
    }
    bulk {
    Mesh(Arc<Mesh>, "mesh"),
    Spheres(Arc<Spheres>, "spheres"),
    Cylinders(Arc<Cylinders>, "cylinders"),
    Cones(Arc<Cones>, "cones"),
    }
}

impl<S: Described> Described for Box<S> {
    const SCHEMA: &'static Schema = S::SCHEMA;

    fn from_args(args: &Args) -> Result<Self, Diagnostic> {
        S::from_args(args).map(Box::new)
    }
}

/// A pointer to a shape is a shape.
macro_rules! pointer {
    ($($pointer:ident)*) => {$(
        impl<S: Shape> Shape for $pointer<S> {
            fn bounds(&self) -> Bounds {
                (**self).bounds()
            }

            fn is_solid(&self) -> bool {
                (**self).is_solid()
            }

            fn is_convex(&self) -> bool {
                (**self).is_convex()
            }

            #[inline]
            fn intersect(&self, ray: &LocalRay) -> Option<Root> {
                (**self).intersect(ray)
            }

            #[inline]
            fn blocks(&self, ray: &LocalRay) -> Option<Root> {
                (**self).blocks(ray)
            }

            fn crossings(&self, ray: &LocalRay, out: &mut Vec<Crossing>) {
                (**self).crossings(ray, out);
            }

            fn surface(&self, point: DVec3, part: u32) -> LocalSurface {
                (**self).surface(point, part)
            }

            fn surface_point(&self, point: DVec3, part: u32) -> SurfacePoint {
                (**self).surface_point(point, part)
            }

            fn memory_bytes(&self) -> usize {
                size_of::<S>() + (**self).memory_bytes()
            }
        }
    )*};
}

pointer!(Box Arc);
