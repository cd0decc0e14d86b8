// SPDX-License-Identifier: MIT OR Apache-2.0
//! Writes the expanded form: short things on one line, long ones one part a line.

use std::fmt::Write;

use dioptric_scene::{Description, NodeId, Value};

use super::VERSION;

/// Longest line that is not broken.
const WIDTH: usize = 100;

/// The scene as JSON. Nodes that are not in the scene are left out; numbers read back exactly.
///
/// Reading the result gives the same scene, except for places in the text.
#[must_use]
pub fn write(scene: &Description) -> String {
    let mut writer = Writer { scene, ids: ids(scene), written: vec![false; scene.nodes.len()] };
    let mut text = format!("{{\n  \"dioptric\": {VERSION},\n  \"scene\": [");
    for (i, &root) in scene.roots.iter().enumerate() {
        text.push_str(if i == 0 { "\n    " } else { ",\n    " });
        text.push_str(&writer.node(root, 4));
    }
    text.push_str(if scene.roots.is_empty() { "]\n}\n" } else { "\n  ]\n}\n" });
    text
}

/// An id for every node that is written more than once, in the order in which they are met; 0 for
/// others.
fn ids(scene: &Description) -> Vec<u32> {
    let mut uses = vec![0u32; scene.nodes.len()];
    let mut order = Vec::new();
    let mut open: Vec<NodeId> = scene.roots.iter().rev().copied().collect();
    while let Some(id) = open.pop() {
        let Some(count) = uses.get_mut(id.0 as usize) else { continue };
        *count += 1;
        match *count {
            1 => {
                let mut inner = Vec::new();
                for (_, value) in &scene.node(id).args {
                    value.for_each_node(&mut |id| inner.push(id));
                }
                open.extend(inner.into_iter().rev());
            }
            2 => order.push(id),
            _ => {}
        }
    }
    let mut ids = vec![0; scene.nodes.len()];
    for (i, id) in order.into_iter().enumerate() {
        if let Some(slot) = ids.get_mut(id.0 as usize) {
            *slot = i as u32 + 1;
        }
    }
    ids
}

struct Writer<'a> {
    scene: &'a Description,
    ids: Vec<u32>,
    written: Vec<bool>,
}

impl Writer<'_> {
    fn node(&mut self, id: NodeId, indent: usize) -> String {
        let index = id.0 as usize;
        let own = self.ids.get(index).copied().unwrap_or(0);
        if self.written.get(index).copied().unwrap_or(false) {
            return format!("{{\"ref\": {own}}}");
        }
        if let Some(flag) = self.written.get_mut(index) {
            *flag = true;
        }
        let node = self.scene.node(id);
        let mut parts = vec![format!("\"kind\": {}", quoted(node.schema.kind))];
        if own > 0 {
            parts.push(format!("\"id\": {own}"));
        }
        if let Some(name) = &node.name {
            parts.push(format!("\"name\": {}", quoted(name)));
        }
        for (i, value) in &node.args {
            let Some(param) = node.schema.all_params().nth(usize::from(*i)) else { continue };
            let value = self.value(value, indent + 2);
            parts.push(format!("\"{}\": {value}", param.name));
        }
        join(&parts, '{', '}', indent)
    }

    fn value(&mut self, value: &Value, indent: usize) -> String {
        match value {
            Value::Bool(b) => b.to_string(),
            Value::Number(x) => number(*x),
            Value::Text(text) => quoted(text),
            Value::Vec2(v) => numbers(v),
            Value::Vec3(v) => numbers(v),
            Value::List(items) => {
                let parts: Vec<String> =
                    items.iter().map(|item| self.value(item, indent + 2)).collect();
                join(&parts, '[', ']', indent)
            }
            Value::Node(id) => self.node(*id, indent),
        }
    }
}

fn numbers(items: &[f64]) -> String {
    let items: Vec<String> = items.iter().map(|x| number(*x)).collect();
    format!("[{}]", items.join(", "))
}

/// The shortest text that reads back as this number; JSON has none for infinity.
fn number(x: f64) -> String {
    if !x.is_finite() {
        "null".into()
    } else if x == 0.0 || (1e-5..1e15).contains(&x.abs()) {
        x.to_string()
    } else {
        format!("{x:e}")
    }
}

fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}

/// Parts on one line if they fit, else one line each.
fn join(parts: &[String], open: char, close: char, indent: usize) -> String {
    let width: usize = parts.iter().map(|part| part.len() + 2).sum();
    if indent + width <= WIDTH && !parts.iter().any(|part| part.contains('\n')) {
        return format!("{open}{}{close}", parts.join(", "));
    }
    let mut text = String::with_capacity(width + parts.len() * (indent + 4));
    text.push(open);
    for (i, part) in parts.iter().enumerate() {
        let comma = if i == 0 { "" } else { "," };
        // Writing to a String does not fail.
        let _ = write!(text, "{comma}\n{:1$}{part}", "", indent + 2);
    }
    let _ = write!(text, "\n{:1$}{close}", "", indent);
    text
}
