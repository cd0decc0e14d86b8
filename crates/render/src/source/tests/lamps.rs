// SPDX-License-Identifier: MIT OR Apache-2.0
//! Chi-square of the ways of looking for light that [`super::patches`] leaves out: lights with a size, solids, tubes,
//! polygons and meshes by their area, places along a line in a medium.

use std::f64::consts::{PI, TAU};

use dioptric_geometry::AnyShape;
use dioptric_math::{DAffine3, DVec3, atan2, normalize, orthonormal_basis, sin_cos};
use dioptric_scene::Value;

use super::maker::{Maker, text, v3};
use super::patches::{BINS, Chart, per_coordinates, rectangle};
use crate::scene::Scene;
use crate::source::emitter::{Emitter, Lamp};
use crate::source::faces::{Face, Faces};
use crate::source::foci::Foci;
use crate::source::patch::{Met, Patch};
use crate::source::sheet::{self, Sheet};
use crate::source::triangles::Triangles;
use crate::source::tube::Tube;
use crate::statistics::{Around, judge, judge_line};

fn lamp(kind: &str, args: &[(&str, Value)]) -> Scene {
    let mut m = Maker::default();
    m.add(kind, args);
    m.scene()
}

fn of(scene: &Scene) -> &Lamp {
    match scene.sources.choice.emitter(0) {
        Some(Emitter::Light(lamp)) => lamp,
        _ => panic!("no lamp"),
    }
}

#[test]
fn lights_with_a_size_are_found_as_often_as_they_say() {
    let n = Value::Number;
    let at = v3(0.4, 2.0, -0.3);
    let flat = |emits: &str| {
        let edges = [("edge_u", v3(1.2, 0.3, 0.0)), ("edge_v", v3(0.2, -0.4, 0.9))];
        let corner = ("corner", v3(-0.3, 1.6, -0.2));
        lamp("area_light", &[&[corner, ("emits", text(emits))][..], &edges].concat())
    };
    let ball = [("position", at.clone()), ("radius", n(0.7)), ("falloff", text("square"))];
    let spot = [("look_at", v3(0.0, 0.0, 0.0)), ("angle", n(60.0))];
    let round = [("center", at), ("normal", v3(0.3, -1.0, 0.2)), ("radius", n(0.8))];
    let scenes = [
        ("ball", lamp("light", &ball)),
        ("ball with a cone", lamp("spot", &[&ball[..], &spot].concat())),
        ("sun", lamp("directional", &[("direction", v3(0.2, -1.0, 0.1)), ("angle", n(9.0))])),
        (
            "wide sun",
            lamp("directional", &[("direction", v3(0.2, -1.0, 0.1)), ("angle", n(180.0))]),
        ),
        ("window to all sides", flat("everywhere")),
        ("window with a front", flat("both")),
        ("disc", lamp("disc_light", &round)),
        (
            "disc with a front",
            lamp("disc_light", &[&round[..], &[("emits", text("both"))]].concat()),
        ),
    ];
    let point = DVec3::new(0.1, 0.05, 0.2);
    for (i, (name, scene)) in scenes.iter().enumerate() {
        let lamp = of(scene);
        // As wide as it is seen.
        let view = lamp.light.view(point).unwrap();
        let most = 1.0 - (1.0 - view.sine * view.sine).max(0.0).sqrt();
        let around = Around { axis: view.direction, most: (1.05 * most).clamp(1e-3, 2.0) };
        let mut off = 0;
        let draw = |u: [f64; 2]| {
            let (direction, _, _, density) = lamp.sample(point, u)?;
            let said = lamp.pass(point, direction).map_or(0.0, |(_, _, density)| density);
            off += u32::from((density / said - 1.0).abs() > 1e-6);
            Some(direction)
        };
        let mut draw = draw;
        let verdict = around.judge(
            60,
            |d| lamp.pass(point, d).map_or(0.0, |(_, _, density)| density),
            |r| draw([r.unit(), r.unit()]),
            500 + i as u64,
        );
        verdict.check(name, scenes.len());
        // A direction on the rim may miss by rounding.
        assert!(off < 5, "{name}: {off}");
    }
}

/// The side of a tube and the disc at its foot.
fn tube(ends: [DVec3; 2], radii: [f64; 2], open: bool) -> (Patch, Chart) {
    let axis = (ends[1] - ends[0]).normalize();
    let height = (ends[1] - ends[0]).length();
    let (x, y) = orthonormal_basis(axis);
    let [a, b] = radii;
    let share = if open { 1.0 } else { 0.5 };
    let chart = Chart {
        at: Box::new(move |[u, v]| {
            let (s, c) = sin_cos(TAU * v);
            let out = x * c + y * s;
            if u < share {
                let t = u / share;
                let r = a + (b - a) * t;
                let slant = (height * height + (a - b) * (a - b)).sqrt();
                let n = normalize(out * height + axis * (a - b)).unwrap();
                return (ends[0] + axis * (height * t) + out * r, n, TAU * r * slant / share);
            }
            let r = a * ((u - share) / (1.0 - share)).sqrt();
            (ends[0] + out * r, -axis, PI * a * a / (1.0 - share))
        }),
        coordinates: Box::new(move |p| {
            let q = p - ends[0];
            let turn = atan2(q.dot(y), q.dot(x)) / TAU;
            let t = q.dot(axis) / height;
            let across = q - axis * q.dot(axis);
            let foot = share + (1.0 - share) * across.length_squared() / (a * a);
            let on_foot = !open && t < 1e-9;
            [if on_foot { foot } else { share * t }, turn - turn.floor()]
        }),
    };
    (Patch::Tube(Tube::new(ends, radii, open).unwrap()), chart)
}

