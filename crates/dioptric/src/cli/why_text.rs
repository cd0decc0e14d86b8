// SPDX-License-Identifier: MIT OR Apache-2.0
//! The tree of `why` as text: every term with its numbers, so that a reader can add them up.
//!
//! Works on the JSON that `why --json` prints and knows nothing else of the renderer: the text cannot
//! say anything that the JSON does not.

use std::fmt::Write;

use serde_json::{Map, Value};

/// What the text may use.
pub struct Style<'a> {
    /// A swatch's colour for a linear one; none where the terminal shows no colours.
    pub swatch: Option<&'a dyn Fn([f64; 3]) -> [u8; 3]>,
    /// Rays below this many others are folded to their value; the camera's ray is at 0.
    pub depth: usize,
    /// Shows every sample's tree, not one of each way that rays take.
    pub all: bool,
}

/// Column in which the numbers of a row begin.
const NUMBERS: usize = 44;

/// The whole explanation of one pixel.
pub fn pixel(pixel: &Value, style: &Style) -> String {
    let mut text = Text { out: String::new(), style };
    let samples = list(pixel, "samples");
    for group in groups(samples, style.all) {
        let Some((&first, others)) = group.split_first() else { continue };
        let sample = &samples[first];
        let weight = number(&sample["weight"]);
        text.line("", &format!("sample {} of {}, weight {weight}", first + 1, samples.len()));
        text.node(&sample["ray"], "", 0);
        if !others.is_empty() {
            text.line("", &format!("the same way: {}", ranges(others)));
        }
        text.line("", "");
    }
    text.line("", &format!("pixel {},{}", pixel["pixel"][0], pixel["pixel"][1]));
    if samples.len() > 1 {
        for (i, sample) in samples.iter().enumerate() {
            let label = format!("{} x sample {}", number(&sample["weight"]), i + 1);
            text.row("", '+', &label, rgb(&sample["ray"]["value"]));
        }
    }
    text.row("", '=', "linear light", rgb(&pixel["linear"]));
    for step in list(pixel, "develop") {
        text.row("", ' ', step["step"].as_str().unwrap_or("step"), rgb(&step["value"]));
    }
    text.bytes(&pixel["rgb8"]);
    text.out
}

/// Samples whose rays met the same things in the same order: the tree of the first one speaks for all.
fn groups(samples: &[Value], all: bool) -> Vec<Vec<usize>> {
    let mut groups: Vec<(String, Vec<usize>)> = Vec::new();
    for (i, sample) in samples.iter().enumerate() {
        let way = way(&sample["ray"]);
        match groups.iter_mut().find(|(known, _)| !all && *known == way) {
            Some((_, group)) => group.push(i),
            None => groups.push((way, vec![i])),
        }
    }
    groups.into_iter().map(|(_, group)| group).collect()
}

/// What a ray and all rays that it caused met.
fn way(node: &Value) -> String {
    let below: Vec<String> = list(node, "children").iter().map(|c| way(&c["ray"])).collect();
    format!("{}>{}({})", node["kind"], node["object"], below.join(","))
}

/// `samples 2, 4 to 6`, counted from 1.
fn ranges(indices: &[usize]) -> String {
    let mut runs: Vec<(usize, usize)> = Vec::new();
    for i in indices.iter().map(|i| i + 1) {
        match runs.last_mut() {
            Some((_, last)) if *last + 1 == i => *last = i,
            _ => runs.push((i, i)),
        }
    }
    let words: Vec<String> = runs
        .iter()
        .map(|&(first, last)| match last - first {
            0 => first.to_string(),
            1 => format!("{first}, {last}"),
            _ => format!("{first} to {last}"),
        })
        .collect();
    format!("sample{} {}", if indices.len() == 1 { "" } else { "s" }, words.join(", "))
}

struct Text<'a> {
    out: String,
    style: &'a Style<'a>,
}

