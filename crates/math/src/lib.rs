// SPDX-License-Identifier: MIT OR Apache-2.0
//! Vectors, deterministic functions, error bounds and random numbers.
//!
//! Invariant 2 of the project (the same bits everywhere) lives or dies here: the operating
//! system's `sin`, `exp` and `pow` differ between processors, so every rendering crate calls
//! [`sin`] and its siblings, which are the pure-Rust ones of crate `libm`. `sqrt` and the four
//! operations are correctly rounded by IEEE 754 and may be used as they are.

pub mod bounds;
mod power;
pub mod random;
mod turn;
pub mod wide;

pub use glam::{DAffine3, DMat3, DVec2, DVec3, DVec4, Vec4, Vec4Swizzles};
pub use libm::{acos, asin, atan, atan2, cbrt, cos, exp, exp2, log2, log10, pow, sin, tan, tanh};
pub use power::{unit_power, unit_powers};
pub use turn::{half_turn_angle, small_sin_cos, turn_sin_cos};

/// Light as three linear lanes (Rec. 709 primaries): radiance, or a weight that multiplies it.
pub type Spectrum = DVec3;

/// Natural logarithm.
#[inline]
#[must_use]
pub fn ln(x: f64) -> f64 {
    libm::log(x)
}

/// Sine and cosine of an angle in radians.
#[inline]
#[must_use]
pub fn sin_cos(x: f64) -> (f64, f64) {
    libm::sincos(x)
}

/// `x` to a whole power, by squaring; `powi(x, 0)` is 1.
#[inline]
#[must_use]
pub fn powi(x: f64, n: u32) -> f64 {
    let (mut base, mut result, mut n) = (x, 1.0, n);
    while n > 0 {
        if n & 1 == 1 {
            result *= base;
        }
        base *= base;
        n >>= 1;
    }
    result
}

/// A unit vector for `v`, or `None` where `v` is zero, infinite or NaN.
///
/// Vectors of length 1e-200 or 1e200 work, too: they are scaled by the largest component first.
#[inline]
#[must_use]
pub fn normalize(v: DVec3) -> Option<DVec3> {
    let length2 = v.length_squared();
    if (1e-200..=1e200).contains(&length2) {
        return Some(v / length2.sqrt());
    }
    let largest = v.abs().max_element();
    if !(largest > 0.0 && largest.is_finite()) {
        return None;
    }
    let scaled = v / largest;
    Some(scaled / scaled.length())
}

/// Two unit vectors that make a right-handed orthonormal basis `(t, b, n)` with the unit vector `n`.
///
/// Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1), 2017, listing 3.
#[inline(always)]
#[must_use]
pub fn orthonormal_basis(n: DVec3) -> (DVec3, DVec3) {
    let sign = 1.0_f64.copysign(n.z);
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    (
        DVec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x),
        DVec3::new(b, sign + n.y * n.y * a, -n.y),
    )
}

/// Luminance of a linear Rec. 709 colour (ITU-R BT.709-6, section 3.2).
#[inline]
#[must_use]
pub fn luminance(c: Spectrum) -> f64 {
    0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powi_equals_repeated_multiplication() {
        for n in 0..20 {
            let slow = (0..n).fold(1.0, |p, _| p * 1.5);
            assert_eq!(powi(1.5, n), slow);
        }
    }

    #[test]
    fn normalize_survives_extreme_lengths() {
        for s in [1e-300, 1e-160, 1e-101, 1e-99, 1.0, 1e99, 1e101, 1e160, 1e300] {
            let n = normalize(DVec3::new(3.0, 0.0, 4.0) * s).unwrap();
            assert!((n - DVec3::new(0.6, 0.0, 0.8)).length() < 1e-15, "scale {s}");
        }
        assert_eq!(normalize(DVec3::ZERO), None);
        assert_eq!(normalize(DVec3::splat(f64::NAN)), None);
        assert_eq!(normalize(DVec3::new(f64::INFINITY, 0.0, 0.0)), None);
    }

    #[test]
    fn basis_is_orthonormal_and_right_handed() {
        for n in [DVec3::Z, -DVec3::Z, DVec3::X, DVec3::new(0.6, -0.48, 0.64)] {
            let (t, b) = orthonormal_basis(n);
            assert!((t.cross(b) - n).length() < 1e-14, "{n}");
            assert!(t.dot(n).abs() < 1e-15 && (t.length() - 1.0).abs() < 1e-14);
        }
    }
}
