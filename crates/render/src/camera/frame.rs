// SPDX-License-Identifier: MIT OR Apache-2.0
//! Where a camera stands and how it is turned: what all cameras have in common.

use dioptric_math::{DVec3, normalize};
use dioptric_scene::{Args, Default, Diagnostic, Param, Type};

use crate::setting::root::Root;

/// `eye`.
pub(super) const EYE: Param =
    Param::new("eye", Type::Vec3, Default::Vec3([0.0, 0.0, 0.0]), "Where it stands.");

/// `look_at`.
pub(super) const LOOK_AT: Param = Param::new(
    "look_at",
    Type::Vec3,
    Default::Vec3([0.0, 0.0, -1.0]),
    "The point in the middle of the picture.",
);

/// `up`.
pub(super) const UP: Param = Param::new(
    "up",
    Type::Direction,
    Default::Absent,
    "Which way is up in the picture; the scene's up if absent.",
);

/// Sine of the smallest angle between the line of sight and up that still tells what is up.
const PARALLEL: f64 = 1e-10;

/// A camera's place and directions in the file's space.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    /// Where it stands.
    pub eye: DVec3,
    /// Unit vector along the line of sight.
    pub forward: DVec3,
    /// Unit vector to the right of the picture.
    pub right: DVec3,
    /// Unit vector to the top of the picture.
    pub up: DVec3,
    /// From the eye to the point looked at.
    pub distance: f64,
}

impl Frame {
    /// Reads [`EYE`], [`LOOK_AT`] and [`UP`].
    pub(super) fn from_args(args: &Args, root: &Root) -> Result<Self, Diagnostic> {
        let kind = args.node().schema.kind;
        let eye = DVec3::from(args.vec3("eye")?);
        let way = DVec3::from(args.vec3("look_at")?) - eye;
        let Some(forward) = normalize(way) else {
            return Err(args
                .error(
                    "look_at",
                    "degenerate-camera",
                    format!("look_at of {kind}: the same point as eye"),
                )
                .help("write the point that should be in the middle of the picture"));
        };
        let up = if args.is_written("up") { args.vec3("up")?.into() } else { root.up() };
        let right = normalize(up)
            .map(|up| forward.cross(up))
            .filter(|right| right.length() > PARALLEL)
            .and_then(normalize);
        let Some(right) = right else {
            return Err(args
                .error(
                    "up",
                    "degenerate-camera",
                    format!("up of {kind}: it points along the line of sight"),
                )
                .help("write another up, such as up = (0, 0, -1) for a camera that looks straight down"));
        };
        Ok(Self { eye, forward, right, up: right.cross(forward), distance: way.length() })
    }
}
