// SPDX-License-Identifier: MIT OR Apache-2.0
//! Irradiances: against closed forms, and the three ways of finding light against each other.

use std::f64::consts::PI;

use dioptric_geometry::Ray;
use dioptric_math::random::Random;
use dioptric_math::{DVec3, acos, atan, orthonormal_basis};
use dioptric_scene::Value;

use super::maker::{Maker, text, v3};
use crate::sampling::warp::concentric_disc;
use crate::scene::Scene;
use crate::source::{brightness, shining};

/// A mean and its standard error.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Mean {
    sum: f64,
    squares: f64,
    count: f64,
}

impl Mean {
    fn add(&mut self, x: f64) {
        assert!(x.is_finite() && x >= 0.0, "{x}");
        self.sum += x;
        self.squares += x * x;
        self.count += 1.0;
    }

    pub fn value(&self) -> f64 {
        self.sum / self.count
    }

    pub fn error(&self) -> f64 {
        let variance = self.squares / self.count - self.value() * self.value();
        (variance.max(0.0) / self.count).sqrt() + 1e-9 * self.value()
    }
}

/// The share of the first of two ways.
fn share(own: f64, other: f64) -> f64 {
    if own == f64::INFINITY { 1.0 } else { own * own / (own * own + other * other) }
}

/// The irradiance of everything but sharp lights at a point: by asking sources, by directions of the hemisphere, and by
/// both, weighted.
pub(super) fn irradiance(
    scene: &Scene,
    point: DVec3,
    normal: DVec3,
    count: u32,
    seed: u64,
) -> [Mean; 3] {
    let mut means = [Mean::default(); 3];
    let mut r = Random::new(seed);
    let (sources, (x, y)) = (&scene.sources, orthonormal_basis(normal));
    for i in 0..count {
        // Strata for the choice; the rest is random.
        let pick = (f64::from(i) + r.unit()) / f64::from(count);
        let mut both = 0.0;
        let sample = sources.sample(scene, point, Some(normal), pick, [r.unit(), r.unit()]);
        let asked = sample.filter(|s| {
            let ray = Ray::new(point, s.direction);
            s.direction.dot(normal) > 0.0 && !scene.world.occluded(&ray, s.distance, None)
        });
        let asked = asked.map_or(0.0, |s| {
            let cos = s.direction.dot(normal);
            let value = brightness(s.value) * cos;
            both += value * share(s.pdf, cos / PI);
            value
        });
        means[0].add(asked);
        let [a, b] = concentric_disc([r.unit(), r.unit()]);
        let cos = (1.0 - a * a - b * b).max(0.0).sqrt();
        let direction = (x * a + y * b + normal * cos).normalize();
        let ray = Ray::new(point, direction);
        let density = cos / PI;
        let mut seen = 0.0;
        let hit = scene.world.closest(&ray, f64::INFINITY, None);
        let end = hit.map_or(f64::INFINITY, |hit| hit.t);
        sources.passed(&ray, Some(normal), end, |_, _, radiance, other| {
            seen += brightness(radiance) * PI;
            both += brightness(radiance) * PI * share(density, other);
        });
        let (radiance, other) = match hit {
            Some(hit) => {
                let shading = scene.shading(&ray, &hit).unwrap();
                let surface = &shading.surface;
                let other =
                    sources.density_of_hit(scene, point, Some(normal), &hit, surface, direction);
                (shining(&shading.finish, true), other)
            }
            None => {
                let other = sources.density_of_sky(point, Some(normal), direction);
                (scene.background.radiance(direction), other)
            }
        };
        seen += brightness(radiance) * PI;
        both += brightness(radiance) * PI * share(density, other);
        means[1].add(seen);
        means[2].add(both);
    }
    means
}

/// What asking finds at a point: one number.
fn asked(maker: Maker, point: DVec3, normal: DVec3, count: u32) -> f64 {
    irradiance(&maker.scene(), point, normal, count, 5)[0].value()
}

fn near(found: f64, expected: f64, tolerance: f64, what: &str) {
    println!("{what}: {found} {expected}");
    assert!((found / expected - 1.0).abs() < tolerance, "{what}: {found} {expected}");
}

