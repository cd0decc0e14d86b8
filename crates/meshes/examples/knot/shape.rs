// SPDX-License-Identifier: MIT OR Apache-2.0
//! A trefoil knot of tube, closed, with normals.

use dioptric_geometry::MeshData;
use dioptric_math::{DVec3, cos, sin};

/// Rings along the tube, and corners of a ring.
const RINGS: u32 = 160;
const SIDES: u32 = 16;
/// Radii of the ring around which the knot winds, of its winding, and of the tube; the knot is 2 high.
const RADII: [f64; 3] = [0.6, 0.26, 0.14];

/// The knot, standing upright around the origin.
pub fn knot() -> MeshData {
    let [around, winding, tube] = RADII;
    let mut mesh = MeshData::default();
    for ring in 0..RINGS {
        let t = f64::from(ring) / f64::from(RINGS) * std::f64::consts::TAU;
        let (s2, c2, s3, c3) = (sin(2.0 * t), cos(2.0 * t), sin(3.0 * t), cos(3.0 * t));
        let middle = DVec3::new(c2, s2, 0.0) * (around + winding * c3) + DVec3::Z * (winding * s3);
        let out = DVec3::new(c2 * c3, s2 * c3, s3);
        let along = DVec3::new(-s2, c2, 0.0) * (2.0 * (around + winding * c3))
            + DVec3::new(-c2 * s3, -s2 * s3, c3) * (3.0 * winding);
        let side = along.cross(out);
        let side = side / side.length();
        for corner in 0..SIDES {
            let a = f64::from(corner) / f64::from(SIDES) * std::f64::consts::TAU;
            let normal = out * cos(a) + side * sin(a);
            mesh.positions.push((middle + normal * tube).to_array().map(|x| x as f32));
            mesh.normals.push(normal.to_array().map(|x| x as f32));
        }
    }
    let at = |ring: u32, corner: u32| ring % RINGS * SIDES + corner % SIDES;
    for (r, c) in (0..RINGS).flat_map(|r| (0..SIDES).map(move |c| (r, c))) {
        mesh.triangles.push([at(r, c), at(r + 1, c + 1), at(r + 1, c)]);
        mesh.triangles.push([at(r, c), at(r, c + 1), at(r + 1, c + 1)]);
    }
    mesh
}
