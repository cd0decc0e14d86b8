// SPDX-License-Identifier: MIT OR Apache-2.0
//! Meshes against their triangles one by one, closed meshes that must not leak, and data that is none.

use dioptric_geometry::bvh::Lanes;
use dioptric_geometry::{Crossing, Leaving, LocalRay, Mesh, MeshData, Root, Shape};
use dioptric_math::random::Random;
use dioptric_math::{DVec3, cos, sin};

fn vector(random: &mut Random, size: f64) -> DVec3 {
    DVec3::from_array([0; 3].map(|_| random.uniform(-size, size)))
}

fn ray(origin: DVec3, direction: DVec3) -> LocalRay {
    LocalRay { origin, direction, error: 0.0, t_max: f64::INFINITY, leaving: None }
}

fn single(p: DVec3) -> [f32; 3] {
    p.to_array().map(|x| x as f32)
}

/// A sphere with bumps from `2 n (m - 1)` triangles.
fn bumpy(n: u32, m: u32, center: DVec3) -> MeshData {
    let pi = std::f64::consts::PI;
    let mut data = MeshData::default();
    let point = |a: f64, b: f64| {
        let r = 1.0 + 0.1 * sin(5.0 * a) * sin(7.0 * b) * sin(b);
        single(center + DVec3::new(sin(b) * cos(a), cos(b), sin(b) * sin(a)) * r)
    };
    data.positions.extend([point(0.0, 0.0), point(0.0, pi)]);
    for j in 1..m {
        for i in 0..n {
            let (a, b) = (f64::from(i) / f64::from(n), f64::from(j) / f64::from(m));
            data.positions.push(point(a * 2.0 * pi, b * pi));
        }
    }
    let at = |i: u32, j: u32| match j {
        0 => 0,
        j if j == m => 1,
        j => 2 + (j - 1) * n + i % n,
    };
    for j in 0..m {
        for i in 0..n {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            if j > 0 {
                data.triangles.push([a, b, c]);
            }
            if j + 1 < m {
                data.triangles.push([a, c, d]);
            }
        }
    }
    data
}

/// Triangles anywhere; one in eight huge, one in eight a needle, some twice, in shared planes too.
fn soup(count: usize, random: &mut Random) -> MeshData {
    let mut data = MeshData::default();
    for i in 0..count as u32 {
        let size = match i % 8 {
            0 => 2.0,
            _ => 0.2,
        };
        let a = vector(random, 1.0);
        let mut b = a + vector(random, size);
        let c = if i % 8 == 1 { a + (b - a) * 1.001 } else { a + vector(random, size) };
        if i % 8 == 2 {
            b.z = a.z;
        }
        data.positions.extend([a, b, c].map(single));
        data.triangles.push([3 * i, 3 * i + 1, 3 * i + 2]);
        if i % 16 == 3 {
            data.triangles.push([3 * i + 2, 3 * i, 3 * i + 1]);
        }
    }
    data
}

/// The nearest hit of all triangles, each a mesh of its own.
fn one_by_one(alone: &[Mesh], ray: &LocalRay) -> Option<Root> {
    let mut best: Option<Root> = None;
    for (mesh, part) in alone.iter().zip(0..) {
        if ray.leaving.is_some_and(|l| l.part == part) {
            continue;
        }
        if let Some(root) = mesh.intersect(ray)
            && best.is_none_or(|b| root.t < b.t)
        {
            best = Some(Root { part, ..root });
        }
    }
    best
}

fn alone(data: &MeshData) -> Vec<Mesh> {
    let one = |triangle: &[u32; 3]| {
        Mesh::new(MeshData {
            positions: triangle.map(|i| data.positions[i as usize]).to_vec(),
            triangles: vec![[0, 1, 2]],
            ..MeshData::default()
        })
    };
    data.triangles.iter().map(one).collect()
}

fn crossings(mesh: &Mesh, ray: &LocalRay) -> Vec<Crossing> {
    let mut out = Vec::new();
    mesh.crossings(ray, &mut out);
    out
}

