// SPDX-License-Identifier: MIT OR Apache-2.0
//! Files of many programs are read as they were meant, and wrong ones say what is wrong where.

use std::path::PathBuf;

use dioptric_geometry::MeshData;
use dioptric_meshes::{Limits, Model, PlyEncoding, read, write_ply};

#[track_caller]
fn model(name: &str, text: impl AsRef<[u8]>) -> Model {
    read(name, &mut text.as_ref(), &Limits::default()).unwrap_or_else(|e| panic!("{e}"))
}

#[track_caller]
fn wrong(name: &str, text: impl AsRef<[u8]>) -> String {
    let error = read(name, &mut text.as_ref(), &Limits::default()).unwrap_err();
    assert!(!error.help.is_empty());
    error.to_string()
}

fn file(name: &str) -> Vec<u8> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/files");
    std::fs::read(folder.join(name)).unwrap()
}

fn ply(encoding: &str, header: &str, body: &[u8]) -> Vec<u8> {
    let header = header.replace("; ", "\n");
    [format!("ply\nformat {encoding} 1.0\n{header}\nend_header\n").as_bytes(), body].concat()
}

const XYZ: &str = "property float x; property float y; property float z";
const FACE: &str = "property list uchar int vertex_indices";

#[test]
fn ply_files_of_others() {
    let solid = model("a.ply", file("icosahedron.ply"));
    assert_eq!((solid.mesh.positions.len(), solid.mesh.triangles.len()), (12, 20));
    assert_eq!(solid.mesh.normals.len(), 12);
    for (n, p) in solid.mesh.normals.iter().zip(&solid.mesh.positions) {
        let along: f32 = n.iter().zip(p).map(|(a, b)| a * b).sum();
        assert!(along > 4.1 && along < 4.3, "{n:?} points away from the middle, as {p:?}");
    }
    let plane = model("a.PLY", file("plane.ply")).mesh;
    assert_eq!(plane.positions[2], [1.0, 1.0, 0.0]);
    assert_eq!(plane.normals, [[0.0, 0.0, 1.0]; 4]);
    assert_eq!(plane.uvs, [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
    assert_eq!(plane.triangles, [[0, 1, 2], [0, 2, 3]]);

    let all = model("a.ply", file("nonindexed-all-attributes-be.ply")).mesh;
    assert_eq!(all.positions[..2], [[1.5, 0.4, 9.2], [0.3, -1.1, 0.1]]);
    assert_eq!(all.normals[1], [12.0, 52.0, -44.0]);
    assert_eq!(all.uvs[0], [15.0 / 65535.0, 33.0 / 65535.0]);
    assert_eq!((all.positions.len(), all.triangles.len()), (12, 4));

    let small = model("a.ply", file("ushort-be.ply")).mesh;
    assert_eq!(small.positions[4], [5.0, 3.0, 9.0]);
    assert_eq!(small.normals[1], [0.0, -4368.0, -32767.0]);
    assert_eq!(small.triangles.len(), 3, "a quad and a triangle");
    assert_eq!(small.triangles[2], [3, 2, 4]);
}

#[test]
fn ply_elements_in_any_order_with_unknown_ones_between() {
    let header = format!(
        "comment faces first; element face 2; property uchar flag; property list short uint vertex_index; \
         property list uchar float texcoord; obj_info x; element edge 1; property int a; property double b; \
         element nothing 4000000000; element vertex 4; property list uchar uchar extra; {XYZ}; property float radius"
    );
    let text = ply(
        "ascii",
        &header,
        b"9 4 0 1 2 3 2 0.5 0.5\n8 3 0 2 3 0\n1 0.5\n2 7 7 0 0 0 0.5\n\n0 1 0 0 1\n0 1 1 0 1.5\n1 9 0.2 0.1 0 2\n",
    );
    let expected = Model {
        mesh: MeshData {
            positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.2, 0.1, 0.0]],
            // The quad is concave at its last corner.
            triangles: vec![[3, 0, 1], [1, 2, 3], [0, 2, 3]],
            ..MeshData::default()
        },
        radii: vec![0.5, 1.0, 1.5, 2.0],
    };
    assert_eq!(model("a.ply", &text), expected);

    let mut body: Vec<u8> = Vec::new();
    let f = |body: &mut Vec<u8>, x: f32| body.extend(x.to_be_bytes());
    for (flag, corners, coordinates) in [(9, &[0, 1, 2, 3][..], 2), (8, &[0, 2, 3], 0)] {
        body.push(flag);
        body.extend((corners.len() as i16).to_be_bytes());
        corners.iter().for_each(|&i: &u32| body.extend(i.to_be_bytes()));
        body.push(coordinates);
        (0..coordinates).for_each(|_| f(&mut body, 0.5));
    }
    body.extend(1_i32.to_be_bytes());
    body.extend(0.5_f64.to_be_bytes());
    for (extra, numbers) in [
        (&[7, 7][..], [0.0, 0.0, 0.0, 0.5]),
        (&[], [1.0, 0.0, 0.0, 1.0]),
        (&[], [1.0, 1.0, 0.0, 1.5]),
        (&[9], [0.2, 0.1, 0.0, 2.0]),
    ] {
        body.push(extra.len() as u8);
        body.extend(extra);
        numbers.into_iter().for_each(|x| f(&mut body, x));
    }
    assert_eq!(model("a.ply", ply("binary_big_endian", &header, &body)), expected);
}

