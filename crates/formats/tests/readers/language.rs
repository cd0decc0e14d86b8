// SPDX-License-Identifier: MIT OR Apache-2.0
//! The scene language: what enters the scene, what values mean, what is computed.

use crate::common::{STAGE, errors_of, read_star, read_with};
use dioptric_formats::{Limits, ReadOptions, Reading};
use dioptric_scene::{NodeId, StackId, Value};

#[track_caller]
fn ok(result: Result<Reading, dioptric_formats::ReadError>) -> Reading {
    match result {
        Ok(reading) => reading,
        Err(error) => {
            panic!(
                "{}",
                dioptric_formats::report::render(&error.diagnostics, &error.sources, false)
            )
        }
    }
}

/// Kinds of the roots, without camera and light.
fn roots(reading: &Reading) -> Vec<&'static str> {
    let scene = &reading.description;
    let kinds = scene.roots.iter().map(|&id| scene.node(id).schema.kind);
    kinds.filter(|kind| !matches!(*kind, "camera" | "light")).collect()
}

#[test]
fn the_scene_of_the_design() {
    let reading = ok(read_star(
        r#"
camera(eye = (0, 2, 10), look_at = (0, 1, 0), fov = 35)
light(position = (5, 8, 5), intensity = 1)
gold = matte("gold")
for i in range(8):
    sphere(center = (2 * i - 7, 1, 0), radius = 0.8, material = gold)
polygon([(0, 0, 0), (1, 0, 0), (0, 1, 0)], material = matte(checker((0.8, 0.8, 0.8), "navy", size = 1)))
"#,
    ));
    let scene = &reading.description;
    assert_eq!(scene.roots.len(), 11);
    assert!(reading.warnings.is_empty(), "{:?}", reading.warnings);
    let balls: Vec<NodeId> = scene.roots_of("sphere").collect();
    assert_eq!(scene.node(balls[3]).arg("center"), Some(&Value::Vec3([-1.0, 1.0, 0.0])));
    assert_eq!(scene.node(balls[3]).arg("radius"), Some(&Value::Number(0.8)));
    assert_eq!(scene.node(balls[0]).arg("material"), scene.node(balls[7]).arg("material"));
    assert_eq!(scene.sources.locate(scene.node(balls[0]).span).unwrap().line, 6);
    assert_eq!(scene.sources.text(scene.argument_span(balls[0], "radius")), Some("0.8"));
}

#[test]
fn a_shape_enters_unless_it_is_consumed() {
    let reading = ok(read_star(&format!(
        "{STAGE}{}",
        r#"
def pair(x):
    sphere((x, 0, 0), 1)
    return sphere((x, 1, 0), 1)

a = pair(1)
b = sphere((5, 5, 5), 2)
group([a, b])
group(shapes = [b], transform = translate((1, 0, 0)))
"#
    )));
    assert_eq!(roots(&reading), ["sphere", "group", "group"]);
    let scene = &reading.description;
    let groups: Vec<_> = scene.roots_of("group").collect();
    let Some(Value::List(first)) = scene.node(groups[0]).arg("shapes") else { panic!() };
    // The same node again: an instance.
    assert_eq!(scene.node(groups[1]).arg("shapes").unwrap().items(), [first[1].clone()]);
}

#[test]
fn a_call_inside_functions_remembers_who_called() {
    let text = format!(
        "{STAGE}def a(r):\n    sphere((0, 0, 0), r)\ndef b():\n    a(1)\n    a(2)\nb()\nb()\n"
    );
    let reading = ok(read_star(&text));
    let scene = &reading.description;
    let stack = |n: usize| {
        let mut lines = Vec::new();
        let mut id = scene.node(scene.roots_of("sphere").nth(n).unwrap()).stack;
        while id != StackId::TOP {
            let frame = &scene.stacks[id.0 as usize];
            lines
                .push((frame.function.to_string(), scene.sources.locate(frame.span).unwrap().line));
            id = frame.parent;
        }
        lines
    };
    assert_eq!(stack(0), [("a".to_string(), 5), ("b".to_string(), 7)]);
    assert_eq!(stack(1), [("a".to_string(), 6), ("b".to_string(), 7)]);
    assert_eq!(stack(3), [("a".to_string(), 6), ("b".to_string(), 8)]);
}

