// SPDX-License-Identifier: MIT OR Apache-2.0
//! `background(...)`: what a ray sees that hits nothing.

use std::f64::consts::{PI, TAU};

use dioptric_math::{DVec2, DVec3, Spectrum, asin, atan2, normalize};
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::root::Root;
use crate::build::Builder;
use crate::input::ColorInput;
use crate::pattern::PatternPoint;

/// The schema of `background`.
pub static SCHEMA: Schema = Schema {
    kind: "background",
    category: Category::Setting,
    summary: "the colour of the sky: what is seen where nothing is hit",
    doc: "A colour, or a pattern painted on a sphere that is infinitely far away. The pattern is asked at the unit\n\
          direction of the ray: in object and world space that is the point (x, y, z) of the unit sphere, so\n\
          that a gradient along the up axis is a sky; in uv space u is the longitude (0.5 straight ahead,\n\
          growing to the right) and v the latitude (0 below, 1 above), which fits panorama pictures. Mirrors and\n\
          glass see it too; it lights nothing by itself.",
    params: &[
        Param::new("color", Type::ColorPattern, Default::Number(0.0), "Its colour."),
        Param::new("intensity", Type::NON_NEGATIVE, Default::Number(1.0), "Multiplies the colour."),
    ],
    example: "background(gradient(\"orange\", \"midnightblue\", end = (0, 0.5, 0)))\n\
              sphere(center = (0, 1, 0), radius = 1, material = mirror())",
};

/// What is seen where nothing is hit.
#[derive(Clone, Debug)]
pub struct Background {
    color: ColorInput,
    intensity: f64,
    /// Takes directions to the file's space, for patterns.
    root: Option<Root>,
}

impl Background {
    /// Black everywhere: what a scene has that says nothing.
    pub const BLACK: Self =
        Self { color: ColorInput::Constant(Spectrum::ZERO), intensity: 1.0, root: None };

    /// The background that a node describes.
    ///
    /// # Errors
    /// An argument is wrong.
    pub fn from_args(args: &Args, builder: &mut Builder, root: &Root) -> Result<Self, Diagnostic> {
        Ok(Self {
            color: builder.color(args, "color")?,
            intensity: args.number("intensity")?,
            root: Some(root.clone()),
        })
    }

    /// What is seen in a direction of the space of rays, of any length.
    #[must_use]
    pub fn radiance(&self, direction: DVec3) -> Spectrum {
        match &self.color {
            ColorInput::Constant(c) => *c * self.intensity,
            pattern => pattern.eval(&self.point(direction)) * self.intensity,
        }
    }

    /// Where the pattern is asked for a direction of the space of rays.
    #[must_use]
    pub fn point(&self, direction: DVec3) -> PatternPoint {
        let (in_file, z_up) = match &self.root {
            Some(root) => (
                root.transform().direction_to_local(direction),
                root.up().z.abs() > root.up().y.abs(),
            ),
            None => (direction, false),
        };
        let d = normalize(in_file).unwrap_or(DVec3::NEG_Z);
        // Straight ahead is -z where y is up, and y where z is up.
        let (ahead, up) = if z_up { (d.y, d.z) } else { (-d.z, d.y) };
        let u = (0.5 + atan2(d.x, ahead) / TAU).clamp(0.0, 1.0);
        let v = 0.5 + asin(up.clamp(-1.0, 1.0)) / PI;
        PatternPoint {
            object: d,
            world: d,
            uv: DVec2::new(u, v),
            object_normal: d,
            world_normal: d,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dioptric_math::DAffine3;

    fn background(up: DVec3, placement: DAffine3) -> Background {
        Background { root: Root::new(placement, up), ..Background::BLACK }
    }

    #[test]
    fn longitude_and_latitude_of_the_six_axes() {
        let y_up = background(DVec3::Y, DAffine3::IDENTITY);
        let uv = |b: &Background, d| b.point(d).uv;
        assert_eq!(uv(&y_up, DVec3::NEG_Z), DVec2::new(0.5, 0.5));
        assert_eq!(uv(&y_up, DVec3::X), DVec2::new(0.75, 0.5));
        assert_eq!(uv(&y_up, DVec3::NEG_X), DVec2::new(0.25, 0.5));
        assert_eq!(uv(&y_up, DVec3::Y).y, 1.0);
        assert_eq!(uv(&y_up, DVec3::NEG_Y).y, 0.0);
        let z_up = background(DVec3::Z, DAffine3::IDENTITY);
        assert_eq!(uv(&z_up, DVec3::Y), DVec2::new(0.5, 0.5));
        assert_eq!(uv(&z_up, DVec3::X), DVec2::new(0.75, 0.5));
        assert_eq!(uv(&z_up, DVec3::Z).y, 1.0);
    }

    #[test]
    fn directions_are_those_of_the_file_and_unit_vectors() {
        let turned = background(
            DVec3::Y,
            DAffine3::from_rotation_y(std::f64::consts::FRAC_PI_2)
                * DAffine3::from_scale(DVec3::splat(1e6)),
        );
        // Turned by 90 degrees about y, the file's -z is the -x of rays.
        assert!((turned.point(DVec3::NEG_X * 7.0).world - DVec3::NEG_Z).length() < 1e-12);
        assert!(turned.point(DVec3::ZERO).world.is_finite());
        assert!(turned.radiance(DVec3::splat(f64::NAN)).is_finite());
    }
}