#[test]
fn meshes_answer_as_their_triangles_do() {
    let mut random = Random::new(11);
    let mut hits = 0;
    for count in (0..12).chain([17, 40, 100, 333, 1000]) {
        let data = soup(count, &mut random);
        let alone = alone(&data);
        let mesh = Mesh::new(data);
        for i in 0..400 {
            let origin = vector(&mut random, 2.0);
            let target = match mesh.data().positions.get(random.bits() as usize % (3 * count + 1)) {
                Some(corner) if i % 2 == 0 => DVec3::from(corner.map(f64::from)),
                _ => vector(&mut random, 1.0),
            };
            let mut ray = ray(origin, (target - origin) * random.uniform(0.1, 10.0));
            if i % 7 == 0 {
                ray.direction[i % 3] = 0.0;
            }
            if i % 5 == 0 {
                ray.t_max = random.uniform(0.0, 1.0);
            }
            let found = mesh.intersect(&ray);
            assert_eq!(found, one_by_one(&alone, &ray), "{count} triangles, {ray:?}");
            hits += u32::from(found.is_some());
            if let Some(root) = found {
                let again = LocalRay { t_max: root.t, ..ray };
                assert_eq!(mesh.intersect(&again), found);
                // On from there: the same triangle is not hit again.
                let surface = mesh.surface(ray.at(root.t), root.part);
                let outward = ray.direction.dot(surface.normal) > 0.0;
                let leaving = Some(Leaving { part: root.part, outward });
                let on = LocalRay {
                    origin: surface.point,
                    error: surface.error,
                    t_max: f64::INFINITY,
                    leaving,
                    ..ray
                };
                assert!(mesh.intersect(&on).is_none_or(|next| next.part != root.part));
            }
        }
    }
    assert!(hits > 1000, "{hits}");
}

#[test]
fn closed_meshes_do_not_leak() {
    for center in [DVec3::ZERO, DVec3::new(3e4, -2e4, 1e4)] {
        let mesh = Mesh::new(bumpy(60, 40, center));
        assert!(mesh.is_solid());
        let mut random = Random::new(12);
        let corner = |i: u32| DVec3::from(mesh.data().positions[i as usize].map(f64::from));
        let triangles = mesh.data().triangles.clone();
        for i in 0..60_000 {
            let origin = center + vector(&mut random, 0.1);
            let [a, b, c] = triangles[i % triangles.len()].map(corner);
            let target = match i % 5 {
                0 => a,
                1 => a + (b - a) * random.unit(),
                2 => (b + c) * 0.5,
                3 => c + (a - c) * 1e-9,
                _ => center + vector(&mut random, 1.0),
            };
            let inside = ray(origin, target - origin);
            let Some(root) = mesh.intersect(&inside) else { panic!("leaks towards {target}") };
            // From there into the mesh again: it must end somewhere else on it.
            let surface = mesh.surface(inside.at(root.t), root.part);
            assert!(surface.normal.dot(inside.direction) > 0.0, "normals point outwards");
            let mut direction = vector(&mut random, 1.0);
            if direction.dot(surface.normal) > 0.0 {
                direction = -direction;
            }
            let bounce = LocalRay {
                error: surface.error,
                leaving: Some(Leaving { part: root.part, outward: false }),
                ..ray(surface.point, direction)
            };
            assert!(
                mesh.intersect(&bounce).is_some(),
                "leaks from {} to {direction}",
                surface.point
            );
        }
    }
}

#[test]
fn lines_pass_in_and_out_of_closed_meshes() {
    let data = bumpy(20, 14, DVec3::ZERO);
    let mut turned = data.clone();
    turned.triangles.iter_mut().for_each(|t| t.swap(0, 1));
    let (mesh, inverted) = (Mesh::new(data), Mesh::new(turned));
    assert!(mesh.is_solid() && inverted.is_solid());
    let mut random = Random::new(13);
    for i in 0..5000usize {
        let corner = |i: usize| DVec3::from(mesh.data().positions[i].map(f64::from));
        let n = mesh.data().positions.len();
        // Through one corner or two.
        let target = if i % 2 == 0 { corner(i % n) } else { vector(&mut random, 1.0) };
        let origin = if i % 8 == 0 { corner(i * 7 % n) } else { vector(&mut random, 2.0) };
        if origin == target {
            continue;
        }
        let all = crossings(&mesh, &ray(origin, target - origin));
        assert!(all.len().is_multiple_of(2) && all.is_sorted_by(|a, b| a.t <= b.t), "{all:?}");
        assert!(all.iter().enumerate().all(|(i, c)| c.enters == (i % 2 == 0)), "{all:?}");
        if i % 2 == 1 && i % 8 != 0 {
            let ahead = all.iter().find(|c| c.t > 0.0).map(|c| (c.t, c.part));
            let found = mesh.intersect(&ray(origin, target - origin)).map(|r| (r.t, r.part));
            assert_eq!(found, ahead);
            assert_eq!(all.len(), crossings(&inverted, &ray(origin, target - origin)).len());
        }
    }
}