#[test]
fn loaded_files_only_define() {
    let files = [
        (
            "lib/things.star",
            "load(\"colors.star\", \"red\")\nunit = sphere((0, 0, 0), 1)\ndef ball(x):\n    return sphere((x, 0, 0), 1, material = red)\ndef both():\n    ball(1)\n    sphere((9, 9, 9))\nball(7)\n",
        ),
        ("lib/colors.star", "red = matte(\"red\")\n"),
    ];
    let text = format!(
        "load(\"lib/things.star\", \"ball\", \"both\", thing = \"unit\")\n{STAGE}ball(3)\nball(4)\nboth()\ngroup([thing])\n"
    );
    let reading = ok(read_with(&text, &files, &ReadOptions::default()));
    assert_eq!(roots(&reading), ["sphere", "sphere", "sphere", "sphere", "group"]);
    let scene = &reading.description;
    let place = |n: usize| {
        let id = scene.roots_of("sphere").nth(n).unwrap();
        let stack = scene.node(id).stack;
        let at = scene.sources.locate(scene.node(id).span).unwrap();
        let from = scene.sources.locate(scene.stacks[stack.0 as usize].span).unwrap();
        (at.file.to_string(), at.line, from.file.to_string(), from.line)
    };
    assert_eq!(place(0), ("lib/things.star".into(), 4, "scene.star".into(), 3));
    assert_eq!(place(1), ("lib/things.star".into(), 4, "scene.star".into(), 4));
    assert_eq!(place(3), ("lib/things.star".into(), 7, "scene.star".into(), 5));
}

#[test]
fn params_are_typed_and_can_be_set() {
    let text = format!(
        "{STAGE}{}",
        r#"
n = param("n", 3, min = 1, max = 10, doc = "how many")
color = param("color", (1, 0, 0))
big = param("big", False)
style = param("style", "none", choices = ["none", "square"])
for i in range(n):
    sphere((i, 0, 0), 2 if big else 1, material = matte(color))
light((0, 0, 0), falloff = style)
"#
    );
    let set = |pairs: &[(&str, &str)]| ReadOptions {
        set: pairs.iter().map(|(k, v)| (k.to_string(), v.to_string())).collect(),
        ..ReadOptions::default()
    };
    let reading = ok(read_with(&text, &[], &set(&[])));
    assert_eq!(roots(&reading).len(), 3);
    assert_eq!(reading.params[0].doc, "how many");
    assert_eq!(reading.params[0].max, Some(10.0));
    let reading =
        ok(read_with(&text, &[], &set(&[("n", "5"), ("color", "blue"), ("big", "true")])));
    assert_eq!(roots(&reading).len(), 5);
    assert_eq!(reading.params[1].value, Value::Vec3([0.0, 0.0, 1.0]));
    let ball = reading.description.roots_of("sphere").next().unwrap();
    assert_eq!(reading.description.node(ball).arg("radius"), Some(&Value::Number(2.0)));
    for (name, value, message) in [
        ("n", "0", "--set n: expected a number from 1 to 10, got 0"),
        ("n", "x", "--set n=x: expected a number"),
        ("style", "sqare", "--set style: expected one of \"none\", \"square\", got \"sqare\""),
        ("colour", "red", "the scene has no parameter \"colour\" to set"),
        ("colour", "red", "help: did you mean \"color\"?"),
    ] {
        let text = errors_of(read_with(&text, &[], &set(&[(name, value)])));
        assert!(text.contains(message), "{text}");
    }
}

