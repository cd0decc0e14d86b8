// SPDX-License-Identifier: MIT OR Apache-2.0
//! The expanded form: round trips, and what is wrong with wrong ones.

use crate::common::{STAGE, errors_of, read_star, vocabulary};
use dioptric_formats::{ReadError, ReadOptions, Reading, json, read};
use dioptric_scene::{Description, MemoryLoader, NodeId, Value};

fn read_json(text: &str) -> Result<Reading, ReadError> {
    let loader = MemoryLoader::new().with("scene.json", text);
    read("scene.json", &loader, &vocabulary(), &ReadOptions::default())
}

/// The same scene up to places and numbering.
fn same(a: &Description, b: &Description) -> bool {
    fn node(a: &Description, i: NodeId, b: &Description, j: NodeId) -> bool {
        let (x, y) = (a.node(i), b.node(j));
        x.schema.kind == y.schema.kind
            && x.name == y.name
            && x.args.len() == y.args.len()
            && x.args.iter().zip(&y.args).all(|(p, q)| p.0 == q.0 && value(a, &p.1, b, &q.1))
    }
    fn value(a: &Description, x: &Value, b: &Description, y: &Value) -> bool {
        match (x, y) {
            (Value::Node(i), Value::Node(j)) => node(a, *i, b, *j),
            (Value::List(p), Value::List(q)) => {
                p.len() == q.len() && p.iter().zip(q.iter()).all(|(x, y)| value(a, x, b, y))
            }
            _ => x == y,
        }
    }
    a.roots.len() == b.roots.len() && a.roots.iter().zip(&b.roots).all(|(&i, &j)| node(a, i, b, j))
}

#[test]
fn what_is_written_reads_back() {
    let scene = read_star(&format!(
        "{STAGE}{}",
        r##"
red = matte((1, 0.1, 1e-9), name = "réd \"1\"\n")
both = group([sphere((0, 0, 0), 0.1 + 0.2, material = red), sphere((1, 0, 0))])
group([both], transform = translate((1, 2, 3)))
group([both], transform = [translate((1, 2, 3)), translate((-1, 0, 1e300))], name = "second")
polygon([(i, i * i, 1 / (i + 1)) for i in range(12)], material = matte(checker("navy", checker(0, 1), size = 2)))
polygon([])
background("#ff8800")
"##
    ))
    .unwrap();
    let text = json::write(&scene.description);
    let again = read_json(&text).unwrap();
    assert!(same(&scene.description, &again.description), "{text}");
    assert_eq!(json::write(&again.description), text);
    assert_eq!(text.matches("\"ref\"").count(), 1, "{text}");
    let mut other = again.description;
    other.roots.pop();
    assert!(!same(&scene.description, &other));
    assert!(text.lines().all(|line| line.len() < 110), "{text}");
}

#[test]
fn the_written_form_is_this() {
    let scene = read_star(
        "camera(fov = 35)\nlight((1, 2, 3))\ngold = matte(\"gold\")\nfor x in range(2):\n    sphere((x, 0.5, -2), material = gold)\n",
    )
    .unwrap();
    assert_eq!(
        json::write(&scene.description),
        r#"{
  "dioptric": 1,
  "scene": [
    {"kind": "camera", "fov": 35},
    {"kind": "light", "position": [1, 2, 3]},
    {
      "kind": "sphere",
      "center": [0, 0.5, -2],
      "material": {"kind": "matte", "id": 1, "color": "gold"}
    },
    {"kind": "sphere", "center": [1, 0.5, -2], "material": {"ref": 1}}
  ]
}
"#
    );
}

#[test]
fn wrong_files_are_explained_at_their_place() {
    let scene = |items: &str| {
        format!(
            "{{\"dioptric\": 1, \"scene\": [{{\"kind\": \"camera\"}}, {{\"kind\": \"light\", \"position\": [0,0,0]}},\n{items}]}}"
        )
    };
    for (text, expected) in [
        ("".into(), "expected '{', got the end of the file"),
        ("{}".into(), "the file lacks \"dioptric\": 1"),
        ("{\"dioptric\": 1}".into(), "the file lacks \"scene\": [...]"),
        ("{\"dioptric\": 2, \"scene\": []}".into(), "this program reads version 1"),
        ("{\"dioptric\": 1, \"scenes\": []}".into(), "help: did you mean \"scene\"?"),
        (scene("{\"kind\": \"shpere\"}"), "--> scene.json:2:10"),
        (scene("{\"kind\": \"shpere\"}"), "help: did you mean \"sphere\"?"),
        (scene("{\"kind\": \"sphere\"}"), "sphere needs center, three numbers (x, y, z)"),
        (
            scene("{\"kind\": \"sphere\", \"center\": [0,0,0], \"raduis\": 2}"),
            "--> scene.json:2:40",
        ),
        (
            scene("{\"kind\": \"sphere\", \"center\": [0,0,0], \"radius\": -2}"),
            "--> scene.json:2:49",
        ),
        (scene("{\"kind\": \"sphere\", \"center\": [0,0], \"radius\": 2}"), "got (0, 0)"),
        (scene("{\"kind\": \"sphere\", \"center\": null}"), "got null; leave the key out"),
        (
            scene("{\"kind\": \"sphere\", \"center\": [0,0,0], \"center\": [0,0,0]}"),
            "center of sphere is given twice",
        ),
        (scene("{\"kind\": \"matte\"}"), "the material matte is not in a scene by itself"),
        (scene("{\"ref\": 3}"), "there is no id 3 before this"),
        (scene("{\"center\": 3}"), "the object has no kind"),
        (scene("{\"kind\": 3}"), "expected the name of a kind, got a number"),
        (scene("7"), "expected an object with a kind, got a number"),
        (scene("{\"kind\": \"group\", \"shapes\": [7]}"), "item 1: expected a shape, got 7"),
        (scene("{\"kind\": \"camera\"}"), "the scene has a second camera"),
        (scene("{\"kind\": \"sphere\", \"center\": [0,0,1e999]}"), "1e999 is no number"),
        (scene("{\"kind\": \"sphere\""), "expected ',' or '}', got ']'"),
        (scene(&"{\"kind\": \"group\", \"shapes\": [".repeat(5000)), "too many brackets"),
    ] {
        let text = errors_of(read_json(&text));
        assert!(text.contains(expected), "{expected}\n{text}");
    }
}

#[test]
fn nesting_is_bounded_but_deep_enough() {
    let deep = |n: usize| {
        format!("{STAGE}x = sphere((0, 0, 0))\nfor i in range({n}):\n    x = group([x])\n")
    };
    let scene = read_star(&deep(100)).unwrap();
    let text = json::write(&scene.description);
    assert!(same(&read_json(&text).unwrap().description, &scene.description));
    let text = errors_of(read_star(&deep(100_000)));
    assert!(text.contains("group holds things within things, more than 100 deep"), "{text}");
}
