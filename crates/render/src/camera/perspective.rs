// SPDX-License-Identifier: MIT OR Apache-2.0
//! The pinhole and thin-lens camera.

use dioptric_geometry::Ray;
use dioptric_geometry::world::Bundle;
use dioptric_math::wide::{Kernel, wide};
use dioptric_math::{DVec3, normalize, tan};
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::frame::{EYE, Frame, LOOK_AT, UP};
use super::{Camera, Places, one_by_one};
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
    /// Nothing for a pinhole.
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
    doc: "Looks from `eye` at `look_at`. `fov` is the vertical field of view; a wider picture shows more to the\n\
          sides. With `aperture` above 0 things at the distance `focus` are sharp and others blurred (Cook, Porter\n\
          and Carpenter, \"Distributed Ray Tracing\", SIGGRAPH 1984): a point at the distance d becomes a disc as\n\
          wide as the lens would look from there, `aperture x |d - focus| / focus` at the distance d. Ask for many\n\
          samples a pixel.",
    params: &[
        EYE,
        LOOK_AT,
        UP,
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
            "Diameter of the lens in units of the scene; 0 is a pinhole.",
        ),
        Param::new(
            "focus",
            Type::Positive,
            Default::Absent,
            "Distance of the plane in focus, along the line of sight; that of `look_at` if absent.",
        ),
    ],
    example: "camera(eye = (-2.6, 1.4, 3), look_at = (-1.1, 0.7, 0.6), fov = 40, aperture = 0.3)",
};

