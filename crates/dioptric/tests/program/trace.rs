// SPDX-License-Identifier: MIT OR Apache-2.0
//! `trace`: what is in its output, and what it says.

use dioptric::geometry::MeshData;
use dioptric::meshes::{PlyEncoding, write_ply};

use super::run::{Folder, finish, good, program, run};

/// A ray as the file has it.
pub type FileRay = [f32; 6];

/// The bytes of a file of rays.
pub fn ray_bytes(rays: &[FileRay]) -> Vec<u8> {
    rays.iter().flatten().flat_map(|x| x.to_le_bytes()).collect()
}

/// The floats in some bytes.
pub fn floats(bytes: &[u8]) -> Vec<f32> {
    bytes.chunks(4).map(|b| f32::from_le_bytes(b.try_into().expect("4 bytes"))).collect()
}

/// What the program answers for a mesh.
pub fn trace_mesh(folder: &Folder, mesh: &MeshData, rays: &[FileRay], more: &[&str]) -> Vec<f32> {
    let mut bytes = Vec::new();
    write_ply(mesh, PlyEncoding::Little, &mut bytes).expect("memory suffices");
    std::fs::write(folder.file("mesh.ply"), bytes).expect("the disk has room");
    std::fs::write(folder.file("rays.bin"), ray_bytes(rays)).expect("the disk has room");
    let (mesh, rays, hits) =
        (folder.file("mesh.ply"), folder.file("rays.bin"), folder.file("hits.bin"));
    let args = ["trace", &mesh, &rays, "-o", &hits];
    good(&[&args, more].concat());
    floats(&folder.bytes("hits.bin"))
}

const SCENE: &str = "sphere(center = (0, 0, 0), radius = 1)\n\
    pair = group([sphere(center = (0, 4, 0), radius = 1), box(min = (-1, 7, -1), max = (1, 9, 1))])\n\
    group([pair]); group([pair], transform = translate((10, 0, 0)))\n";

/// Straight at the ball, past it, at a box in the second instance, not going anywhere.
const RAYS: [FileRay; 4] = [
    [0.0, 0.0, 5.0, 0.0, 0.0, -2.0],
    [0.0, 0.0, 5.0, 0.0, 0.0, 1.0],
    [10.5, 8.5, 5.0, 0.0, 0.0, -0.25],
    [0.0, 0.0, 5.0, 0.0, 0.0, 0.0],
];

fn folder() -> Folder {
    let folder = Folder::new("trace");
    std::fs::write(folder.file("scene.star"), SCENE).unwrap();
    std::fs::write(folder.file("rays.bin"), ray_bytes(&RAYS)).unwrap();
    folder
}

#[test]
fn distances_hits_and_records() {
    let folder = folder();
    let (scene, rays, hits) =
        (folder.file("scene.star"), folder.file("rays.bin"), folder.file("hits.bin"));
    let said = good(&["trace", &scene, &rays, "-o", &hits, "--repeat", "3", "--threads", "2"]);
    let lines: Vec<&str> = said.lines().collect();
    assert_eq!(lines.len(), 3, "{said}");
    assert!(lines[0].starts_with("read ") && lines[0].contains(" s, build "), "{said}");
    assert!(lines[0].contains(" s, objects 3, instances 2"), "{said}");
    assert_eq!(lines[1], "rays 4, 2 hit");
    let rates: Option<Vec<f64>> = lines[2]
        .strip_prefix("median ")
        .and_then(|rest| rest.strip_suffix(')'))
        .map(|rest| rest.replace(" Mrays/s (", " ").replace(" .. ", " "))
        .map(|rest| rest.split(' ').map(|x| x.parse().unwrap()).collect());
    let rates = rates.unwrap_or_else(|| panic!("{said}"));
    assert!(rates.len() == 3 && rates[1] <= rates[0] && rates[0] <= rates[2], "{said}");
    let inf = f32::INFINITY;
    assert_eq!(floats(&folder.bytes("hits.bin")), [4.0, inf, 4.0, inf]);

    good(&["trace", &scene, &rays, "-o", &hits, "--any"]);
    assert_eq!(floats(&folder.bytes("hits.bin")), [1.0, 0.0, 1.0, 0.0]);

    for options in [&["--batch"][..], &["--batch", "--threads", "1"]] {
        good(&[&["trace", &scene, &rays, "-o", &hits], options].concat());
        assert_eq!(floats(&folder.bytes("hits.bin")), [4.0, inf, 4.0, inf]);
        good(&[&["trace", &scene, &rays, "-o", &hits, "--any"], options].concat());
        assert_eq!(floats(&folder.bytes("hits.bin")), [1.0, 0.0, 1.0, 0.0]);
    }

    good(&["trace", &scene, &rays, "-o", &hits, "--full"]);
    let bytes = folder.bytes("hits.bin");
    assert_eq!(bytes.len(), 4 * 36);
    let records: Vec<(f32, [u32; 3], Vec<f32>)> = bytes
        .chunks(36)
        .map(|r| {
            let ids = [4, 8, 12].map(|at| u32::from_le_bytes(r[at..at + 4].try_into().unwrap()));
            (floats(&r[..4])[0], ids, floats(&r[16..]))
        })
        .collect();
    let none = u32::MAX;
    assert_eq!(records[0], (4.0, [none, 0, 0], vec![0.5, 0.5, 0.0, 0.0, 1.0]));
    assert_eq!(records[1], (inf, [none; 3], vec![0.0; 5]));
    assert_eq!((records[2].0, records[2].1[0]), (4.0, 1), "the second instance");
    assert_eq!(records[2].2[2..], [0.0, 0.0, 1.0]);
}

