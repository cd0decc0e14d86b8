// SPDX-License-Identifier: MIT OR Apache-2.0
//! Readers given damaged files answer with a mesh or an error: they never panic, never run away and never
//! take more memory than the file can account for. A fixed seed.

use dioptric_math::random::Random;
use dioptric_meshes::{Limits, Place, PlyEncoding, read, write_ply};

const OBJ: &str = "mtllib a.mtl\no cube\nv 0 0 0\nv 1 0 0\nv 1.5e-1 1 0 0.5 0.5 0.5\nv .2 -.1 1\nvt 0 1\nvt 1 0\nvn 0 0 1\nvn 0 1 0\n\
usemtl red\ns off\nf 1 2 3\nf 1/1 2/2 3/1 4/2\nf -1//1 -2//2 -3//1\nf 1/1/1 2/2/2 \\\n 4/1/2\n";
const ASCII: &str = "ply\nformat ascii 1.0\ncomment c\nelement vertex 4\nproperty float x\nproperty double y\nproperty short z\n\
property uchar s\nproperty uchar t\nproperty float radius\nelement face 2\nproperty list uchar int vertex_indices\n\
property list uchar float texcoord\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n\
0 0 0 0 0 1\n1 0 0 255 0 1\n1 1 0 9 9 2\n0.2 0.1 0 1 1 1\n4 0 1 2 3 2 0.5 0.5\n3 0 1 2 0\n6 0 1 2 -1 2 3\n";

const WORDS: [&[u8]; 20] = [
    b"\n",
    b" ",
    b"-1",
    b"4294967295",
    b"4294967296",
    b"99999999999999999999",
    b"nan",
    b"1e999",
    b"/",
    b"//",
    b"list ",
    b"f 1 1 1 1 1 1\n",
    b"element face 3000000000\n",
    b"property list uint uint vertex_index\n",
    b"\\\n",
    b"\0",
    b"\xff\xff\xff\xff",
    b"end_header\n",
    b"element x 4000000000\n",
    b"binary_big_endian",
];

fn edit(bytes: &[u8], random: &mut Random) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for _ in 0..1 + random.bits() % 3 {
        let below = |n: usize, random: &mut Random| (random.bits() % (n as u64 + 1)) as usize;
        let at = below(bytes.len(), random);
        let end = (at + below(12, random)).min(bytes.len());
        match random.bits() % 5 {
            0 => drop(bytes.drain(at..end)),
            1 => {
                let copy = bytes[at..end].to_vec();
                bytes.splice(at..at, copy);
            }
            2 if at < bytes.len() => bytes[at] = random.bits() as u8,
            3 => bytes.truncate(at),
            _ => {
                let word = WORDS[(random.bits() % WORDS.len() as u64) as usize];
                bytes.splice(at..at, word.iter().copied());
            }
        }
    }
    bytes
}

#[test]
fn damaged_files_are_refused_politely() {
    let mesh = read("a.obj", &mut OBJ.as_bytes(), &Limits::default()).unwrap().mesh;
    let [mut little, mut big] = [Vec::new(), Vec::new()];
    write_ply(&mesh, PlyEncoding::Little, &mut little).unwrap();
    write_ply(&mesh, PlyEncoding::Big, &mut big).unwrap();
    let files = [
        ("a.obj", OBJ.as_bytes()),
        ("a.ply", ASCII.as_bytes()),
        ("b.ply", little.as_slice()),
        ("c.ply", big.as_slice()),
    ];
    let mut random = Random::new(1);
    let mut good = 0;
    for round in 0..40_000 {
        let (name, bytes) = files[round % files.len()];
        let bytes = edit(bytes, &mut random);
        match read(name, &mut bytes.as_slice(), &Limits::default()) {
            Ok(model) => {
                good += 1;
                let mesh = model.mesh;
                let count = mesh.positions.len();
                assert!(mesh.triangles.iter().flatten().all(|&i| (i as usize) < count));
                for other in [mesh.normals.len(), mesh.uvs.len(), model.radii.len()] {
                    assert!(other == 0 || other == count);
                }
                assert!(mesh.triangles.capacity() + mesh.positions.capacity() <= 2 * bytes.len());
            }
            Err(error) => {
                assert!(!error.message.is_empty() && error.message.len() < 300);
                match error.place {
                    Place::Line(n) => {
                        assert!(n <= 1 + bytes.iter().filter(|&&b| b == b'\n').count() as u64)
                    }
                    Place::Byte(n) => assert!(n <= bytes.len() as u64),
                    Place::File => {}
                }
            }
        }
    }
    assert!(good > 2000, "the edits are too violent to test much: {good}");
}
