// SPDX-License-Identifier: MIT OR Apache-2.0
//! Everything a ray can hit, and how it is found: exact shapes, transforms, the hierarchy of boxes.
//!
//! Knows nothing of colour, light or files. The way of a query:
//! [`Ray`] -> (instance, object) transforms -> [`LocalRay`] -> [`Shape::intersect`] -> nearest hit ->
//! [`Shape::surface`] once -> [`Surface`] in the space of the ray.
//!
//! There is no global epsilon (invariant 6). A ray knows a bound on the error of its origin, and
//! which point of which object it leaves ([`Departure`]): on that object the point itself is ignored,
//! on any other object a surface within the bound is hit at `t = 0`.

// Allowed in the modules that use processors' vector instructions, and nowhere else.
#![deny(unsafe_code)]

pub mod bounds;
pub mod bvh;
pub mod group;
#[allow(unsafe_code)]
pub mod memory;
pub mod mesh;
pub mod mesh_data;
pub mod placement;
pub mod plain;
pub mod pool;
pub mod ray;
pub mod shape;
pub mod shapes;
pub mod transform;
pub mod world;

pub use bounds::Bounds;
pub use group::GROUP_SCHEMA;
pub use mesh::Mesh;
pub use mesh_data::MeshData;
pub use placement::{TRANSFORM_SCHEMAS, placement};
pub use plain::Plain;
pub use ray::{Contacts, Departure, HitId, Leaving, LocalRay, Ray};
pub use shape::{Crossing, Described, LocalSurface, Root, Shape, SurfacePoint};
pub use shapes::AnyShape;
pub use transform::Transform;
pub use world::{GroupId, Hit, PlacementError, Surface, World, WorldBuilder};