impl Text<'_> {
    fn line(&mut self, indent: &str, text: &str) {
        self.out.push_str(indent.trim_end_matches(|c| c == ' ' && text.is_empty()));
        self.out.push_str(&printable(text));
        self.out.push('\n');
    }

    /// A name and three numbers, those of all rows below one another, and the colour that they are.
    fn row(&mut self, indent: &str, sign: char, label: &str, [r, g, b]: [f64; 3]) {
        let label = printable(label);
        let used = indent.chars().count() + 2 + label.chars().count();
        let pad = NUMBERS.saturating_sub(used).max(1);
        // Writing to a string cannot fail.
        let _ = write!(self.out, "{indent}{sign} {label}{:pad$}{r:>10.6} {g:>10.6} {b:>10.6}", "");
        self.swatch([r, g, b]);
        self.out.push('\n');
    }

    fn swatch(&mut self, linear: [f64; 3]) {
        if let Some(show) = self.style.swatch {
            let [r, g, b] = show(linear);
            let _ = write!(self.out, "  \x1b[48;2;{r};{g};{b}m    \x1b[0m");
        }
    }

    fn bytes(&mut self, rgb8: &Value) {
        let [r, g, b] = [0, 1, 2].map(|i| rgb8[i].as_u64().unwrap_or(0));
        let label = format!("  8-bit value #{r:02x}{g:02x}{b:02x}");
        let pad = NUMBERS.saturating_sub(label.len()).max(1);
        let _ = write!(self.out, "{label}{:pad$}{r:>10} {g:>10} {b:>10}", "");
        if self.style.swatch.is_some() {
            let _ = write!(self.out, "  \x1b[48;2;{r};{g};{b}m    \x1b[0m");
        }
        self.out.push('\n');
    }

    /// A ray: what it met, its terms, the rays that it caused, its value.
    fn node(&mut self, node: &Value, indent: &str, depth: usize) {
        let kind = node["kind"].as_str().unwrap_or("ray");
        self.line(indent, &format!("{kind} ray {}", met(node)));
        let inner = format!("{indent}│ ");
        for fact in facts(node) {
            self.line(&inner, &fact);
        }
        for term in list(node, "terms") {
            let name = term["name"].as_str().unwrap_or("term");
            let light = term["light"].as_str().map(|l| format!(" of {l}")).unwrap_or_default();
            self.row(&inner, '+', &format!("{name}{light}"), rgb(&term["value"]));
            for detail in term_details(term) {
                self.line(&format!("{inner}    "), &detail);
            }
        }
        for child in list(node, "children") {
            let (weight, ray) = (rgb(&child["weight"]), &child["ray"]);
            let value = rgb(&ray["value"]);
            let kind = ray["kind"].as_str().unwrap_or("ray");
            let sum = [0, 1, 2].map(|i| weight[i] * value[i]);
            self.row(&inner, '+', &format!("{} x {kind} ray", weights(weight)), sum);
            if let Some(told) = scalings(child) {
                self.line(&format!("{inner}    "), &told);
            }
            if depth < self.style.depth {
                self.node(ray, &inner, depth + 1);
            } else {
                let folded = format!("{kind} ray {} (folded: {} rays)", met(ray), count(ray));
                self.line(&format!("{inner}  "), &folded);
            }
        }
        self.row(indent, '=', &format!("value of the {kind} ray"), rgb(&node["value"]));
    }
}

/// What a ray hit, where that was made, and how far away it is.
fn met(node: &Value) -> String {
    match node["object"].as_str() {
        Some(object) => {
            format!("hits {object}{} at t {}", source(&node["source"]), number(&node["t"]))
        }
        None => "leaves the scene".into(),
    }
}

/// ` (scenes/space.star:12)`, or nothing.
fn source(place: &Value) -> String {
    match (place["file"].as_str(), place["line"].as_u64()) {
        (Some(file), Some(line)) => format!(" ({file}:{line})"),
        _ => String::new(),
    }
}