#[test]
fn a_sphere_gives_what_its_projection_does() {
    for (radius, d) in [(0.5, 2.0), (1e-5, 3.0), (0.999, 1.0)] {
        let mut m = Maker::default();
        let args = [("center", v3(0.0, d, 0.0)), ("radius", Value::Number(radius))];
        m.glow("sphere", &args, [3.0, 2.0, 1.0]);
        let expected = PI * 2.0 * (radius / d) * (radius / d);
        near(asked(m, DVec3::ZERO, DVec3::Y, 20_000), expected, 0.02, "sphere");
    }
}

/// Lambert's formula for a polygon of radiance 1 (Lambert, "Photometria", 1760): the sum over the edges of the angle that
/// an edge fills, times the cosine of its plane's normal to the surface's, over 2.
fn lambert(corners: &[DVec3], normal: DVec3) -> f64 {
    let edges = corners.iter().zip(corners.iter().cycle().skip(1));
    let sum: f64 = edges
        .map(|(a, b)| {
            let (a, b) = (a.normalize(), b.normalize());
            acos(a.dot(b).clamp(-1.0, 1.0)) * a.cross(b).normalize().dot(normal)
        })
        .sum();
    0.5 * sum.abs()
}

#[test]
fn polygons_give_what_lambert_says() {
    let v = DVec3::new;
    let normal = v(0.36, 0.48, 0.8);
    let corners = [v(1.0, 0.0, 1.0), v(2.0, 0.4, 1.1), v(1.2, 2.0, 1.5)];
    let args = [("a", corners[0]), ("b", corners[1]), ("c", corners[2])];
    let args = args.map(|(name, p)| (name, Value::Vec3(p.into())));
    let mut m = Maker::default();
    m.glow("triangle", &args, [1.0; 3]);
    near(asked(m, DVec3::ZERO, normal, 40_000), lambert(&corners, normal), 0.01, "triangle");

    let (c, e, f) = (v(1.0, 0.0, 1.0), v(0.0, 2.0, 0.0), v(1.5, 0.0, 0.5));
    let args = [("corner", c), ("edge_u", e), ("edge_v", f)];
    let args = args.map(|(name, p)| (name, Value::Vec3(p.into())));
    let mut m = Maker::default();
    m.glow("rectangle", &args, [1.0; 3]);
    let expected = lambert(&[c, c + e, c + e + f, c + f], normal);
    near(asked(m, DVec3::ZERO, normal, 40_000), expected, 0.01, "rectangle");

    // A box: its three faces that are seen.
    let mut m = Maker::default();
    m.glow("box", &[("min", v3(1.0, 1.0, 1.0)), ("max", v3(2.0, 3.0, 1.5))], [1.0; 3]);
    let face = |a, b, c, d| lambert(&[a, b, c, d], normal);
    let (x, y, z) = (v(1.0, 0.0, 0.0), v(0.0, 2.0, 0.0), v(0.0, 0.0, 0.5));
    let o = v(1.0, 1.0, 1.0);
    let expected = face(o, o + x, o + x + y, o + y)
        + face(o, o + y, o + y + z, o + z)
        + face(o, o + z, o + z + x, o + x);
    near(asked(m, DVec3::ZERO, normal, 40_000), expected, 0.01, "box");
}

/// Howell, "A Catalog of Radiation Heat Transfer Configuration Factors", B-12 (coaxial disc).
#[test]
fn a_disc_gives_what_its_form_factor_says() {
    let (r, h) = (1.5, 2.0);
    let mut m = Maker::default();
    let args = [("center", v3(0.0, h, 0.0)), ("radius", Value::Number(r))];
    m.glow("disc", &args, [2.0; 3]);
    let expected = PI * 2.0 * r * r / (r * r + h * h);
    near(asked(m, DVec3::ZERO, DVec3::Y, 60_000), expected, 0.01, "disc");
}

#[test]
fn the_sky_gives_pi_times_its_radiance() {
    let mut m = Maker::default();
    m.add("background", &[("color", v3(0.5, 1.0, 1.5))]);
    let normal = DVec3::new(0.6, 0.0, 0.8);
    near(asked(m, DVec3::ZERO, normal, 40_000), PI, 0.01, "sky");
}

