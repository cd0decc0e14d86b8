// SPDX-License-Identifier: MIT OR Apache-2.0
//! NFF: every entity becomes what the format means by it, and wrong files say where.

use dioptric_formats::{ReadError, ReadOptions, Reading, json, read, report};
use dioptric_scene::MemoryLoader;

fn read_nff(text: &str) -> Result<Reading, ReadError> {
    let loader = MemoryLoader::new().with("scene.nff", text);
    read("scene.nff", &loader, &dioptric_render::vocabulary(), &ReadOptions::default())
}

const VIEW: &str =
    "v\nfrom 2.1 1.3 1.7\nat 0 0 0\nup 0 0 1\nangle 45\nhither 0.01\nresolution 512 256\n";

#[test]
fn every_entity_becomes_what_it_means() {
    let text = format!(
        "b 0.078 0.361 0.753\n{VIEW}l 4 3 2\nl 1 -4 4 # with a comment\nl -3 1 5 1 0 0\nl 1 2 3\n\
         f 1 0.75 0.33 0.8 0 100000 0 1\np 4\n12 12 -0.5\n-12 12 -0.5\n-12 -12 -0.5\n12 -12 -0.5\n\
         f 1 0.9 0.7 0.5 0.25 3.0827 0 1\ns 0 0 0 0.5\nc 0 0 0 0.2\n0 0 1 0.2\nc 0 0 0 -0.2 0 0 1 0.1\n\
         f 1 0.5 0.25 0.2 0 100000 0.8 1.1\n\
         pp 4\n0 0 0 0 0 1\n1 0 0 0 0 1\n1 1 0 0 0 1\n1 1 0 0 0 1\n\
         f 0 0 0 0 0 0 0 0\n"
    );
    let reading = read_nff(&text).unwrap_or_else(|error| {
        panic!("{}", report::render(&error.diagnostics, &error.sources, false))
    });
    assert!(reading.warnings.is_empty(), "{:?}", reading.warnings);
    assert_eq!(
        json::write(&reading.description),
        r#"{
  "dioptric": 1,
  "scene": [
    {"kind": "background", "color": [0.078, 0.361, 0.753]},
    {"kind": "camera", "eye": [2.1, 1.3, 1.7], "look_at": [0, 0, 0], "up": [0, 0, 1], "fov": 45},
    {
      "kind": "polygon",
      "points": [[12, 12, -0.5], [-12, 12, -0.5], [-12, -12, -0.5], [12, -12, -0.5]],
      "material": {
        "kind": "phong",
        "color": [1, 0.75, 0.33],
        "specular": 0,
        "mirror": 0,
        "ambient": 0,
        "diffuse": 0.8
      }
    },
    {
      "kind": "sphere",
      "center": [0, 0, 0],
      "radius": 0.5,
      "material": {
        "kind": "phong",
        "id": 1,
        "color": [1, 0.9, 0.7],
        "specular": 0.25,
        "exponent": 3.0827,
        "mirror": 0.25,
        "ambient": 0,
        "diffuse": 0.5
      }
    },
    {
      "kind": "cylinder",
      "base": [0, 0, 0],
      "radius": 0.2,
      "top": [0, 0, 1],
      "open": true,
      "material": {"ref": 1}
    },
    {
      "kind": "cone",
      "base": [0, 0, 0],
      "radius": 0.2,
      "top": [0, 0, 1],
      "top_radius": 0.1,
      "open": true,
      "material": {"ref": 1}
    },
    {
      "kind": "triangle",
      "a": [0, 0, 0],
      "b": [1, 0, 0],
      "c": [1, 1, 0],
      "normals": [[0, 0, 1], [0, 0, 1], [0, 0, 1]],
      "material": {
        "kind": "clear",
        "color": [1, 0.5, 0.25],
        "own": 0.19999999999999996,
        "ior": 1.1,
        "tint": [1, 0.5, 0.25],
        "specular": 0,
        "ambient": 0,
        "diffuse": 0.2
      }
    },
    {"kind": "light", "position": [4, 3, 2], "intensity": 0.5},
    {"kind": "light", "position": [1, -4, 4], "intensity": 0.5},
    {"kind": "light", "position": [-3, 1, 5], "color": [1, 0, 0]},
    {"kind": "light", "position": [1, 2, 3], "intensity": 0.5},
    {"kind": "render", "size": [512, 256], "bounces": 32, "shadows": "tinted"},
    {"kind": "scene", "colors": "raw"},
    {"kind": "develop", "encoding": "raw"}
  ]
}
"#
    );
}

#[test]
fn wrong_files_are_explained_at_their_place() {
    for (text, expected) in [
        ("", "scene.nff has no viewpoint"),
        ("v\nfrom 1 2 3\nat 0 0 0\nresolution 9 9\n", "the viewpoint is not complete"),
        (&format!("{VIEW}{VIEW}"), "the file has a second viewpoint"),
        (&format!("{VIEW}s 1 2 3\n"), "the file ends too early"),
        (&format!("{VIEW}l 1 1 1\ns 1 2 3\nx 1\n"), "--> scene.nff:10:1"),
        (&format!("{VIEW}s 1 2 3 4 5\n"), "unknown word 5"),
        (&format!("{VIEW}s 1 2 nan 4\n"), "expected a number, got nan"),
        (&format!("{VIEW}s 1 2 3 0\n"), "radius of sphere: expected a number above 0, got 0"),
        (&format!("{VIEW}f 1 0 0\nhex 0 0 0 5 10 20\n"), "f takes 8 numbers: red, green, blue"),
        (
            &format!("{VIEW}f 2 0 0 3 0 0 0 0\ns 0 0 0 1\n"),
            "diffuse of phong: expected a number from 0 to 1",
        ),
        (&format!("{VIEW}p 1000000000\n0 0 0\n"), "the file ends too early"),
        (&format!("{VIEW}p -3\n0 0 0\n"), "expected a whole number, got -3"),
        (&format!("{VIEW}p x\n0 0 0\n"), "p needs the number of its corners"),
        (&format!("{VIEW}é\n"), "unknown word é"),
        (
            "v\nfrom 0 0 0\nat 0 0 0\nup 0 0 0\nangle 45\nhither 1\nresolution 512 512",
            "up of camera",
        ),
        (
            "v\nfrom 0 0 0\nat 0 0 1\nup 0 1 0\nangle 180\nhither 1\nresolution 512 512",
            "fov of camera",
        ),
    ] {
        match read_nff(text) {
            Ok(_) => panic!("read: {text}"),
            Err(error) => {
                let shown = report::render(&error.diagnostics, &error.sources, false);
                assert!(shown.contains(expected), "{expected}\n{shown}");
            }
        }
    }
}
