// SPDX-License-Identifier: MIT OR Apache-2.0
//! Checks of a whole scene, after each node was checked against its schema.
//!
//! It knows categories, and a few words of the vocabulary: those by which a scene without lights is
//! still bright, and what a scene without a camera or light should write.

use std::collections::HashMap;

use crate::description::{Description, NodeId};
use crate::diagnostic::Diagnostic;
use crate::schema::Category;
use crate::source::{FileId, Span};
use crate::suggest;

/// Kinds by which a scene without lights is still not black.
const BRIGHT_KINDS: [&str; 4] = ["ambient", "background", "environment", "glow"];
/// Parameters by which a surface shines.
const BRIGHT_PARAMS: [&str; 1] = ["emission"];

/// Nodes within nodes: no reader makes a description that nests deeper, so whoever walks one may
/// call itself for every level.
pub const MAX_NESTING: usize = 100;

/// Leaves one camera among the roots: the one called `wanted`, else the first.
///
/// # Errors
/// No camera has that name; or there are several, of which some have no name to choose them by.
pub fn choose_camera(scene: &mut Description, wanted: Option<&str>) -> Result<(), Diagnostic> {
    let cameras: Vec<NodeId> = roots_in(scene, Category::Camera).collect();
    let name = |id: NodeId| scene.node(id).name.as_deref();
    let chosen = match wanted {
        Some(wanted) => match cameras.iter().find(|&&id| name(id) == Some(wanted)) {
            Some(&id) => id,
            None => {
                let names = || cameras.iter().filter_map(|&id| name(id));
                let help = match suggest::nearest(wanted, names()) {
                    Some(near) => format!("did you mean \"{near}\"?"),
                    None if names().next().is_none() => {
                        "give the scene's camera a name: camera(name = \"...\")".into()
                    }
                    None => format!("the scene has {}", names().collect::<Vec<_>>().join(", ")),
                };
                return Err(Diagnostic::error(
                    "unknown-camera",
                    format!("the scene has no camera called \"{wanted}\""),
                )
                .help(help));
            }
        },
        None => match cameras.as_slice() {
            [] => return Ok(()),
            [first, rest @ ..] => {
                if let Some(&second) = rest.first()
                    && let Some(&nameless) = cameras.iter().rev().find(|&&id| name(id).is_none())
                {
                    let other = if nameless == *first { second } else { *first };
                    return Err(Diagnostic::error(
                        "second-camera",
                        "the scene has a second camera",
                    )
                    .at(scene.node(nameless).span, "")
                    .at(scene.node(other).span, "another camera")
                    .help("remove one, or name both and choose with --camera NAME"));
                }
                *first
            }
        },
    };
    scene.roots.retain(|id| *id == chosen || !cameras.contains(id));
    Ok(())
}

/// Everything that is wrong or doubtful about the scene as a whole, errors first.
#[must_use]
pub fn validate(scene: &Description) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    repeated_settings(scene, &mut found);
    if roots_in(scene, Category::Camera).next().is_none() {
        found.push(
            Diagnostic::error("no-camera", "the scene has no camera")
                .help("add: camera(eye = (0, 1, 5), look_at = (0, 0, 0), fov = 40)"),
        );
    }
    if !is_lit(scene) {
        found.push(
            Diagnostic::warning("no-light", "the scene has no light: the picture will be black")
                .help("add: light(position = (5, 8, 5), intensity = 1)"),
        );
    }
    unused(scene, &mut found);
    repeated_names(scene, &mut found);
    found
}

fn roots_in(scene: &Description, category: Category) -> impl Iterator<Item = NodeId> + '_ {
    let ids = scene.roots.iter().copied();
    ids.filter(move |&id| scene.node(id).schema.category == category)
}

/// A setting is given at most once.
fn repeated_settings(scene: &Description, found: &mut Vec<Diagnostic>) {
    let mut first: HashMap<&str, NodeId> = HashMap::new();
    for id in roots_in(scene, Category::Setting) {
        let node = scene.node(id);
        let kind = node.schema.kind;
        match first.get(kind) {
            None => {
                first.insert(kind, id);
            }
            Some(&before) => found.push(
                Diagnostic::error("repeated-setting", format!("{kind} is given a second time"))
                    .at(node.span, "")
                    .at(scene.node(before).span, "first given here")
                    .help("keep one of them"),
            ),
        }
    }
}

fn is_lit(scene: &Description) -> bool {
    scene.nodes.iter().any(|node| {
        node.schema.category == Category::Light
            || BRIGHT_KINDS.contains(&node.schema.kind)
            || BRIGHT_PARAMS.iter().any(|name| node.arg(name).is_some())
    })
}

/// Which nodes another node refers to.
fn consumed(scene: &Description) -> Vec<bool> {
    let mut consumed = vec![false; scene.nodes.len()];
    for node in &scene.nodes {
        for (_, value) in &node.args {
            value.for_each_node(&mut |id| {
                if let Some(flag) = consumed.get_mut(id.0 as usize) {
                    *flag = true;
                }
            });
        }
    }
    consumed
}