#[test]
fn numbers_are_computed_and_random_ones_repeat() {
    let text = format!(
        "{STAGE}{}",
        r#"
def near(a, b):
    if a - b > 1e-12 or b - a > 1e-12:
        fail(f"{a} is not {b}")
near(sin(pi / 6), 0.5)
near(cos(tau), 1)
near(degrees(atan2(1, 1)), 45)
near(sqrt(2) * sqrt(2), 2)
near(log(exp(3)), 3)
near(log(8, 2), 3)
near(pow(2, 10), 1024)
near(lerp(2, 4, 0.5), 3)
near(lerp((0, 2), (4, 4), 0.25)[1], 2.5)
near(clamp(7, 0, 5), 5)
near(sum([x * x for x in range(4)]), 14)
near(floor(-1.5) + ceil(1.5) + round(2.5), 2)
near(time() + frame(), 10.25)
version(1)
if "ab" * 3 != "ababab" or [0] * 2 != [0, 0] or 3 * "x" != "xxx":
    fail("repetition")
r, s = random(7), random(7)
for i in range(100):
    if r.uniform(2, 3) != s.uniform(2, 3):
        fail("not the same")
    x = r.integer(1, 6)
    if x < 1 or x > 6 or x != s.integer(1, 6):
        fail("integer")
    near(r.normal(5, 2), s.normal(5, 2))
    if r.choice([1, 2]) not in (1, 2): fail("choice")
    s.choice((1, 2))
print("seen", x, sphere((0, 0, 0)))
"#
    );
    let options = ReadOptions { time: 0.25, frame: 10, ..ReadOptions::default() };
    let reading = ok(read_with(&text, &[], &options));
    assert_eq!(reading.printed.len(), 1);
    assert!(reading.printed[0].ends_with("<sphere>"), "{:?}", reading.printed);
}

#[test]
fn random_numbers_have_the_moments_they_should() {
    let text = format!(
        "{STAGE}{}",
        r#"
r = random(1)
n = 20000
normal = [r.normal(1, 2) for i in range(n)]
mean = sum(normal) / n
variance = sum([(x - mean) * (x - mean) for x in normal]) / n
whole = [r.integer(1, 6) for i in range(n)]
if not (0.95 < mean and mean < 1.05 and 3.85 < variance and variance < 4.15):
    fail(f"{mean} {variance}")
for face in range(1, 7):
    count = len([1 for x in whole if x == face])
    if count < 3133 or count > 3533: fail(f"{face}: {count}")
"#
    );
    ok(read_star(&text));
}

#[test]
fn limits_stop_what_does_not_end() {
    let limits =
        Limits { steps: 100_000, depth: 100, objects: 1000, memory: 64 << 20, source: 1 << 20 };
    let options = ReadOptions { limits, ..ReadOptions::default() };
    for (text, code) in [
        ("for i in range(10000):\n    for j in range(10000):\n        x = i\n", "too-many-steps"),
        ("x = [i for i in range(10000) for j in range(10000)]\n", "too-many-steps"),
        ("x = list(range(2000000000))\n", "too-many-steps"),
        ("def f():\n    f()\nf()\n", "too-deep"),
        ("def f(x):\n    return sorted([1, 2], key = f)\nf(1)\n", "too-deep"),
        ("for i in range(2000):\n    sphere((0, 0, 0))\n", "too-many-objects"),
        ("x = [str(i) * 20000 for i in range(9999)]\n", "too-much-memory"),
        ("x = 'x' * 2000000000 * 2000000000\n", "too-much-memory"),
        ("x = [0] * 1000000000\n", "too-much-memory"),
        ("x = 'x'\nfor i in range(60):\n    x += x\n", "too-much-memory"),
        ("x = [1]\nfor i in range(60):\n    x = x + x\n", "too-much-memory"),
        (&"(".repeat(100_000), "too-nested"),
        (&format!("x = {}1{}", "[".repeat(90), "]".repeat(90)), "ok"),
        (&format!("x = {}1", "1 + ".repeat(1900)), "ok"),
        (&format!("x = {}True", "not ".repeat(1900)), "ok"),
        (&"# a\n".repeat(300_000), "file-too-large"),
        ("x = []\nfor i in range(90000):\n    x = [x]\n", "ok"),
    ] {
        match read_with(&format!("{STAGE}{text}"), &[], &options) {
            Ok(_) => assert_eq!(code, "ok", "{text:.60}"),
            Err(error) => assert_eq!(error.diagnostics[0].code, code, "{text:.60}"),
        }
    }
}

