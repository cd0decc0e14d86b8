// SPDX-License-Identifier: MIT OR Apache-2.0
//! `scene(...)`: how the whole file is to be read, and where its root stands.

use dioptric_geometry::Transform;
use dioptric_math::{DAffine3, DVec3};
use dioptric_scene::{Category, Default, Param, Schema, Type};

/// The schema of `scene`.
pub static SCHEMA: Schema = Schema {
    kind: "scene",
    category: Category::Setting,
    summary: "how the file is read: colours, which way is up, a transform of everything",
    doc: "`colors` says what the numbers of colours and 8-bit pictures mean: \"srgb\" (decoded to linear\n\
          light) or \"raw\" (used as they are, as old programs do). `transform` moves, turns and scales\n\
          everything together: shapes, lights, cameras and patterns; \"world\" space stays the space\n\
          in which the file is written.",
    params: &[
        Param::new(
            "colors",
            Type::Choice(&["srgb", "raw"]),
            Default::Text("srgb"),
            "What colours mean.",
        ),
        Param::new(
            "up",
            Type::Choice(&["y", "z"]),
            Default::Text("y"),
            "Which axis points up for cameras.",
        ),
        Param::new(
            "transform",
            Type::List(&Type::Node(Category::Transform)),
            Default::Absent,
            "One transform or a list of them, for the whole scene.",
        ),
    ],
    example: "",
};

/// The root: from the space in which the file is written to the space of rays.
#[derive(Clone, Debug)]
pub struct Root {
    transform: Transform,
    up: DVec3,
    scale: f64,
    still: bool,
}

impl std::default::Default for Root {
    /// The file's space is the space of rays, y is up.
    fn default() -> Self {
        Self { transform: Transform::IDENTITY, up: DVec3::Y, scale: 1.0, still: true }
    }
}

impl Root {
    /// A root with a placement; `None` where it has no inverse.
    #[must_use]
    pub fn new(placement: DAffine3, up: DVec3) -> Option<Self> {
        let scale = dioptric_math::cbrt(placement.matrix3.determinant().abs());
        let still = placement == DAffine3::IDENTITY;
        Some(Self { transform: Transform::new(placement)?, up, scale, still })
    }

    /// The transform from the file's space to the space of rays.
    #[must_use]
    pub const fn transform(&self) -> &Transform {
        &self.transform
    }

    /// Whether both spaces are the same.
    #[must_use]
    pub const fn is_identity(&self) -> bool {
        self.still
    }

    /// A point, carried to the space of rays.
    #[must_use]
    pub fn point(&self, p: DVec3) -> DVec3 {
        self.transform.to_world().transform_point3(p)
    }

    /// A vector, carried to the space of rays; its length is scaled too.
    #[must_use]
    pub fn vector(&self, v: DVec3) -> DVec3 {
        self.transform.to_world().transform_vector3(v)
    }

    /// Length in the space of rays of one unit of the file: the cube root of the change of volume.
    #[must_use]
    pub const fn scale(&self) -> f64 {
        self.scale
    }

    /// The file's up direction, in the file's space.
    #[must_use]
    pub const fn up(&self) -> DVec3 {
        self.up
    }
}
