// SPDX-License-Identifier: MIT OR Apache-2.0
//! The tree of `why` as text: every term with its numbers, so that a reader can add them up.
//!
//! Works on the JSON that `why --json` prints and knows nothing else of the renderer: the text cannot
//! say anything that the JSON does not.

mod paths;
mod words;

use std::fmt::Write;

use serde_json::Value;

use words::{facts, list, met, number, printable, rgb, scalings, term_details, weights};

/// What the text may use.
pub struct Style<'a> {
    /// A swatch's colour for a linear one; none where the terminal shows no colours.
    pub swatch: Option<&'a dyn Fn([f64; 3]) -> [u8; 3]>,
    /// Rays below this many others are folded to their value; the camera's ray is at 0.
    pub depth: usize,
    /// Shows every sample's tree, not one of each way that rays take, or the brightest paths.
    pub all: bool,
    /// Shows this sample's tree alone, counted from 1.
    pub sample: Option<usize>,
}

/// Column in which the numbers of a row begin.
const NUMBERS: usize = 44;

/// The whole explanation of one pixel.
pub fn pixel(pixel: &Value, style: &Style) -> String {
    let mut text = Text { out: String::new(), style };
    let samples = list(pixel, "samples");
    let by_paths = pixel["paths"].is_object();
    for group in told(pixel, samples, style) {
        let Some((&first, others)) = group.split_first() else { continue };
        let Some(sample) = samples.get(first) else { continue };
        let weight = number(&sample["weight"]);
        text.line("", &format!("sample {} of {}, weight {weight}", first + 1, samples.len()));
        text.node(&sample["ray"], "", 0);
        if !others.is_empty() {
            text.line("", &format!("the same way: {}", ranges(others)));
        }
        text.line("", "");
    }
    text.line("", &format!("pixel {},{}", pixel["pixel"][0], pixel["pixel"][1]));
    if by_paths {
        text.groups(&pixel["paths"]);
    } else if samples.len() > 1 {
        for (i, sample) in samples.iter().enumerate() {
            let label = format!("{} x sample {}", number(&sample["weight"]), i + 1);
            text.row("", '+', &label, rgb(&sample["ray"]["value"]));
        }
    }
    text.row("", '=', "linear light", rgb(&pixel["linear"]));
    if by_paths && samples.len() > 1 {
        let label = format!("standard error of {} samples", samples.len());
        text.row("", ' ', &label, rgb(&pixel["paths"]["standard_error"]));
    }
    for step in list(pixel, "develop") {
        text.row("", ' ', step["step"].as_str().unwrap_or("step"), rgb(&step["value"]));
    }
    text.bytes(&pixel["rgb8"]);
    text.out
}

/// Which samples are told in full, each with those that it speaks for.
fn told(pixel: &Value, samples: &[Value], style: &Style) -> Vec<Vec<usize>> {
    if let Some(sample) = style.sample {
        return vec![vec![sample.saturating_sub(1)]];
    }
    match &pixel["paths"] {
        paths @ Value::Object(_) if !style.all => {
            let brightest = list(paths, "brightest").iter().filter_map(Value::as_u64);
            brightest.map(|i| vec![i as usize]).collect()
        }
        _ => groups(samples, style.all),
    }
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
        for fact in facts(node).into_iter().chain(paths::bounces(node)) {
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

/// How many rays a tree has.
fn count(node: &Value) -> usize {
    1 + list(node, "children").iter().map(|c| count(&c["ray"])).sum::<usize>()
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
        let text = pixel(&tree(), &Style { swatch: None, depth: 9, all: false, sample: None });
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
        let text = pixel(&tree(), &Style { swatch: None, depth: 0, all: false, sample: None });
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
        let style = |all| Style { swatch: None, depth: 9, all, sample: None };
        let text = pixel(&pixels, &style(false));
        assert!(text.contains("the same way: samples 2, 4, 5\n"), "{text}");
        assert!(text.contains("sample 3 of 5") && !text.contains("sample 2 of 5"), "{text}");
        assert!(text.contains("+ 1 x sample 5"), "{text}");
        assert!(pixel(&pixels, &style(true)).contains("sample 2 of 5"));
    }

    #[test]
    fn paths_are_summed_up_and_the_brightest_told() {
        let mut pixels = tree();
        let mut sample = pixels["samples"][0].clone();
        sample["ray"]["bounces"] = json!([
            {"bounce": 0, "object": "ball", "source": null, "t": 2.5, "point": [0, 0, 2.5], "normal": [0, 0, 1],
             "how": "mirrors", "weight": [0.5, 0.5, 0.5]},
            {"bounce": 1, "object": "wall", "source": null, "t": 1, "point": [0, 0, 3.5], "normal": [0, 0, -1]},
        ]);
        sample["ray"]["ended"] = json!("absorbed");
        pixels["samples"] = json!([pixels["samples"][0], sample]);
        pixels["paths"] = json!({"brightest": [1], "standard_error": [0.1, 0, 0], "groups": [
            {"class": "LDSE", "light": "lamp", "value": [0.2, 0.3, 0.4], "standard_error": [0.1, 0, 0], "samples": 2}]});
        let style = Style { swatch: None, depth: 9, all: false, sample: None };
        let text = pixel(&pixels, &style);
        for line in [
            "sample 2 of 2, weight 1\n",
            "│ 0. ball at t 2.5 mirrors x 0.5\n│    point (0, 0, 2.5), normal (0, 0, 1)\n│ 1. wall at t 1 is the last\n",
            "│ the path ended absorbed\n",
            "+ LDSE from lamp                              0.200000   0.300000   0.400000\n",
            "    give or take 0.100000 0.000000 0.000000, in 2 samples\n",
            "  standard error of 2 samples                 0.100000   0.000000   0.000000\n",
        ] {
            assert!(text.contains(line), "{line}{text}");
        }
        assert!(!text.contains("sample 1 of 2"), "{text}");
        assert!(pixel(&pixels, &Style { sample: Some(1), ..style }).contains("sample 1 of 2"));
    }

    #[test]
    fn swatches_show_the_developed_colour() {
        let show = |c: [f64; 3]| c.map(|x| (x * 100.0) as u8);
        let text =
            pixel(&tree(), &Style { swatch: Some(&show), depth: 0, all: false, sample: None });
        assert!(text.contains("\x1b[48;2;20;30;40m    \x1b[0m"), "{text}");
    }
}
