// SPDX-License-Identifier: MIT OR Apache-2.0
//! Triangle meshes: millions of triangles as one shape, with a tree of their own.
//!
//! The corners are the f32 numbers of [`MeshData`], exactly. A part is the index of a triangle. Triangles
//! with bad indices, with numbers that are not finite and without area are left out.

mod build;
mod closed;
mod line;
#[allow(unsafe_code)]
mod query;
mod surface;

use dioptric_math::DVec3;
use dioptric_math::bounds::gamma;

use crate::bounds::Bounds;
use crate::bvh::triangles::Packet;
use crate::bvh::{Bvh, Lanes};
use crate::mesh_data::MeshData;
use crate::ray::LocalRay;
use crate::shape::{Crossing, LocalSurface, Root, Shape, SurfacePoint};
use line::Corners;

/// Indexed triangles, ready to be hit.
///
/// `surface` gives interpolated normals and coordinates where the data has them, else flat ones with
/// `uv` 0, 0 at a triangle's first corner, u = 1 at the second and v = 1 at the third.
///
/// It is solid where its triangles enclose a volume: every edge, by its corners' positions, is walked as
/// often in one direction as in the other. Normals of solids point outwards whatever their winding; those of
/// others follow the winding (counter-clockwise is in front), or the side to which most of the
/// triangle's shading normals point.
#[derive(Clone, Debug)]
pub struct Mesh {
    data: MeshData,
    /// Leaves are ranges of packets; with [`LARGE`] added to the first one's index where some of their
    /// triangles are large.
    bvh: Bvh,
    packets: Vec<Packet>,
    /// How many triangles can be hit.
    count: usize,
    bounds: Bounds,
    /// Bounds the rounding of all heights and of points on the surface.
    error: f64,
    single: Single,
    closed: bool,
    /// Whether the winding of a closed mesh makes its inside its front.
    inverted: bool,
}

/// What filters are made of, in single precision and rounded up.
#[derive(Clone, Copy, Debug)]
struct Single {
    /// The largest coordinate.
    largest: f32,
    /// The longest edge, along any axis, of triangles that are not large.
    edge: f32,
    /// As [`Mesh::error`].
    error: f32,
    /// What hits may lie outside of their boxes for the mesh's own sake.
    pad: f32,
    /// The largest coordinate of the tree's centre.
    center: f32,
}

impl Single {
    fn new(largest: f64, edge: f64, error: f64, center: f64) -> Self {
        let up = |x: f64| (x as f32).next_up();
        let pad = up(4.0 * error + gamma(64) * center);
        let center = if center == 0.0 { 0.0 } else { up(center) };
        Self { largest: up(largest), edge: up(edge), error: up(error), pad, center }
    }
}

impl Mesh {
    /// Builds the tree over some triangles. Uses the pool of threads that it is called in, if any; the
    /// mesh is the same for any number of threads.
    #[must_use]
    pub fn new(data: MeshData) -> Self {
        Self::build(data)
    }

    /// The triangles, as they were given.
    #[must_use]
    pub const fn data(&self) -> &MeshData {
        &self.data
    }

    /// How many triangles can be hit.
    #[must_use]
    pub const fn triangle_count(&self) -> usize {
        self.count
    }

    /// Runs the queries on these instructions, or the best below them that there are: for tests.
    #[doc(hidden)]
    pub fn use_lanes(&mut self, lanes: Lanes) {
        self.bvh.use_lanes(lanes);
    }

    fn corners(&self, part: u32) -> Option<Corners> {
        corners(&self.data, part)
    }
}

/// Marks leaves with large triangles, in the index of their first packet.
const LARGE: usize = Bvh::MAX_ITEMS >> 1;
/// The corners of a triangle; `None` where there are none, or not finite ones.
fn corners(data: &MeshData, part: u32) -> Option<Corners> {
    let indices = data.triangles.get(part as usize)?;
    let corner = |i: usize| data.positions.get(indices[i] as usize).copied();
    let corners = [corner(0)?, corner(1)?, corner(2)?];
    corners.iter().flatten().all(|x| x.is_finite()).then_some(corners)
}

impl Shape for Mesh {
    fn bounds(&self) -> Bounds {
        self.bounds
    }

    fn is_solid(&self) -> bool {
        self.closed
    }

    fn is_convex(&self) -> bool {
        false
    }

    #[inline]
    fn intersect(&self, ray: &LocalRay) -> Option<Root> {
        self.closest(ray)
    }

    #[inline]
    fn blocks(&self, ray: &LocalRay) -> Option<Root> {
        self.any(ray)
    }

    fn crossings(&self, ray: &LocalRay, out: &mut Vec<Crossing>) {
        if self.closed {
            self.all_crossings(ray, out);
        }
    }

    fn surface(&self, point: DVec3, part: u32) -> LocalSurface {
        self.surface_at(point, part)
    }

    fn surface_point(&self, point: DVec3, part: u32) -> SurfacePoint {
        self.point_at(point, part)
    }

    fn memory_bytes(&self) -> usize {
        self.bvh.memory_bytes()
            + self.packets.capacity() * size_of::<Packet>()
            + self.data.positions.capacity() * size_of::<[f32; 3]>()
            + self.data.triangles.capacity() * size_of::<[u32; 3]>()
            + self.data.normals.capacity() * size_of::<[f32; 3]>()
            + self.data.uvs.capacity() * size_of::<[f32; 2]>()
    }
}
