// SPDX-License-Identifier: MIT OR Apache-2.0
//! Scenes made in code, with the words of the scene language.
//!
//! ```
//! use dioptric::SceneBuilder;
//!
//! let mut scene = SceneBuilder::new();
//! scene.add("camera", &[("eye", [0.0, 2.0, 8.0].into()), ("look_at", [0.0, 1.0, 0.0].into())])?;
//! scene.add("light", &[("position", [5.0, 8.0, 5.0].into())])?;
//! let gold = scene.make("metal", &[("metal", "gold".into())])?;
//! scene.add("sphere", &[("center", [0.0, 1.0, 0.0].into()), ("material", gold.into())])?;
//! let scene = scene.compile()?;
//! assert_eq!(scene.world.object_count(), 1);
//! # Ok::<(), dioptric::BuildError>(())
//! ```

use std::fmt;
use std::sync::Arc;

use dioptric_render::compile::{Options, compile};
use dioptric_render::scene::Scene;
use dioptric_scene::args::make_node;
use dioptric_scene::{
    Args, Description, Diagnostic, MemoryLoader, NodeId, Severity, Value, Vocabulary, validate,
};

/// A scene in the making. Kinds and arguments are those of the scene language: `dioptric list`.
#[derive(Clone, Debug)]
pub struct SceneBuilder {
    description: Description,
    vocabulary: Vocabulary,
}

/// What is wrong with a scene that a program made: at least one message.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BuildError(pub Vec<Diagnostic>);

impl fmt::Display for BuildError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, d) in self.0.iter().enumerate() {
            f.write_str(if i > 0 { "; " } else { "" })?;
            f.write_str(&d.message)?;
            if let Some(help) = &d.help {
                write!(f, " ({help})")?;
            }
        }
        Ok(())
    }
}

impl std::error::Error for BuildError {}

impl From<Diagnostic> for BuildError {
    fn from(diagnostic: Diagnostic) -> Self {
        Self(vec![diagnostic])
    }
}

impl Default for SceneBuilder {
    fn default() -> Self {
        Self::new()
    }
}

impl SceneBuilder {
    /// An empty scene.
    #[must_use]
    pub fn new() -> Self {
        Self { description: Description::default(), vocabulary: dioptric_render::vocabulary() }
    }

    /// Makes a value, such as a material or a transform, for an argument of something else.
    ///
    /// # Errors
    /// There is no such kind or argument, or an argument's value is wrong.
    pub fn make(&mut self, kind: &str, args: &[(&str, Value)]) -> Result<NodeId, BuildError> {
        let Some(schema) = self.vocabulary.get(kind) else {
            let error = Diagnostic::error("unknown-name", format!("there is no {kind}"));
            return Err(match self.vocabulary.nearest(kind) {
                Some(near) => error.help(format!("did you mean {near}?")),
                None => error,
            }
            .into());
        };
        if let Some((name, _)) = args.iter().find(|(name, _)| schema.param(name).is_none()) {
            let message = format!("{kind} has no argument \"{name}\"");
            return Err(Diagnostic::error("unknown-argument", message).into());
        }
        let Some(node) = make_node(schema, args) else {
            let message = format!("{kind} cannot be made of these arguments");
            return Err(Diagnostic::error("wrong-value", message).into());
        };
        let id = self.description.push(node);
        let args = Args::new(&self.description, id);
        for param in schema.all_params().filter(|p| p.name != "name") {
            args.value(param.name)?;
        }
        Ok(id)
    }

    /// Makes a shape, light, camera or setting and puts it into the scene.
    ///
    /// # Errors
    /// As [`Self::make`].
    pub fn add(&mut self, kind: &str, args: &[(&str, Value)]) -> Result<NodeId, BuildError> {
        let id = self.make(kind, args)?;
        self.description.roots.push(id);
        Ok(id)
    }

    /// The scene as plain data, to be written as JSON or compiled.
    #[must_use]
    pub fn description(&self) -> &Description {
        &self.description
    }

    /// Compiles the scene. It reads no files: scenes with pictures are compiled with a loader by
    /// [`dioptric_render::compile::compile`].
    ///
    /// # Errors
    /// Everything that is wrong with it.
    pub fn compile(self) -> Result<Scene, BuildError> {
        let mut problems = validate::validate(&self.description);
        problems.retain(|d| d.severity == Severity::Error);
        if !problems.is_empty() {
            return Err(BuildError(problems));
        }
        let description = Arc::new(self.description);
        match compile(&description, &MemoryLoader::new(), &Options::default()) {
            Ok((scene, _)) => Ok(scene),
            Err(errors) => Err(BuildError(errors)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mistakes_are_told_at_once() {
        let mut scene = SceneBuilder::new();
        let said = |e: BuildError| e.to_string();
        assert_eq!(
            said(scene.add("spheer", &[]).unwrap_err()),
            "there is no spheer (did you mean sphere?)"
        );
        assert_eq!(
            said(scene.add("sphere", &[("raduis", 1.0.into())]).unwrap_err()),
            "sphere has no argument \"raduis\""
        );
        assert_eq!(
            said(scene.add("sphere", &[("radius", 0.0.into())]).unwrap_err()),
            "radius of sphere: expected a number above 0, got 0"
        );
        assert!(said(scene.add("light", &[]).unwrap_err()).starts_with("light needs position"));
        assert!(said(SceneBuilder::new().compile().unwrap_err()).contains("no camera"));
    }
}
