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

/// A whole line, ready to be tested. All its vectors are in the order of `axes`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Line {
    /// The axes in cyclic order; the direction is longest along the last one.
    pub axes: [usize; 3],
    /// Where `t` is 0.
    pub origin: [f64; 3],
    /// Where `t` grows.
    pub direction: [f64; 3],
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
    /// The triangle's normal by its winding, in the line's order of axes, not of unit length.
    pub normal: [f64; 3],
}

/// A corner as the line sees it: offsets from it along the first two axes, and the depth.
type Seen = [f64; 3];

impl Line {
    /// The line of a ray. Directions that are none give lines that pass nothing.
    #[inline(always)]
    pub fn new(origin: DVec3, direction: DVec3) -> Self {
        let size = direction.abs();
        let z = if size.x >= size.y && size.x >= size.z {
            0
        } else if size.y >= size.z {
            1
        } else {
            2
        };
        let around = |v: DVec3| {
            let twice = [v.x, v.y, v.z, v.x, v.y];
            [twice[z + 1], twice[z + 2], twice[z]]
        };
        const AXES: [[usize; 3]; 3] = [[1, 2, 0], [2, 0, 1], [0, 1, 2]];
        let direction = around(direction);
        let per_depth = 1.0 / direction[2];
        Self {
            axes: AXES[z],
            origin: around(origin),
            direction,
            slope: [direction[0] * per_depth, direction[1] * per_depth],
            per_depth,
        }
    }

    /// Corners in the line's order of axes.
    #[inline(always)]
    pub fn turn(&self, corners: &Corners) -> Corners {
        let [x, y, z] = self.axes;
        corners.map(|c| [c[x], c[y], c[z]])
    }

    #[inline(always)]
    fn see_one(&self, corner: [f32; 3]) -> Seen {
        let depth = f64::from(corner[2]) - self.origin[2];
        [
            (f64::from(corner[0]) - self.origin[0]) - self.slope[0] * depth,
            (f64::from(corner[1]) - self.origin[1]) - self.slope[1] * depth,
            depth,
        ]
    }

    /// Turned corners as the line sees them.
    #[inline(always)]
    pub fn see(&self, corners: &Corners) -> [Seen; 3] {
        // Written out here and below: `map` on arrays is a call.
        [self.see_one(corners[0]), self.see_one(corners[1]), self.see_one(corners[2])]
    }

    /// Where the line passes through a triangle, its edges included; at any `t`, also behind. The corners are
    /// turned, and `seen` is what [`Self::see`] makes of them.
    #[inline(always)]
    pub fn pass(&self, corners: &Corners, [a, b, c]: &[Seen; 3]) -> Option<Passage> {
        let (u, v, w) = (area(b, c), area(c, a), area(a, b));
        let within = (u >= 0.0 && v >= 0.0 && w >= 0.0) || (u <= 0.0 && v <= 0.0 && w <= 0.0);
        let sum = u + v + w;
        if !within || sum == 0.0 {
            return None;
        }
        let (i, j, k) = (exact(corners[0]), exact(corners[1]), exact(corners[2]));
        let n = (j - i).cross(k - i);
        let normal = [n.x, n.y, n.z];
        // By the plane, which is as good for needles as for other triangles, and within the corners' depths.
        let [x, y, z] = self.origin;
        let height = n.x * (i.x - x) + n.y * (i.y - y) + n.z * (i.z - z);
        let t = height / self.rate(&normal);
        let (i, j, k) = (a[2] * self.per_depth, b[2] * self.per_depth, c[2] * self.per_depth);
        let t = if t.is_finite() {
            t.max(i.min(j).min(k)).min(i.max(j).max(k))
        } else {
            (u * i + v * j + w * k) / sum
        };
        t.is_finite().then_some(Passage { t, normal })
    }

    /// The `t` that [`Self::pass`] finds in a triangle that the line certainly passes: to the last bit, and with less to
    /// do. `None` where it takes more.
    #[inline(always)]
    pub fn cut(&self, corners: &Corners) -> Option<f64> {
        let (i, j, k) = (exact(corners[0]), exact(corners[1]), exact(corners[2]));
        let n = (j - i).cross(k - i);
        let [x, y, z] = self.origin;
        let height = n.x * (i.x - x) + n.y * (i.y - y) + n.z * (i.z - z);
        let t = height / self.rate(&[n.x, n.y, n.z]);
        let depth = |corner: DVec3| (corner.z - z) * self.per_depth;
        let (i, j, k) = (depth(i), depth(j), depth(k));
        let (low, high) = (lesser(i, lesser(j, k)), greater(i, greater(j, k)));
        (t + (i + j + k)).is_finite().then(|| lesser(greater(t, low), high))
    }

    /// How fast the line moves along a normal.
    #[inline(always)]
    pub fn rate(&self, normal: &[f64; 3]) -> f64 {
        let [x, y, z] = self.direction;
        normal[0] * x + normal[1] * y + normal[2] * z
    }

    /// The same for a count of passages: a line through an edge or a corner passes as one beside it would,
    /// always the same one.
    pub fn pass_once(&self, corners: &Corners) -> Option<Passage> {
        let corners = self.turn(corners);
        let seen = self.see(&corners);
        let [a, b, c] = &seen;
        let sides = [beside(b, c), beside(c, a), beside(a, b)];
        (sides.iter().all(|&s| s > 0.0) || sides.iter().all(|&s| s < 0.0))
            .then(|| self.pass(&corners, &seen))?
    }
}

/// The smaller one of two numbers that are not NaN: one instruction, where the minimum of a number and NaN takes three.
#[inline(always)]
fn lesser(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// The larger one of two numbers that are not NaN.
#[inline(always)]
fn greater(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// Twice the signed area of the triangle (0, `a`, `b`); exactly the negative for (0, `b`, `a`).
#[inline(always)]
fn area(a: &Seen, b: &Seen) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

/// The sign of the area seen from a point that is moved by nearly nothing along the first axis, and by
/// nearly nothing of that along the second; 0 only for an edge that the line runs along.
fn beside(a: &Seen, b: &Seen) -> f64 {
    let area = area(a, b);
    if area != 0.0 {
        area
    } else if a[1] != b[1] {
        a[1] - b[1]
    } else {
        b[0] - a[0]
    }
}

/// A corner in f64.
#[inline(always)]
pub(crate) fn exact(corner: [f32; 3]) -> DVec3 {
    DVec3::new(f64::from(corner[0]), f64::from(corner[1]), f64::from(corner[2]))
}

/// The normal by the winding, twice as long as the triangle's area; zero for triangles without area.
#[inline(always)]
pub(crate) fn normal(corners: &Corners) -> DVec3 {
    let (a, b, c) = (exact(corners[0]), exact(corners[1]), exact(corners[2]));
    (b - a).cross(c - a)
}

/// The point of a triangle that is nearest to `p`: Ericson, "Real-Time Collision Detection", 2005, 5.1.5.
pub(crate) fn nearest(p: DVec3, corners: &Corners) -> DVec3 {
    let [a, b, c] = corners.map(exact);
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