/// Lights with a size send what Whitted's pictures average.
#[test]
fn lights_send_what_whitted_averages() {
    for kind in ["light", "spot", "area_light", "disc_light", "directional"] {
        let mut m = Maker::default();
        let (position, square) = (("position", v3(0.5, 2.0, 0.2)), ("falloff", text("square")));
        let radius = ("radius", Value::Number(0.7));
        match kind {
            "light" => m.add(kind, &[position, radius, square]),
            "spot" => m.add(kind, &[position, radius, ("look_at", v3(0.1, 0.0, 0.2))]),
            "area_light" => m.add(
                kind,
                &[
                    ("corner", v3(0.0, 2.0, 0.0)),
                    ("edge_u", v3(2.0, 0.5, 0.0)),
                    ("edge_v", v3(0.3, 0.0, 1.0)),
                    ("emits", text("front")),
                    square,
                ],
            ),
            "disc_light" => m.add(
                kind,
                &[("center", v3(0.3, 2.0, 0.0)), ("normal", v3(0.5, -1.0, 0.0)), radius],
            ),
            _ => m.add(kind, &[("direction", v3(0.4, -1.0, 0.2)), ("angle", Value::Number(60.0))]),
        };
        let scene = m.scene();
        let (mut mean, n) = (0.0, 200);
        for i in 0..n * n {
            let at = |i: i32| (f64::from(i) + 0.5) / f64::from(n);
            let light = &scene.lights[0].light;
            let Some(s) = light.sample(DVec3::ZERO, [at(i / n), at(i % n)]) else { continue };
            mean += PI * brightness(s.arriving) * s.direction.y.max(0.0) / f64::from(n * n);
        }
        let all = irradiance(&scene, DVec3::ZERO, DVec3::Y, 60_000, 9);
        for (found, way) in all.iter().zip(["asked", "seen", "both"]) {
            let off = (found.value() - mean).abs() / found.error();
            println!("{kind} {way}: {} {mean} {off:.1}", found.value());
            assert!(off < 4.0, "{kind} {way}: {found:?} {mean}");
        }
    }
}

/// Many things at once, moved, stretched and patterned: asking, seeing and both agree.
#[test]
fn three_ways_find_the_same() {
    let mut m = Maker::default();
    let n = Value::Number;
    m.add("background", &[("color", v3(0.02, 0.05, 0.1))]);
    let stretch = m.add("scale", &[("by", v3(1.0, 0.4, 2.0))]);
    let turn = m.add("rotate", &[("axis", v3(1.0, 1.0, 0.0)), ("angle", n(40.0))]);
    let lift = m.add("translate", &[("by", v3(1.0, 3.0, 0.0))]);
    let transform =
        ("transform", Value::List([stretch, turn, lift].map(Value::Node).to_vec().into()));
    m.glow("sphere", &[("radius", n(0.4)), transform.clone()], [4.0, 1.0, 0.0]);
    m.glow("disc", &[("center", v3(0.0, 0.5, 1.0)), transform.clone()], [1.0, 2.0, 0.0]);
    let low = [("min", v3(1.0, 0.0, -1.0)), ("max", v3(1.5, 0.8, -0.5)), transform];
    m.glow("box", &low, [1.0, 1.0, 3.0]);
    let checker =
        m.add("checker", &[("even", v3(5.0, 5.0, 0.0)), ("odd", n(0.1)), ("size", n(0.3))]);
    let screen = m.add("glow", &[("color", Value::Node(checker))]);
    let screen = ("material", Value::Node(screen));
    m.add(
        "rectangle",
        &[
            ("corner", v3(-2.0, 1.0, -1.0)),
            ("edge_u", v3(1.0, 0.0, 0.5)),
            ("edge_v", v3(0.0, 1.0, 0.5)),
            screen,
        ],
    );
    m.add("light", &[("position", v3(0.0, 5.0, -2.0)), ("radius", n(1.0))]);
    // What is not looked for: rays find it.
    m.glow(
        "torus",
        &[("center", v3(-1.0, 3.0, 2.0)), ("major_radius", n(0.6)), ("minor_radius", n(0.2))],
        [1.0, 0.0, 1.0],
    );
    let scene = m.scene();
    // Not the torus.
    assert!(scene.sources.label(&scene, 5).is_some() && scene.sources.label(&scene, 6).is_none());
    for (point, normal) in [
        (DVec3::ZERO, DVec3::Y),
        (DVec3::new(-0.5, 0.3, 0.4), DVec3::new(0.6, 0.64, 0.48)),
        (DVec3::new(3.0, 0.0, -1.0), DVec3::new(-0.6, 0.8, 0.0)),
    ] {
        let [_, seen, both] = irradiance(&scene, point, normal, 60_000, 11);
        let off = (seen.value() - both.value()).abs()
            / (seen.error() * seen.error() + both.error() * both.error()).sqrt();
        println!("{seen:?} {both:?} {off:.2} {:.4} {:.4}", seen.error(), both.error());
        assert!(off < 4.0);
        assert!(both.error() < seen.error());
    }
}