#[test]
fn only_meshes_without_a_border_are_solid() {
    let whole = bumpy(12, 8, DVec3::ZERO);
    assert!(Mesh::new(whole.clone()).is_solid());
    for i in 0..whole.triangles.len() {
        let mut open = whole.clone();
        open.triangles.remove(i);
        assert!(!Mesh::new(open).is_solid());
        let mut twisted = whole.clone();
        twisted.triangles[i].swap(0, 1);
        assert!(!Mesh::new(twisted).is_solid());
    }
    // Every triangle with corners of its own: closed by position.
    let apart = MeshData {
        positions: whole.triangles.iter().flatten().map(|&i| whole.positions[i as usize]).collect(),
        triangles: (0..whole.triangles.len() as u32)
            .map(|i| [3 * i, 3 * i + 1, 3 * i + 2])
            .collect(),
        ..MeshData::default()
    };
    assert!(Mesh::new(apart).is_solid());
}

#[test]
fn what_is_no_triangle_is_left_out() {
    let data = MeshData {
        positions: vec![
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [f32::NAN, 0.0, 0.0],
            [f32::INFINITY, 0.0, 0.0],
            [2.0, 0.0, 0.0],
        ],
        triangles: vec![[0, 1, 9], [0, 1, 3], [0, 4, 2], [0, 1, 5], [1, 1, 2], [0, 1, 2]],
        ..MeshData::default()
    };
    let mesh = Mesh::new(data);
    assert_eq!(mesh.triangle_count(), 1);
    let down = ray(DVec3::new(0.25, 0.25, 1.0), -DVec3::Z);
    assert_eq!(mesh.intersect(&down), Some(Root { t: 1.0, part: 5 }));
    for wrong in [f64::NAN, f64::INFINITY] {
        assert_eq!(mesh.intersect(&LocalRay { origin: DVec3::splat(wrong), ..down }), None);
        assert_eq!(mesh.intersect(&LocalRay { direction: DVec3::splat(wrong), ..down }), None);
    }
    assert_eq!(mesh.intersect(&LocalRay { direction: DVec3::ZERO, ..down }), None);
    let none = Mesh::new(MeshData::default());
    assert!(none.intersect(&down).is_none() && none.bounds().is_empty() && !none.is_solid());
}

#[test]
fn degenerate_meshes_by_the_hundred_thousand() {
    let n = 100_000u32;
    let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let down = ray(DVec3::new(0.25, 0.25, 1.0), -DVec3::Z);
    let same = MeshData {
        positions: corners.clone(),
        triangles: vec![[0, 1, 2]; n as usize],
        ..MeshData::default()
    };
    assert_eq!(Mesh::new(same).intersect(&down), Some(Root { t: 1.0, part: 0 }));
    let flat = MeshData {
        positions: corners.clone(),
        triangles: vec![[0, 0, 2]; n as usize],
        ..MeshData::default()
    };
    assert_eq!(Mesh::new(flat).triangle_count(), 0);
    let mut random = Random::new(14);
    let mut uneven = MeshData { positions: corners, ..MeshData::default() };
    uneven.positions[2] = [0.0, 1e9, 0.0];
    uneven.triangles.push([0, 1, 2]);
    for i in 1..=n {
        let a = vector(&mut random, 1.0) - DVec3::Z * 5.0;
        uneven.positions.extend([a, a + DVec3::X * 1e-4, a + DVec3::Y * 1e-4].map(single));
        uneven.triangles.push([3 * i, 3 * i + 1, 3 * i + 2]);
    }
    assert_eq!(Mesh::new(uneven).intersect(&down), Some(Root { t: 1.0, part: 0 }));
}

#[test]
fn tiny_triangles_around_a_huge_one() {
    let mut random = Random::new(15);
    let mut data = MeshData {
        positions: vec![[-1e9, -1e9, 0.25], [1e9, -1e9, 0.25], [0.0, 1e9, 0.25]],
        triangles: vec![[0, 1, 2]],
        ..MeshData::default()
    };
    for i in 1..2000 {
        let a = vector(&mut random, 1.0);
        data.positions.extend([a, a + DVec3::X * 1e-2, a + vector(&mut random, 1e-2)].map(single));
        data.triangles.push([3 * i, 3 * i + 1, 3 * i + 2]);
    }
    let (alone, mesh) = (alone(&data), Mesh::new(data));
    let mut tiny = 0;
    for i in 0..300 {
        let part = random.bits() as usize % alone.len();
        let [a, b, c] = [0, 1, 2].map(|corner| mesh.data().positions[3 * part + corner]);
        let [a, b, c] = [a, b, c].map(|p| DVec3::from(p.map(f64::from)));
        let target = if i % 2 == 0 { a } else { (a + b + c) / 3.0 };
        let origin = target + vector(&mut random, if i % 3 == 0 { 1e5 } else { 0.1 });
        let ray = ray(origin, target - origin);
        let hit = mesh.intersect(&ray);
        assert_eq!(hit, one_by_one(&alone, &ray), "{i}");
        tiny += u32::from(hit.is_some_and(|hit| hit.part > 0));
    }
    assert!(tiny > 50, "{tiny}");
}

