// SPDX-License-Identifier: MIT OR Apache-2.0
//! The registry of patterns: colours and numbers that vary over surfaces. One file and one line each.

use dioptric_math::{DVec2, DVec3, Spectrum};
use dioptric_scene::{Args, Diagnostic, Schema};

use crate::build::Builder;

pub mod add;
pub mod bricks;
pub mod checker;
pub mod crackle;
mod daylight;
pub mod distorted;
pub mod dots;
pub mod gradient;
pub mod hexagons;
pub mod image;
pub mod lattice;
mod mapping;
pub mod marble;
pub mod mix;
pub mod multiply;
pub mod noise;
mod perlin;
mod place;
pub mod ramp;
pub mod sky;
pub mod solid;
pub mod stripes;
#[cfg(test)]
pub(crate) mod testing;
pub mod transformed;
pub mod turbulence;
pub mod wood;

/// Where a pattern is asked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PatternPoint {
    /// The point in the object's own space, before its transforms.
    pub object: DVec3,
    /// The point in the space of the scene's root.
    pub world: DVec3,
    /// The surface coordinates of the shape.
    pub uv: DVec2,
    /// The unit shading normal in the object's own space, outward (mappings use it).
    pub object_normal: DVec3,
    /// The unit shading normal in the space of the scene's root, outward.
    pub world_normal: DVec3,
    /// A number in `[0, 1)` that belongs to the ray that asks: by it materials choose that are several things
    /// at once. Patterns do not look at it.
    pub lot: f64,
}

impl PatternPoint {
    /// For what asks no pattern.
    pub const NOWHERE: Self = Self {
        object: DVec3::ZERO,
        world: DVec3::ZERO,
        uv: DVec2::ZERO,
        object_normal: DVec3::Y,
        world_normal: DVec3::Y,
        lot: 0.5,
    };
}

/// The space in which a pattern lives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Space {
    /// The object's own space: the pattern moves with the object.
    Object,
    /// The space of the scene's root.
    World,
    /// Surface coordinates `(u, v, 0)`.
    Uv,
}

impl Space {
    /// The words of the `space` parameter.
    pub const NAMES: &'static [&'static str] = &["object", "world", "uv"];

    /// The space with this name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        match name {
            "object" => Some(Self::Object),
            "world" => Some(Self::World),
            "uv" => Some(Self::Uv),
            _ => None,
        }
    }

    /// The point's coordinates in this space.
    #[must_use]
    pub fn of(self, point: &PatternPoint) -> DVec3 {
        match self {
            Self::Object => point.object,
            Self::World => point.world,
            Self::Uv => point.uv.extend(0.0),
        }
    }
}

/// A pattern.
pub trait Pattern: Sized {
    /// The pattern's manual page and parameters.
    const SCHEMA: &'static Schema;

    /// Builds the pattern from checked arguments.
    ///
    /// # Errors
    /// The arguments make no pattern.
    fn from_args(args: &Args, builder: &mut Builder) -> Result<Self, Diagnostic>;

    /// The value at a point, in linear light; a number pattern gives the same in all lanes.
    fn eval(&self, point: &PatternPoint) -> Spectrum;
}

