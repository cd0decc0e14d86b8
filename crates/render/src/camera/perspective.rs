// SPDX-License-Identifier: MIT OR Apache-2.0
//! The pinhole and thin-lens camera.

use dioptric_geometry::Ray;
use dioptric_math::{DVec3, normalize, tan};
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::Camera;
use crate::setting::root::Root;

/// A perspective camera.
#[derive(Clone, Debug)]
pub struct Perspective {
    eye: DVec3,
    /// From the eye to the middle of the picture plane at distance 1.
    forward: DVec3,
    /// From the middle of that plane to its right edge.
    right: DVec3,
    /// From the middle of that plane to its upper edge.
    up: DVec3,
    /// Lens radius as a share of the focal distance's unit, along unit right and up; 0 for a pinhole.
    lens: Option<Lens>,
}

#[derive(Clone, Debug)]
struct Lens {
    /// Radius along the camera's right and up, in the space of rays.
    right: DVec3,
    up: DVec3,
    /// Distance of the plane in focus, in units of `forward`.
    focus: f64,
}

static SCHEMA: Schema = Schema {
    kind: "camera",
    category: Category::Camera,
    summary: "a perspective camera, with a pinhole or a lens",
    doc: "Looks from `eye` at `look_at`. `fov` is the vertical field of view. With `aperture` above 0 things\n\
          at the distance `focus` are sharp and others blurred (Cook, Porter and Carpenter, \"Distributed Ray\n\
          Tracing\", SIGGRAPH 1984).",
    params: &[
        Param::new("eye", Type::Vec3, Default::Vec3([0.0, 0.0, 0.0]), "Where it stands."),
        Param::new(
            "look_at",
            Type::Vec3,
            Default::Vec3([0.0, 0.0, -1.0]),
            "The point in the middle of the picture.",
        ),
        Param::new(
            "up",
            Type::Direction,
            Default::Absent,
            "Which way is up in the picture; the scene's up if absent.",
        ),
        Param::new(
            "fov",
            Type::Number { min: 1e-3, max: 179.0 },
            Default::Number(45.0),
            "Vertical field of view in degrees.",
        ),
        Param::new(
            "aperture",
            Type::NON_NEGATIVE,
            Default::Number(0.0),
            "Diameter of the lens; 0 is a pinhole.",
        ),
        Param::new(
            "focus",
            Type::Positive,
            Default::Absent,
            "Distance of the plane in focus; that of `look_at` if absent.",
        ),
    ],
    example: "",
};

impl Camera for Perspective {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args, root: &Root, aspect: f64) -> Result<Self, Diagnostic> {
        let eye = DVec3::from(args.vec3("eye")?);
        let way = DVec3::from(args.vec3("look_at")?) - eye;
        let Some(forward) = normalize(way) else {
            return Err(args
                .error("look_at", "degenerate-camera", "look_at of camera: the same point as eye")
                .help("write the point that should be in the middle of the picture"));
        };
        let up = if args.is_written("up") { args.vec3("up")?.into() } else { root.up() };
        let Some(right) = normalize(forward.cross(up)) else {
            return Err(args
                .error("up", "degenerate-camera", "up of camera: it points along the line of sight")
                .help("write another up, such as up = (0, 0, -1) for a camera that looks straight down"));
        };
        let half = tan(args.number("fov")?.to_radians() * 0.5);
        let up = right.cross(forward);
        let radius = args.number("aperture")? * 0.5;
        let focus = args.optional_number("focus")?.unwrap_or(way.length());
        Ok(Self {
            eye: root.point(eye),
            forward: root.vector(forward),
            right: root.vector(right * (half * aspect)),
            up: root.vector(up * half),
            lens: (radius > 0.0).then(|| Lens {
                right: root.vector(right * radius),
                up: root.vector(up * radius),
                focus,
            }),
        })
    }

    fn ray(&self, x: f64, y: f64, lens: [f64; 2]) -> Option<Ray> {
        let direction = self.forward + self.right * (2.0 * x - 1.0) + self.up * (1.0 - 2.0 * y);
        let (origin, direction) = match &self.lens {
            None => (self.eye, direction),
            Some(l) => {
                let [a, b] = crate::sampling::warp::concentric_disc(lens);
                let shift = l.right * a + l.up * b;
                (self.eye + shift, direction * l.focus - shift)
            }
        };
        Some(Ray::new(origin, normalize(direction)?))
    }

    fn has_lens(&self) -> bool {
        self.lens.is_some()
    }
}