impl Camera for Perspective {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args, root: &Root, aspect: f64) -> Result<Self, Diagnostic> {
        let frame = Frame::from_args(args, root)?;
        let half = tan(args.number("fov")?.to_radians() * 0.5);
        let radius = args.number("aperture")? * 0.5;
        let focus = args.optional_number("focus")?.unwrap_or(frame.distance);
        Ok(Self {
            eye: root.point(frame.eye),
            forward: root.vector(frame.forward),
            right: root.vector(frame.right * (half * aspect)),
            up: root.vector(frame.up * half),
            lens: (radius > 0.0).then(|| Lens {
                right: root.vector(frame.right * radius),
                up: root.vector(frame.up * radius),
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

    fn rays(&self, places: &Places, rays: &mut Bundle) -> u16 {
        if self.lens.is_none() {
            rays.free();
            if wide(Pinhole { camera: self, places, rays }) {
                return u16::MAX;
            }
        }
        one_by_one(self, places, rays)
    }
}

/// Sixteen rays through a pinhole; false where one of them has an odd length and must be made by itself.
struct Pinhole<'a> {
    camera: &'a Perspective,
    places: &'a Places,
    rays: &'a mut Bundle,
}

impl Kernel for Pinhole<'_> {
    type Output = bool;

    #[inline(always)]
    fn run(self) -> bool {
        let Perspective { eye, forward, right, up, .. } = self.camera;
        let Bundle { origin, direction, .. } = self.rays;
        let [dx, dy, dz] = direction;
        let mut length = [0.0; Bundle::LANES];
        for i in 0..Bundle::LANES {
            let (x, y) = (2.0 * self.places.x[i] - 1.0, 1.0 - 2.0 * self.places.y[i]);
            dx[i] = forward.x + right.x * x + up.x * y;
            dy[i] = forward.y + right.y * x + up.y * y;
            dz[i] = forward.z + right.z * x + up.z * y;
            length[i] = (dx[i] * dx[i] + dy[i] * dy[i] + dz[i] * dz[i]).sqrt();
        }
        for axis in [dx, dy, dz] {
            for i in 0..Bundle::LANES {
                axis[i] /= length[i];
            }
        }
        for (origin, eye) in origin.iter_mut().zip(eye.to_array()) {
            *origin = [eye; Bundle::LANES];
        }
        let mut odd = false;
        for length in &length {
            odd |= !(*length >= LENGTHS.0) | !(*length <= LENGTHS.1);
        }
        !odd
    }
}

/// Squares of other lengths may be out of range.
const LENGTHS: (f64, f64) = (1e-99, 1e99);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::testing::build;
    use crate::setting::testing::{plain_root, scaled_root};
    use dioptric_math::DAffine3;
    use dioptric_scene::Value;

    const CENTER: [f64; 2] = [0.5; 2];

    /// SCENE.md: the image plane is 20 x 20 at the distance 40.
    #[test]
    fn the_corners_of_the_report_s_picture() {
        let fov = 2.0 * dioptric_math::atan(10.0 / 40.0).to_degrees();
        let camera =
            build::<Perspective>(&[("fov", Value::Number(fov))], &plain_root(), 1.0).unwrap();
        for (x, y, to) in [
            (0.0, 0.0, DVec3::new(-10.0, 10.0, -40.0)),
            (1.0, 0.0, DVec3::new(10.0, 10.0, -40.0)),
            (1.0, 1.0, DVec3::new(10.0, -10.0, -40.0)),
            (0.5, 0.5, DVec3::new(0.0, 0.0, -40.0)),
        ] {
            let ray = camera.ray(x, y, CENTER).unwrap();
            assert_eq!(ray.origin, DVec3::ZERO);
            assert!((ray.direction - to.normalize()).length() < 1e-15, "{x} {y}");
        }
    }

    #[test]
    fn fov_is_vertical_and_the_middle_is_looked_at() {
        let arguments = [
            ("eye", Value::Vec3([1.0, 2.0, 3.0])),
            ("look_at", Value::Vec3([-4.0, 0.0, 1.0])),
            ("fov", Value::Number(60.0)),
        ];
        for aspect in [0.5, 1.0, 2.5] {
            let camera = build::<Perspective>(&arguments, &plain_root(), aspect).unwrap();
            let at = |x, y| camera.ray(x, y, CENTER).unwrap().direction;
            let way = DVec3::new(-5.0, -2.0, -2.0).normalize();
            assert!((at(0.5, 0.5) - way).length() < 1e-15);
            assert!((at(0.5, 0.0).dot(at(0.5, 1.0)) - 0.5).abs() < 1e-12, "60 degrees");
            let half_width = dioptric_math::acos(at(0.0, 0.5).dot(way));
            let expected = dioptric_math::atan(aspect * dioptric_math::tan(30f64.to_radians()));
            assert!((half_width - expected).abs() < 1e-12, "{aspect}");
            // Up in the picture is up in the scene, right is to the right.
            assert!(at(0.5, 0.0).y > at(0.5, 1.0).y);
            assert!(way.cross(DVec3::Y).dot(at(1.0, 0.5) - at(0.0, 0.5)) > 0.0);
        }
    }

    #[test]
    fn rays_through_the_lens_meet_in_the_plane_in_focus() {
        let arguments = [
            ("eye", Value::Vec3([0.0, 1.0, 5.0])),
            ("look_at", Value::Vec3([0.0, 1.0, 0.0])),
            ("aperture", Value::Number(0.5)),
            ("focus", Value::Number(8.0)),
        ];
        for scale in [1e-6, 1.0, 1e6] {
            let camera = build::<Perspective>(&arguments, &scaled_root(scale), 1.5).unwrap();
            assert!(camera.has_lens());
            let mut widest = 0.0_f64;
            for (x, y) in [(0.5, 0.5), (0.1, 0.9)] {
                let meet = |lens| {
                    let ray = camera.ray(x, y, lens).unwrap();
                    // The plane z = 5 - 8 of the file.
                    ray.at((-3.0 * scale - ray.origin.z) / ray.direction.z) / scale
                };
                let first = meet(CENTER);
                for i in 0..25 {
                    let lens = [f64::from(i % 5) / 5.0, f64::from(i / 5) / 5.0];
                    assert!((meet(lens) - first).length() < 1e-9, "{scale}");
                    let origin = camera.ray(x, y, lens).unwrap().origin / scale;
                    widest = widest.max((origin - DVec3::new(0.0, 1.0, 5.0)).length());
                }
            }
            assert!(widest <= 0.25 + 1e-9 && widest > 0.24, "radius of the lens: {widest}");
        }
    }

    /// What is seen of a point does not depend on the root: its ray goes through the carried point.
    #[test]
    fn the_root_carries_camera_and_world_alike() {
        let arguments = [("eye", Value::Vec3([1.0, 2.0, 3.0])), ("look_at", Value::Vec3([0.0; 3]))];
        let plain = build::<Perspective>(&arguments, &plain_root(), 1.3).unwrap();
        let shear = DAffine3::from_mat3(dioptric_math::DMat3::from_cols(
            DVec3::new(-2.0, 0.1, 0.0),
            DVec3::new(0.5, 1.0, 0.2),
            DVec3::new(0.0, -0.3, 3.0),
        ));
        let root = Root::new(shear, DVec3::Y).unwrap();
        assert!(root.transform().is_mirror());
        let carried = build::<Perspective>(&arguments, &root, 1.3).unwrap();
        let seen = plain.ray(0.2, 0.7, CENTER).unwrap().at(4.0);
        let ray = carried.ray(0.2, 0.7, CENTER).unwrap();
        let way = (root.point(seen) - ray.origin).normalize();
        assert!((ray.direction - way).length() < 1e-12);
        assert!((ray.direction.length() - 1.0).abs() < 1e-15);
    }

    #[test]
    fn up_is_the_scene_s() {
        let z_up = Root::new(DAffine3::IDENTITY, DVec3::Z).unwrap();
        let arguments =
            [("eye", Value::Vec3([0.0, -5.0, 1.0])), ("look_at", Value::Vec3([0.0, 0.0, 1.0]))];
        let camera = build::<Perspective>(&arguments, &z_up, 1.0).unwrap();
        let top = camera.ray(0.5, 0.0, CENTER).unwrap().direction;
        assert!(top.z > 0.3 && top.x.abs() < 1e-15);
        let right = camera.ray(1.0, 0.5, CENTER).unwrap().direction;
        assert!(right.x > 0.3 && right.z.abs() < 1e-15);
    }

    #[test]
    fn cameras_that_see_nothing_are_refused() {
        let message = |arguments: &[(&str, Value)]| {
            build::<Perspective>(arguments, &plain_root(), 1.0).unwrap_err().message
        };
        assert_eq!(
            message(&[("eye", Value::Vec3([0.0, 0.0, -1.0]))]),
            "look_at of camera: the same point as eye"
        );
        let down = ("look_at", Value::Vec3([1e-13, -3.0, 0.0]));
        assert_eq!(
            message(std::slice::from_ref(&down)),
            "up of camera: it points along the line of sight"
        );
        assert!(
            build::<Perspective>(
                &[down, ("up", Value::Vec3([0.0, 0.0, -1e-9]))],
                &plain_root(),
                1.0
            )
            .is_ok()
        );
    }
}
