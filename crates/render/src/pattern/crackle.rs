// SPDX-License-Identifier: MIT OR Apache-2.0
//! Cells around random points: dried mud, scales, cobbles.

use dioptric_math::random::{join, unit};
use dioptric_math::{DVec3, Spectrum};
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::place::{self, Place, blend};
use super::{Pattern, PatternPoint};
use crate::build::Builder;
use crate::input::ColorInput;

/// What is shown of the cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Shown {
    Edges,
    Distance,
    Cells,
}

/// Cellular noise.
#[derive(Clone, Debug)]
pub struct Crackle {
    low: ColorInput,
    high: ColorInput,
    shown: Shown,
    seed: u64,
    place: Place,
}

static SCHEMA: Schema = Schema {
    kind: "crackle",
    category: Category::Pattern,
    summary: "cells around random points, as in dried mud",
    doc: "Every cube of edge `size` holds one random point; F1 and F2 are the distances, in units of `size`,\n\
          to the nearest and second nearest of all points (Worley, \"A Cellular Texture Basis Function\",\n\
          SIGGRAPH 1996; one point a cube instead of a random number of them). The value, at most 1, is\n\
          F2 - F1 (`show = \"edges\"`, 0 on the borders of the cells), F1 (\"distance\", 0 at their points) or\n\
          a random number for each cell (\"cells\").",
    params: &[
        place::LOW,
        place::HIGH,
        place::FEATURE_SIZE,
        Param::new(
            "show",
            Type::Choice(&["edges", "distance", "cells"]),
            Default::Text("edges"),
            "What is shown of the cells.",
        ),
        place::SEED,
        place::OFFSET,
        place::SPACE,
    ],
    example: "sphere(center = (0, 1, 0), radius = 1, material = matte(ramp(crackle(size = 0.4), [(0, \"black\"), (0.1, \"saddlebrown\"), (1, \"tan\")])))",
};

impl Pattern for Crackle {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args, builder: &mut Builder) -> Result<Self, Diagnostic> {
        Ok(Self {
            low: builder.color(args, "low")?,
            high: builder.color(args, "high")?,
            shown: match &*args.text("show")? {
                "distance" => Shown::Distance,
                "cells" => Shown::Cells,
                _ => Shown::Edges,
            },
            seed: args.integer("seed")? as u64,
            place: Place::from_args(args)?,
        })
    }

    fn eval(&self, point: &PatternPoint) -> Spectrum {
        let near = nearest(self.place.of(point), self.seed);
        let t = match self.shown {
            Shown::Edges => near.second - near.first,
            Shown::Distance => near.first,
            Shown::Cells => unit(join(near.key, 3)),
        };
        blend(&self.low, &self.high, t, point)
    }
}

/// The two nearest points, and the key of the cube with the nearest.
#[derive(Clone, Copy, Debug)]
struct Nearest {
    first: f64,
    second: f64,
    key: u64,
}

/// The key of a cube's random numbers. Coordinates beyond any integer share a cube, where no
/// fraction is left that could tell them apart.
fn cube_key(seed: u64, cube: DVec3) -> u64 {
    let word = |x: f64| x as i64 as u64;
    join(join(join(seed, word(cube.x)), word(cube.y)), word(cube.z))
}

/// Searches the cubes up to two away. That is enough: a point within the square root of 3 of any place
/// is in its own cube, and another within that distance in the cube across the nearest face (with f
/// the distance to that face, its square is at most `(1 + f)^2 + 2 (1 - f)^2 <= 3` for f up to 1/2).
fn nearest(p: DVec3, seed: u64) -> Nearest {
    let home = p.floor();
    let f = p - home;
    let mut near = Nearest { first: f64::INFINITY, second: f64::INFINITY, key: seed };
    // The own cube and its neighbours first: their points rule out most of the outer cubes.
    for shell in [1, 2] {
        for i in -shell..=shell {
            for j in -shell..=shell {
                for k in -shell..=shell {
                    let step = DVec3::new(f64::from(i), f64::from(j), f64::from(k));
                    if shell == 2 && step.abs().max_element() < 2.0 {
                        continue;
                    }
                    // Squared distance to the cube itself.
                    let gap = (step - f).max(f - step - 1.0).max(DVec3::ZERO);
                    if gap.length_squared() > near.second {
                        continue;
                    }
                    let key = cube_key(seed, home + step);
                    let jitter =
                        DVec3::new(unit(join(key, 0)), unit(join(key, 1)), unit(join(key, 2)));
                    let d = (step + jitter - f).length_squared();
                    if d < near.first {
                        near = Nearest { first: d, second: near.first, key };
                    } else if d < near.second {
                        near.second = d;
                    }
                }
            }
        }
    }
    Nearest { first: near.first.sqrt(), second: near.second.sqrt(), key: near.key }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dioptric_math::random::Random;

    #[test]
    fn the_search_finds_what_a_wider_one_finds() {
        let mut r = Random::new(11);
        for _ in 0..300 {
            let p = DVec3::new(r.uniform(-9.0, 9.0), r.uniform(-9.0, 9.0), r.uniform(-9.0, 9.0));
            let mut distances = Vec::new();
            for i in 0..7 * 7 * 7 {
                let step = DVec3::new(f64::from(i % 7), f64::from(i / 7 % 7), f64::from(i / 49));
                let cube = p.floor() + step - 3.0;
                let key = cube_key(4, cube);
                let jitter = DVec3::from([0, 1, 2].map(|lane| unit(join(key, lane))));
                distances.push((cube + jitter - p).length());
            }
            distances.sort_by(f64::total_cmp);
            let near = nearest(p, 4);
            assert!((near.first - distances[0]).abs() < 1e-12);
            assert!((near.second - distances[1]).abs() < 1e-12);
            assert!(near.second <= 3.0_f64.sqrt());
        }
    }

    #[test]
    fn a_cell_keeps_its_number_up_to_its_border() {
        // Along a line the number changes exactly where F2 - F1 passes 0.
        let mut changes = 0;
        let mut last = nearest(DVec3::new(-5.0, 0.3, 0.7), 9);
        for i in 1..=100_000 {
            let now = nearest(DVec3::new(-5.0 + f64::from(i) * 1e-4, 0.3, 0.7), 9);
            if now.key != last.key {
                changes += 1;
                assert!(now.second - now.first < 1e-3, "{now:?}");
            }
            last = now;
        }
        assert!((5..40).contains(&changes), "{changes}");
    }

    #[test]
    fn huge_and_broken_places_have_an_answer() {
        for x in [1e18, -1e300, f64::INFINITY, f64::NAN] {
            let near = nearest(DVec3::splat(x), 1);
            assert!(near.key == near.key.wrapping_add(0) && !(near.first < 0.0));
        }
    }
}