/// A rectangle's closed form, for a check of [`lambert`] itself: the corner of a rectangle straight above (Howell B-3).
#[test]
fn lambert_is_right() {
    let (a, b, h) = (1.0_f64, 2.0_f64, 1.5_f64);
    let v = DVec3::new;
    let corners = [v(0.0, h, 0.0), v(a, h, 0.0), v(a, h, b), v(0.0, h, b)];
    let (x, y) = (a / h, b / h);
    let (p, q) = ((1.0 + x * x).sqrt(), (1.0 + y * y).sqrt());
    let expected = 0.5 * (x / p * atan(y / p) + y / q * atan(x / q));
    near(lambert(&corners, DVec3::Y), expected, 1e-12, "corner");
}

/// The same for tubes, cones and polygons with holes, as they are and moved.
#[test]
fn round_ones_and_polygons_are_found_as_they_are_seen() {
    let mut m = Maker::default();
    let n = Value::Number;
    let list = |points: &[[f64; 3]]| {
        Value::List(points.iter().map(|&p| Value::Vec3(p)).collect::<Vec<_>>().into())
    };
    let stretch = m.add("scale", &[("by", v3(1.0, 0.5, 1.6))]);
    let turn = m.add("rotate", &[("axis", v3(1.0, 0.4, 0.0)), ("angle", n(50.0))]);
    let transform = ("transform", Value::List([stretch, turn].map(Value::Node).to_vec().into()));
    let tube = [("base", v3(-2.0, 1.5, 0.0)), ("top", v3(-0.5, 2.0, 0.5)), ("radius", n(0.2))];
    m.glow("cylinder", &tube, [3.0, 1.0, 0.0]);
    let open = [tube.to_vec(), vec![("open", Value::Bool(true)), transform.clone()]].concat();
    m.glow("cylinder", &open, [1.0, 2.0, 0.0]);
    let cone = [("base", v3(1.0, 1.5, -1.0)), ("radius", n(0.6)), ("height", n(0.9))];
    m.glow("cone", &cone, [0.0, 1.0, 2.0]);
    let cut = [
        ("base", v3(1.0, 2.5, 1.0)),
        ("radius", n(0.2)),
        ("top_radius", n(0.5)),
        ("height", n(0.4)),
        transform,
    ];
    m.glow("cone", &cut, [2.0, 0.0, 1.0]);
    let outline = list(&[
        [-1.0, 3.0, -2.0],
        [1.5, 3.0, -2.0],
        [2.0, 3.0, 1.0],
        [0.3, 3.0, 0.0],
        [-1.0, 3.0, 1.0],
    ]);
    let hole = list(&[[0.0, 3.0, -1.5], [1.0, 3.0, -1.5], [0.5, 3.0, -0.7]]);
    let holed = [("points", outline), ("holes", Value::List(vec![hole].into()))];
    m.glow("polygon", &holed, [1.0, 1.0, 1.0]);
    // Too many corners to be looked at one by one.
    let star: Vec<[f64; 3]> = (0..30)
        .map(|i| {
            let (s, c) = dioptric_math::sin_cos(f64::from(i) * std::f64::consts::TAU / 30.0);
            let r = if i % 2 == 0 { 0.8 } else { 0.5 };
            [2.5 + 0.2 * r * c, 1.0 + r * s, r * c]
        })
        .collect();
    m.glow("polygon", &[("points", list(&star))], [0.5, 2.0, 0.5]);
    let scene = m.scene();
    assert!((0..6).all(|source| scene.sources.label(&scene, source).is_some()));
    for (point, normal) in [
        (DVec3::ZERO, DVec3::Y),
        (DVec3::new(-0.5, 0.3, 0.4), DVec3::new(0.6, 0.64, 0.48)),
        (DVec3::new(3.0, 0.0, -1.0), DVec3::new(-0.6, 0.8, 0.0)),
    ] {
        let [_, seen, both] = irradiance(&scene, point, normal, 60_000, 13);
        let off = (seen.value() - both.value()).abs()
            / (seen.error() * seen.error() + both.error() * both.error()).sqrt();
        assert!(off < 4.0, "{seen:?} {both:?} {off:.2}");
        assert!(both.error() < 0.6 * seen.error(), "{} {}", both.error(), seen.error());
    }
}
