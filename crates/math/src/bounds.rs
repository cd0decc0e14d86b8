// SPDX-License-Identifier: MIT OR Apache-2.0
//! Bounds on rounding errors (Higham, "Accuracy and Stability of Numerical Algorithms", 2nd ed., §3.1).

/// Half the distance between 1 and the next f64: the largest relative error of one rounding.
pub const UNIT_ROUNDOFF: f64 = f64::EPSILON * 0.5;

/// The relative error of a result after `n` roundings is at most `gamma(n)`.
#[must_use]
pub const fn gamma(n: u32) -> f64 {
    let nu = n as f64 * UNIT_ROUNDOFF;
    nu / (1.0 - nu)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gamma_bounds_a_sum() {
        let exact = 0.1 * 10.0;
        let sum = (0..10).fold(0.0, |s, _| s + 0.1);
        assert!(sum != exact && (sum - exact) / exact <= gamma(10));
    }
}
