// SPDX-License-Identifier: MIT OR Apache-2.0
//! What a mesh looks like at a point of one of its triangles.

use dioptric_math::bounds::gamma;
use dioptric_math::{DVec2, DVec3, normalize, orthonormal_basis};

use super::Mesh;
use super::line::{Corners, exact, normal};
use crate::shape::{LocalSurface, SurfacePoint};
use crate::shapes::triangle::barycentric;

impl Mesh {
    /// The unit normal of a triangle, on its outer side.
    pub(super) fn outward(&self, part: u32, corners: &Corners) -> DVec3 {
        let unit = normalize(normal(corners)).unwrap_or(DVec3::Y);
        if self.closed {
            return if self.inverted { -unit } else { unit };
        }
        let against =
            self.normals_of(part).is_some_and(|n| n.iter().sum::<DVec3>().dot(unit) < 0.0);
        if against { -unit } else { unit }
    }

    /// The shading normals at the corners, of unit length.
    fn normals_of(&self, part: u32) -> Option<[DVec3; 3]> {
        let indices = self.data.triangles.get(part as usize)?;
        let at = |i: usize| {
            let n = self.data.normals.get(indices[i] as usize)?;
            normalize(DVec3::from(n.map(f64::from)))
        };
        Some([at(0)?, at(1)?, at(2)?])
    }

    /// The surface coordinates at the corners.
    fn uvs_of(&self, part: u32) -> Option<[DVec2; 3]> {
        let indices = self.data.triangles.get(part as usize)?;
        let at = |i: usize| {
            let uv = self.data.uvs.get(indices[i] as usize)?;
            uv.iter().all(|x| x.is_finite()).then(|| DVec2::from(uv.map(f64::from)))
        };
        Some([at(0)?, at(1)?, at(2)?])
    }

    /// See [`crate::Shape::surface_point`].
    pub(super) fn point_at(&self, point: DVec3, part: u32) -> SurfacePoint {
        let corners = self.corners(part).unwrap_or_default();
        let normal = self.outward(part, &corners);
        let weights = barycentric(corners.map(exact), normal, point);
        self.point_with(&corners, normal, weights, part)
    }

    fn point_with(
        &self,
        corners: &Corners,
        normal: DVec3,
        weights: [f64; 3],
        part: u32,
    ) -> SurfacePoint {
        let [a, b, c] = corners.map(exact);
        let (e, f) = (b - a, c - a);
        let blend = |n: [DVec3; 3]| n[0] * weights[0] + n[1] * weights[1] + n[2] * weights[2];
        // On the side of the geometric normal, as the surface's reader expects.
        let shading_normal = self
            .normals_of(part)
            .and_then(|n| normalize(blend(n)))
            .map_or(normal, |n| if n.dot(normal) < 0.0 { -n } else { n });
        SurfacePoint {
            point: a + (e * weights[1] + f * weights[2]),
            error: gamma(8) * (a.abs() + e.abs() + f.abs()).max_element(),
            normal,
            shading_normal,
        }
    }

    /// See [`crate::Shape::surface`].
    pub(super) fn surface_at(&self, point: DVec3, part: u32) -> LocalSurface {
        let corners = self.corners(part).unwrap_or_default();
        let geometric = self.outward(part, &corners);
        let [a, b, c] = corners.map(exact);
        let weights = barycentric([a, b, c], geometric, point);
        let (e, f) = (b - a, c - a);
        let [uv_a, uv_b, uv_c] = self.uvs_of(part).unwrap_or([DVec2::ZERO, DVec2::X, DVec2::Y]);
        let (g, h) = (uv_b - uv_a, uv_c - uv_a);
        let turn = g.x * h.y - g.y * h.x;
        let (dpdu, dpdv) = ((e * h.y - f * g.y) / turn, (f * g.x - e * h.x) / turn);
        // Coordinates that do not span the triangle have no directions: any tangents will do.
        let (dpdu, dpdv) = if dpdu.is_finite() && dpdv.is_finite() {
            (dpdu, dpdv)
        } else {
            orthonormal_basis(geometric)
        };
        let SurfacePoint { point, error, normal, shading_normal } =
            self.point_with(&corners, geometric, weights, part);
        let uv = uv_a + (g * weights[1] + h * weights[2]);
        LocalSurface { point, error, normal, shading_normal, uv, dpdu, dpdv }
    }
}
