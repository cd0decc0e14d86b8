// SPDX-License-Identifier: MIT OR Apache-2.0
//! Readers given damaged files answer with a scene or with errors at places inside the text: they
//! never panic and never run away. A few thousand random edits with a fixed seed; `fuzz` goes on.

use crate::common::vocabulary;
use dioptric_formats::{Limits, ReadOptions, read, report};
use dioptric_math::random::Random;
use dioptric_scene::{MemoryLoader, Sources};

const STAR: &str = r#"load("lib.star", "tree")
camera(eye = (0, 2, 10), fov = 35); light((5, 8, 5))
def f(n, x = 1):
    if n <= 0: return [x]
    elif n == 3: return f(n - 1) + ["%s" % n]
    return [f"{n}"] + f(n - 1, x * 2)
gold = matte(checker((0.8, 0.8, 0.8), "navy", size = 1e-3))
for i in range(param("n", 3, max = 9)):
    sphere(center = (2 * i - 7, 1, 0), radius = 0.8, material = gold)
    tree(random(i).uniform(1, 2))
group([sphere(v) for v in [(0, 0, 0), (1, 1, 1)] if v], transform = [translate((1, 2, 3))])
print(len(f(5)), {"a": (lambda y: y + 1)(2)}, not True, -1 // 2)
polygon(points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)], name = "p\u00e9")
"#;
const LIB: &str = "def tree(x):\n    return group([sphere((x, 0, 0), 1)])\n";
const JSON: &str = r##"{"dioptric": 1, "scene": [
  {"kind": "camera", "fov": 3.5e1}, {"kind": "light", "position": [5, -8.25, 5]},
  {"kind": "sphere", "name": "\u00e9\n", "center": [0, 0, 0], "material": {"kind": "matte", "id": 1, "color": "#f80"}},
  {"kind": "group", "shapes": [{"kind": "sphere", "center": [1, 1, 1], "material": {"ref": 1}}]}
]}"##;
const NFF: &str = "b 0 0.5 1\nv\nfrom 2.1 1.3 1.7\nat 0 0 0\nup 0 0 1\nangle 45\nhither 0.01\nresolution 64 64\nl 4 3 2\nf 1 0.75 0.33 0.8 0 100000 0 1\np 3\n12 12 -0.5\n-12 12 -0.5\n-12 -12 -0.5\ns 0 0 0 0.5\ns 1 0 0 0.5\n";

/// Words that edits put in besides single characters.
const WORDS: [&str; 24] = [
    "(",
    ")",
    "[",
    "]]",
    "{",
    "}",
    "\"",
    "'''",
    "#",
    "\n",
    "    ",
    "1e308",
    "-1",
    "0",
    "nan",
    "range(9)",
    "* 1000000000",
    "for x in ",
    "sphere(",
    "\u{0}",
    "é",
    "None",
    "**{}",
    "\\",
];

fn edit(text: &str, random: &mut Random) -> String {
    let mut chars: Vec<char> = text.chars().collect();
    for _ in 0..random.bits() % 4 {
        let at = (random.bits() % (chars.len() as u64 + 1)) as usize;
        let end = (at + (random.bits() % 12) as usize).min(chars.len());
        match random.bits() % 4 {
            0 => drop(chars.drain(at..end)),
            1 => {
                let copy: Vec<char> = chars[at..end].to_vec();
                chars.splice(at..at, copy);
            }
            2 => {
                let from = (random.bits() % (chars.len() as u64 + 1)) as usize;
                let copy: Vec<char> = chars[from..(from + 20).min(chars.len())].to_vec();
                chars.splice(at..end, copy);
            }
            _ => {
                let word = WORDS[(random.bits() % WORDS.len() as u64) as usize];
                chars.splice(at..at, word.chars());
            }
        }
    }
    chars.into_iter().collect()
}

#[test]
fn damaged_files_are_refused_politely() {
    let options = ReadOptions {
        limits: Limits {
            steps: 20_000,
            depth: 50,
            objects: 1000,
            memory: 16 << 20,
            source: 1 << 16,
        },
        ..ReadOptions::default()
    };
    let vocabulary = vocabulary();
    let mut random = Random::new(1);
    let mut read_well = 0;
    for round in 0..3000 {
        let (name, text) =
            [("scene.star", STAR), ("scene.json", JSON), ("scene.nff", NFF)][round % 3];
        let text = edit(text, &mut random);
        let loader = MemoryLoader::new().with(name, text.as_str()).with("lib.star", LIB);
        match read(name, &loader, &vocabulary, &options) {
            Ok(_) => read_well += 1,
            Err(error) => {
                assert!(!error.diagnostics.is_empty(), "{text}");
                for diagnostic in &error.diagnostics {
                    for label in &diagnostic.labels {
                        let inside = |sources: &Sources| sources.locate(label.span).is_some();
                        assert!(inside(&error.sources), "{diagnostic:?}\n{text}");
                    }
                }
                assert!(!report::render(&error.diagnostics, &error.sources, false).is_empty());
                let internal = error
                    .diagnostics
                    .iter()
                    .any(|d| d.code == "internal" && !d.message.contains("which NFF needs"));
                assert!(!internal, "{:?}\n{text}", error.diagnostics);
            }
        }
    }
    assert!(read_well > 100, "the edits are too violent to test much: {read_well}");
}