/// Keys of a ray that are shown in a way of their own, or repeat another one.
const SHOWN: &[&str] = &["kind", "object", "source", "t", "terms", "children", "value", "origin"];

/// The order of those facts that every hit has; others follow.
const ORDER: &[&str] = &[
    "direction",
    "point",
    "point_in_file",
    "point_in_object",
    "normal",
    "shading_normal",
    "uv",
    "pattern",
    "medium",
    "bounce",
];

/// Facts that say nothing where they equal another one.
const SAME_AS: &[(&str, &str)] = &[
    ("point_in_file", "point"),
    ("point_in_object", "point_in_file"),
    ("shading_normal", "normal"),
];

/// Everything else that is known of a ray, short facts together in a line.
fn facts(node: &Value) -> Vec<String> {
    let mut lines =
        vec![format!("from {} along {}", value(&node["origin"]), value(&node["direction"]))];
    let Some(map) = node.as_object() else { return lines };
    let mut keys: Vec<&str> =
        map.keys().map(String::as_str).filter(|key| *key != "direction").collect();
    keys.sort_by_key(|key| ORDER.iter().position(|k| k == key).unwrap_or(ORDER.len()));
    let repeats =
        |key: &str| SAME_AS.iter().any(|(k, other)| *k == key && map.get(*other) == map.get(key));
    let (mut line, mut stories) = (String::new(), Vec::new());
    for key in keys {
        let v = &map[key];
        if SHOWN.contains(&key)
            || v.is_null()
            || *v == Value::Bool(true) && key == "from_outside"
            || repeats(key)
        {
            continue;
        }
        if let Some(map) = v.as_object().filter(|map| map.values().any(is_list_of_objects)) {
            stories.extend(told_in_lines(key, map));
            continue;
        }
        let fact = format!("{} {}", key.replace('_', " "), value(v));
        if !line.is_empty() && line.chars().count() + fact.chars().count() > 72 {
            lines.push(std::mem::take(&mut line));
        }
        line.push_str(if line.is_empty() { "" } else { ", " });
        line.push_str(&fact);
    }
    lines.extend(Some(line).filter(|l| !l.is_empty()));
    lines.extend(stories);
    lines
}

fn is_list_of_objects(value: &Value) -> bool {
    value.as_array().is_some_and(|items| items.first().is_some_and(Value::is_object))
}

/// A fact that is a story: what holds for all of it, then each event on a line of its own.
fn told_in_lines(key: &str, map: &Map<String, Value>) -> Vec<String> {
    let whole: Map<String, Value> = map
        .iter()
        .filter(|(_, v)| !is_list_of_objects(v))
        .map(|(k, v)| (k.clone(), v.clone()))
        .collect();
    let mut lines = vec![format!("{} {}", key.replace('_', " "), object(&whole))];
    for event in map
        .values()
        .filter(|v| is_list_of_objects(v))
        .flat_map(|v| v.as_array().into_iter().flatten())
    {
        lines.push(format!("  {}", value(event)));
    }
    lines
}

/// The numbers that a term was made of, and what blocks its light.
fn term_details(term: &Value) -> Vec<String> {
    let Some(map) = term.as_object() else { return Vec::new() };
    let mut lines = Vec::new();
    // A light that nothing weakens needs no more words than its cosine.
    let lit =
        term["visibility"].as_array().is_some_and(|v| v.iter().all(|v| v.as_f64() == Some(1.0)));
    let skip = |key: &str, v: &Value| {
        ["name", "light", "value", "blockers", "light_source", "scaled_by"].contains(&key)
            || (lit && ["visibility", "unshadowed"].contains(&key))
            || (key == "samples" && v.as_u64() == Some(1))
            || v.is_null()
            || *v == Value::Bool(false)
    };
    let parts: Vec<String> = map
        .iter()
        .filter(|(key, v)| !skip(key, v))
        .map(|(key, v)| format!("{} {}", key.replace('_', " "), value(v)))
        .collect();
    if !parts.is_empty() {
        lines.push(parts.join(", "));
    }
    lines.extend(scalings(term));
    for blocker in list(term, "blockers") {
        let object = blocker["object"].as_str().unwrap_or("something");
        let place = source(&blocker["source"]);
        let passes = match &blocker["passes"] {
            Value::Array(rgb) if rgb.iter().any(|v| v.as_f64() != Some(0.0)) => {
                format!(", which lets {} pass", value(&blocker["passes"]))
            }
            _ => String::new(),
        };
        lines.push(format!("blocked by {object}{place} at t {}{passes}", number(&blocker["t"])));
    }
    lines
}