#[test]
fn lines_may_end_as_windows_ends_them() {
    let header =
        format!("ply\nformat binary_little_endian 1.0\nelement vertex 1\n{XYZ}\nend_header\n");
    let header = header.replace("; ", "\n").replace('\n', "\r\n");
    let numbers: Vec<u8> = [1.0_f32, 2.0, 3.0].iter().flat_map(|x| x.to_le_bytes()).collect();
    let mesh = model("a.ply", [header.as_bytes(), &numbers].concat()).mesh;
    assert_eq!(mesh.positions, [[1.0, 2.0, 3.0]]);
}

#[test]
fn strips_and_points_alone() {
    let header = format!(
        "element vertex 5; {XYZ}; element tristrips 1; property list int int vertex_indices"
    );
    let body = b"0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n9 0 1 2 3 4 -1 2 1 0\n";
    let mesh = model("a.ply", ply("ascii", &header, body)).mesh;
    assert_eq!(mesh.triangles, [[0, 1, 2], [2, 1, 3], [2, 3, 4], [2, 1, 0]]);
    let points = format!("element vertex 1; {XYZ}; property float radius; element face 0");
    let points = model("a.ply", ply("ascii", &points, b"1 2 3 0.25\n"));
    assert_eq!((points.mesh.positions, points.radii), (vec![[1.0, 2.0, 3.0]], vec![0.25]));
    assert!(points.mesh.triangles.is_empty());
}

#[test]
fn what_is_written_is_read() {
    let mut mesh = MeshData {
        positions: vec![[0.1, -2.5e-30, 3e20], [1.0, 2.0, 3.0], [f32::MIN_POSITIVE, 1e-45, 0.0]],
        triangles: vec![[0, 1, 2], [2, 1, 0]],
        normals: vec![[0.0, 0.1, 1.0]; 3],
        uvs: vec![[0.25, 0.75], [1e-3, 2.0], [-1.0, 0.0]],
    };
    for _ in 0..2 {
        for encoding in [PlyEncoding::Ascii, PlyEncoding::Little, PlyEncoding::Big] {
            let mut bytes = Vec::new();
            write_ply(&mesh, encoding, &mut bytes).unwrap();
            assert_eq!(model("a.ply", bytes).mesh, mesh);
        }
        (mesh.normals, mesh.uvs) = (Vec::new(), Vec::new());
    }
}

