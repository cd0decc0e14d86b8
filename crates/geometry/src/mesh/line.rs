// SPDX-License-Identifier: MIT OR Apache-2.0
//! The exact test of a triangle: the one formula, in plain f64, by which a mesh is hit or not.
//!
//! Edges after Woop, Benthin and Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013, from
//! numbers that depend on each corner and the ray alone, so neighbours agree about their common edge
//! to the last bit, and an edge belongs to both. In f64, corners being f32, the sign of an edge function is
//! never wrong, only 0 where rounding hides it.

use dioptric_math::DVec3;

/// The corners of a triangle, as files hold them.
pub(crate) type Corners = [[f32; 3]; 3];

/// A whole line, ready to be tested.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Line {
    /// Where `t` is 0.
    pub origin: DVec3,
    /// Where `t` grows.
    pub direction: DVec3,
    /// The axes in cyclic order; the direction is longest along the last one.
    pub axes: [usize; 3],
    /// How far the line moves along the first two axes for each step along the last.
    pub slope: [f64; 2],
    /// Steps of `t` for each step along the last axis.
    pub per_depth: f64,
}

/// A passage of the line through a triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Passage {
    /// Where.
    pub t: f64,
    /// The triangle's normal by its winding, not of unit length.
    pub normal: DVec3,
}

/// A corner as the line sees it: offsets from it along the first two axes, and the depth.
type Seen = [f64; 3];

impl Line {
    /// The line of a ray. Directions that are none give lines that pass nothing.
    #[inline]
    pub fn new(origin: DVec3, direction: DVec3) -> Self {
        let size = direction.abs();
        let z = if size.x >= size.y && size.x >= size.z {
            0
        } else if size.y >= size.z {
            1
        } else {
            2
        };
        let (x, y) = ([1, 2, 0][z], [2, 0, 1][z]);
        let [dx, dy, dz] = [direction[x], direction[y], direction[z]];
        Self { origin, direction, axes: [x, y, z], slope: [dx / dz, dy / dz], per_depth: 1.0 / dz }
    }

    #[inline]
    fn see(&self, corner: [f32; 3]) -> Seen {
        let offset = DVec3::from(corner.map(f64::from)) - self.origin;
        let [x, y, z] = self.axes.map(|axis| offset[axis]);
        [x - self.slope[0] * z, y - self.slope[1] * z, z]
    }

    /// Where the line passes through a triangle, its edges included; at any `t`, also behind.
    #[inline]
    pub fn pass(&self, corners: &Corners) -> Option<Passage> {
        let [a, b, c] = corners.map(|corner| self.see(corner));
        let (u, v, w) = (area(b, c), area(c, a), area(a, b));
        let within = (u >= 0.0 && v >= 0.0 && w >= 0.0) || (u <= 0.0 && v <= 0.0 && w <= 0.0);
        let sum = u + v + w;
        if !within || sum == 0.0 {
            return None;
        }
        let normal = normal(corners);
        // By the plane, which is as good for needles as for other triangles, and within the corners' depths.
        let height = normal.dot(DVec3::from(corners[0].map(f64::from)) - self.origin);
        let t = height / normal.dot(self.direction);
        let depths = [a[2], b[2], c[2]].map(|depth| depth * self.per_depth);
        let (low, high) =
            (depths[0].min(depths[1]).min(depths[2]), depths[0].max(depths[1]).max(depths[2]));
        let t = if t.is_finite() {
            t.max(low).min(high)
        } else {
            (u * depths[0] + v * depths[1] + w * depths[2]) / sum
        };
        t.is_finite().then_some(Passage { t, normal })
    }

    /// The same for a count of passages: a line through an edge or a corner passes as one beside it would,
    /// always the same one.
    pub fn pass_once(&self, corners: &Corners) -> Option<Passage> {
        let [a, b, c] = corners.map(|corner| self.see(corner));
        let sides = [beside(b, c), beside(c, a), beside(a, b)];
        (sides.iter().all(|&s| s > 0.0) || sides.iter().all(|&s| s < 0.0))
            .then(|| self.pass(corners))?
    }
}

/// Twice the signed area of the triangle (0, `a`, `b`); exactly the negative for (0, `b`, `a`).
#[inline]
fn area(a: Seen, b: Seen) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

/// The sign of the area seen from a point that is moved by nearly nothing along the first axis, and by
/// nearly nothing of that along the second; 0 only for an edge that the line runs along.
fn beside(a: Seen, b: Seen) -> f64 {
    let area = area(a, b);
    if area != 0.0 {
        area
    } else if a[1] != b[1] {
        a[1] - b[1]
    } else {
        b[0] - a[0]
    }
}

/// The normal by the winding, twice as long as the triangle's area; zero for triangles without area.
#[inline]
pub(crate) fn normal(corners: &Corners) -> DVec3 {
    let [a, b, c] = corners.map(|corner| DVec3::from(corner.map(f64::from)));
    (b - a).cross(c - a)
}

/// The point of a triangle that is nearest to `p`: Ericson, "Real-Time Collision Detection", 2005, 5.1.5.
pub(crate) fn nearest(p: DVec3, corners: &Corners) -> DVec3 {
    let [a, b, c] = corners.map(|corner| DVec3::from(corner.map(f64::from)));
    let (ab, ac) = (b - a, c - a);
    let along = |to: DVec3| (ab.dot(p - to), ac.dot(p - to));
    let ((d1, d2), (d3, d4), (d5, d6)) = (along(a), along(b), along(c));
    if d1 <= 0.0 && d2 <= 0.0 {
        return a;
    }
    if d3 >= 0.0 && d4 <= d3 {
        return b;
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return a + ab * (d1 / (d1 - d3));
    }
    if d6 >= 0.0 && d5 <= d6 {
        return c;
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return a + ac * (d2 / (d2 - d6));
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        return b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
    }
    a + ab * (vb / (va + vb + vc)) + ac * (vc / (va + vb + vc))
}