/// The factors that are in a term's value or a child's weight already.
fn scalings(told: &Value) -> Option<String> {
    let factors: Vec<String> = list(told, "scaled_by")
        .iter()
        .map(|f| {
            format!("x {} for {}", weights(rgb(&f["factor"])), f["by"].as_str().unwrap_or("?"))
        })
        .collect();
    (!factors.is_empty()).then(|| format!("counted already: {}", factors.join(", ")))
}

/// How many rays a tree has.
fn count(node: &Value) -> usize {
    1 + list(node, "children").iter().map(|c| count(&c["ray"])).sum::<usize>()
}

fn list<'a>(value: &'a Value, key: &str) -> &'a [Value] {
    value[key].as_array().map_or(&[], Vec::as_slice)
}

fn rgb(value: &Value) -> [f64; 3] {
    [0, 1, 2].map(|i| value[i].as_f64().unwrap_or(0.0))
}

/// One number where all lanes are alike.
fn weights([r, g, b]: [f64; 3]) -> String {
    if r == g && g == b { short(r) } else { format!("({}, {}, {})", short(r), short(g), short(b)) }
}

fn number(value: &Value) -> String {
    value.as_f64().map_or_else(|| "infinity".into(), short)
}

/// About six digits, without zeros at the end.
fn short(x: f64) -> String {
    if x == 0.0 || (1e-4..1e7).contains(&x.abs()) {
        let digits = 6 - (x.abs().max(1.0).to_string().find('.').unwrap_or(1) as i64).clamp(1, 6);
        let text = format!("{x:.*}", digits as usize);
        let text = if text.contains('.') {
            text.trim_end_matches('0').trim_end_matches('.')
        } else {
            &text
        };
        if text == "-0" { "0".into() } else { text.into() }
    } else {
        format!("{x:.5e}")
    }
}

fn value(value: &Value) -> String {
    match value {
        Value::Null => "nothing".into(),
        Value::Bool(true) => "yes".into(),
        Value::Bool(false) => "no".into(),
        Value::Number(_) => number(value),
        Value::String(text) => text.clone(),
        Value::Array(items) => {
            let items: Vec<String> = items.iter().map(self::value).collect();
            format!("({})", items.join(", "))
        }
        Value::Object(map) => object(map),
    }
}

fn object(map: &Map<String, Value>) -> String {
    let told = map.iter().filter(|(_, v)| **v != Value::Bool(false) && !v.is_null());
    let parts: Vec<String> =
        told.map(|(key, v)| format!("{} {}", key.replace('_', " "), value(v))).collect();
    parts.join(", ")
}

