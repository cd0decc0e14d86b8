// SPDX-License-Identifier: MIT OR Apache-2.0
//! From a point of a surface to a point of a picture.

use std::f64::consts::{PI, TAU};

use dioptric_math::{DVec2, DVec3, asin, atan2, normalize};
use dioptric_scene::{Args, Default, Diagnostic, Param, Type};

use super::place;
use super::{PatternPoint, Space};

/// The ways to lay a picture on a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Projection {
    Uv,
    Planar,
    LonLat,
    Cylindrical,
    Cube,
    Asin,
}

/// A projection in its place.
#[derive(Clone, Debug)]
pub(super) struct Mapping {
    projection: Projection,
    space: Space,
    origin: DVec3,
    /// Right-handed unit vectors: the picture's right, its up, and towards the viewer.
    axes: [DVec3; 3],
    /// Lengths along right and up that the picture spans.
    spans: DVec2,
    /// Edge lengths of the cube mapping's box.
    size: DVec3,
}

pub(super) const MAPPING: Param = Param::new(
    "mapping",
    Type::Choice(&["uv", "planar", "lonlat", "cylindrical", "cube", "asin"]),
    Default::Text("uv"),
    "How the picture lies on the surface.",
);
pub(super) const ORIGIN: Param = Param::new(
    "origin",
    Type::Vec3,
    Default::Vec3([0.0; 3]),
    "For \"planar\" the picture's lower left corner, for \"cylindrical\" the middle of the foot, for \
     \"lonlat\" and \"cube\" the middle.",
);
pub(super) const RIGHT: Param = Param::new(
    "right",
    Type::Direction,
    Default::Vec3([1.0, 0.0, 0.0]),
    "To the picture's right; for \"planar\" as long as the picture is wide.",
);
pub(super) const UP: Param = Param::new(
    "up",
    Type::Direction,
    Default::Vec3([0.0, 1.0, 0.0]),
    "Upwards in the picture; for \"planar\" and \"cylindrical\" as long as the picture is high.",
);
pub(super) const BOX_SIZE: Param = Param::new(
    "size",
    Type::Scale,
    Default::Number(1.0),
    "For \"cube\": the edge lengths of the box, of which only the proportions count.",
);

impl Mapping {
    /// Reads `mapping`, `space`, `origin`, `right`, `up` and `size`.
    pub(super) fn from_args(args: &Args) -> Result<Self, Diagnostic> {
        let projection = match &*args.text("mapping")? {
            "planar" => Projection::Planar,
            "lonlat" => Projection::LonLat,
            "cylindrical" => Projection::Cylindrical,
            "cube" => Projection::Cube,
            "asin" => Projection::Asin,
            _ => Projection::Uv,
        };
        let parallel = || {
            args.error("up", "wrong-value", "image: right and up point the same way")
                .help("choose right and up at an angle, best a right one")
        };
        let right = DVec3::from(args.vec3("right")?);
        let up = DVec3::from(args.vec3("up")?);
        let up_unit = normalize(up).unwrap_or(DVec3::Y);
        let across = |v: DVec3, from: DVec3| normalize(v - from * v.dot(from));
        let right_unit = normalize(right).and_then(|r| across(r, up_unit)).ok_or_else(parallel)?;
        if right_unit.dot(right) < 1e-9 * right.length() {
            return Err(parallel());
        }
        // Where the edges are not at right angles, u grows across the up edge and v across the right
        // one: the corners of the parallelogram get the corners of the picture.
        let upright = if projection == Projection::Planar {
            across(up, right.normalize_or_zero()).unwrap_or(up_unit)
        } else {
            up_unit
        };
        let size = DVec3::from(args.vec3("size")?);
        if !(size.min_element() > 0.0) {
            return Err(args
                .error("size", "wrong-value", "size of image: expected numbers above 0")
                .help("write the edge lengths of the box, as in size = (2, 1, 3)"));
        }
        Ok(Self {
            projection,
            space: place::space(args)?,
            origin: args.vec3("origin")?.into(),
            axes: [right_unit, upright, right_unit.cross(up_unit)],
            spans: DVec2::new(right.dot(right_unit), up.dot(upright)),
            size,
        })
    }

    /// Whether u, and whether v, of this mapping end at the picture's edges instead of going around or on.
    pub(super) fn ends(&self) -> [bool; 2] {
        match self.projection {
            Projection::Uv | Projection::Planar | Projection::Cylindrical => [false; 2],
            Projection::LonLat => [false, true],
            Projection::Cube | Projection::Asin => [true; 2],
        }
    }

    /// The point of the picture: u to the right, v upwards, the picture from 0 to 1.
    pub(super) fn uv(&self, point: &PatternPoint) -> DVec2 {
        let [right, up, front] = self.axes;
        let p = self.space.of(point) - self.origin;
        let turn = |d: DVec3| atan2(d.dot(right), d.dot(front)) / TAU + 0.5;
        let half_turn = |x: f64| asin(x.clamp(-1.0, 1.0)) / PI + 0.5;
        match self.projection {
            Projection::Uv => point.uv,
            Projection::Planar => DVec2::new(p.dot(right) / self.spans.x, p.dot(up) / self.spans.y),
            Projection::LonLat => {
                let d = normalize(p).unwrap_or(front);
                DVec2::new(turn(d), half_turn(d.dot(up)))
            }
            Projection::Cylindrical => DVec2::new(turn(p), p.dot(up) / self.spans.y),
            Projection::Cube => {
                let q = DVec3::new(p.dot(right), p.dot(up), p.dot(front)) / self.size;
                cube_face(q) * 0.5 + 0.5
            }
            Projection::Asin => {
                let n = match self.space {
                    Space::World => point.world_normal,
                    Space::Object | Space::Uv => point.object_normal,
                };
                DVec2::new(half_turn(n.dot(right)), half_turn(n.dot(up)))
            }
        }
    }
}

/// Where the line from the middle through `q` leaves the cube from -1 to 1, as seen from outside: x to
/// the right, y up; the top is seen with the front below, the bottom with the front above.
fn cube_face(q: DVec3) -> DVec2 {
    let a = q.abs();
    let face = if a.z >= a.x && a.z >= a.y {
        DVec2::new(q.x * q.z.signum(), q.y) / a.z
    } else if a.x >= a.y {
        DVec2::new(-q.z * q.x.signum(), q.y) / a.x
    } else {
        DVec2::new(q.x, -q.z * q.y.signum()) / a.y
    };
    if face.is_finite() { face } else { DVec2::ZERO }
}
