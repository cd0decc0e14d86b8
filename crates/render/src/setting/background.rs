// SPDX-License-Identifier: MIT OR Apache-2.0
//! `background(...)`: what a ray sees that hits nothing.

use std::f64::consts::{PI, TAU};

use dioptric_math::{DMat3, DVec2, DVec3, Spectrum, asin, atan2, normalize};
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::root::Root;
use crate::build::Builder;
use crate::input::ColorInput;
use crate::pattern::{AnyPattern, PatternPoint};

/// The schema of `background`.
pub static SCHEMA: Schema = Schema {
    kind: "background",
    category: Category::Setting,
    summary: "the colour of the sky: what is seen where nothing is hit",
    doc: "A colour, or a pattern painted on a sphere that is infinitely far away. The pattern is asked at the unit\n\
          direction of the ray: in object and world space that is the point (x, y, z) of the unit sphere, so\n\
          that a gradient along the up axis is a sky (and `sky` is the real one, with the sun as a light); in uv space u is the longitude (0.5 straight ahead,\n\
          growing to the right) and v the latitude (0 below, 1 above), which fits panorama pictures. Mirrors and\n\
          glass see it too. In Whitted's pictures it lights nothing by itself; by paths it lights everything, as the sky\n\
          does.",
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
    /// Whether its pattern may ask for longitude and latitude: two arcs for each direction.
    by_angles: bool,
}

impl Background {
    /// Black everywhere: what a scene has that says nothing.
    pub const BLACK: Self = Self {
        color: ColorInput::Constant(Spectrum::ZERO),
        intensity: 1.0,
        root: None,
        by_angles: true,
    };

    /// The background that a node describes.
    ///
    /// # Errors
    /// An argument is wrong.
    pub fn from_args(args: &Args, builder: &mut Builder, root: &Root) -> Result<Self, Diagnostic> {
        let color = builder.color(args, "color")?;
        let by_angles = match &color {
            ColorInput::Constant(_) => false,
            ColorInput::Pattern(pattern) => {
                !matches!(&**pattern, AnyPattern::Gradient(gradient) if gradient.ignores_uv())
            }
        };
        let intensity = args.number("intensity")?;
        Ok(Self { color, intensity, root: Some(root.clone()), by_angles })
    }

    /// What is seen in a direction of the space of rays, of any length.
    #[must_use]
    pub fn radiance(&self, direction: DVec3) -> Spectrum {
        match &self.color {
            ColorInput::Constant(c) => *c * self.intensity,
            pattern => pattern.eval(&self.point(direction)) * self.intensity,
        }
    }

    /// What is seen everywhere, if that is the same.
    #[must_use]
    pub fn constant(&self) -> Option<Spectrum> {
        match &self.color {
            ColorInput::Constant(c) => Some(*c * self.intensity),
            ColorInput::Pattern(_) => None,
        }
    }

    /// The light of the sun, if it is a sky that has one: the way to it in the space of rays, and what arrives.
    #[must_use]
    pub fn sun(&self) -> Option<(DVec3, Spectrum)> {
        let (ColorInput::Pattern(pattern), Some(root)) = (&self.color, &self.root) else {
            return None;
        };
        let AnyPattern::Sky(sky) = &**pattern else { return None };
        let (towards, strength) = sky.sun()?;
        Some((normalize(root.vector(towards))?, strength * self.intensity))
    }

    /// Width and height of the picture that the sky is, if it is one.
    #[must_use]
    pub fn picture_size(&self) -> Option<[usize; 2]> {
        match &self.color {
            ColorInput::Pattern(pattern) => match &**pattern {
                AnyPattern::Image(image) => Some(image.size()),
                _ => None,
            },
            ColorInput::Constant(_) => None,
        }
    }

    /// From directions of the space of rays to those whose lanes are right, ahead and up: `u` is the angle from
    /// ahead to the right, `v` that above the horizon.
    #[must_use]
    pub fn frame(&self) -> DMat3 {
        let (to_file, z_up) = match &self.root {
            Some(root) => {
                (root.transform().to_local().matrix3, root.up().z.abs() > root.up().y.abs())
            }
            None => (DMat3::IDENTITY, false),
        };
        // Straight ahead is -z where y is up, and y where z is up.
        let rows =
            if z_up { DMat3::IDENTITY } else { DMat3::from_cols(DVec3::X, DVec3::Z, DVec3::NEG_Y) };
        rows * to_file
    }

    /// Where the pattern is asked for a direction of the space of rays.
    #[must_use]
    pub fn point(&self, direction: DVec3) -> PatternPoint {
        let in_file = match &self.root {
            Some(root) => root.transform().direction_to_local(direction),
            None => direction,
        };
        let d = normalize(in_file).unwrap_or(DVec3::NEG_Z);
        let z_up = self.root.as_ref().is_some_and(|root| root.up().z.abs() > root.up().y.abs());
        // Straight ahead is -z where y is up, and y where z is up.
        let (ahead, up) = if z_up { (d.y, d.z) } else { (-d.z, d.y) };
        let uv = if self.by_angles {
            let u = (0.5 + atan2(d.x, ahead) / TAU).clamp(0.0, 1.0);
            DVec2::new(u, 0.5 + asin(up.clamp(-1.0, 1.0)) / PI)
        } else {
            DVec2::ZERO
        };
        PatternPoint { object: d, world: d, uv, object_normal: d, world_normal: d, lot: 0.5 }
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
    fn the_frame_says_the_same() {
        for up in [DVec3::Y, DVec3::Z] {
            let sky = background(up, DAffine3::from_rotation_x(0.7));
            let d = DVec3::new(0.48, -0.6, 0.64);
            let own = sky.frame() * d;
            let uv = sky.point(d).uv;
            assert!((0.5 + atan2(own.x, own.y) / TAU - uv.x).abs() < 1e-12, "{up}");
            assert!((0.5 + asin(own.z) / PI - uv.y).abs() < 1e-12, "{up}");
        }
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
