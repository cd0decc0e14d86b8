// SPDX-License-Identifier: MIT OR Apache-2.0
//! A lens that sees half of everything, or all of it, in a circle.

use std::f64::consts::PI;

use dioptric_geometry::Ray;
use dioptric_math::{DVec3, normalize, sin_cos};
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::Camera;
use super::frame::{EYE, Frame, LOOK_AT, UP};
use crate::setting::root::Root;

/// An equidistant fisheye.
#[derive(Clone, Debug)]
pub struct Fisheye {
    eye: DVec3,
    forward: DVec3,
    right: DVec3,
    up: DVec3,
    /// Angle to the line of sight at the rim of the circle.
    half_angle: f64,
    /// Half width and half height of the picture, in radii of the circle.
    half_size: [f64; 2],
}

static SCHEMA: Schema = Schema {
    kind: "fisheye",
    category: Category::Camera,
    summary: "a very wide lens that shows its view in a circle",
    doc: "The distance from the middle of the picture is in proportion to the angle to the line of sight (the\n\
          equidistant projection, r = f t). The circle fits the shorter side of the picture; around it there is\n\
          nothing. With `fov = 180` it is a dome, with 360 everything is seen.",
    params: &[
        EYE,
        LOOK_AT,
        UP,
        Param::new(
            "fov",
            Type::Number { min: 1e-3, max: 360.0 },
            Default::Number(180.0),
            "Field of view across the circle, in degrees.",
        ),
    ],
    example: "fisheye(eye = (0, 1.2, 1.6), look_at = (0, 0.7, 0), fov = 200)",
};

impl Camera for Fisheye {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args, root: &Root, aspect: f64) -> Result<Self, Diagnostic> {
        let frame = Frame::from_args(args, root)?;
        Ok(Self {
            eye: root.point(frame.eye),
            forward: root.vector(frame.forward),
            right: root.vector(frame.right),
            up: root.vector(frame.up),
            half_angle: (args.number("fov")?.to_radians() * 0.5).min(PI),
            half_size: [aspect.max(1.0), (1.0 / aspect).max(1.0)],
        })
    }

    fn ray(&self, x: f64, y: f64, _lens: [f64; 2]) -> Option<Ray> {
        let (a, b) = ((2.0 * x - 1.0) * self.half_size[0], (1.0 - 2.0 * y) * self.half_size[1]);
        let radius = (a * a + b * b).sqrt();
        if radius > 1.0 {
            return None;
        }
        let (sin, cos) = sin_cos(radius * self.half_angle);
        // sin(radius f) / radius tends to 0 / 0 in the middle, where there is nothing to the side.
        let side = if radius > 0.0 { sin / radius } else { 0.0 };
        let direction = self.forward * cos + (self.right * a + self.up * b) * side;
        Some(Ray::new(self.eye, normalize(direction)?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::testing::build;
    use crate::setting::testing::{plain_root, scaled_root};

    #[test]
    fn angles_are_in_proportion_to_distances() {
        for scale in [1e-6, 1.0] {
            let dome = build::<Fisheye>(&[], &scaled_root(scale), 2.0).unwrap();
            let at = |x, y| dome.ray(x, y, [0.5; 2]).map(|r| r.direction);
            assert_eq!(at(0.5, 0.5), Some(DVec3::NEG_Z));
            assert!((at(0.5, 0.0).unwrap() - DVec3::Y).length() < 1e-12);
            let half = (DVec3::NEG_Z + DVec3::Y).normalize();
            assert!((at(0.5, 0.25).unwrap() - half).length() < 1e-12);
            // The picture is twice as wide as the circle.
            assert!((at(0.75, 0.5).unwrap() - DVec3::X).length() < 1e-12);
            assert_eq!(at(0.8, 0.5), None);
            assert_eq!(at(0.0, 0.0), None);
        }
        let upright = build::<Fisheye>(&[], &plain_root(), 0.5).unwrap();
        assert!(upright.ray(0.5, 0.2, [0.5; 2]).is_none());
        assert!(upright.ray(0.01, 0.5, [0.5; 2]).is_some());
    }
}
