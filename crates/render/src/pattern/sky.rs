// SPDX-License-Identifier: MIT OR Apache-2.0
//! The clear sky by day, for backgrounds; its sun is a light.

use dioptric_math::{DVec3, Spectrum, normalize};
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::daylight::Daylight;
use super::{Pattern, PatternPoint};
use crate::build::Builder;

/// The sky by day.
#[derive(Clone, Debug)]
pub struct Sky {
    daylight: Daylight,
    sun: DVec3,
    up: DVec3,
    /// What the ground shows.
    ground: Spectrum,
    light: bool,
}

static SCHEMA: Schema = Schema {
    kind: "sky",
    category: Category::Pattern,
    summary: "the clear sky by day, for the background, with the sun as a light",
    doc: "The sky as the air scatters the sun's light, by the position of the sun and how hazy it is (Preetham, Shirley\n\
          and Smits, \"A Practical Analytic Model for Daylight\", SIGGRAPH 1999). As the `color` of a `background` it\n\
          brings its sun: a light of half a degree, as bright and as red as the air leaves it, in both integrators. (Lights\n\
          are not seen by the camera: the glow around the sun is, its disc is not.) Paths are lit by the sky itself, too;\n\
          for Whitted's pictures give some `ambient` light in its place.\n\n\
          It is in units in which 100 000 lux make a white surface white: with the sun high and clear air, all is about as\n\
          bright as with a light of intensity 1. `background(intensity = ...)` changes sky and sun together. Below the\n\
          horizon there is ground of the colour `ground`, lit by both.\n\n\
          The model was fitted for a turbidity from 2 to 6 and for the sun above the horizon. As any pattern it can be\n\
          painted on a surface: it is asked in the direction of the point from the origin, in world space.",
    params: &[
        Param::new(
            "sun",
            Type::Direction,
            Default::Vec3([0.5, 0.7, 0.5]),
            "The way to the sun, above the horizon.",
        ),
        Param::new(
            "turbidity",
            Type::Number { min: 1.7, max: 10.0 },
            Default::Number(3.0),
            "How hazy the air is: 2 very clear, 3 clear, 6 hazy, 10 very hazy.",
        ),
        Param::new("ground", Type::Color, Default::Number(0.4), "Colour of the ground."),
        Param::new(
            "light",
            Type::Bool,
            Default::Bool(true),
            "Whether the sun lights the scene where this is its background.",
        ),
    ],
    example: "render(size = (320, 240), integrator = \"path\", samples = 64)\n\
              background(sky(sun = (-0.7, 0.35, -0.3)), intensity = 1.3)\n\
              sphere(center = (-0.4, 1, -0.5), radius = 1, material = mirror())\n\
              sphere(center = (1.2, 0.5, 0.6), radius = 0.5, material = matte(\"white\"))",
};

/// Which way is up in the file.
fn up(builder: &Builder) -> Result<DVec3, Diagnostic> {
    let description = builder.description;
    let z = match description.roots_of("scene").last() {
        Some(id) => &*Args::new(description, id).text("up")? == "z",
        None => false,
    };
    Ok(if z { DVec3::Z } else { DVec3::Y })
}

impl Pattern for Sky {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args, builder: &mut Builder) -> Result<Self, Diagnostic> {
        let up = up(builder)?;
        let sun = normalize(args.vec3("sun")?.into()).filter(|sun| sun.dot(up) > 0.0);
        let sun = sun.ok_or_else(|| {
            args.error("sun", "wrong-value", "sun of sky: expected a direction above the horizon")
                .help(
                    "this sky is that of the day; for dusk and night take a gradient or a picture",
                )
        })?;
        let daylight = Daylight::new(sun, up, args.number("turbidity")?);
        let ground = builder.constant_color(args, "ground")? * daylight.on_the_ground();
        Ok(Self { daylight, sun, up, ground, light: args.bool("light")? })
    }

    fn eval(&self, point: &PatternPoint) -> Spectrum {
        let direction = normalize(point.world).unwrap_or(self.up);
        if direction.dot(self.up) < 0.0 { self.ground } else { self.daylight.sky(direction) }
    }
}

impl Sky {
    /// The way to the sun in the file's space, and what arrives from it, if it lights the scene.
    #[must_use]
    pub fn sun(&self) -> Option<(DVec3, Spectrum)> {
        self.light.then(|| (self.sun, self.daylight.sun()))
    }
}

#[cfg(test)]
mod tests {
    use crate::pattern::testing::{Bench, at, pattern, v};
    use dioptric_math::luminance;

    #[test]
    fn it_is_brighter_towards_the_sun_and_has_ground_below() {
        let sky = pattern("sky", &[("sun", v(1.0, 1.0, 0.0))]);
        let see = |x, y, z| sky.eval(&at(x, y, z));
        assert!(luminance(see(1.0, 1.0, 0.1)) > 2.0 * luminance(see(-1.0, 1.0, 0.1)));
        assert_eq!(see(0.3, -0.2, 0.1), see(-0.9, -0.1, 0.4));
        // How far away does not count.
        assert!((see(2.0, 1.0, 0.0) - see(4.0, 2.0, 0.0)).length() < 1e-12);
    }

    #[test]
    fn by_night_there_is_none() {
        let mut bench = Bench::default();
        let id = bench.node("sky", &[("sun", v(1.0, -0.1, 0.0))]);
        let why = bench.build(id).unwrap_err();
        assert_eq!(why.message, "sun of sky: expected a direction above the horizon");
    }
}
