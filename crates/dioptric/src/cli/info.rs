// SPDX-License-Identifier: MIT OR Apache-2.0
//! `info`: what a scene holds, without rendering it.

use std::collections::BTreeMap;

use dioptric::formats::ParamInfo;
use dioptric::render::RenderSettings;
use dioptric::scene::{Category, Description, Value};

use super::failure::Failure;
use super::scene_options::SceneOptions;
use super::terminal::{self, Terminal};

/// Says what a scene holds: cameras, lights, shapes, materials, and the params that --set can change.
#[derive(Debug, clap::Args)]
pub struct InfoArgs {
    #[command(flatten)]
    scene: SceneOptions,
}

/// Reads the scene and prints what it holds.
pub fn run(args: &InfoArgs, terminal: &Terminal) -> Result<(), Failure> {
    let scene = args.scene.read(terminal)?;
    let description = &scene.reading.description;
    let mut text = String::new();
    // Settings that are wrong are for `render` to complain about.
    if let Ok(settings) = RenderSettings::from_scene(description, &[], u64::MAX) {
        text.push_str(&picture(&settings));
    }
    for category in Category::ALL {
        let kinds = count(description, category);
        if !kinds.is_empty() {
            let total: usize = kinds.values().sum();
            let parts: Vec<String> = kinds.iter().map(|(kind, n)| format!("{n} {kind}")).collect();
            text.push_str(&format!("{:<10} {total:>8}  {}\n", plural(category), parts.join(", ")));
        }
    }
    if !scene.reading.params.is_empty() {
        text.push_str("\nparams (--set NAME=VALUE)\n");
        scene.reading.params.iter().for_each(|p| text.push_str(&param(p)));
    }
    text.push_str("\nfiles\n");
    for (_, source) in description.sources.iter() {
        text.push_str(&format!("  {} ({} lines)\n", source.name, source.text.lines().count()));
    }
    terminal::print(text.as_bytes())
}

fn picture(settings: &RenderSettings) -> String {
    let [width, height] = settings.size;
    let samples = match settings.max_samples {
        most if most != settings.samples => format!("{} to {most}", settings.samples),
        _ => settings.samples.to_string(),
    };
    let plural = if samples == "1" { "" } else { "s" };
    format!(
        "{:<10} {:>8}  {} anti-aliasing, {samples} sample{plural} a pixel, {} bounces, {}\n",
        "picture",
        format!("{width}x{height}"),
        settings.antialias.name(),
        settings.bounces,
        settings.integrator.name(),
    )
}

fn plural(category: Category) -> String {
    format!("{}s", category.name())
}

/// How many nodes of each kind there are.
fn count(description: &Description, category: Category) -> BTreeMap<&'static str, usize> {
    let mut kinds = BTreeMap::new();
    for node in description.nodes.iter().filter(|n| n.schema.category == category) {
        *kinds.entry(node.schema.kind).or_insert(0) += 1;
    }
    kinds
}

fn param(param: &ParamInfo) -> String {
    let mut line = format!("  {} = {}", param.name, written(&param.value));
    if param.value != param.default {
        line.push_str(&format!(" (default {})", written(&param.default)));
    }
    match (param.min, param.max) {
        (Some(low), Some(high)) => line.push_str(&format!(", {low} to {high}")),
        (Some(low), None) => line.push_str(&format!(", at least {low}")),
        (None, Some(high)) => line.push_str(&format!(", at most {high}")),
        (None, None) => {}
    }
    if !param.choices.is_empty() {
        let words: Vec<String> = param.choices.iter().map(written).collect();
        line.push_str(&format!(", one of {}", words.join(", ")));
    }
    if !param.doc.is_empty() {
        line.push_str(&format!(": {}", param.doc));
    }
    line.push('\n');
    line
}

/// A value as the scene language writes it.
pub fn written(value: &Value) -> String {
    match value {
        Value::Bool(true) => "True".into(),
        Value::Bool(false) => "False".into(),
        Value::Number(x) => x.to_string(),
        Value::Text(text) => format!("{text:?}"),
        Value::Vec2(_) | Value::Vec3(_) | Value::List(_) => {
            let items: Vec<String> = value.items().iter().map(written).collect();
            format!("({})", items.join(", "))
        }
        Value::Node(_) => "...".into(),
    }
}