#[test]
fn normals_and_coordinates_are_interpolated() {
    let data = MeshData {
        positions: vec![[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]],
        triangles: vec![[0, 1, 2]],
        normals: vec![[0.0, 0.0, -2.0], [-1.0, 0.0, -1.0], [0.0, 0.0, -1.0]],
        uvs: vec![[0.0, 0.0], [0.5, 0.0], [0.0, 1.0]],
    };
    let mesh = Mesh::new(data.clone());
    let s = mesh.surface(DVec3::new(1.0, 0.5, 0.0), 0);
    assert_eq!(s.point, DVec3::new(1.0, 0.5, 0.0));
    assert_eq!((s.normal, s.uv.to_array()), (-DVec3::Z, [0.25, 0.25]));
    assert!((s.shading_normal.x / s.shading_normal.z - 0.414_213_562).abs() < 1e-6);
    assert_eq!((s.dpdu, s.dpdv), (DVec3::X * 4.0, DVec3::Y * 2.0));
    let plain = Mesh::new(MeshData { normals: vec![], uvs: vec![], ..data });
    let s = plain.surface(DVec3::new(1.0, 0.5, 0.0), 0);
    assert_eq!((s.normal, s.shading_normal), (DVec3::Z, DVec3::Z));
    assert_eq!(s.uv.to_array(), [0.5, 0.25]);
}

#[test]
fn every_instruction_set_gives_the_same_bits() {
    let mut random = Random::new(15);
    let far = DVec3::new(1e5, -3e4, 0.0);
    let small = |data: &mut MeshData| data.positions.iter_mut().flatten().for_each(|x| *x *= 1e-30);
    let mut tiny = soup(500, &mut random);
    small(&mut tiny);
    for (data, middle, size) in [
        (soup(3000, &mut random), DVec3::ZERO, 1.0),
        (bumpy(80, 60, DVec3::ZERO), DVec3::ZERO, 1.0),
        (bumpy(80, 60, far), far, 1.0),
        (tiny, DVec3::ZERO, 1e-30),
    ] {
        let corners: Vec<_> =
            data.positions.iter().map(|p| DVec3::from(p.map(f64::from))).collect();
        let meshes = [Lanes::Plain, Lanes::Avx2, Lanes::Avx512].map(|lanes| {
            let mut mesh = Mesh::new(data.clone());
            mesh.use_lanes(lanes);
            mesh
        });
        let mut hits = 0;
        for i in 0..3000 {
            let origin = middle + vector(&mut random, size * if i % 4 == 0 { 100.0 } else { 1.0 });
            let target = corners[random.bits() as usize % corners.len()];
            let mut ray = ray(origin, target - origin);
            if i % 3 == 0 {
                ray.direction = vector(&mut random, 1e-3);
            }
            if i % 5 == 0 {
                ray.error = 1e-6 * size;
            }
            let [plain, avx2, avx512] = meshes.each_ref().map(|mesh| {
                let any = mesh.blocks(&ray);
                let first = mesh.intersect(&ray);
                assert!(any.is_some() == first.is_some() && mesh.hides(&ray) == any.is_some());
                for (part, is_hidden) in [(0.5, false), (1.0, false), (1.0 + 1e-15, true)] {
                    let Some(Root { t, .. }) = first.filter(|root| root.t > 0.0) else { break };
                    let before = LocalRay { t_max: t * part, ..ray };
                    assert_eq!(mesh.hides(&before), is_hidden, "{before:?}");
                    assert_eq!(mesh.blocks(&before).is_some(), is_hidden);
                }
                first
            });
            assert!(plain == avx2 && plain == avx512, "{ray:?}: {plain:?} {avx2:?} {avx512:?}");
            hits += u32::from(plain.is_some());
        }
        assert!(hits > 1000);
    }
}

#[test]
fn any_number_of_threads_builds_the_same_mesh() {
    let data = bumpy(150, 100, DVec3::ZERO);
    let alone = format!("{:?}", Mesh::new(data.clone()));
    for threads in [1, 2, 7] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let together = pool.install(|| Mesh::new(data.clone()));
        assert!(format!("{together:?}") == alone, "{threads} threads");
    }
}

#[test]
fn a_triangle_takes_at_most_120_bytes() {
    let mesh = Mesh::new(bumpy(150, 100, DVec3::ZERO));
    let each = mesh.memory_bytes() as f64 / mesh.triangle_count() as f64;
    println!("{each:.1} bytes a triangle");
    assert!(each <= 120.0, "{each}");
}