macro_rules! registry {
    ($($variant:ident($ty:ty),)*) => {
        /// Any pattern, dispatched without a virtual call.
        #[derive(Clone, Debug)]
        pub enum AnyPattern {
            $(#[doc = concat!("See [`", stringify!($ty), "`].")] $variant($ty),)*
        }

        /// The schemas of all patterns.
        pub static SCHEMAS: &[&Schema] = &[$(<$ty as Pattern>::SCHEMA,)*];

        impl AnyPattern {
            /// Builds the pattern that a node describes.
            ///
            /// # Errors
            /// The node is no pattern, or its arguments make none.
            pub fn from_args(args: &Args, builder: &mut Builder) -> Result<Self, Diagnostic> {
                let kind = args.node().schema.kind;
                $(if kind == <$ty as Pattern>::SCHEMA.kind {
                    return <$ty as Pattern>::from_args(args, builder).map(Self::$variant);
                })*
                Err(args.error_here("internal", format!("{kind} is no pattern")))
            }

            /// See [`Pattern::eval`].
            #[must_use]
            pub fn eval(&self, point: &PatternPoint) -> Spectrum {
                match self { $(Self::$variant(p) => p.eval(point),)* }
            }
        }
    };
}

registry! {
    Add(add::Add),
    Bricks(bricks::Bricks),
    Checker(checker::Checker),
    Crackle(crackle::Crackle),
    Distorted(distorted::Distorted),
    Dots(dots::Dots),
    Gradient(gradient::Gradient),
    Hexagons(hexagons::Hexagons),
    Image(image::Image),
    Lattice(lattice::Lattice),
    Marble(marble::Marble),
    Mix(mix::Mix),
    Multiply(multiply::Multiply),
    Noise(noise::Noise),
    Ramp(ramp::Ramp),
    Sky(sky::Sky),
    Solid(solid::Solid),
    Stripes(stripes::Stripes),
    Transformed(transformed::Transformed),
    Turbulence(turbulence::Turbulence),
    Wood(wood::Wood),
}

#[cfg(test)]
mod tests {
    use super::testing::{Bench, at, grey, n};
    use super::*;
    use dioptric_math::random::Random;
    use dioptric_scene::Value;
    use dioptric_scene::schema::{Default, Type};

    /// Every pattern with greys, checkers, or numbers for what must be given.
    fn all() -> Vec<(&'static str, AnyPattern)> {
        let mut patterns = Vec::new();
        for schema in SCHEMAS.iter().filter(|s| s.kind != "image") {
            let mut bench = Bench::default();
            let inner = bench.node("checker", &[("even", n(0.1)), ("odd", n(0.9))]);
            let stop = |x: f64, c: Value| Value::from_items(vec![n(x), c]);
            let stops = vec![stop(0.0, n(0.2)), stop(0.5, Value::Node(inner)), stop(1.0, n(2.0))];
            let mut args: Vec<(&str, Value)> = Vec::new();
            for param in schema.params.iter().filter(|p| p.default == Default::Required) {
                args.push((
                    param.name,
                    match param.ty {
                        Type::ColorPattern if !args.is_empty() => n(0.3),
                        Type::ColorPattern | Type::NumberPattern { .. } => Value::Node(inner),
                        Type::Node(dioptric_scene::Category::Pattern) => Value::Node(inner),
                        Type::List(&Type::Pair(..)) => Value::List(stops.clone().into()),
                        Type::List(_) => Value::List([].into()),
                        _ => n(0.5),
                    },
                ));
            }
            let id = bench.node(schema.kind, &args);
            patterns.push((schema.kind, bench.build(id).unwrap_or_else(|e| panic!("{e:?}"))));
        }
        patterns
    }

    #[test]
    fn no_pattern_gives_nan_or_a_negative_value_anywhere() {
        let special = [0.0, -0.0, 1e-300, 1e9, -1e18, 1e300, f64::MAX, f64::INFINITY, f64::NAN];
        for (kind, pattern) in all() {
            let mut r = Random::new(17);
            for i in 0..10_000 {
                let reach = if i % 2 == 0 { 3.0 } else { 1e4 };
                let mut lane = || {
                    if i % 5 == 0 {
                        special[(r.bits() % 9) as usize]
                    } else {
                        r.uniform(-reach, reach)
                    }
                };
                let point = at(lane(), lane(), lane());
                let value = pattern.eval(&point);
                assert!(
                    value.min_element() >= 0.0 && value.is_finite(),
                    "{kind} {point:?}: {value}"
                );
                assert_eq!(value, pattern.eval(&point), "{kind}");
            }
        }
    }

    #[test]
    fn patterns_live_in_the_space_that_they_name() {
        for (kind, pattern) in all() {
            // Object and world differ; what a pattern ignores must not change it.
            let mut r = Random::new(23);
            let mut changed = [false; 3];
            for _ in 0..200 {
                let mut lane = || r.uniform(-2.0, 2.0);
                let base = at(lane(), lane(), lane());
                let other = at(lane(), lane(), lane());
                for (i, point) in [
                    PatternPoint { object: other.object, ..base },
                    PatternPoint { world: other.world, ..base },
                    PatternPoint { uv: other.uv, ..base },
                ]
                .iter()
                .enumerate()
                {
                    changed[i] |= pattern.eval(point) != pattern.eval(&base);
                }
            }
            let expected = match kind {
                "solid" => [false; 3],
                "sky" => [false, true, false],
                // Its argument is a checker in object space.
                "lattice" => [true, true, false],
                _ => [true, false, false],
            };
            assert_eq!(changed, expected, "{kind}");
        }
        assert_eq!(Space::Uv.of(&at(1.0, 2.0, 3.0)), DVec3::new(1.0, 2.0, 0.0));
        assert_eq!(
            testing::pattern("solid", &[("color", n(0.5))]).eval(&at(0.0, 0.0, 0.0)),
            grey(0.5)
        );
    }
}