#[test]
fn obj_forms_of_corners() {
    let solid = "v 0 0 0 1.0\nv 1 0 0 # a comment\n  v 1 1 0\r\nv\t0 1 0\nvt 0 0\nvt 1 0 0\nvt 1\nvn 0 0 1\n";
    let mesh = |faces: &str| model("a.obj", format!("{solid}{faces}")).mesh;
    let plain = mesh("o thing\nusemtl red\ns 1\nf 1 2 3\nf -4 -2 -1 # last\n");
    assert_eq!(plain.triangles, [[0, 1, 2], [0, 2, 3]]);
    assert!(plain.normals.is_empty() && plain.uvs.is_empty());

    let full = mesh("f 1/1/1 2/2/1 3/3/1\nf 1/2/1 3/3/1 \\\n 4//1\nf 1/1/-1 2/-2/1 3/3/1\n");
    assert_eq!(full.triangles, [[0, 1, 2], [3, 2, 4], [0, 1, 2]], "corners are shared");
    assert_eq!(full.positions[3], full.positions[0]);
    assert_eq!(full.uvs, [[0.0, 0.0], [1.0, 0.0], [1.0, 0.0], [1.0, 0.0], [0.0, 0.0]]);
    assert_eq!(full.normals, [[0.0, 0.0, 1.0]; 5]);

    let mixed = mesh("f 1 2 3\nf 1//1 3//1 4//1\nf 4 3 1\n");
    assert_eq!(mixed.triangles, [[0, 1, 2], [4, 5, 6], [3, 2, 0]]);
    assert_eq!(mixed.normals[..5], [[0.0; 3], [0.0; 3], [0.0; 3], [0.0; 3], [0.0, 0.0, 1.0]]);
    let late = mesh("f 1 2 3/1\n");
    assert_eq!((late.triangles.as_slice(), late.positions.len()), (&[[0, 1, 4]][..], 5));
    assert_eq!(late.positions[4], [1.0, 1.0, 0.0]);

    assert_eq!(mesh("f 1 2\nf 1\nl 1 2\np 1\n").triangles, [[0; 3]; 0]);
    assert_eq!(mesh("f 1/ 2// 3\n").triangles, [[0, 1, 2]]);
    let turned = model("a.obj", file("negative_indices.obj")).mesh;
    assert_eq!((turned.triangles.len(), turned.uvs.len()), (12, turned.positions.len()));
}

#[test]
fn many_corners_at_one_place_take_linear_time() {
    let n = 100_000;
    let mut text = "v 0 0 0\nv 1 0 0\nv 0 1 0\n".to_string();
    for i in 0..n {
        text.push_str(&format!("vn 0 {i} 1\nf 1//{0} 2//{0} 3//{0}\n", i + 1));
    }
    text.push_str("f 1//7 2//7 3//7\n");
    let mesh = model("a.obj", text).mesh;
    assert_eq!(mesh.positions.len(), 3 * n);
    assert_eq!(mesh.triangles[n], mesh.triangles[6]);
    assert_eq!(mesh.normals[mesh.triangles[99][1] as usize], [0.0, 99.0, 1.0]);
}

#[test]
fn numbers_that_are_none() {
    let mesh = model("a.obj", "v nan 0 -inf\nv 1.#IND 1 1\nv 1 1 1e99\nf 1 2 3\n").mesh;
    assert!(mesh.positions[0][0].is_nan() && mesh.positions[1][0].is_nan());
    assert_eq!(mesh.positions[2][2], f32::INFINITY);
}

