// SPDX-License-Identifier: MIT OR Apache-2.0
//! Directions around an axis, so that all round and flat shapes agree on where u begins.

use std::f64::consts::PI;

use dioptric_math::{DVec3, atan2, orthonormal_basis};

/// The images of +x and +z under the smallest rotation that carries +y to the unit vector `axis`:
/// `(x, axis, z)` is a right-handed orthonormal basis.
pub(crate) fn around(axis: DVec3) -> (DVec3, DVec3) {
    // The basis of Duff et al. is that rotation for +z; here the axes are renamed z -> x -> y -> z.
    let (t, b) = orthonormal_basis(DVec3::new(axis.z, axis.x, axis.y));
    let back = |v: DVec3| DVec3::new(v.y, v.z, v.x);
    (back(b), back(t))
}

/// Longitude in `[0, 1]` of the direction `(x, z)`: 0 at -z, 0.25 at -x, 0.5 at +z.
pub(crate) fn longitude(x: f64, z: f64) -> f64 {
    atan2(x, z) / (2.0 * PI) + 0.5
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_turn_with_the_axis() {
        assert_eq!(around(DVec3::Y), (DVec3::X, DVec3::Z));
        // A wall that faces +z: u to the right, and -z (which becomes v) upwards.
        assert_eq!(around(DVec3::Z), (DVec3::X, -DVec3::Y));
        for axis in [-DVec3::Y, DVec3::X, DVec3::new(0.6, -0.48, 0.64)] {
            let (x, z) = around(axis);
            assert!((z.cross(x) - axis).length() < 1e-14, "{axis}");
            assert!(x.dot(axis).abs() < 1e-15 && (x.length() - 1.0).abs() < 1e-14);
        }
    }
}
