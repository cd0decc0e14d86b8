// SPDX-License-Identifier: MIT OR Apache-2.0
//! Files are read once, lists and files give the same shapes, and wrong ones are told.

use std::sync::Mutex;

use dioptric_geometry::Shape;
use dioptric_scene::args::make_node;
use dioptric_scene::{Description, LoadError, Loader, MemoryLoader, Value};

use super::*;
use crate::build::ColorReading;

/// Notes what is read.
struct Noting {
    files: MemoryLoader,
    read: Mutex<Vec<String>>,
}

impl Loader for Noting {
    fn read(&self, path: &str) -> Result<Vec<u8>, LoadError> {
        self.read.lock().unwrap().push(path.into());
        self.files.read(path)
    }
}

const CUBE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\nvn 0 0 1\n\
f 1//1 4//1 3//1 2//1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
const ATOMS: &str = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
property float radius\nend_header\n0 0 0 1\n5 0 0 2\n10 0 0 nan\n15 0 0 -1\n";

fn loader() -> Noting {
    let files = MemoryLoader::new().with("cube.obj", CUBE).with("atoms.ply", ATOMS);
    Noting { files: files.with("broken.obj", "v 0 0\n"), read: Mutex::default() }
}

/// Builds nodes one after the other with one builder.
fn build(
    loader: &dyn Loader,
    nodes: &[(&str, &[(&str, Value)])],
) -> Vec<Result<AnyShape, Diagnostic>> {
    let all = crate::vocabulary::vocabulary();
    let mut scene = Description::default();
    let nodes: Vec<NodeId> = nodes
        .iter()
        .map(|(kind, args)| scene.push(make_node(all.get(kind).unwrap(), args).unwrap()))
        .collect();
    let mut builder = Builder::new(&scene, ColorReading::Raw, loader);
    let mut one = |id| shape(&Args::new(&scene, id), &mut builder).map(|s| s.expect("a bulk kind"));
    nodes.into_iter().map(&mut one).collect()
}

fn wrong(kind: &str, args: &[(&str, Value)]) -> String {
    let error = build(&loader(), &[(kind, args)]).remove(0).unwrap_err();
    format!("{} ({})", error.message, error.help.expect("a remedy"))
}

fn list<T: Into<Value> + Copy>(items: &[T]) -> Value {
    Value::List(items.iter().map(|&x| x.into()).collect())
}

#[test]
fn files_are_read_once_and_kept_once() {
    let loader = loader();
    let cube = ("file", Value::from("cube.obj"));
    let flat = [cube.clone(), ("smooth", false.into())];
    let atoms = [("file", Value::from("atoms.ply"))];
    let small = [atoms[0].clone(), ("radius", 0.25.into())];
    let built = build(
        &loader,
        &[
            ("mesh", std::slice::from_ref(&cube)),
            ("mesh", std::slice::from_ref(&cube)),
            ("mesh", &flat),
            ("spheres", &atoms),
            ("spheres", &small),
        ],
    );
    let built: Vec<AnyShape> = built.into_iter().map(|s| s.unwrap()).collect();
    let [
        AnyShape::Mesh(a),
        AnyShape::Mesh(b),
        AnyShape::Mesh(flat),
        AnyShape::Spheres(own),
        AnyShape::Spheres(small),
    ] = built.as_slice()
    else {
        panic!("{built:?}");
    };
    assert!(Arc::ptr_eq(a, b) && a.is_solid() && !a.data().normals.is_empty());
    assert!(flat.data().normals.is_empty());
    assert_eq!(*loader.read.lock().unwrap(), ["cube.obj", "cube.obj", "atoms.ply"]);
    // A radius that is none leaves its sphere out, and the others keep their numbers.
    assert_eq!(own.len(), 4);
    assert!(own.get(1).is_some_and(|s| s.bounds().max.x.round() == 7.0));
    assert!(own.get(2).is_none() && own.get(3).is_none());
    assert!(small.get(3).is_some());
}

