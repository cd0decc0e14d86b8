// SPDX-License-Identifier: MIT OR Apache-2.0
//! Directions and weights of mirrored and refracted rays.

use dioptric_math::{DVec3, normalize};

/// The mirror image of a unit direction at a surface with unit normal `n`.
#[must_use]
pub fn reflect(direction: DVec3, n: DVec3) -> DVec3 {
    let r = direction - n * (2.0 * direction.dot(n));
    normalize(r).unwrap_or(r)
}

/// The shading normal on the side of the surface from which a direction comes. Where it would be seen from
/// behind nevertheless, bent as it is, it is turned just so far that it is not.
#[must_use]
pub fn facing(direction: DVec3, geometric: DVec3, shading: DVec3) -> DVec3 {
    let n = if direction.dot(geometric) > 0.0 { -shading } else { shading };
    let away = direction.dot(n);
    if away > 0.0 { normalize(n - direction * away).unwrap_or(n) } else { n }
}

/// Snell's law for a unit direction and a unit normal that faces it (`direction . n < 0`), `eta` being
/// the index of refraction on the ray's side over that on the other; `None` where all is reflected.
/// (Glassner, "An Introduction to Ray Tracing", 1989, section 5.2; Heckbert's method.)
#[must_use]
pub fn refract(direction: DVec3, n: DVec3, eta: f64) -> Option<DVec3> {
    let cos_i = -direction.dot(n);
    let sin2_t = eta * eta * (1.0 - cos_i * cos_i).max(0.0);
    if sin2_t > 1.0 {
        return None;
    }
    normalize(direction * eta + n * (eta * cos_i - (1.0 - sin2_t).sqrt()))
}

/// The share of unpolarised light that a smooth dielectric reflects: Fresnel's equations, for the
/// cosine of the angle of incidence and `eta` as in [`refract`] (Born and Wolf, "Principles of Optics",
/// 7th ed., section 1.5.2). 1 where all is reflected.
#[must_use]
pub fn fresnel(cos_i: f64, eta: f64) -> f64 {
    // No interface at all; rounding would leave a trace of a reflection that costs a ray.
    if eta == 1.0 {
        return 0.0;
    }
    let cos_i = cos_i.clamp(0.0, 1.0);
    let sin2_t = eta * eta * (1.0 - cos_i * cos_i);
    if sin2_t >= 1.0 {
        return 1.0;
    }
    let cos_t = (1.0 - sin2_t).sqrt();
    let s = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    let p = (eta * cos_t - cos_i) / (eta * cos_t + cos_i);
    0.5 * (s * s + p * p)
}

/// Schlick's curve from `normal` incidence to `grazing` (Schlick, "An Inexpensive BRDF Model for
/// Physically-based Rendering", 1994, equation 15).
#[must_use]
pub fn schlick(normal: DVec3, grazing: DVec3, cos_i: f64) -> DVec3 {
    let m = (1.0 - cos_i).clamp(0.0, 1.0);
    normal + (grazing - normal) * (m * m * m * m * m)
}

/// A normal of the facets that make a surface rough, for two uniform numbers: the GGX distribution
/// with width `alpha` around `n` (Walter et al., "Microfacet Models for Refraction through Rough
/// Surfaces", EGSR 2007, equations 35 and 36).
#[must_use]
pub fn facet_normal(n: DVec3, alpha: f64, u: [f64; 2]) -> DVec3 {
    if alpha <= 0.0 {
        return n;
    }
    let tan2 = alpha * alpha * u[0] / (1.0 - u[0]);
    let cos = 1.0 / (1.0 + tan2).sqrt();
    let sin = (1.0 - cos * cos).max(0.0).sqrt();
    let (s, c) = dioptric_math::sin_cos(2.0 * std::f64::consts::PI * u[1]);
    let (t, b) = dioptric_math::orthonormal_basis(n);
    normalize(t * (sin * c) + b * (sin * s) + n * cos).unwrap_or(n)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refraction_obeys_snell() {
        let n = DVec3::Y;
        for degrees in [0.0_f64, 10.0, 45.0, 80.0, 89.9] {
            let (s, c) = dioptric_math::sin_cos(degrees.to_radians());
            let d = DVec3::new(s, -c, 0.0);
            let t = refract(d, n, 1.0 / 1.5).unwrap();
            assert!((t.x - s / 1.5).abs() < 1e-15 && t.y < 0.0, "{degrees}");
            // And back again.
            let back = refract(t, n, 1.5).unwrap();
            assert!((back - d).length() < 1e-12, "{degrees}");
        }
        let steep = DVec3::new(0.8, -0.6, 0.0);
        assert_eq!(refract(steep, n, 1.5), None);
        assert_eq!(fresnel(0.6, 1.5), 1.0);
    }

    #[test]
    fn fresnel_at_known_angles() {
        // Normal incidence on glass: ((1.5 - 1) / (1.5 + 1))^2 = 4 %.
        assert!((fresnel(1.0, 1.0 / 1.5) - 0.04).abs() < 1e-15);
        // At Brewster's angle only s-polarised light is reflected: ((n^2 - 1) / (n^2 + 1))^2 / 2.
        let brewster = dioptric_math::atan(1.5);
        let expected = 0.5 * (1.25_f64 / 3.25) * (1.25 / 3.25);
        assert!((fresnel(dioptric_math::cos(brewster), 1.0 / 1.5) - expected).abs() < 1e-14);
        assert_eq!(fresnel(0.0, 1.0 / 1.5), 1.0);
        assert_eq!(fresnel(0.3, 1.0), 0.0);
    }

    #[test]
    fn facets_follow_the_distribution() {
        // Mean of cos^2 under D cos: compare with the quadrature of Walter's equation 33.
        let (alpha, n) = (0.4, 100_000);
        let mean: f64 = (0..n)
            .map(|i| {
                let m = facet_normal(DVec3::Z, alpha, [(f64::from(i) + 0.5) / f64::from(n), 0.3]);
                m.z * m.z
            })
            .sum::<f64>()
            / f64::from(n);
        let (steps, mut quadrature) = (200_000, 0.0);
        for i in 0..steps {
            let c2 = (f64::from(i) + 0.5) / f64::from(steps); // cos^2; d(cos^2) = 2 cos sin d(theta)
            let k = c2 * (alpha * alpha - 1.0) + 1.0;
            quadrature += c2 * alpha * alpha / (k * k) / f64::from(steps);
        }
        assert!((mean - quadrature).abs() < 1e-4, "{mean} {quadrature}");
    }
}
