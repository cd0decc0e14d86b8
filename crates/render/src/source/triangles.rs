// SPDX-License-Identifier: MIT OR Apache-2.0
//! A mesh, found uniformly over its area.

use std::sync::Arc;

use dioptric_geometry::Mesh;
use dioptric_math::bounds::gamma;
use dioptric_math::{DAffine3, DVec3, normalize};

use super::emitter::ball_around;
use super::faces::Face;
use super::patch::{Found, Met};

/// A mesh in its place.
#[derive(Clone, Debug)]
pub(super) struct Triangles {
    mesh: Arc<Mesh>,
    to_ray: DAffine3,
    /// The area of all triangles up to and with each.
    areas: Vec<f64>,
}

impl Triangles {
    /// `None` where nothing of it has an area.
    pub fn new(mesh: &Arc<Mesh>, to_ray: DAffine3) -> Option<Self> {
        let mut sum = 0.0;
        let triangles = mesh.data().triangles.len() as u32;
        let areas = (0..triangles)
            .map(|part| {
                sum += face(mesh, &to_ray, part).map_or(0.0, |f| f.area());
                sum
            })
            .collect();
        (sum > 0.0 && sum.is_finite()).then(|| Self { mesh: mesh.clone(), to_ray, areas })
    }

    pub fn area(&self) -> f64 {
        self.areas.last().copied().unwrap_or(0.0)
    }

    /// A ball around it.
    pub fn ball(&self) -> (DVec3, f64) {
        let points = self.mesh.data().positions.iter();
        let points = points.map(|p| self.to_ray.transform_point3(DVec3::from(p.map(f64::from))));
        ball_around(points.filter(|p| p.is_finite()))
    }

    /// A point and its triangle, uniform over the area.
    pub fn point(&self, u: [f64; 2]) -> Option<(DVec3, Face)> {
        let at = u[0] * self.area();
        let part = self.areas.partition_point(|&a| a <= at);
        let before = if part > 0 { self.areas.get(part - 1).copied()? } else { 0.0 };
        let own = self.areas.get(part)? - before;
        let face = face(&self.mesh, &self.to_ray, part as u32)?;
        Some((face.point([((at - before) / own).clamp(0.0, 1.0), u[1]]), face))
    }

    pub fn sample(&self, point: DVec3, u: [f64; 2]) -> Option<Found> {
        let (there, face) = self.point(u)?;
        let (way, normal) = (there - point, face.normal());
        let rounding = gamma(32) * (there.abs().max_element() + point.abs().max_element());
        if !(way.dot(normal).abs() > rounding) {
            return None; // in its plane
        }
        let (direction, distance) = (normalize(way)?, way.length());
        let met = Met { direction, distance, normal };
        let density = met.per_solid_angle(1.0 / self.area());
        Some(Found { direction, distance, normal, density, part: face.part() })
    }
}

/// A triangle of a mesh in the space of rays.
pub(super) fn face(mesh: &Mesh, to_ray: &DAffine3, part: u32) -> Option<Face> {
    let data = mesh.data();
    let indices = data.triangles.get(part as usize)?;
    let mut corners = [DVec3::ZERO; 3];
    for (corner, &index) in corners.iter_mut().zip(indices) {
        let at = data.positions.get(index as usize)?;
        *corner = DVec3::from(at.map(f64::from));
    }
    let [a, b, c] = corners;
    let edges = [b - a, c - a].map(|e| to_ray.transform_vector3(e));
    Face::triangle(to_ray.transform_point3(a), edges, part)
}
