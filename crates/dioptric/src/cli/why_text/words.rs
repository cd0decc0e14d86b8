// SPDX-License-Identifier: MIT OR Apache-2.0
//! The facts of a ray and the numbers of a term in words, a line at a time.

use serde_json::{Map, Value};

/// What a ray hit, where that was made, and how far away it is.
pub(super) fn met(node: &Value) -> String {
    match node["object"].as_str() {
        Some(object) => {
            let part = node["part"].as_str().map(|p| format!(", {p},")).unwrap_or_default();
            format!("hits {object}{}{part} at t {}", source(&node["source"]), number(&node["t"]))
        }
        None => "leaves the scene".into(),
    }
}

/// ` (scenes/space.star:12)`, or nothing.
pub(super) fn source(place: &Value) -> String {
    match (place["file"].as_str(), place["line"].as_u64()) {
        (Some(file), Some(line)) => format!(" ({file}:{line})"),
        _ => String::new(),
    }
}

/// Keys of a ray that are shown in a way of their own, or repeat another one.
const SHOWN: &[&str] = &[
    "kind", "object", "part", "source", "t", "terms", "children", "value", "origin", "bounces",
    "ended",
];

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
pub(super) fn facts(node: &Value) -> Vec<String> {
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
pub(super) fn term_details(term: &Value) -> Vec<String> {
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
pub(super) fn scalings(told: &Value) -> Option<String> {
    let factors: Vec<String> = list(told, "scaled_by")
        .iter()
        .map(|f| {
            format!("x {} for {}", weights(rgb(&f["factor"])), f["by"].as_str().unwrap_or("?"))
        })
        .collect();
    (!factors.is_empty()).then(|| format!("counted already: {}", factors.join(", ")))
}

pub(super) fn list<'a>(value: &'a Value, key: &str) -> &'a [Value] {
    value[key].as_array().map_or(&[], Vec::as_slice)
}

pub(super) fn rgb(value: &Value) -> [f64; 3] {
    [0, 1, 2].map(|i| value[i].as_f64().unwrap_or(0.0))
}

/// One number where all lanes are alike.
pub(super) fn weights([r, g, b]: [f64; 3]) -> String {
    if r == g && g == b { short(r) } else { format!("({}, {}, {})", short(r), short(g), short(b)) }
}

pub(super) fn number(value: &Value) -> String {
    value.as_f64().map_or_else(|| "infinity".into(), short)
}

/// About six digits, without zeros at the end.
pub(super) fn short(x: f64) -> String {
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

pub(super) fn value(value: &Value) -> String {
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
pub(super) fn printable(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { '\u{fffd}' } else { c }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

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
