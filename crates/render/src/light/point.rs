// SPDX-License-Identifier: MIT OR Apache-2.0
//! A lamp: a point or a ball that shines everywhere.

use dioptric_math::{DVec3, Spectrum, normalize};
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::profile::{PROFILE, PROFILE_TURN, Profile};
use super::shared::{Ball, COLOR, FALLOFF, INTENSITY, RADIUS, SAMPLES, samples, strength};
use super::{Light, LightPass, LightPlace, LightSample, LightView, Sharp};
use crate::build::Builder;
use crate::setting::root::Root;

/// A lamp.
#[derive(Clone, Debug)]
pub struct Point {
    ball: Ball,
    strength: Spectrum,
    samples: u32,
    profile: Option<Profile>,
}

static SCHEMA: Schema = Schema {
    kind: "light",
    category: Category::Light,
    summary: "a lamp that shines in all directions: a point, or a ball with soft shadows",
    doc: "With the intensity 1 a white matte surface that faces it is white. Without falloff it is as bright far\n\
          away as near, as in Whitted's pictures; `falloff = \"square\"` weakens it by the square of the distance,\n\
          as nature does.\n\n\
          A `radius` above 0 makes it a ball, whose shadows have soft edges. The ball itself is not seen, casts\n\
          no shadow, and gives a surface that faces it exactly what the point would. `samples` directions are\n\
          taken, uniform over those in which the ball is seen (Shirley, Wang and Zimmerman, \"Monte Carlo\n\
          Techniques for Direct Lighting Calculations\", ACM TOG 15(1), 1996).\n\n\
          A `profile` says how bright a real lamp is to each side; the sides of a ball all follow that of its middle.\n\
          `intensity` is then that of the brightest direction. The angle 0 around the axis is towards x (z for lamps\n\
          that point along x), and angles grow counterclockwise seen from above a lamp that points down.",
    params: &[
        Param::required("position", Type::Vec3, "Where it is: its middle."),
        INTENSITY,
        COLOR,
        FALLOFF,
        RADIUS,
        SAMPLES,
        PROFILE,
        Param::new(
            "profile_direction",
            Type::Direction,
            Default::Absent,
            "Where the profile's axis points: down if absent.",
        ),
        PROFILE_TURN,
    ],
    example: "light(position = (-3, 5, 4), intensity = 0.9, radius = 0.6)",
};

impl Point {
    /// The share of its strength towards a point; `None` where that is nothing.
    fn share(&self, point: DVec3) -> Option<f64> {
        let Some(profile) = &self.profile else { return Some(1.0) };
        let share = normalize(point - self.ball.center).map_or(1.0, |away| profile.share(away));
        (share > 0.0).then_some(share)
    }
}

impl Light for Point {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args, builder: &mut Builder, root: &Root) -> Result<Self, Diagnostic> {
        let axis = if args.is_written("profile_direction") {
            normalize(args.vec3("profile_direction")?.into()).unwrap_or(-root.up())
        } else {
            -root.up()
        };
        Ok(Self {
            profile: Profile::from_args(args, builder, root, axis)?,
            ball: Ball::from_args(args, root)?,
            strength: strength(args, builder)?,
            samples: samples(args)?,
        })
    }

    fn sample(&self, point: DVec3, u: [f64; 2]) -> Option<LightSample> {
        let s = self.ball.sample(point, u)?;
        let share = self.share(point)?;
        Some(LightSample {
            direction: s.direction,
            distance: s.distance,
            arriving: self.strength * (s.weight * share),
        })
    }

    fn samples(&self) -> u32 {
        if self.is_sharp() { 1 } else { self.samples }
    }

    fn is_sharp(&self) -> bool {
        !(self.ball.radius > 0.0)
    }

    fn pass(&self, origin: DVec3, direction: DVec3) -> Option<LightPass> {
        let (s, density) = self.ball.pass(origin, direction)?;
        let arriving = self.strength * (s.weight * self.share(origin)?);
        Some(LightPass { distance: s.distance, arriving, density })
    }

    fn view(&self, point: DVec3) -> Option<LightView> {
        let (direction, sine, weight) = self.ball.view(point)?;
        Some(LightView { direction, sine, arriving: self.strength * (weight * self.share(point)?) })
    }

    fn sharp(&self) -> Option<Sharp> {
        let Ball { center, falloff, radius } = self.ball;
        (radius == 0.0 && self.profile.is_none()).then_some(Sharp::Point {
            center,
            falloff,
            strength: self.strength,
        })
    }

    fn place(&self) -> Option<LightPlace> {
        let Ball { center, radius, falloff } = self.ball;
        let intensity = self.strength * falloff.at(1.0);
        falloff.weakens().then_some(LightPlace { center, radius, intensity })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::testing::build;
    use crate::setting::testing::{plain_root, scaled_root};
    use dioptric_scene::Value;

    const POSITION: (&str, Value) = ("position", Value::Vec3([0.0, 3.0, 4.0]));

    #[test]
    fn falloff_is_measured_in_the_units_of_the_file() {
        for (word, expected) in [("none", 0.5), ("square", 0.5 / 25.0)] {
            for scale in [1.0, 1e-6, 1e6] {
                let light = build::<Point>(
                    &[
                        POSITION,
                        ("intensity", Value::Number(0.5)),
                        ("falloff", Value::Text(word.into())),
                    ],
                    &scaled_root(scale),
                )
                .unwrap();
                let s = light.sample(DVec3::ZERO, [0.5; 2]).unwrap();
                assert!((s.arriving.x / expected - 1.0).abs() < 1e-12, "{word} {scale}");
                assert!((s.distance / (5.0 * scale) - 1.0).abs() < 1e-12);
                assert!((s.direction - DVec3::new(0.0, 0.6, 0.8)).length() < 1e-15);
            }
        }
    }

    #[test]
    fn only_a_ball_takes_several_samples() {
        let root = plain_root();
        assert_eq!(build::<Point>(&[POSITION], &root).unwrap().samples(), 1);
        let ball = build::<Point>(
            &[POSITION, ("radius", Value::Number(0.5)), ("samples", Value::Number(9.0))],
            &root,
        );
        assert_eq!(ball.unwrap().samples(), 9);
        assert!(build::<Point>(&[POSITION, ("samples", Value::Number(0.0))], &root).is_err());
    }

    #[test]
    fn nothing_arrives_at_the_point_itself() {
        let light = build::<Point>(&[POSITION], &plain_root()).unwrap();
        assert_eq!(light.sample(DVec3::new(0.0, 3.0, 4.0), [0.5; 2]), None);
    }
}
