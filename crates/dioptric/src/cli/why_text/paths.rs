// SPDX-License-Identifier: MIT OR Apache-2.0
//! A pixel of a path-traced picture as text: its light by source and class, and its brightest paths bounce by bounce.

use serde_json::Value;

use super::Text;
use super::words::{list, number, rgb, source, value, weights};

impl Text<'_> {
    /// The table of the light's ways, the strongest first.
    pub(super) fn groups(&mut self, paths: &Value) {
        for group in list(paths, "groups") {
            let class = group["class"].as_str().unwrap_or("");
            let light = group["light"].as_str().map(|l| format!(" from {l}")).unwrap_or_default();
            self.row("", '+', &format!("{class}{light}"), rgb(&group["value"]));
            let [r, g, b] = rgb(&group["standard_error"]).map(|e| format!("{e:.6}"));
            let samples = number(&group["samples"]);
            self.line("", &format!("    give or take {r} {g} {b}, in {samples} samples"));
        }
    }
}

/// The surfaces that a path went over, a line each, and how it ended.
pub(super) fn bounces(node: &Value) -> Vec<String> {
    let mut lines = Vec::new();
    for bounce in list(node, "bounces") {
        let object = bounce["object"].as_str().unwrap_or("something");
        let place = source(&bounce["source"]);
        let how = match bounce["how"].as_str() {
            Some(how) => {
                let chance = match bounce["goes_on"].as_f64() {
                    Some(p) => format!(", goes on with a chance of {p:.3}"),
                    None => String::new(),
                };
                format!("{how} x {}{chance}", weights(rgb(&bounce["weight"])))
            }
            None => "is the last".into(),
        };
        let (n, t) = (number(&bounce["bounce"]), number(&bounce["t"]));
        lines.push(format!("{n}. {object}{place} at t {t} {how}"));
        lines.push(format!(
            "   point {}, normal {}",
            value(&bounce["point"]),
            value(&bounce["normal"])
        ));
    }
    if let Some(ended) = node["ended"].as_str() {
        lines.push(format!("the path ended {ended}"));
    }
    lines
}