/// Names come from the scene's text: no character of them may steer the terminal.
fn printable(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { '\u{fffd}' } else { c }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn tree() -> Value {
        json!({"schema": 1, "pixel": [3, 4], "samples": [{"weight": 1.0, "ray": {
            "kind": "camera", "object": "ball", "source": {"file": "a.star", "line": 7}, "t": 2.5,
            "origin": [0, 0, 5], "direction": [0, 0, -1], "uv": [0.5, 0.25],
            "terms": [
                {"name": "ambient", "value": [0.1, 0.1, 0.1],
                 "scaled_by": [{"by": "fog", "factor": [0.5, 0.5, 0.5]}]},
                {"name": "diffuse", "light": "sun", "value": [0, 0, 0], "cosine": 0.75, "behind": false,
                 "blockers": [{"object": "wall\u{1b}", "source": {"file": "a.star", "line": 9}, "t": 3.0, "passes": [0.0, 0.0, 0.0]}]},
            ],
            "children": [{"weight": [0.5, 0.5, 0.5], "ray": {
                "kind": "reflected", "object": null, "source": null, "t": null,
                "origin": [0, 0, 2.5], "direction": [0, 0, 1], "terms": [{"name": "background", "value": [0.2, 0.4, 0.6]}],
                "children": [], "value": [0.2, 0.4, 0.6]}}],
            "value": [0.2, 0.3, 0.4]}}],
            "linear": [0.2, 0.3, 0.4], "develop": [{"step": "exposure", "value": [0.2, 0.3, 0.4]}], "rgb8": [51, 77, 102]})
    }

    #[test]
    fn every_term_has_its_numbers() {
        let text = pixel(&tree(), &Style { swatch: None, depth: 9, all: false });
        let expected = "\
sample 1 of 1, weight 1
camera ray hits ball (a.star:7) at t 2.5
│ from (0, 0, 5) along (0, 0, -1)
│ uv (0.5, 0.25)
│ + ambient                                   0.100000   0.100000   0.100000
│     counted already: x 0.5 for fog
│ + diffuse of sun                            0.000000   0.000000   0.000000
│     cosine 0.75
│     blocked by wall\u{fffd} (a.star:9) at t 3
│ + 0.5 x reflected ray                       0.100000   0.200000   0.300000
│ reflected ray leaves the scene
│ │ from (0, 0, 2.5) along (0, 0, 1)
│ │ + background                              0.200000   0.400000   0.600000
│ = value of the reflected ray                0.200000   0.400000   0.600000
= value of the camera ray                     0.200000   0.300000   0.400000

pixel 3,4
= linear light                                0.200000   0.300000   0.400000
  exposure                                    0.200000   0.300000   0.400000
  8-bit value #334d66                               51         77        102
";
        assert_eq!(text, expected, "{text}");
    }

    #[test]
    fn folded_rays_keep_their_share() {
        let text = pixel(&tree(), &Style { swatch: None, depth: 0, all: false });
        assert!(text.contains("+ 0.5 x reflected ray                       0.100000"), "{text}");
        assert!(text.contains("reflected ray leaves the scene (folded: 1 rays)"), "{text}");
        assert!(!text.contains("background"), "{text}");
    }

    #[test]
    fn samples_that_go_the_same_way_are_told_once() {
        let mut pixels = tree();
        let sample = pixels["samples"][0].clone();
        let mut other = sample.clone();
        other["ray"]["object"] = json!("wall");
        pixels["samples"] = json!([sample, sample, other, sample, sample]);
        let style = |all| Style { swatch: None, depth: 9, all };
        let text = pixel(&pixels, &style(false));
        assert!(text.contains("the same way: samples 2, 4, 5\n"), "{text}");
        assert!(text.contains("sample 3 of 5") && !text.contains("sample 2 of 5"), "{text}");
        assert!(text.contains("+ 1 x sample 5"), "{text}");
        assert!(pixel(&pixels, &style(true)).contains("sample 2 of 5"));
    }

    #[test]
    fn swatches_show_the_developed_colour() {
        let show = |c: [f64; 3]| c.map(|x| (x * 100.0) as u8);
        let text = pixel(&tree(), &Style { swatch: Some(&show), depth: 0, all: false });
        assert!(text.contains("\x1b[48;2;20;30;40m    \x1b[0m"), "{text}");
    }

    #[test]
    fn numbers_are_short() {
        for (x, expected) in [
            (0.0, "0"),
            (1.0, "1"),
            (109.25, "109.25"),
            (0.1 + 0.2, "0.3"),
            (1e-9, "1.00000e-9"),
            (-0.5, "-0.5"),
            (123456.7, "123457"),
        ] {
            assert_eq!(short(x), expected);
        }
    }
}