/// Materials, patterns and transforms that the scene's own file makes and never uses. What other
/// files make is offered, not meant.
fn unused(scene: &Description, found: &mut Vec<Diagnostic>) {
    let consumed = consumed(scene);
    let mut warned: Vec<Span> = Vec::new();
    for (node, _) in scene.nodes.iter().zip(&consumed).filter(|(_, used)| !**used) {
        let category = node.schema.category;
        let value =
            matches!(category, Category::Material | Category::Pattern | Category::Transform);
        // A loop makes many at one place: one warning is enough.
        if !value || node.span.file != FileId(0) || warned.contains(&node.span) {
            continue;
        }
        warned.push(node.span);
        let name = node.name.as_ref().map_or(String::new(), |name| format!(" \"{name}\""));
        let what = format!("the {} {}{name} is never used", category.name(), node.schema.kind);
        let warning = Diagnostic::warning("unused", what).at(node.span, "");
        found.push(match category {
            Category::Material => warning.help("give it to a shape: material = ..."),
            Category::Pattern => warning.help("give it to a material, as its color for example"),
            _ => warning.help("give it to a shape or group: transform = ..."),
        });
        if warned.len() == 20 {
            break;
        }
    }
}

/// Names of things that can be asked for by name, in a hit or on the command line.
fn repeated_names(scene: &Description, found: &mut Vec<Diagnostic>) {
    let mut first: HashMap<(&str, bool), NodeId> = HashMap::new();
    let mut warned: Vec<&str> = Vec::new();
    for (i, node) in scene.nodes.iter().enumerate() {
        let camera = match node.schema.category {
            Category::Shape | Category::Light => false,
            Category::Camera => true,
            _ => continue,
        };
        let Some(name) = node.name.as_deref() else { continue };
        let Some(&before) = first.get(&(name, camera)) else {
            first.insert((name, camera), NodeId(i as u32));
            continue;
        };
        if warned.contains(&name) || warned.len() == 20 {
            continue;
        }
        warned.push(name);
        let message = format!("two things are called \"{name}\"");
        found.push(
            Diagnostic::warning("repeated-name", message)
                .at(node.span, "")
                .at(scene.node(before).span, "the first")
                .help("messages and `why` cannot tell them apart: use different names"),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::args::make_node;
    use crate::schema::{Param, Schema, Type};
    use crate::value::Value;

    const fn schema(kind: &'static str, category: Category, params: &'static [Param]) -> Schema {
        Schema { kind, category, summary: "", doc: "", params, example: "" }
    }

    static BALL: Schema = schema("ball", Category::Shape, &[]);
    static LAMP: Schema = schema("lamp", Category::Light, &[]);
    static CAMERA: Schema = schema("camera", Category::Camera, &[]);
    static FOG: Schema = schema("fog", Category::Setting, &[]);
    static GLOW: Schema =
        schema("glow", Category::Material, &[Param::required("emission", Type::Color, "")]);

    fn add(scene: &mut Description, schema: &'static Schema, args: &[(&str, Value)]) -> NodeId {
        let mut node = make_node(schema, args).unwrap();
        let start = scene.nodes.len() as u32;
        node.span = Span { file: FileId(0), start, end: start + 1 };
        let id = scene.push(node);
        if schema.category.enters_scene() {
            scene.roots.push(id);
        }
        id
    }

    fn codes(scene: &Description) -> Vec<&'static str> {
        validate(scene).iter().map(|d| d.code).collect()
    }

    #[test]
    fn an_empty_scene_lacks_camera_and_light() {
        let mut scene = Description::default();
        assert_eq!(codes(&scene), ["no-camera", "no-light"]);
        add(&mut scene, &CAMERA, &[]);
        add(&mut scene, &LAMP, &[]);
        assert_eq!(codes(&scene), [""; 0]);
    }

    #[test]
    fn what_glows_is_light_and_what_nothing_uses_is_noticed() {
        let mut scene = Description::default();
        add(&mut scene, &CAMERA, &[]);
        let glow = add(&mut scene, &GLOW, &[("emission", Value::Number(1.0))]);
        assert_eq!(codes(&scene), ["unused"]);
        add(&mut scene, &BALL, &[("material", Value::Node(glow))]);
        assert_eq!(codes(&scene), [""; 0]);
    }

    #[test]
    fn settings_and_names_are_given_once() {
        let mut scene = Description::default();
        add(&mut scene, &CAMERA, &[]);
        add(&mut scene, &LAMP, &[("name", Value::Text("a".into()))]);
        for _ in 0..3 {
            add(&mut scene, &BALL, &[("name", Value::Text("a".into()))]);
        }
        add(&mut scene, &FOG, &[]);
        add(&mut scene, &FOG, &[]);
        assert_eq!(codes(&scene), ["repeated-setting", "repeated-name"]);
    }

    #[test]
    fn one_camera_is_chosen() {
        let named = |name: &str| [("name", Value::Text(name.into()))];
        let mut scene = Description::default();
        assert_eq!(choose_camera(&mut scene, None), Ok(()));
        let front = add(&mut scene, &CAMERA, &named("front"));
        let side = add(&mut scene, &CAMERA, &named("side"));
        let mut one = scene.clone();
        assert_eq!(choose_camera(&mut one, None), Ok(()));
        assert_eq!(one.roots, [front]);
        let mut other = scene.clone();
        assert_eq!(choose_camera(&mut other, Some("side")), Ok(()));
        assert_eq!(other.roots, [side]);
        let error = choose_camera(&mut scene.clone(), Some("frnt")).unwrap_err();
        assert_eq!(error.help.as_deref(), Some("did you mean \"front\"?"));
        add(&mut scene, &CAMERA, &[]);
        assert_eq!(choose_camera(&mut scene, None).unwrap_err().code, "second-camera");
    }
}
