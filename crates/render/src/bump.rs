// SPDX-License-Identifier: MIT OR Apache-2.0
//! Bump mapping: the shading normal of a surface that a pattern displaces, without displacing it.
//!
//! A point p with unit normal n moves to `p + h n`; for small heights h the new normal is
//! `n - grad h` with the gradient along the surface (Blinn, "Simulation of Wrinkled Surfaces",
//! SIGGRAPH 1978, with two tangents at right angles instead of the surface's own, so that nothing
//! happens at poles). The gradient is a central difference: the shape is asked for the surface a
//! small step away, so that point, uv and normals of the displaced point all fit together.

use dioptric_geometry::{AnyShape, LocalSurface};
use dioptric_math::{DMat3, DVec3, normalize, orthonormal_basis};

use crate::material::{Bump, Relief};
use crate::pattern::PatternPoint;

/// The step as a share of the surface's size: small against what patterns show, large against rounding.
const STEP: f64 = 1e-6;

/// The least step as a share of the largest coordinate: a millionfold of its rounding.
const STEP_OVER_ROUNDING: f64 = 1e-9;

/// Steeper slopes count as this: the sharp edges of patterns stand upright, and a direction within
/// the surface would be no normal.
const STEEPEST: f64 = 1e3;

/// The least cosine between a bumped normal and the true one.
const LEAST_COSINE: f64 = 1e-3;

/// The bumped unit shading normal in the object's own space, at `point` on part `part` of `shape`.
///
/// `to_file` is the linear part of the transform from the object's space to that of
/// [`PatternPoint::world`]. The result is on the side of the shape's true normal and finite; where the
/// height has no finite slope it is the shape's own shading normal.
#[must_use]
pub fn perturbed_normal(
    shape: &AnyShape,
    part: u32,
    to_file: &DMat3,
    point: &PatternPoint,
    relief: &Relief,
) -> DVec3 {
    let own = shape.surface(point.object, part);
    let mut normal = own.shading_normal;
    if !relief.bumps.is_empty() {
        normal = displaced(shape, part, to_file, point, &relief.bumps, &own);
    }
    if let Some(map) = relief.normals {
        normal = turned(normal, &own, map.lanes.eval(point), map.strength);
    }
    towards(normal, own.normal)
}

/// A normal bent by a map's texel: its lanes are the parts along the directions in which u and v grow, at right
/// angles to the normal, and along the normal itself (as in glTF 2.0, section 3.9.3; where u and v grow along the
/// surface's edges the directions are those of MikkTSpace).
fn turned(normal: DVec3, own: &LocalSurface, texel: DVec3, strength: f64) -> DVec3 {
    let along = texel * 2.0 - 1.0;
    let Some(u) = normalize(own.dpdu - normal * own.dpdu.dot(normal)) else { return normal };
    let v = normal.cross(u);
    let v = if v.dot(own.dpdv) < 0.0 { -v } else { v };
    let bent = u * (along.x * strength) + v * (along.y * strength) + normal * along.z;
    normalize(bent).filter(|n| n.is_finite()).unwrap_or(normal)
}

/// The normal over heights.
fn displaced(
    shape: &AnyShape,
    part: u32,
    to_file: &DMat3,
    point: &PatternPoint,
    bumps: &[&Bump],
    own: &LocalSurface,
) -> DVec3 {
    let normal = own.shading_normal;
    let (t, b) = orthonormal_basis(normal);
    let normals_to_file = to_file.inverse().transpose();
    let size = own.dpdu.abs().max_element().max(own.dpdv.abs().max_element());
    let size = if size.is_finite() { size } else { 0.0 };
    let rounding = STEP_OVER_ROUNDING * point.object.abs().max_element();

    let slope = |direction: DVec3| {
        let stretch = (*to_file * direction).length();
        let far = STEP_OVER_ROUNDING * point.world.abs().max_element();
        let far = if stretch > 0.0 { far / stretch } else { 0.0 };
        let step = (STEP * size).max(rounding).max(far);
        let height = |bump: &Bump, distance: f64| {
            let s = shape.surface(point.object + direction * distance, part);
            bump.height.eval(&PatternPoint {
                object: s.point,
                world: point.world + *to_file * (s.point - own.point),
                uv: s.uv,
                object_normal: s.normal,
                world_normal: normalize(normals_to_file * s.shading_normal)
                    .unwrap_or(point.world_normal),
                lot: point.lot,
            })
        };
        let slopes = bumps
            .iter()
            .map(|bump| bump.scale * (height(bump, step) - height(bump, -step)) / (2.0 * step));
        slopes.sum::<f64>()
    };
    let gradient = t * slope(t) + b * slope(b);
    let steepness = gradient.length();
    if !steepness.is_finite() {
        return normal;
    }
    let gradient = if steepness > STEEPEST { gradient * (STEEPEST / steepness) } else { gradient };
    normalize(normal - gradient).unwrap_or(normal)
}

