// SPDX-License-Identifier: MIT OR Apache-2.0
//! Triangle meshes: millions of triangles as one shape, with a tree of their own.
//!
//! The corners are the f32 numbers of [`MeshData`], exactly. A part is the index of a triangle. Triangles
//! with bad indices, with numbers that are not finite and without area are left out.

mod closed;
mod line;
mod query;
mod surface;

use dioptric_math::DVec3;
use dioptric_math::bounds::gamma;

use crate::bounds::Bounds;
use crate::bvh::Bvh;
use crate::mesh_data::MeshData;
use crate::ray::LocalRay;
use crate::shape::{Crossing, LocalSurface, Root, Shape, SurfacePoint};
use closed::Boundary;
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
    bvh: Bvh,
    /// Triangles in the order of the tree's leaves.
    order: Vec<u32>,
    bounds: Bounds,
    /// Bounds the rounding of all heights and of points on the surface.
    error: f64,
    closed: bool,
    /// Whether the winding of a closed mesh makes its inside its front.
    inverted: bool,
}

impl Mesh {
    /// Builds the tree over some triangles. Uses the pool of threads that it is called in, if any; the
    /// mesh is the same for any number of threads.
    #[must_use]
    pub fn new(data: MeshData) -> Self {
        let mut kept = Vec::with_capacity(data.triangles.len());
        let mut tight = Bounds::EMPTY;
        let mut boundary = Boundary::default();
        let mut volume = 0.0;
        for part in 0..data.triangles.len() as u32 {
            let Some(corners) = corners(&data, part) else { continue };
            boundary.add(&corners);
            if line::normal(&corners) == DVec3::ZERO {
                continue;
            }
            let [a, b, c] = corners.map(|corner| DVec3::from(corner.map(f64::from)));
            volume += a.dot(b.cross(c));
            tight = tight.union(Bounds::of([a, b, c]));
            kept.push(part);
        }
        let boxes = kept.iter().map(|&part| {
            let corners = corners(&data, part).unwrap_or_default();
            Bounds::of(corners.map(|corner| DVec3::from(corner.map(f64::from))))
        });
        let center = if tight.is_empty() { DVec3::ZERO } else { tight.center() };
        let (bvh, order) = Bvh::build(boxes, center);
        let order = order.iter().filter_map(|&i| kept.get(i as usize).copied()).collect();
        let largest =
            if tight.is_empty() { 0.0 } else { tight.min.abs().max(tight.max.abs()).max_element() };
        let error = gamma(16) * largest;
        let bounds = Bounds { min: tight.min - error, max: tight.max + error };
        let closed = boundary.is_closed() && !kept.is_empty();
        Self { data, bvh, order, bounds, error, closed, inverted: closed && volume < 0.0 }
    }

    /// The triangles, as they were given.
    #[must_use]
    pub const fn data(&self) -> &MeshData {
        &self.data
    }

    /// How many triangles can be hit.
    #[must_use]
    pub fn triangle_count(&self) -> usize {
        self.order.len()
    }

    fn corners(&self, part: u32) -> Option<Corners> {
        corners(&self.data, part)
    }
}

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

    fn intersect(&self, ray: &LocalRay) -> Option<Root> {
        self.closest(ray)
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
            + self.order.capacity() * size_of::<u32>()
            + self.data.positions.capacity() * size_of::<[f32; 3]>()
            + self.data.triangles.capacity() * size_of::<[u32; 3]>()
            + self.data.normals.capacity() * size_of::<[f32; 3]>()
            + self.data.uvs.capacity() * size_of::<[f32; 2]>()
    }
}