#[test]
fn lists_give_what_files_give() {
    let points: Vec<Value> = CUBE
        .lines()
        .filter_map(|l| l.strip_prefix("v "))
        .map(|l| {
            Value::from_items(l.split(' ').map(|x| Value::Number(x.parse().unwrap())).collect())
        })
        .collect();
    let faces =
        [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];
    let faces = faces.map(|f| Value::from_items(f.map(|i| Value::Number(f64::from(i))).into()));
    let args = [("points", Value::from_items(points)), ("faces", Value::from_items(faces.into()))];
    let file = [("file", Value::from("cube.obj")), ("smooth", false.into())];
    let built = build(&loader(), &[("mesh", &args), ("mesh", &file)]);
    let [Ok(AnyShape::Mesh(written)), Ok(AnyShape::Mesh(read))] = built.as_slice() else {
        panic!("{built:?}");
    };
    let corners = |m: &Mesh| -> Vec<[[f32; 3]; 3]> {
        m.data().triangles.iter().map(|t| t.map(|i| m.data().positions[i as usize])).collect()
    };
    assert_eq!(corners(written), corners(read));
    assert_eq!(written.triangle_count(), 12);
    assert!(written.is_solid());
}

#[test]
fn pools_have_the_shapes_of_their_lists() {
    let (a, b) = (Value::Vec3([0.0; 3]), Value::Vec3([0.0, 2.0, 0.0]));
    let pair = Value::List([a.clone(), b].into());
    let ends = ("ends", Value::List([pair.clone(), pair].into()));
    let radii = ("radii", list(&[0.5, 1.5]));
    let tops = ("top_radii", Value::Vec2([0.0, 4.0]));
    let built = build(
        &loader(),
        &[("cylinders", &[ends.clone(), radii.clone()]), ("cones", &[ends, radii, tops])],
    );
    let [Ok(AnyShape::Cylinders(cylinders)), Ok(AnyShape::Cones(cones))] = built.as_slice() else {
        panic!("{built:?}");
    };
    let width = |shape: Option<&dyn Shape>| shape.map(|s| s.bounds().max.x.round());
    assert_eq!((width(cylinders.get(1).map(|c| c as _)), cylinders.len()), (Some(2.0), 2));
    assert_eq!((width(cones.get(1).map(|c| c as _)), cones.len()), (Some(4.0), 2));

    for (kind, args, said) in [
        (
            "cylinders",
            vec![("ends", Value::List([Value::List([a.clone(), a.clone()].into())].into()))],
            "cylinder 1 of the list has no length",
        ),
        (
            "spheres",
            vec![("centers", list(&[[0.0; 3]])), ("radii", Value::Vec2([1.0, 2.0]))],
            "radii has 2 numbers for 1 spheres",
        ),
        (
            "spheres",
            vec![("centers", list(&[[0.0; 3]])), ("radii", list(&[1.0])), ("radius", 1.0.into())],
            "spheres has both radius and radii",
        ),
        (
            "spheres",
            vec![("centers", list(&[[0.0; 3]])), ("file", "a.ply".into())],
            "spheres has both centers and a file",
        ),
        ("spheres", vec![], "spheres needs centers, or a file"),
        ("mesh", vec![], "mesh needs a file, or points"),
        ("mesh", vec![("points", list(&[[0.0; 3]]))], "mesh needs a file, or faces"),
        (
            "mesh",
            vec![("file", "cube.obj".into()), ("uvs", list(&[[0.0; 2]]))],
            "mesh has both a file and uvs",
        ),
        (
            "mesh",
            vec![("file", "broken.obj".into())],
            "broken.obj, line 1: expected three numbers after v, got 2",
        ),
        (
            "mesh",
            vec![("file", "cube.ojb".into())],
            "there is no file cube.ojb (did you mean cube.obj?)",
        ),
        (
            "mesh",
            vec![("points", list(&[[0.0; 3]])), ("faces", list(&[[0.0, 0.0, 1.0]]))],
            "face 1 names point 1, but there are 1",
        ),
        (
            "mesh",
            vec![("points", list(&[[0.0; 3]])), ("faces", Value::Vec3([0.0; 3]))],
            "face 1 has fewer than 3 corners",
        ),
        (
            "mesh",
            vec![
                ("points", list(&[[0.0; 3]])),
                ("faces", list(&[[0.0; 3]])),
                ("normals", list(&[[0.0, 1.0, 0.0]; 2])),
            ],
            "normals has 2 items for 1 points",
        ),
    ] {
        let message = wrong(kind, &args);
        assert!(message.starts_with(said), "{message} is not {said}");
    }
}