#[test]
fn nothing_that_can_be_typed_ends_the_program() {
    for text in [
        "",
        "\u{feff}camera()",
        "(",
        ")",
        "\"",
        "'''",
        "def",
        "def f(:",
        "x = ",
        "if",
        "\0",
        "\u{202e}",
        "sphere",
        "sphere(",
        "sphere()",
        "sphere(*[1], **{\"radius\": 2})",
        "sphere(**{1: 2})",
        "sphere(**5)",
        "sphere(*5)",
        "x = sphere((0,0,0))\nx.y",
        "x = sphere((0,0,0))\nx()",
        "sphere(radius)",
        "1 / 0",
        "1 // 0",
        "1 % 0",
        "1.0 / 0.0",
        "[][0]",
        "{}[1]",
        "fail()",
        "fail(\"a\\nb\")",
        "load(\"x.star\")",
        "load(\"scene.star\", \"a\")",
        "load(\"/etc/passwd\", \"a\")",
        "load(\"../x.star\", \"a\")",
        "int(\"x\")",
        "int(\"9\" * 5000)",
        "1 << 100000",
        "param(1, 2)",
        "param(\"a\", None)",
        "param(\"a\", sphere)",
        "random(\"x\")",
        "random(1).choice([])",
        "random(1).integer(2, 1)",
        "version(2)",
        "version()",
        "sqrt(-1)",
        "lerp((1, 2), 3, 4)",
        "clamp(1, 3, 2)",
        "floor(1e300)",
        "sum([\"a\"])",
        "range(1, 2, 0)",
        "range(-2147483648, 2147483647)",
        "x = [1]\nx.append(x)\nprint(x)\nsphere(x)",
        "break",
        "return 1",
        "yield 1",
        "class A: pass",
        "import os",
        "while True: pass",
        "sphere((float(\"nan\"), 0, 0))",
        "\tx = 1",
        "x = 1\n  y = 2",
        "é = 1\nsphere(é)",
        "print(\"\\x1b[2J\")",
        "sphere((1, 2, 3), radius = \"💥\")",
        "f\"{1 + }\"",
        "\"{\".format()",
        "\"%s\" % ()",
        "\"%d\" % \"x\"",
        "lambda: (yield)",
        "x: 1 = 2",
        "(1, 2) = 3",
        "breakpoint()",
        "a, b = 1",
        "for x in 5: pass",
        "for sphere in range(3): sphere",
    ] {
        let _ = read_star(text);
    }
}

/// `cargo test --release -p dioptric-formats -- --ignored --nocapture million` prints the figures.
#[test]
#[ignore = "slow without optimisation"]
fn a_million_spheres_are_read_quickly() {
    let text = format!(
        "{STAGE}{}",
        r#"
red = matte("red")
n = 0
for i in range(1000000):
    sphere(center = (i % 1000 * 0.5, i // 1000, 0), radius = 0.8, material = red)
    n += 1
"#
    );
    let start = std::time::Instant::now();
    let reading = ok(read_star(&text));
    let seconds = start.elapsed().as_secs_f64();
    let peak = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let peak = peak.lines().find(|line| line.starts_with("VmHWM")).unwrap_or_default().to_string();
    println!("{seconds:.2} s, {peak}");
    assert_eq!(reading.description.roots.len(), 1_000_002);
    assert!(seconds < 3.0);
}
