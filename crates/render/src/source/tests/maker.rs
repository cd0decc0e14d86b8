// SPDX-License-Identifier: MIT OR Apache-2.0
//! Scenes for tests, node by node.

use std::sync::Arc;

use dioptric_scene::args::make_node;
use dioptric_scene::{Category, Description, MemoryLoader, NodeId, Value};

use crate::compile::{Options, compile};
use crate::scene::Scene;
use crate::source::Sources;
use crate::vocabulary;

/// A scene that grows.
#[derive(Default)]
pub(crate) struct Maker {
    description: Description,
}

pub(crate) fn v3(x: f64, y: f64, z: f64) -> Value {
    Value::Vec3([x, y, z])
}

pub(crate) fn text(word: &str) -> Value {
    Value::Text(word.into())
}

impl Maker {
    /// Adds a node; it is in the scene by itself unless it is a part of others.
    pub fn add(&mut self, kind: &str, args: &[(&str, Value)]) -> NodeId {
        let all = vocabulary();
        let schema = all.iter().find(|s| s.kind == kind).unwrap_or_else(|| panic!("{kind}?"));
        let node = make_node(schema, args).unwrap_or_else(|| panic!("{kind} {args:?}"));
        let id = self.description.push(node);
        if !matches!(schema.category, Category::Material | Category::Pattern | Category::Transform)
        {
            self.description.roots.push(id);
        }
        id
    }

    /// A shape that glows with this radiance.
    pub fn glow(&mut self, kind: &str, args: &[(&str, Value)], radiance: [f64; 3]) -> NodeId {
        let color = ("color", Value::Vec3(radiance));
        let material = self.add("glow", &[color]);
        let mut all = args.to_vec();
        all.push(("material", Value::Node(material)));
        self.add(kind, &all)
    }

    /// The scene and its sources.
    pub fn scene(self) -> Scene {
        self.scene_with(&[])
    }

    /// The same with arguments for the whole scene.
    pub fn scene_with(mut self, args: &[(&str, Value)]) -> Scene {
        let mut all = args.to_vec();
        all.push(("colors", text("raw")));
        self.add("scene", &all);
        let position = ("eye", v3(0.0, 0.0, 50.0));
        self.add("camera", &[position, ("look_at", v3(0.0, 0.0, 0.0))]);
        let (mut scene, _) =
            compile(&Arc::new(self.description), &MemoryLoader::new(), &Options::default())
                .unwrap_or_else(|errors| panic!("{}", errors[0].message));
        scene.sources = Sources::new(&scene);
        scene
    }
}
