// SPDX-License-Identifier: MIT OR Apache-2.0
//! Everything around a point on one picture: longitude and latitude.

use std::f64::consts::PI;

use dioptric_geometry::Ray;
use dioptric_math::{DVec3, normalize, sin_cos};
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::Camera;
use super::frame::{EYE, Frame, LOOK_AT, UP};
use crate::setting::root::Root;

/// A panorama.
#[derive(Clone, Debug)]
pub struct Panorama {
    eye: DVec3,
    forward: DVec3,
    right: DVec3,
    up: DVec3,
    /// Half of the width and of the height, in radians.
    half: [f64; 2],
}

static SCHEMA: Schema = Schema {
    kind: "panorama",
    category: Category::Camera,
    summary: "everything around a point, by longitude and latitude",
    doc: "Columns of the picture are directions all round, rows are heights above the horizon, both in equal\n\
          angles (the equirectangular projection that viewers of 360-degree pictures expect; give it a picture\n\
          twice as wide as high). The middle of the picture is `look_at`. Such a picture can be the `background`\n\
          of another scene.",
    params: &[
        EYE,
        LOOK_AT,
        UP,
        Param::new(
            "fov",
            Type::Number { min: 1e-3, max: 360.0 },
            Default::Number(360.0),
            "Angle from the left to the right edge, in degrees.",
        ),
        Param::new(
            "vertical_fov",
            Type::Number { min: 1e-3, max: 180.0 },
            Default::Number(180.0),
            "Angle from the lower to the upper edge, in degrees.",
        ),
    ],
    example: "panorama(eye = (0, 1, 1.4), look_at = (0, 1, 0), vertical_fov = 150)",
};

impl Camera for Panorama {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args, root: &Root, _aspect: f64) -> Result<Self, Diagnostic> {
        let frame = Frame::from_args(args, root)?;
        Ok(Self {
            eye: root.point(frame.eye),
            forward: root.vector(frame.forward),
            right: root.vector(frame.right),
            up: root.vector(frame.up),
            half: [
                (args.number("fov")?.to_radians() * 0.5).min(PI),
                (args.number("vertical_fov")?.to_radians() * 0.5).min(PI * 0.5),
            ],
        })
    }

    fn ray(&self, x: f64, y: f64, _lens: [f64; 2]) -> Option<Ray> {
        let (sin_lon, cos_lon) = sin_cos((2.0 * x - 1.0) * self.half[0]);
        let (sin_lat, cos_lat) = sin_cos((1.0 - 2.0 * y) * self.half[1]);
        let level = self.forward * cos_lon + self.right * sin_lon;
        Some(Ray::new(self.eye, normalize(level * cos_lat + self.up * sin_lat)?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::testing::build;
    use crate::setting::background::Background;
    use crate::setting::testing::plain_root;

    #[test]
    fn it_sees_all_around_as_a_background_shows_it() {
        let camera = build::<Panorama>(&[], &plain_root(), 2.0).unwrap();
        for (x, y, way) in [
            (0.5, 0.5, DVec3::NEG_Z),
            (0.75, 0.5, DVec3::X),
            (0.0, 0.5, DVec3::Z),
            (0.3, 0.0, DVec3::Y),
            (0.9, 1.0, DVec3::NEG_Y),
        ] {
            let ray = camera.ray(x, y, [0.5; 2]).unwrap();
            assert!((ray.direction - way).length() < 1e-12, "{x} {y}");
        }
        // A panorama taken here and hung up as a background is seen where it was taken.
        for (x, y) in [(0.1, 0.2), (0.6, 0.7), (0.99, 0.5)] {
            let uv = Background::BLACK.point(camera.ray(x, y, [0.5; 2]).unwrap().direction).uv;
            assert!((uv.x - x).abs() < 1e-12 && (uv.y - (1.0 - y)).abs() < 1e-12, "{x} {y} {uv}");
        }
    }
}
