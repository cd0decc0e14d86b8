// SPDX-License-Identifier: MIT OR Apache-2.0
//! Shapes in bulk: meshes and pools, whose points come from files or long lists. They are built here and not in
//! `geometry`, which knows no files.

mod cones;
mod cylinders;
mod lists;
mod mesh;
mod spheres;

use std::collections::HashMap;
use std::sync::Arc;

use dioptric_geometry::AnyShape;
use dioptric_geometry::mesh::Mesh;
use dioptric_meshes::{Limits, Model};
use dioptric_scene::{Args, Diagnostic, NodeId, Schema};

use crate::build::Builder;

/// How a kind's shape is built.
type Build = fn(&Args, &mut Builder) -> Result<AnyShape, Diagnostic>;

/// The registry: one line for each kind.
static KINDS: &[(&Schema, Build)] = &[
    (&mesh::SCHEMA, mesh::build),
    (&spheres::SCHEMA, spheres::build),
    (&cylinders::SCHEMA, cylinders::build),
    (&cones::SCHEMA, cones::build),
];

/// The schemas of all kinds.
pub static SCHEMAS: &[&Schema] =
    &[&mesh::SCHEMA, &spheres::SCHEMA, &cylinders::SCHEMA, &cones::SCHEMA];

/// What was built and read before, so that nothing is built or read twice.
#[derive(Default)]
pub(crate) struct Built {
    shapes: HashMap<NodeId, AnyShape>,
    /// Meshes of files, with their normals and without.
    meshes: HashMap<(Arc<str>, bool), Arc<Mesh>>,
    /// Files that are more than meshes.
    models: HashMap<Arc<str>, Arc<Model>>,
}

/// The shape that a node describes, built once; `None` where its kind is none of these.
///
/// # Errors
/// Its arguments or its file are wrong.
pub(crate) fn shape(args: &Args, builder: &mut Builder) -> Result<Option<AnyShape>, Diagnostic> {
    let kind = args.node().schema.kind;
    let Some((_, build)) = KINDS.iter().find(|(schema, _)| schema.kind == kind) else {
        return Ok(None);
    };
    if let Some(shape) = builder.bulk.shapes.get(&args.id) {
        return Ok(Some(shape.clone()));
    }
    let shape = build(args, builder)?;
    builder.bulk.shapes.insert(args.id, shape.clone());
    Ok(Some(shape))
}

impl Builder<'_> {
    /// The mesh in the file that an argument names, with the file's normals or without; read once.
    pub(crate) fn mesh(
        &mut self,
        args: &Args,
        name: &str,
        smooth: bool,
    ) -> Result<Arc<Mesh>, Diagnostic> {
        let key = (args.text(name)?, smooth);
        if let Some(mesh) = self.bulk.meshes.get(&key) {
            return Ok(mesh.clone());
        }
        let mut data = self.read_model(args, name, &key.0)?.mesh;
        if !smooth {
            data.normals = Vec::new();
        }
        let mesh = Arc::new(Mesh::new(data));
        self.bulk.meshes.insert(key, mesh.clone());
        Ok(mesh)
    }

    /// Everything in the file that an argument names; read once.
    pub(crate) fn model(&mut self, args: &Args, name: &str) -> Result<Arc<Model>, Diagnostic> {
        let path = args.text(name)?;
        if let Some(model) = self.bulk.models.get(&path) {
            return Ok(model.clone());
        }
        let model = Arc::new(self.read_model(args, name, &path)?);
        self.bulk.models.insert(path, model.clone());
        Ok(model)
    }

    fn read_model(&mut self, args: &Args, name: &str, path: &str) -> Result<Model, Diagnostic> {
        let place = args.description.argument_span(args.id, name);
        let mut file = self.loader.open(path).map_err(|why| why.diagnostic().at(place, ""))?;
        let limits = Limits { bytes: self.mesh_bytes_left };
        let model = dioptric_meshes::read(path, &mut file, &limits).map_err(|why| {
            let code = if why.is_too_large { "mesh-too-large" } else { "mesh-damaged" };
            Diagnostic::error(code, why.to_string()).at(place, "").help(why.help)
        })?;
        self.mesh_bytes_left = self.mesh_bytes_left.saturating_sub(model.bytes());
        Ok(model)
    }
}

#[cfg(test)]
mod tests;
