// SPDX-License-Identifier: MIT OR Apache-2.0
//! The pictures of a scene, read side by side before the first is asked for: reading them is most of what compiling
//! such a scene takes.

use std::collections::{BTreeSet, HashMap};
use std::sync::Arc;

use dioptric_scene::{Description, Loader, Value};
use rayon::prelude::*;

use super::Texture;

/// Reads all pictures that `image` patterns name, on the threads of the pool in which this is called; outside of a
/// pool none, and none where there is only one. Together they have at most `max_texels`.
///
/// What cannot be read is left out, and so is a picture that has more than its share of the texels: it is read
/// again when the scene asks for it, which says what is wrong with it, and where.
pub fn load_ahead(
    description: &Description,
    loader: &dyn Loader,
    max_texels: u64,
) -> HashMap<Arc<str>, Texture> {
    let images = description.nodes.iter().filter(|node| node.schema.kind == "image");
    let paths: BTreeSet<&Arc<str>> = images
        .filter_map(|node| match node.arg("file") {
            Some(Value::Text(path)) => Some(path),
            _ => None,
        })
        .collect();
    if paths.len() < 2 || rayon::current_thread_index().is_none() {
        return HashMap::new();
    }
    let share = max_texels / paths.len() as u64;
    let read = |path: Arc<str>| {
        let bytes = loader.read(&path).ok()?;
        let texture = Texture::from_bytes(&bytes, &path, share).ok()?;
        Some((path, texture))
    };
    let paths: Vec<Arc<str>> = paths.into_iter().cloned().collect();
    paths.into_par_iter().with_max_len(1).filter_map(read).collect()
}
