// SPDX-License-Identifier: MIT OR Apache-2.0
//! A lamp that shines into a cone, with a soft edge.

use dioptric_math::{DVec3, Spectrum, cos, normalize};
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::profile::{PROFILE, PROFILE_TURN, Profile};
use super::shared::{Ball, COLOR, FALLOFF, INTENSITY, RADIUS, SAMPLES, samples, strength};
use super::{Light, LightPass, LightPlace, LightSample, LightView};
use crate::build::Builder;
use crate::setting::root::Root;

/// A spotlight.
#[derive(Clone, Debug)]
pub struct Spot {
    ball: Ball,
    strength: Spectrum,
    samples: u32,
    /// Unit vector along which it shines.
    axis: DVec3,
    /// Cosine of the angle inside which it is at full strength.
    cos_inner: f64,
    /// Cosine of the angle outside which it is dark.
    cos_outer: f64,
    profile: Option<Profile>,
}

static SCHEMA: Schema = Schema {
    kind: "spot",
    category: Category::Light,
    summary: "a lamp that shines into a cone with a soft edge",
    doc: "Shines from `position` to `look_at`, or along `direction`. `angle` is the whole opening of the cone; the\n\
          outer part `soft` of it fades smoothly from full strength to nothing: with s = (cos t - cos o) / (cos i -\n\
          cos o) clamped to 0..1, t being the angle to the axis, o the outer and i the inner half angle, the\n\
          strength is 3 s^2 - 2 s^3 (Pharr, Jakob and Humphreys, \"Physically Based Rendering\", 4th ed.,\n\
          section 12.2.1). In all else it is like `light`.",
    params: &[
        Param::required("position", Type::Vec3, "Where it is."),
        Param::new(
            "look_at",
            Type::Vec3,
            Default::Absent,
            "A point in the middle of its light. Either this or `direction`.",
        ),
        Param::new("direction", Type::Direction, Default::Absent, "The way the light goes."),
        Param::new(
            "angle",
            Type::Number { min: 1e-3, max: 180.0 },
            Default::Number(45.0),
            "Opening of the cone, from edge to edge, in degrees.",
        ),
        Param::new(
            "soft",
            Type::UNIT,
            Default::Number(0.2),
            "Part of the cone that fades: 0 is a hard edge, 1 fades from the middle on.",
        ),
        INTENSITY,
        COLOR,
        FALLOFF,
        RADIUS,
        SAMPLES,
        PROFILE,
        PROFILE_TURN,
    ],
    example: "spot(position = (-2, 4, 4), look_at = (0, 0.5, 0), angle = 28, soft = 0.4)",
};

impl Spot {
    /// Its axis, and the cosine of the widest angle to it that it lights.
    pub(crate) const fn cone(&self) -> (DVec3, f64) {
        (self.axis, self.cos_outer)
    }

    /// The share of full strength towards a point.
    fn towards(&self, point: DVec3) -> Option<f64> {
        let away = normalize(point - self.ball.center)?;
        let share = self.share(away.dot(self.axis));
        let share = match &self.profile {
            Some(profile) if share > 0.0 => share * profile.share(away),
            _ => share,
        };
        (share > 0.0).then_some(share)
    }

    /// The share of full strength at an angle to the axis, given by its cosine.
    fn share(&self, cos: f64) -> f64 {
        if self.cos_inner <= self.cos_outer {
            return if cos >= self.cos_outer { 1.0 } else { 0.0 };
        }
        let s = ((cos - self.cos_outer) / (self.cos_inner - self.cos_outer)).clamp(0.0, 1.0);
        s * s * (3.0 - 2.0 * s)
    }
}

/// The axis from `look_at` or `direction`, in the file's space.
fn axis(args: &Args) -> Result<DVec3, Diagnostic> {
    match (args.is_written("look_at"), args.is_written("direction")) {
        (true, false) => {
            let way = DVec3::from(args.vec3("look_at")?) - DVec3::from(args.vec3("position")?);
            normalize(way).ok_or_else(|| {
                args.error(
                    "look_at",
                    "degenerate-light",
                    "look_at of spot: the same point as position",
                )
                .help("write a point that should be in the middle of its light")
            })
        }
        (false, true) => normalize(args.vec3("direction")?.into()).ok_or_else(|| {
            args.error("direction", "wrong-value", "direction of spot: expected a direction")
        }),
        (true, true) => Err(args
            .error("direction", "contradiction", "spot: both look_at and direction are given")
            .help("keep one of them")),
        (false, false) => Err(args
            .error_here("missing-argument", "spot needs look_at or direction")
            .help("write look_at = (x, y, z), a point in the middle of its light")),
    }
}