#[test]
fn what_is_found_by_its_area_is_found_as_often_as_it_says() {
    let v = DVec3::new;
    let (e, f) = (v(2.0, 0.3, 0.0), v(0.2, -0.5, 1.5));
    let corner = v(-1.0, 2.0, -1.0);
    let (_, plain) = rectangle(corner, e, f);
    let ring = vec![corner, corner + e * 0.4, corner + e, corner + e + f, corner + f];
    let faces = sheet::triangles(&[ring], e.cross(f).normalize()).unwrap();
    let sheet = Patch::Sheet(Sheet::new(faces).unwrap());
    // A mesh of two triangles that share the rectangle.
    let mut m = Maker::default();
    let points = [corner, corner + e, corner + e + f, corner + f].map(|p| Value::Vec3(p.into()));
    let list = |v: Vec<Value>| Value::List(v.into());
    let three = |t: [f64; 3]| list(t.map(Value::Number).into());
    let triangles = list(vec![three([0.0, 1.0, 2.0]), three([0.0, 2.0, 3.0])]);
    m.glow("mesh", &[("points", list(points.into())), ("faces", triangles)], [1.0; 3]);
    let scene = m.scene();
    let Some(AnyShape::Mesh(mesh)) = scene.world.shape(0) else { panic!("no mesh") };
    // What a mesh keeps is in single precision.
    let mesh = Patch::Triangles(Triangles::new(mesh, DAffine3::IDENTITY).unwrap());
    let (_, again) = rectangle(corner, e, f);
    let ends = [v(-0.5, 1.4, -0.2), v(0.6, 2.4, 0.5)];
    let cases = [
        ("polygon", (sheet, plain)),
        ("mesh", (mesh, again)),
        ("cylinder", tube(ends, [0.3, 0.3], true)),
        ("cone with a foot", tube(ends, [0.5, 0.0], false)),
        ("cut cone", tube([ends[1], ends[0]], [0.2, 0.6], true)),
    ];
    let point = v(0.3, 0.2, -0.2);
    for (i, (name, (patch, chart))) in cases.iter().enumerate() {
        let density = |u| per_coordinates(patch, chart, point, u);
        let draw = |u: [f64; 2]| {
            let found = patch.sample(point, u)?;
            Some((chart.coordinates)(point + found.direction * found.distance))
        };
        let verdict =
            judge([BINS; 2], [24; 2], density, |r| draw([r.unit(), r.unit()]), 900 + i as u64);
        verdict.check(name, cases.len());
    }
}

#[test]
fn boxes_are_found_evenly_over_what_is_seen_of_them() {
    let (low, high) = (DVec3::new(-0.5, 1.0, -0.4), DVec3::new(0.7, 1.8, 0.5));
    let size = high - low;
    let mut faces = Vec::new();
    for axis in 0..3 {
        let [x, y] = [(axis + 1) % 3, (axis + 2) % 3].map(|k| DVec3::AXES[k] * size[k]);
        Face::parallelogram(low, [y, x], 0, &mut faces);
        Face::parallelogram(low + DVec3::AXES[axis] * size[axis], [x, y], 0, &mut faces);
    }
    let patch = Patch::Faces(Faces::solid(faces).unwrap());
    // From below, from a corner, and from inside.
    let points = [DVec3::new(0.1, 0.0, 0.2), DVec3::new(2.0, 0.2, 1.4), (low + high) * 0.52];
    for (i, point) in points.into_iter().enumerate() {
        let inside = i == 2;
        let way = (low + high) * 0.5 - point;
        let axis = normalize(way).unwrap();
        let ball = 0.5 * size.length() / way.length();
        let most = if inside { 2.0 } else { 1.0 - (1.0 - ball * ball).max(0.0).sqrt() };
        let met = |d: DVec3| {
            let (a, b) = ((low - point) / d, (high - point) / d);
            let (near, far) = (a.min(b).max_element(), a.max(b).min_element());
            (near <= far && far > 0.0).then_some(Met { direction: d, distance: near, normal: d })
        };
        let verdict = Around { axis, most }.judge(
            60,
            |d| met(d).map_or(0.0, |met| patch.density(point, &met)),
            |r| patch.sample(point, [r.unit(), r.unit()]).map(|found| found.direction),
            40 + i as u64,
        );
        verdict.check(&format!("box from {point}"), points.len());
    }
}

#[test]
fn places_on_a_line_are_found_as_often_as_they_say() {
    let mut m = Maker::default();
    let n = Value::Number;
    m.add("light", &[("position", v3(1.0, 1.0, 0.0)), ("falloff", text("square"))]);
    let spot = [("position", v3(3.0, 2.0, 0.3)), ("look_at", v3(3.0, 0.0, 0.0))];
    let wide = [("angle", n(50.0)), ("falloff", text("square")), ("intensity", n(3.0))];
    m.add("spot", &[&spot[..], &wide].concat());
    m.glow("sphere", &[("center", v3(2.0, 0.4, 1.0)), ("radius", n(0.2))], [5.0; 3]);
    let scene = m.scene();
    let foci = Foci::new((0..3).filter_map(|e| scene.sources.choice.emitter(e)));
    let direction = DVec3::new(0.8, 0.0, 0.6).normalize();
    for (i, end) in [1.5, 6.0, f64::INFINITY].into_iter().enumerate() {
        let aims = foci.aims(DVec3::ZERO, direction, end, 0.1).unwrap();
        let verdict =
            judge_line(1.5, |t| aims.density(t), |r| Some(aims.sample(r.unit())), 70 + i as u64);
        verdict.check(&format!("a line up to {end}"), 3);
    }
}
