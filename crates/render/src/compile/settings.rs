// SPDX-License-Identifier: MIT OR Apache-2.0
//! The settings of the whole scene, each from its node or its default.

use dioptric_geometry::placement;
use dioptric_math::{DAffine3, DVec3, Spectrum};
use dioptric_scene::{Args, Description, Diagnostic, NodeId};

use crate::build::{Builder, ColorReading};
use crate::setting::ambient;
use crate::setting::background::Background;
use crate::setting::fog::Fog;
use crate::setting::medium::Surroundings;
use crate::setting::root::Root;

fn node(d: &Description, kind: &str) -> Option<NodeId> {
    d.roots_of(kind).last()
}

pub(super) fn root(d: &Description) -> Result<(ColorReading, Root), Diagnostic> {
    let Some(id) = node(d, "scene") else {
        return Ok((ColorReading::Srgb, Root::default()));
    };
    let args = Args::new(d, id);
    let reading =
        if &*args.text("colors")? == "raw" { ColorReading::Raw } else { ColorReading::Srgb };
    let up = if &*args.text("up")? == "z" { DVec3::Z } else { DVec3::Y };
    let transforms = args.nodes("transform")?;
    let affine =
        if transforms.is_empty() { DAffine3::IDENTITY } else { placement(&args, "transform")? };
    let root = Root::new(affine, up).ok_or_else(|| {
        args.error("transform", "singular-transform", "transform of scene: it has no inverse")
            .help("use scales other than 0")
    })?;
    Ok((reading, root))
}

pub(super) fn ambient(d: &Description, builder: &mut Builder) -> Result<Spectrum, Diagnostic> {
    match node(d, "ambient") {
        Some(id) => ambient::from_args(&Args::new(d, id), builder),
        None => Ok(Spectrum::ZERO),
    }
}

pub(super) fn background(
    d: &Description,
    builder: &mut Builder,
    root: &Root,
) -> Result<Background, Diagnostic> {
    match node(d, "background") {
        Some(id) => Background::from_args(&Args::new(d, id), builder, root),
        None => Ok(Background::BLACK),
    }
}

pub(super) fn fog(
    d: &Description,
    builder: &Builder,
    root: &Root,
) -> Result<Option<Fog>, Diagnostic> {
    node(d, "fog").map(|id| Fog::from_args(&Args::new(d, id), builder, root)).transpose()
}

pub(super) fn surroundings(d: &Description, root: &Root) -> Result<Surroundings, Diagnostic> {
    match node(d, "medium") {
        Some(id) => Surroundings::from_args(&Args::new(d, id), root),
        None => Ok(Surroundings::EMPTY),
    }
}