impl Light for Spot {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args, builder: &mut Builder, root: &Root) -> Result<Self, Diagnostic> {
        let outer = args.number("angle")?.to_radians() * 0.5;
        let inner = outer * (1.0 - args.number("soft")?);
        let axis = axis(args)?;
        Ok(Self {
            profile: Profile::from_args(args, builder, root, axis)?,
            ball: Ball::from_args(args, root)?,
            strength: strength(args, builder)?,
            samples: samples(args)?,
            axis: normalize(root.vector(axis)).unwrap_or(axis),
            cos_inner: cos(inner),
            cos_outer: cos(outer),
        })
    }

    fn sample(&self, point: DVec3, u: [f64; 2]) -> Option<LightSample> {
        let share = self.towards(point)?;
        let s = self.ball.sample(point, u)?;
        Some(LightSample {
            direction: s.direction,
            distance: s.distance,
            arriving: self.strength * (share * s.weight),
        })
    }

    fn samples(&self) -> u32 {
        if self.is_sharp() { 1 } else { self.samples }
    }

    fn is_sharp(&self) -> bool {
        !(self.ball.radius > 0.0)
    }

    fn pass(&self, origin: DVec3, direction: DVec3) -> Option<LightPass> {
        let share = self.towards(origin)?;
        let (s, density) = self.ball.pass(origin, direction)?;
        let arriving = self.strength * (share * s.weight);
        Some(LightPass { distance: s.distance, arriving, density })
    }

    fn view(&self, point: DVec3) -> Option<LightView> {
        let share = self.towards(point)?;
        let (direction, sine, weight) = self.ball.view(point)?;
        Some(LightView { direction, sine, arriving: self.strength * (share * weight) })
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
    use dioptric_math::sin_cos;
    use dioptric_scene::Value;

    fn down(soft: f64, scale: f64) -> Spot {
        build::<Spot>(
            &[
                ("position", Value::Vec3([0.0, 2.0, 0.0])),
                ("look_at", Value::Vec3([0.0, 0.0, 0.0])),
                ("angle", Value::Number(60.0)),
                ("soft", Value::Number(soft)),
            ],
            &scaled_root(scale),
        )
        .unwrap()
    }

    /// Strength at an angle in degrees from the axis.
    fn at(spot: &Spot, degrees: f64, scale: f64) -> f64 {
        let (s, c) = sin_cos(degrees.to_radians());
        let point = DVec3::new(3.0 * s, 2.0 - 3.0 * c, 0.0) * scale;
        spot.sample(point, [0.5; 2]).map_or(0.0, |s| s.arriving.x)
    }

    #[test]
    fn the_edge_is_continuous_and_where_it_should_be() {
        for scale in [1.0, 1e-6] {
            let spot = down(0.5, scale);
            assert_eq!(at(&spot, 0.0, scale), 1.0);
            assert_eq!(at(&spot, 14.99, scale), 1.0);
            assert_eq!(at(&spot, 30.01, scale), 0.0);
            assert_eq!(at(&spot, 120.0, scale), 0.0);
            let middle = 0.5 * (cos(15f64.to_radians()) + cos(30f64.to_radians()));
            let degrees = dioptric_math::acos(middle).to_degrees();
            assert!((at(&spot, degrees, scale) - 0.5).abs() < 1e-9);
            let values: Vec<f64> = (0..400).map(|i| at(&spot, f64::from(i) * 0.1, scale)).collect();
            for pair in values.windows(2) {
                assert!(pair[0] >= pair[1] && pair[0] - pair[1] < 0.02, "{pair:?}");
            }
        }
    }

    #[test]
    fn a_hard_edge_is_hard() {
        let spot = down(0.0, 1.0);
        assert_eq!(at(&spot, 29.99, 1.0), 1.0);
        assert_eq!(at(&spot, 30.01, 1.0), 0.0);
    }

    #[test]
    fn the_direction_is_given_once() {
        let position = ("position", Value::Vec3([0.0, 2.0, 0.0]));
        let message = |arguments: &[(&str, Value)]| {
            build::<Spot>(arguments, &plain_root()).unwrap_err().message
        };
        assert_eq!(message(std::slice::from_ref(&position)), "spot needs look_at or direction");
        let aim = ("look_at", Value::Vec3([0.0, 2.0, 0.0]));
        assert_eq!(
            message(&[position.clone(), aim.clone()]),
            "look_at of spot: the same point as position"
        );
        assert_eq!(
            message(&[position, aim, ("direction", Value::Vec3([0.0, 1.0, 0.0]))]),
            "spot: both look_at and direction are given"
        );
    }
}
