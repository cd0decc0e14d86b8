// SPDX-License-Identifier: MIT OR Apache-2.0
//! A camera without perspective: parallel rays.

use dioptric_geometry::Ray;
use dioptric_math::{DVec3, normalize};
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::Camera;
use super::frame::{EYE, Frame, LOOK_AT, UP};
use crate::setting::root::Root;

/// Parallel projection.
#[derive(Clone, Debug)]
pub struct Orthographic {
    eye: DVec3,
    /// Unit vector of all rays.
    forward: DVec3,
    /// From the eye to the right edge of the picture.
    right: DVec3,
    /// From the eye to the upper edge.
    up: DVec3,
}

static SCHEMA: Schema = Schema {
    kind: "orthographic",
    category: Category::Camera,
    summary: "a camera without perspective, for plans and diagrams",
    doc: "All rays are parallel, so that things keep their size at any distance: what is `height` high fills the\n\
          picture. The rays start in the plane through `eye` that faces the line of sight; what is behind it is\n\
          not seen.",
    params: &[
        EYE,
        LOOK_AT,
        UP,
        Param::new(
            "height",
            Type::Positive,
            Default::Number(2.0),
            "Height of what the picture shows, in units of the scene.",
        ),
    ],
    example: "orthographic(eye = (4, 4, 4), look_at = (0, 0.5, 0), height = 3.5)",
};

impl Camera for Orthographic {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args, root: &Root, aspect: f64) -> Result<Self, Diagnostic> {
        let frame = Frame::from_args(args, root)?;
        let half = args.number("height")? * 0.5;
        let Some(forward) = normalize(root.vector(frame.forward)) else {
            return Err(
                args.error_here("degenerate-camera", "orthographic: it has no line of sight")
            );
        };
        Ok(Self {
            eye: root.point(frame.eye),
            forward,
            right: root.vector(frame.right * (half * aspect)),
            up: root.vector(frame.up * half),
        })
    }

    fn ray(&self, x: f64, y: f64, _lens: [f64; 2]) -> Option<Ray> {
        let origin = self.eye + self.right * (2.0 * x - 1.0) + self.up * (1.0 - 2.0 * y);
        Some(Ray::new(origin, self.forward))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::testing::build;
    use crate::setting::testing::scaled_root;
    use dioptric_scene::Value;

    #[test]
    fn the_picture_is_as_high_as_asked_and_its_rays_are_parallel() {
        let arguments = [
            ("eye", Value::Vec3([0.0, 10.0, 0.0])),
            ("look_at", Value::Vec3([0.0, 0.0, 0.0])),
            ("up", Value::Vec3([0.0, 0.0, -1.0])),
            ("height", Value::Number(6.0)),
        ];
        for scale in [1e-6, 1.0] {
            let camera = build::<Orthographic>(&arguments, &scaled_root(scale), 2.0).unwrap();
            assert!(!camera.has_lens());
            for (x, y, corner) in [
                (0.0, 0.0, DVec3::new(-6.0, 10.0, -3.0)),
                (1.0, 1.0, DVec3::new(6.0, 10.0, 3.0)),
                (0.5, 0.5, DVec3::new(0.0, 10.0, 0.0)),
            ] {
                let ray = camera.ray(x, y, [0.5; 2]).unwrap();
                assert!((ray.origin / scale - corner).length() < 1e-12, "{x} {y}");
                assert_eq!(ray.direction, DVec3::NEG_Y);
            }
        }
    }
}