/// A unit vector that is turned to the side of a normal if it was not there.
fn towards(n: DVec3, normal: DVec3) -> DVec3 {
    let cosine = n.dot(normal);
    if cosine >= LEAST_COSINE {
        return n;
    }
    normalize(n + normal * (LEAST_COSINE - cosine)).unwrap_or(normal)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::NumberInput;
    use crate::pattern::testing::{Bench, at, n, t, v};
    use dioptric_geometry::shapes::sphere::Sphere;
    use dioptric_math::DVec2;
    use dioptric_math::random::Random;
    use dioptric_scene::{NodeId, Value};
    use std::sync::Arc;

    fn bump(scale: f64, make: impl FnOnce(&mut Bench) -> NodeId) -> Bump {
        let mut bench = Bench::default();
        let id = make(&mut bench);
        Bump { height: NumberInput::Pattern(Arc::new(bench.build(id).unwrap())), scale }
    }

    fn of(bump: &Bump) -> Relief<'_> {
        Relief { bumps: vec![bump], normals: None }
    }

    fn sphere(center: DVec3, radius: f64) -> AnyShape {
        AnyShape::Sphere(Sphere::new(center, radius))
    }

    /// The point of a surface next to `p`, under a linear map to the file's space.
    fn point_of(shape: &AnyShape, p: DVec3, to_file: &DMat3) -> PatternPoint {
        let s = shape.surface(p, 0);
        PatternPoint {
            object: s.point,
            world: *to_file * s.point,
            uv: s.uv,
            object_normal: s.normal,
            world_normal: s.normal,
            lot: 0.5,
        }
    }

    fn directions(count: usize) -> impl Iterator<Item = DVec3> {
        let mut r = Random::new(77);
        let ends = [DVec3::Y, DVec3::NEG_Y, DVec3::X, DVec3::NEG_Z];
        let random = std::iter::repeat_with(move || {
            let mut lane = || r.uniform(-1.0, 1.0);
            normalize(DVec3::new(lane(), lane(), lane())).unwrap_or(DVec3::X)
        });
        ends.into_iter().chain(random).take(count)
    }

    /// `n - grad h` for the gradient of a height in space.
    fn expected(normal: DVec3, gradient: DVec3) -> DVec3 {
        normalize(normal - (gradient - normal * gradient.dot(normal))).unwrap()
    }

    #[test]
    fn heights_in_space_on_a_sphere_at_every_scale_and_place() {
        for (scale, center) in [
            (1.0, DVec3::ZERO),
            (1e-6, DVec3::ZERO),
            (1e6, DVec3::ZERO),
            (1.0, DVec3::new(1e5, -1e5, 3e4)),
        ] {
            // h = 0.3 |p - c| with c off the sphere's centre: a gradient of length 0.3 away from c.
            let c = center + DVec3::new(0.3, 0.2, -0.4) * scale;
            let radial = bump(3.0 * scale, |bench| {
                let end = c + DVec3::X * 10.0 * scale;
                let args = [
                    ("start", v(c.x, c.y, c.z)),
                    ("end", v(end.x, end.y, end.z)),
                    ("form", t("radial")),
                ];
                bench.node("gradient", &args)
            });
            let ball = sphere(center, scale);
            for d in directions(200) {
                let point = point_of(&ball, center + d * scale, &DMat3::IDENTITY);
                let got = perturbed_normal(&ball, 0, &DMat3::IDENTITY, &point, &of(&radial));
                let gradient = normalize(point.object - c).unwrap() * 0.3;
                let error = (got - expected(d, gradient)).length();
                assert!(error < 1e-5, "scale {scale}, at {d}: {error}");
            }
        }
    }

    #[test]
    fn heights_over_uv() {
        // h = 0.05 u: the gradient is dpdu / |dpdu|^2 times that.
        let over_u = bump(0.05, |bench| {
            bench.node("gradient", &[("end", v(1.0, 0.0, 0.0)), ("space", t("uv"))])
        });
        let ball = sphere(DVec3::ZERO, 2.0);
        for d in directions(100).filter(|d| d.y.abs() < 0.95 && (d.x.abs() > 0.1 || d.z > 0.0)) {
            let s = ball.surface(d * 2.0, 0);
            let point = point_of(&ball, d * 2.0, &DMat3::IDENTITY);
            let got = perturbed_normal(&ball, 0, &DMat3::IDENTITY, &point, &of(&over_u));
            let gradient = s.dpdu * (0.05 / s.dpdu.length_squared());
            assert!((got - expected(d, gradient)).length() < 1e-6, "{d}");
        }
    }

    #[test]
    fn heights_over_the_normal() {
        // The asin mapping sees nothing but normals: those must be displaced too.
        let mut bench = Bench::default();
        let picture =
            dioptric_image::Image::from_fn(64, 1, dioptric_image::Encoding::Raw, |x, _| {
                [(x as f32 + 0.5) / 64.0; 3]
            });
        let file = dioptric_image::encode(
            &picture.unwrap().into(),
            dioptric_image::FileFormat::Exr,
            &dioptric_image::EncodeOptions::default(),
        );
        bench.files = bench.files.with("a.exr", file.unwrap());
        let id = bench.node("image", &[("file", t("a.exr")), ("mapping", t("asin"))]);
        let height = NumberInput::Pattern(Arc::new(bench.build(id).unwrap()));
        let asin = Bump { height, scale: 0.1 };
        let ball = sphere(DVec3::ZERO, 2.0);
        for d in directions(60).filter(|d| d.x.abs() < 0.8) {
            let point = point_of(&ball, d * 2.0, &DMat3::IDENTITY);
            let got = perturbed_normal(&ball, 0, &DMat3::IDENTITY, &point, &of(&asin));
            // h = 0.1 (asin(x / r) / pi + 1/2).
            let slope = 0.1 / std::f64::consts::PI / (1.0 - d.x * d.x).sqrt() / 2.0;
            assert!((got - expected(d, DVec3::X * slope)).length() < 1e-5, "{d}");
        }
    }

    #[test]
    fn heights_in_world_space_follow_the_transform() {
        let to_file = DMat3::from_diagonal(DVec3::new(2.0, 0.5, 1.0));
        let world = bump(0.2, |bench| {
            bench.node("gradient", &[("end", v(2.0, 2.0, 0.0)), ("space", t("world"))])
        });
        let ball = sphere(DVec3::ZERO, 0.5);
        for d in directions(100) {
            let point = point_of(&ball, d * 0.5, &to_file);
            // The clamped ends of the gradient are flat.
            let value = (point.world.x + point.world.y) / 4.0;
            if !(0.01..0.99).contains(&value) {
                continue;
            }
            let got = perturbed_normal(&ball, 0, &to_file, &point, &of(&world));
            let gradient = to_file.transpose() * DVec3::new(0.25, 0.25, 0.0) * 0.2;
            assert!((got - expected(d, gradient)).length() < 1e-6, "{d}");
        }
    }

    #[test]
    fn always_a_unit_vector_on_the_right_side() {
        let rough = [
            bump(1e9, |b| {
                b.node("checker", &[("even", n(0.0)), ("odd", n(1.0)), ("size", n(1e-9))])
            }),
            bump(5.0, |b| b.node("turbulence", &[("size", n(0.01))])),
            bump(f64::MAX, |b| b.node("crackle", &[])),
            bump(1.0, |b| {
                let inner = b.node("noise", &[]);
                b.node("multiply", &[("a", Value::Node(inner)), ("b", n(1e308))])
            }),
        ];
        for (center, radius) in [(0.0, 1.0), (0.0, 1e-200), (1e200, 1e3), (-1e15, 1.0)] {
            let ball = sphere(DVec3::splat(center), radius);
            for d in directions(200) {
                let p = DVec3::splat(center) + d * radius;
                let s = ball.surface(p, 0);
                let point = point_of(&ball, p, &DMat3::IDENTITY);
                for (i, bump) in rough.iter().enumerate() {
                    let got = perturbed_normal(&ball, 0, &DMat3::IDENTITY, &point, &of(bump));
                    assert!((got.length() - 1.0).abs() < 1e-9, "{i} {center} {radius} {d}: {got}");
                    assert!(got.dot(s.normal) >= 0.9 * LEAST_COSINE, "{i} {d}: {got}");
                }
            }
        }
        let broken = PatternPoint { uv: DVec2::NAN, ..at(f64::NAN, 0.0, 0.0) };
        let ball = sphere(DVec3::ZERO, 1.0);
        assert!(perturbed_normal(&ball, 0, &DMat3::ZERO, &broken, &of(&rough[1])).is_finite());
    }

    #[test]
    fn vectors_below_the_surface_are_turned_up() {
        let bent = towards(normalize(DVec3::new(1.0, -0.2, 0.0)).unwrap(), DVec3::Y);
        assert!((bent.length() - 1.0).abs() < 1e-12 && bent.y > 0.9 * LEAST_COSINE, "{bent}");
        let fine = normalize(DVec3::new(1.0, 0.2, 0.0)).unwrap();
        assert_eq!(towards(fine, DVec3::Y), fine);
        assert!(towards(DVec3::NEG_Y, DVec3::Y).is_finite());
    }
}