#[test]
fn standard_streams_hold_rays_and_hits() {
    use std::io::Write;
    let folder = folder();
    let mut child = program(&["trace", &folder.file("scene.star"), "-", "-o", "-", "--any"])
        .stdin(std::process::Stdio::piped())
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    child.stdin.take().unwrap().write_all(&ray_bytes(&RAYS)).unwrap();
    let ran = finish(child.wait_with_output().unwrap());
    assert_eq!(floats(&ran.stdout), [1.0, 0.0, 1.0, 0.0]);
    assert!(ran.stderr.contains("\nmedian "), "{}", ran.stderr);
}

#[test]
fn meshes_and_clouds_are_scenes_too() {
    let folder = Folder::new("trace-meshes");
    let mesh = MeshData {
        positions: vec![[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]],
        triangles: vec![[0, 1, 2]],
        ..MeshData::default()
    };
    let rays = [[1.0, 1.0, 3.0, 0.0, 0.0, -1.0], [3.0, 3.0, 3.0, 0.0, 0.0, -1.0]];
    assert_eq!(trace_mesh(&folder, &mesh, &rays, &[]), [3.0, f32::INFINITY]);
    std::fs::write(folder.file("a.obj"), "v 0 0 0\nv 4 0 0\nv 0 4 0\nf 1 2 3\n").unwrap();
    let cloud = "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n\
                 property float radius\nend_header\n3 3 0 0.5\n1 1 0 nan\n";
    std::fs::write(folder.file("cloud.ply"), cloud).unwrap();
    let (rays, hits) = (folder.file("rays.bin"), folder.file("hits.bin"));
    good(&["trace", &folder.file("a.obj"), &rays, "-o", &hits]);
    assert_eq!(floats(&folder.bytes("hits.bin")), [3.0, f32::INFINITY]);
    good(&["trace", &folder.file("cloud.ply"), &rays, "-o", &hits]);
    assert_eq!(floats(&folder.bytes("hits.bin")), [f32::INFINITY, 2.5]);
}

#[test]
fn wrong_files_and_options_are_told() {
    let folder = folder();
    std::fs::write(folder.file("short.bin"), [0; 25]).unwrap();
    std::fs::write(folder.file("cut.ply"), "ply\nformat ascii 1.0\nelement vertex 2\n").unwrap();
    let (scene, rays) = (folder.file("scene.star"), folder.file("rays.bin"));
    let (short, cut) = (folder.file("short.bin"), folder.file("cut.ply"));
    for (args, status, said) in [
        (vec!["trace", &scene, &short], 1, "has 25 bytes, which is no whole number of rays"),
        (vec!["trace", &scene, "nowhere.bin"], 1, "cannot read nowhere.bin"),
        (vec!["trace", &cut, &rays], 1, "cut.ply, line 3: the header has no end_header"),
        (vec!["trace", "nowhere.ply", &rays], 1, "cannot read nowhere.ply: no such file or folder"),
        (vec!["trace", "-", "-"], 2, "scene and rays cannot both come from standard input"),
        (vec!["trace", &scene, &rays, "--any", "--full"], 2, "cannot be used with"),
        (vec!["trace", &scene, &rays, "--repeat", "0"], 2, "0 is not in 1.."),
        (
            vec!["trace", &scene, &rays, "-o", "nowhere/hits.bin"],
            1,
            "cannot write nowhere/hits.bin",
        ),
    ] {
        let ran = run(&args);
        assert_eq!(ran.status, status, "{args:?}: {}", ran.stderr);
        assert!(ran.stderr.contains(said), "{args:?}: {}", ran.stderr);
    }
    std::fs::write(folder.file("none.bin"), []).unwrap();
    assert!(good(&["trace", &scene, &folder.file("none.bin")]).contains("\nrays 0, 0 hit\n"));
}
