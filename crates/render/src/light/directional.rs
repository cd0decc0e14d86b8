// SPDX-License-Identifier: MIT OR Apache-2.0
//! The sun: light from one direction everywhere.

use dioptric_math::{DVec3, Spectrum, normalize, sin};
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::shared::{
    COLOR, INTENSITY, SAMPLES, density_in_cone, direction_in_cone, facing_weight, samples,
    spread_of_sin2, strength,
};
use super::{Light, LightPass, LightPlace, LightSample, LightView, Sharp};
use crate::build::Builder;
use crate::setting::root::Root;

/// Parallel light.
#[derive(Clone, Debug)]
pub struct Directional {
    /// Unit vector towards the light.
    towards: DVec3,
    /// `1 - cos` of half the angle under which it is seen.
    spread: f64,
    strength: Spectrum,
    samples: u32,
}

static SCHEMA: Schema = Schema {
    kind: "directional",
    category: Category::Light,
    summary: "parallel light from infinitely far away, like the sun's",
    doc: "`direction` is the way the light goes: `(0, -1, 0)` shines straight down. It is equally bright\n\
          everywhere. With an `angle` above 0 it comes from a disc in the sky of that diameter and shadows soften\n\
          with distance; the sun's is 0.53 degrees. A surface that faces it receives the same for every angle.",
    params: &[
        Param::required("direction", Type::Direction, "The way the light goes."),
        INTENSITY,
        COLOR,
        Param::new(
            "angle",
            Type::Number { min: 0.0, max: 180.0 },
            Default::Number(0.0),
            "Diameter of the disc that it comes from, in degrees.",
        ),
        SAMPLES,
    ],
    example: "directional(direction = (1, -2, -1.5), intensity = 0.9, angle = 3)",
};

impl Directional {
    /// A disc in the sky as large as the sun, towards a unit vector in the space of rays.
    pub(crate) fn sun(towards: DVec3, strength: Spectrum) -> Self {
        let half = sin(0.533_f64.to_radians() * 0.5);
        Self { towards, spread: spread_of_sin2(half * half), strength, samples: 4 }
    }
}

impl Light for Directional {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args, builder: &mut Builder, root: &Root) -> Result<Self, Diagnostic> {
        let way = root.vector(DVec3::from(args.vec3("direction")?));
        let Some(way) = normalize(way) else {
            return Err(args.error(
                "direction",
                "wrong-value",
                "direction of directional: too large or too small to be a direction",
            ));
        };
        let half = sin(args.number("angle")?.to_radians() * 0.5);
        Ok(Self {
            towards: -way,
            spread: spread_of_sin2(half * half),
            strength: strength(args, builder)?,
            samples: samples(args)?,
        })
    }

    fn sample(&self, _point: DVec3, u: [f64; 2]) -> Option<LightSample> {
        let direction = if self.spread > 0.0 {
            direction_in_cone(self.towards, self.spread, u)
        } else {
            self.towards
        };
        Some(LightSample {
            direction,
            distance: f64::INFINITY,
            arriving: self.strength * facing_weight(self.spread),
        })
    }

    fn samples(&self) -> u32 {
        if self.is_sharp() { 1 } else { self.samples }
    }

    fn is_sharp(&self) -> bool {
        !(self.spread > 0.0)
    }

    fn pass(&self, _origin: DVec3, direction: DVec3) -> Option<LightPass> {
        // 1 - cos, without cancellation where the disc is small.
        let height = 0.5 * (direction - self.towards).length_squared();
        (self.spread > 0.0 && height <= self.spread).then(|| LightPass {
            distance: f64::INFINITY,
            arriving: self.strength * facing_weight(self.spread),
            density: density_in_cone(self.spread),
        })
    }

    fn view(&self, _point: DVec3) -> Option<LightView> {
        let sine = (self.spread * (2.0 - self.spread)).max(0.0).sqrt();
        Some(LightView {
            direction: self.towards,
            sine: if self.spread < 1.0 { sine } else { 1.0 },
            arriving: self.strength,
        })
    }

    fn sharp(&self) -> Option<Sharp> {
        let arriving = self.strength * facing_weight(self.spread);
        self.is_sharp().then_some(Sharp::Parallel { towards: self.towards, arriving })
    }

    fn place(&self) -> Option<LightPlace> {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::testing::{build, grid};
    use crate::setting::testing::scaled_root;
    use dioptric_scene::Value;

    const DOWN: (&str, Value) = ("direction", Value::Vec3([0.0, -2.0, 0.0]));

    #[test]
    fn it_shines_the_way_it_says_from_anywhere() {
        let sun = build::<Directional>(&[DOWN], &scaled_root(1e-6)).unwrap();
        for point in [DVec3::ZERO, DVec3::splat(1e9)] {
            let s = sun.sample(point, [0.3, 0.9]).unwrap();
            assert_eq!(s.direction, DVec3::Y);
            assert_eq!(s.arriving, Spectrum::ONE);
            assert_eq!(s.distance, f64::INFINITY);
        }
    }

    #[test]
    fn its_disc_has_the_diameter_asked_for() {
        let sun = build::<Directional>(&[DOWN, ("angle", Value::Number(60.0))], &scaled_root(1.0))
            .unwrap();
        assert_eq!(sun.samples(), 16);
        let rim = sun.sample(DVec3::ZERO, [0.0, 0.5]).unwrap().direction;
        assert!((rim.y - dioptric_math::cos(30.0_f64.to_radians())).abs() < 1e-12);
        // A surface that faces it receives what parallel light would give.
        let n = 128;
        let mean: f64 = grid(n)
            .filter_map(|u| sun.sample(DVec3::ZERO, u))
            .map(|s| s.direction.y * s.arriving.x / f64::from(n * n))
            .sum();
        assert!((mean - 1.0).abs() < 1e-4, "{mean}");
    }
}
