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
#[inline(always)]
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

/// A normal of the facets that make a surface rough, for two uniform numbers: one of those that a
/// direction meets, of the GGX distribution with width `alpha` around `n`, which faces it (Heitz,
/// "Sampling the GGX Distribution of Visible Normals", JCGT 7(4), 2018, listing 3).
#[must_use]
pub fn facet_normal(n: DVec3, direction: DVec3, alpha: f64, u: [f64; 2]) -> DVec3 {
    if alpha <= 0.0 {
        return n;
    }
    let (t, b) = dioptric_math::orthonormal_basis(n);
    let to_eye = DVec3::new(-direction.dot(t), -direction.dot(b), (-direction.dot(n)).max(0.0));
    // Stretched by 1 / alpha the facets are those of a hemisphere, whose visible part is projected to a
    // half disc and a half ellipse.
    let stretch = DVec3::new(alpha, alpha, 1.0);
    let v = normalize(to_eye * stretch).unwrap_or(DVec3::Z);
    let across = normalize(DVec3::Z.cross(v)).unwrap_or(DVec3::X);
    let along = v.cross(across);
    let (sin, cos) = dioptric_math::sin_cos(2.0 * std::f64::consts::PI * u[1]);
    let (x, y) = (u[0].sqrt() * cos, u[0].sqrt() * sin);
    let share = 0.5 * (1.0 + v.z);
    let y = (1.0 - share) * (1.0 - x * x).max(0.0).sqrt() + share * y;
    let m = across * x + along * y + v * (1.0 - x * x - y * y).max(0.0).sqrt();
    let m = DVec3::new(m.x, m.y, m.z.max(0.0)) * stretch;
    normalize(t * m.x + b * m.y + n * m.z).unwrap_or(n)
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
        // Seen straight on: the mean of cos^2 under D cos. Compare with the quadrature of Walter's equation 33.
        let (alpha, n) = (0.4, 100_000);
        let mean: f64 = (0..n)
            .map(|i| {
                let u = [(f64::from(i) + 0.5) / f64::from(n), 0.3];
                let m = facet_normal(DVec3::Z, DVec3::NEG_Z, alpha, u);
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

    #[test]
    fn facets_are_found_as_often_as_they_are_seen() {
        for (i, (alpha, degrees)) in
            [(0.15, 0.0_f64), (0.5, 60.0), (1.0, 85.0)].into_iter().enumerate()
        {
            let (s, c) = dioptric_math::sin_cos(degrees.to_radians());
            let v = DVec3::new(s, 0.0, c);
            // Heitz, "Understanding the Masking-Shadowing Function", JCGT 3(2), 2014, equation 16, with Walter's D and G1.
            let g1 = 2.0 / (1.0 + (1.0 + alpha * alpha * s * s / (c * c)).sqrt());
            let density = |m: DVec3| {
                let k = m.z * m.z * (alpha * alpha - 1.0) + 1.0;
                let d = alpha * alpha / (std::f64::consts::PI * k * k);
                if m.z > 0.0 { g1 * d * m.dot(v).max(0.0) / c } else { 0.0 }
            };
            let most = if alpha < 0.2 { 0.2 } else { 1.0 };
            let around = crate::statistics::Around { axis: DVec3::Z, most };
            let draw = |u| facet_normal(DVec3::Z, -v, alpha, u);
            let verdict =
                around.judge(100, density, |r| Some(draw([r.unit(), r.unit()])), 80 + i as u64);
            verdict.check(&format!("{alpha} {degrees}"), 3);
        }
    }

    #[test]
    fn facets_are_those_that_are_seen() {
        // The visible ones are in proportion to D max(0, v.m), whose integral is v.n / G1 (Heitz, equations 2
        // and 3): the mean of cos over them is that of max(0, v.m) under D cos, times G1 / v.n.
        for (alpha, degrees) in [(0.1, 80.0_f64), (0.5, 60.0), (1.0, 85.0)] {
            let (s, c) = dioptric_math::sin_cos(degrees.to_radians());
            let v = DVec3::new(s, 0.0, c);
            let n = 400;
            let at = |i: u32| (f64::from(i) + 0.5) / f64::from(n);
            let grid = || (0..n * n).map(|i| [at(i % n), at(i / n)]);
            let mut mean = 0.0;
            for u in grid() {
                let m = facet_normal(DVec3::Z, -v, alpha, u);
                assert!(m.dot(v) > -1e-12 && m.z >= 0.0 && (m.length() - 1.0).abs() < 1e-12);
                mean += m.z / f64::from(n * n);
            }
            // D cos is sampled by a view straight on.
            let all =
                grid().map(|u| facet_normal(DVec3::Z, DVec3::NEG_Z, alpha, u).dot(v).max(0.0));
            let g1 = 2.0 / (1.0 + (1.0 + alpha * alpha * s * s / (c * c)).sqrt());
            let expected = all.sum::<f64>() / f64::from(n * n) * g1 / c;
            assert!((mean / expected - 1.0).abs() < 1e-2, "{alpha} {degrees}: {mean} {expected}");
        }
    }
}
