// SPDX-License-Identifier: MIT OR Apache-2.0
//! Points as a ray sees them: moved and sheared so that the ray runs along an axis from the origin.
//! What a ray passes is then decided in two dimensions, from numbers that depend on each corner alone,
//! so neighbours that share corners agree about their common edge to the last bit.
//!
//! Woop, Benthin and Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013. In plain f64,
//! the sign of a difference of two rounded products is never wrong, only 0 where they are too close.

use dioptric_math::{DVec2, DVec3};

/// The shear of one ray.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shear {
    origin: DVec3,
    axes: (usize, usize, usize),
    slope: DVec2,
}

impl Shear {
    /// The shear that carries `direction` to an axis. Directions that are none give NaN.
    pub fn new(origin: DVec3, direction: DVec3) -> Self {
        let size = direction.abs();
        let z = if size.x >= size.y && size.x >= size.z {
            0
        } else if size.y >= size.z {
            1
        } else {
            2
        };
        let (x, y) = ((z + 1) % 3, (z + 2) % 3);
        let slope = DVec2::new(direction[x], direction[y]) / direction[z];
        Self { origin, axes: (x, y, z), slope }
    }

    /// A point as the ray sees it; the ray itself is at (0, 0).
    pub fn project(&self, p: DVec3) -> DVec2 {
        let offset = p - self.origin;
        let (x, y, z) = self.axes;
        DVec2::new(offset[x], offset[y]) - self.slope * offset[z]
    }
}

/// Twice the signed area of the triangle (0, `a`, `b`); exactly the negative for (0, `b`, `a`).
pub(crate) fn area(a: DVec2, b: DVec2) -> f64 {
    a.x * b.y - a.y * b.x
}

/// Unit normal of a triangle and the sine of the angle that it was taken from, which divides the
/// normal's rounding error; `None` where the corners lie on a line or are not finite.
///
/// The angle opposite to the longest edge loses the fewest digits.
pub(crate) fn triangle_normal(a: DVec3, b: DVec3, c: DVec3) -> Option<(DVec3, f64)> {
    let (ab, bc, ca) = (b - a, c - b, a - c);
    let (x, y, z) = (ab.length(), bc.length(), ca.length());
    let (e, f) = if x >= y && x >= z {
        ((bc, y), (ca, z))
    } else if y >= z {
        ((ca, z), (ab, x))
    } else {
        ((ab, x), (bc, y))
    };
    let cross = (e.0 / e.1).cross(f.0 / f.1);
    let sine = cross.length();
    // Below this, rounding alone decides the normal.
    (sine > 1e-12).then(|| (cross / sine, sine))
}