#[test]
fn wrong_ply_files_say_what_and_where() {
    let vertices = format!("element vertex 3; {XYZ}; element face 1; {FACE}");
    let points = b"0 0 0\n1 0 0\n0 1 0\n";
    let text = |body: &[u8]| ply("ascii", &vertices, &[&points[..], body].concat());
    let binary = |body: &[u8]| ply("binary_little_endian", &vertices, &[&[0; 36], body].concat());
    let start = ply("binary_little_endian", &vertices, b"").len() + 36;
    for (text, message) in [
        (b"".to_vec(), "a.ply, line 1: expected ply, the first line of a PLY file".to_string()),
        (b"solid x".to_vec(), "a.ply, line 1: expected ply, the first line of a PLY file".into()),
        (b"ply\nformat ascii 1.0\n".to_vec(), "a.ply, line 2: the header has no end_header".into()),
        (b"ply\nend_header\n".to_vec(), "a.ply, line 2: the header has no line format".into()),
        (b"ply\nformat utf8 1.0\n".to_vec(), "a.ply, line 2: expected ascii, binary_little_endian or binary_big_endian after format, got utf8".into()),
        (ply("ascii", "property float x", b""), "a.ply, line 3: a property comes before the first element".into()),
        (ply("ascii", "element vertex", b""), "a.ply, line 3: expected how many there are after element vertex".into()),
        (ply("ascii", "element vertex -1", b""), "a.ply, line 3: expected how many there are after element vertex".into()),
        (ply("ascii", "element vertex 1; property real x", b""), "a.ply, line 4: expected a type such as float, int or uchar, got real".into()),
        (ply("ascii", "element vertex 1; property list float int x", b""), "a.ply, line 4: the length of a list is no whole number's type".into()),
        (ply("ascii", "element face 0", b""), "a.ply: the header has no element vertex".into()),
        (ply("ascii", "element vertex 1; property float x; property float z", b""), "a.ply: the element vertex has no property y".into()),
        (ply("ascii", &format!("element vertex 5000000000; {XYZ}"), b""), "a.ply: the file has 5000000000 vertices, more than can be told apart".into()),
        (ply("ascii", &format!("element vertex 4000000000; {XYZ}"), b"1 2 3\n"), "a.ply, line 8: the file ends before vertex 2 of 4000000000".into()),
        (ply("binary_little_endian", &format!("element vertex 4000000000; {XYZ}"), &[0; 15]), "a.ply, byte 136: the file ends in vertex 2 of 4000000000, 3 bytes of 12 are there".into()),
        (text(b""), "a.ply, line 12: the file ends before face 1 of 1".into()),
        (text(b"3 0 1\n"), "a.ply, line 13: face 1 of 1: vertex_indices has 2 of the 3 items it announces".into()),
        (text(b"3 0 1 3\n"), "a.ply, line 13: face 1 of 1 names vertex 3, but they count from 0 to 2".into()),
        (text(b"3 0 1 -1\n"), "a.ply, line 13: face 1 of 1 names vertex -1, but they count from 0 to 2".into()),
        (text(b"3 0 1 2.5\n"), "a.ply, line 13: face 1 of 1: vertex_indices holds 2.5, which is no whole number".into()),
        (text(b"-3 0 1 2\n"), "a.ply, line 13: face 1 of 1: vertex_indices has a length of -3".into()),
        (ply("ascii", &vertices, b"0 0 0\n1 x 0\n"), "a.ply, line 11: vertex 2 of 3: y is x, which is no number".into()),
        (ply("ascii", &vertices, b"0 0 0\n1 0\n"), "a.ply, line 11: vertex 2 of 3: the line ends before z".into()),
        (binary(b""), format!("a.ply, byte {start}: the file ends in face 1 of 1, 0 bytes of 1 are there")),
        (binary(b"\x03\0\0\0\0"), format!("a.ply, byte {start}: the file ends in face 1 of 1, 5 bytes of 13 are there")),
        (binary(b"\x03\0\0\0\0\0\0\0\0\x03\0\0\0"), format!("a.ply, byte {start}: face 1 of 1 names vertex 3, but they count from 0 to 2")),
        (file("incomplete-face-specification.ply"), "a.ply: the element face has no list vertex_indices of whole numbers".into()),
        (file("integer-literal-too-large.ply"), "a.ply, line 5: the header has no end_header".into()),
    ] {
        assert_eq!(wrong("a.ply", &text), message, "{}", String::from_utf8_lossy(&text));
    }
}

