// SPDX-License-Identifier: MIT OR Apache-2.0
//! How scenes say from where to where cylinders and cones reach.

use dioptric_math::DVec3;
use dioptric_scene::{Args, Diagnostic};

/// The base and the way from there to the top, from the arguments `base`, `height` and `top`.
pub(crate) fn ends(args: &Args) -> Result<(DVec3, DVec3), Diagnostic> {
    let base = DVec3::from(args.vec3("base")?);
    let height = args.optional_number("height")?;
    if !args.is_written("top") {
        return Ok((base, DVec3::Y * height.unwrap_or(1.0)));
    }
    if height.is_some() {
        let message = format!("the {} has both a height and a top", args.node().schema.kind);
        return Err(args.error("top", "two-heights", message).help(
            "keep height for a shape that stands along +y, or top for one that points anywhere",
        ));
    }
    Ok((base, DVec3::from(args.vec3("top")?) - base))
}

/// The error for ends that coincide.
pub(crate) fn no_length(args: &Args) -> Diagnostic {
    let kind = args.node().schema.kind;
    let name = if args.is_written("top") { "top" } else { "height" };
    args.error(
        name,
        "no-size",
        format!("the {kind} has no length: base and top are the same point"),
    )
    .help("move top away from base; for a flat round shape use disc")
}
