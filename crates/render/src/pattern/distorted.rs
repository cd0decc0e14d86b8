// SPDX-License-Identifier: MIT OR Apache-2.0
//! A pattern whose lines waver.

use dioptric_math::{DVec3, Spectrum};
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::perlin::{GAIN, LACUNARITY, Octaves};
use super::place::{self, Place};
use super::{Pattern, PatternPoint, Space};
use crate::build::Builder;
use crate::input::ColorInput;

/// A pattern that is asked at points moved about by noise.
#[derive(Clone, Debug)]
pub struct Distorted {
    pattern: ColorInput,
    strength: f64,
    octaves: Octaves,
    place: Place,
    space: Space,
}

static SCHEMA: Schema = Schema {
    kind: "distorted",
    category: Category::Pattern,
    summary: "a pattern whose lines waver",
    doc: "Asks `pattern` at `p + strength N(p / size)`, where N is a vector of three noises (the domain\n\
          distortion of Ebert et al., \"Texturing and Modeling\", 3rd ed., 2003, chapter 2). The point is\n\
          moved in `space` alone, which should be the one in which the pattern lives.",
    params: &[
        Param::required("pattern", Type::ColorPattern, "The pattern."),
        Param::new(
            "strength",
            Type::NON_NEGATIVE,
            Default::Number(0.2),
            "How far points are moved at most, as a length in `space`.",
        ),
        place::FEATURE_SIZE,
        Param::new(
            "octaves",
            Type::Integer { min: 1, max: 16 },
            Default::Number(3.0),
            "How many layers of finer and finer noise move the points.",
        ),
        LACUNARITY,
        GAIN,
        place::SEED,
        place::OFFSET,
        place::SPACE,
    ],
    example: "sphere(center = (0, 1, 0), radius = 1, material = matte(distorted(stripes(\"ivory\", \"darkred\", size = 0.15), size = 0.5)))",
};

impl Pattern for Distorted {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args, builder: &mut Builder) -> Result<Self, Diagnostic> {
        Ok(Self {
            pattern: builder.color(args, "pattern")?,
            strength: args.number("strength")?,
            octaves: Octaves::from_args(args)?,
            place: Place::from_args(args)?,
            space: place::space(args)?,
        })
    }

    fn eval(&self, point: &PatternPoint) -> Spectrum {
        let p = self.place.of(point);
        // Three far places of one noise, for its whole period is random.
        let lane = |x: f64, y: f64, z: f64| self.octaves.fbm(p + DVec3::new(x, y, z));
        let push = DVec3::new(lane(0.0, 0.0, 0.0), lane(91.7, 34.3, 57.9), lane(23.1, 77.5, 119.3));
        let push = push * self.strength;
        let mut moved = *point;
        match self.space {
            Space::Object => moved.object += push,
            Space::World => moved.world += push,
            Space::Uv => moved.uv += push.truncate(),
        }
        self.pattern.eval(&moved)
    }
}

#[cfg(test)]
mod tests {
    use crate::pattern::testing::{Bench, at, n, t, v};
    use dioptric_math::random::Random;
    use dioptric_scene::Value;

    #[test]
    fn points_move_by_at_most_the_strength_and_in_one_space() {
        let mut bench = Bench::default();
        let ends = [("start", v(-9.0, 0.0, 0.0)), ("end", v(9.0, 0.0, 0.0)), ("space", t("world"))];
        let ruler = bench.node("gradient", &ends);
        let mut distorted = |strength: f64, space: &str| {
            let args = [
                ("pattern", Value::Node(ruler)),
                ("strength", n(strength)),
                ("space", t(space)),
                ("size", n(0.3)),
            ];
            let id = bench.node("distorted", &args);
            bench.build(id).unwrap()
        };
        let (world, object, still) =
            (distorted(0.5, "world"), distorted(0.5, "object"), distorted(0.0, "world"));
        let mut r = Random::new(12);
        let mut largest = 0.0_f64;
        for _ in 0..2000 {
            let p = at(r.uniform(-5.0, 5.0), r.uniform(-5.0, 5.0), r.uniform(-5.0, 5.0));
            let x = |pattern: &crate::pattern::AnyPattern| pattern.eval(&p).x * 18.0 - 9.0;
            assert!(
                (x(&object) - p.world.x).abs() < 1e-12 && (x(&still) - p.world.x).abs() < 1e-12
            );
            largest = largest.max((x(&world) - p.world.x).abs());
        }
        assert!((0.2..=0.5).contains(&largest), "{largest}");
    }
}