#[test]
fn wrong_obj_files_say_what_and_where() {
    for (text, message) in [
        ("", "a.obj, line 0: the file has no line that starts with v, so it is no mesh"),
        ("v 1 2\n", "a.obj, line 1: expected three numbers after v, got 2"),
        ("v\n", "a.obj, line 1: expected three numbers after v, got 0"),
        ("\nv 1 2 3.1+e2\n", "a.obj, line 2: expected a number after v, got 3.1+e2"),
        ("v 0 0 0\nvt x\n", "a.obj, line 2: expected a number after vt, got x"),
        ("v 0 0 0\nvt\nvt ", "a.obj, line 3: expected a number after vt, got 0"),
        ("v 0 0 0\nf 1 1 2", "a.obj, line 2: the face names v 2, but only 1 come before it"),
        ("v 0 0 0\nf 1 1 0", "a.obj, line 2: the face names v 0, but they count from 1"),
        ("v 0 0 0\nf 1 1 -2", "a.obj, line 2: the face names v -2, but only 1 come before it"),
        (
            "v 0 0 0
vt 0
f 1/1 1/2 1/1",
            "a.obj, line 3: the face names vt 2, but only 1 come before it",
        ),
        (
            "v 0 0 0\nf 1 a 1",
            "a.obj, line 2: expected a corner such as 1, 1/2, 1//3 or 1/2/3, got a",
        ),
        (
            "v 0 0 0
f 1 1/1/1/1 1",
            "a.obj, line 2: expected a corner such as 1, 1/2, 1//3 or 1/2/3, got 1/1/1/1",
        ),
        (
            "v 0 0 0\nf 1 1///1 1",
            "a.obj, line 2: expected a corner such as 1, 1/2, 1//3 or 1/2/3, got 1///1",
        ),
    ] {
        assert_eq!(wrong("a.obj", text), message);
    }
    let index = wrong("a.obj", file("invalid_index.obj"));
    assert_eq!(index, "a.obj, line 12: the face names v 7, but only 6 come before it");
    assert_eq!(wrong("a.stl", ""), "a.stl: the file is of no format that is known");
}

#[test]
fn the_limit_on_memory_holds() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\n".to_string() + &"f 1 2 3\n".repeat(1000);
    let limits = Limits { bytes: 10_000 };
    let error = read("a.obj", &mut text.as_bytes(), &limits).unwrap_err();
    assert!(error.is_too_large && error.help.contains("--max-memory"));
    let header = format!("element vertex 3; {XYZ}; element face 1000; {FACE}");
    let text =
        ply("ascii", &header, ["0 0 0\n".repeat(3), "3 0 1 2\n".repeat(1000)].concat().as_bytes());
    let error = read("a.ply", &mut text.as_slice(), &limits).unwrap_err();
    assert!(error.is_too_large, "{error}");
}

/// The models that lie beside the checkout where this project is made; elsewhere there are none.
#[test]
fn models_beside_the_checkout() {
    let here = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    let Some(models) = here.ancestors().map(|a| a.join("shared/data/models")).find(|f| f.is_dir())
    else {
        return;
    };
    let triangles = |path: &str| {
        let bytes = std::fs::read(models.join(path)).unwrap();
        read(path, &mut bytes.as_slice(), &Limits::default()).map(|m| m.mesh.triangles.len())
    };
    for (path, count) in [
        ("ply/cube.ply", 12),
        ("ply/cycloidal.ply", 43368),
        ("ply/float-color.ply", 1),
        ("ply/reference.ply", 1610),
        ("obj/catmark_torus_creases0.obj", 64),
        ("obj/concave_polygon/concave_polygon.obj", 64),
        ("obj/cornell_box/cornell_box.obj", 36),
        ("obj/cube-vertexcol/cube-vertexcol.obj", 12),
        ("obj/spot.obj", 5856),
        ("obj/usemtl-issue-68/usemtl-issue-68.obj", 400),
        ("broken/test-nan.obj", 36),
    ] {
        assert_eq!(triangles(path).unwrap_or_else(|e| panic!("{e}")), count, "{path}");
    }
    for (path, message) in [
        ("obj/number_formats.obj", ", line 11: expected a number after v, got 3.1+e2"),
        (
            "broken/crash-30d6d0f7.ply",
            ", line 7: expected a type such as float, int or uchar, got ???",
        ),
        ("broken/malformed.obj", ", line 23: the face names v 12, but only 8 come before it"),
    ] {
        assert_eq!(triangles(path).unwrap_err().to_string(), format!("{path}{message}"));
    }
}
