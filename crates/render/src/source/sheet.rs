// SPDX-License-Identifier: MIT OR Apache-2.0
//! Flat polygons with any outline and holes: cut into triangles, found uniformly over their area where these are many.

use dioptric_math::bounds::gamma;
use dioptric_math::{DVec2, DVec3, normalize, orthonormal_basis};

use super::faces::Face;
use super::patch::{Found, Met};

/// Polygons with more corners are not cut: the work grows with the square.
const MOST_CORNERS: usize = 2000;

/// Many faces of one plane.
#[derive(Clone, Debug)]
pub(super) struct Sheet {
    faces: Vec<Face>,
    /// The area of all faces up to and with each.
    areas: Vec<f64>,
}

impl Sheet {
    pub fn new(faces: Vec<Face>) -> Option<Self> {
        let mut sum = 0.0;
        let areas = faces.iter().map(|face| {
            sum += face.area();
            sum
        });
        let areas: Vec<f64> = areas.collect();
        (sum > 0.0 && sum.is_finite()).then_some(Self { faces, areas })
    }

    pub fn faces(&self) -> &[Face] {
        &self.faces
    }

    pub fn area(&self) -> f64 {
        self.areas.last().copied().unwrap_or(0.0)
    }

    /// A point, uniform over the area, and the normal.
    pub fn point(&self, u: [f64; 2]) -> Option<(DVec3, DVec3)> {
        let at = u[0] * self.area();
        let i = self.areas.partition_point(|&a| a <= at).min(self.faces.len() - 1);
        let before = if i > 0 { self.areas[i - 1] } else { 0.0 };
        let own = self.areas[i] - before;
        let face = self.faces.get(i)?;
        Some((face.point([((at - before) / own).clamp(0.0, 1.0), u[1]]), face.normal()))
    }

    pub fn sample(&self, point: DVec3, u: [f64; 2]) -> Option<Found> {
        let (there, normal) = self.point(u)?;
        let way = there - point;
        let rounding = gamma(32) * (there.abs().max_element() + point.abs().max_element());
        if !(way.dot(normal).abs() > rounding) {
            return None; // in its plane
        }
        let (direction, distance) = (normalize(way)?, way.length());
        let met = Met { direction, distance, normal };
        let density = met.per_solid_angle(1.0 / self.area());
        Some(Found { direction, distance, normal, density, part: 0 })
    }
}

/// The triangles of what rings of corners in a plane enclose, by the parity of rings around a point: between every two
/// neighbouring heights of corners the edges cut off trapezoids.
pub(super) fn triangles(rings: &[Vec<DVec3>], normal: DVec3) -> Option<Vec<Face>> {
    let corners: usize = rings.iter().map(Vec::len).sum();
    let origin = *rings.first()?.first()?;
    if corners > MOST_CORNERS {
        return None;
    }
    let (x, y) = orthonormal_basis(normal);
    let flat = |p: DVec3| DVec2::new((p - origin).dot(x), (p - origin).dot(y));
    let mut heights: Vec<f64> = rings.iter().flatten().map(|&p| flat(p).y).collect();
    heights.sort_by(f64::total_cmp);
    heights.dedup();
    let mut edges = Vec::with_capacity(corners);
    for ring in rings {
        for (i, &a) in ring.iter().enumerate() {
            let (a, b) = (flat(a), flat(ring[(i + 1) % ring.len()]));
            if a.y != b.y {
                edges.push(if a.y < b.y { [a, b] } else { [b, a] });
            }
        }
    }
    let mut faces = Vec::new();
    for slab in heights.windows(2) {
        let [low, high] = [slab[0], slab[1]];
        let at = |[a, b]: &[DVec2; 2], h: f64| a.x + (b.x - a.x) * ((h - a.y) / (b.y - a.y));
        let mut sides: Vec<[f64; 2]> = edges
            .iter()
            .filter(|[a, b]| a.y <= low && b.y >= high)
            .map(|edge| [at(edge, low), at(edge, high)])
            .collect();
        sides.sort_by(|a, b| (a[0] + a[1]).total_cmp(&(b[0] + b[1])));
        for pair in sides.chunks_exact(2) {
            let place = |u: f64, v: f64| origin + x * u + y * v;
            let [a, b] = [place(pair[0][0], low), place(pair[1][0], low)];
            let [c, d] = [place(pair[1][1], high), place(pair[0][1], high)];
            faces.extend(Face::triangle(a, [b - a, c - a], 0));
            faces.extend(Face::triangle(a, [c - a, d - a], 0));
        }
    }
    Some(faces)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_with_a_hole_has_the_area_that_is_left() {
        let ring = |points: &[(f64, f64)]| {
            points.iter().map(|&(a, b)| DVec3::new(a, 0.3 * a, b)).collect::<Vec<_>>()
        };
        let outer = ring(&[(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (2.0, 3.0), (0.0, 4.0)]);
        let hole = ring(&[(1.0, 1.0), (1.0, 2.0), (2.0, 2.0)]);
        let normal = normalize(DVec3::new(-0.3, 1.0, 0.0)).unwrap();
        let faces = triangles(&[outer, hole], normal).unwrap();
        let area: f64 = faces.iter().map(Face::area).sum();
        let slope = 1.09_f64.sqrt();
        assert!((area - (14.0 - 0.5) * slope).abs() < 1e-12, "{area}");
        let sheet = Sheet::new(faces).unwrap();
        for i in 0..200 {
            let u = [(f64::from(i) + 0.5) / 200.0, (f64::from(i) * 0.618).fract()];
            let (p, _) = sheet.point(u).unwrap();
            let in_hole = p.x > 1.0 && p.z < 2.0 && p.z > p.x;
            assert!((p.y - 0.3 * p.x).abs() < 1e-12 && !in_hole, "{p}");
        }
    }
}
