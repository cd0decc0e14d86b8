// SPDX-License-Identifier: MIT OR Apache-2.0
//! Hexagonal tiles of three colours.

use dioptric_math::{DVec3, Spectrum};
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::place::{self, Place, blend, smooth_step};
use super::{Pattern, PatternPoint};
use crate::build::Builder;
use crate::input::ColorInput;

/// Half of the square root of 3: the height of a hexagon's side above its middle, for a side of 1.
const APOTHEM: f64 = 0.866_025_403_784_438_6;

/// Six-sided columns.
#[derive(Clone, Debug)]
pub struct Hexagons {
    colors: [ColorInput; 3],
    mortar: ColorInput,
    joint: f64,
    softness: f64,
    axis: usize,
    place: Place,
}

static SCHEMA: Schema = Schema {
    kind: "hexagons",
    category: Category::Pattern,
    summary: "hexagonal tiles of three colours",
    doc: "Regular hexagons with sides of length `size` stand along `axis`; the first has its middle at\n\
          `offset` and two corners towards the second of the other two axes. No two neighbours have the\n\
          same of the three colours. The tile is found by rounding cube coordinates (Patel, \"Hexagonal\n\
          Grids\", Red Blob Games, 2013).",
    params: &[
        Param::required("first", Type::ColorPattern, "Colour of the tile in the middle."),
        Param::required("second", Type::ColorPattern, "Colour of three of its neighbours."),
        Param::required("third", Type::ColorPattern, "Colour of the other three."),
        Param::new("size", Type::Positive, Default::Number(1.0), "Length of a side."),
        Param::new(
            "axis",
            Type::Choice(&["x", "y", "z"]),
            Default::Text("y"),
            "Along which axis the tiles do not change; \"z\" for `space = \"uv\"`.",
        ),
        Param::new(
            "joint",
            Type::NON_NEGATIVE,
            Default::Number(0.0),
            "Width of the joint between tiles.",
        ),
        Param::new("mortar", Type::ColorPattern, Default::Number(0.1), "Colour of the joint."),
        Param::new(
            "softness",
            Type::NON_NEGATIVE,
            Default::Number(0.0),
            "Width of the soft edge of the tiles, as a length; 0 is sharp.",
        ),
        place::OFFSET,
        place::SPACE,
    ],
    example: "box(min = (-1.3, 0, -1.3), max = (1.3, 0.2, 1.3), material = matte(hexagons(\"wheat\", \"peru\", \"sienna\", size = 0.2, joint = 0.02)))",
};

impl Pattern for Hexagons {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args, builder: &mut Builder) -> Result<Self, Diagnostic> {
        Ok(Self {
            colors: [
                builder.color(args, "first")?,
                builder.color(args, "second")?,
                builder.color(args, "third")?,
            ],
            mortar: builder.color(args, "mortar")?,
            joint: args.number("joint")?,
            softness: args.number("softness")?,
            axis: match &*args.text("axis")? {
                "x" => 0,
                "z" => 2,
                _ => 1,
            },
            place: Place::from_args(args)?,
        })
    }

    fn eval(&self, point: &PatternPoint) -> Spectrum {
        let p = self.place.of(point);
        let (x, y) = match self.axis {
            0 => (p.y, p.z),
            1 => (p.x, p.z),
            _ => (p.x, p.y),
        };
        // Axial coordinates of the point, then of its tile.
        let (q, r) = (x / (2.0 * APOTHEM) - y / 3.0, y * 2.0 / 3.0);
        let tile = round_cube(DVec3::new(q, r, -q - r));
        let color = match (tile.x - tile.y).rem_euclid(3.0) {
            1.0 => &self.colors[1],
            2.0 => &self.colors[2],
            _ => &self.colors[0],
        };
        if self.joint == 0.0 && self.softness == 0.0 {
            return color.eval(point);
        }
        // From the tile's middle, towards the three pairs of sides.
        let (dx, dy) = (x - (tile.x + 0.5 * tile.y) * 2.0 * APOTHEM, y - tile.y * 1.5);
        let out =
            dx.abs().max((0.5 * dx + APOTHEM * dy).abs()).max((0.5 * dx - APOTHEM * dy).abs());
        let border = (APOTHEM - out) * self.place.size().x;
        blend(&self.mortar, color, smooth_step(0.5 * self.joint, self.softness, border), point)
    }
}

/// The tile nearest to cube coordinates that sum to 0: the lane that rounding moved most is worked
/// out from the other two.
fn round_cube(cube: DVec3) -> DVec3 {
    let mut tile = (cube + 0.5).floor();
    let off = (tile - cube).abs();
    if off.x > off.y && off.x > off.z {
        tile.x = -tile.y - tile.z;
    } else if off.y > off.z {
        tile.y = -tile.x - tile.z;
    }
    tile
}

#[cfg(test)]
mod tests {
    use super::APOTHEM;
    use crate::pattern::testing::{at, grey, n, pattern};
    use dioptric_math::{cos, random::Random, sin};

    fn tiles(joint: f64) -> crate::pattern::AnyPattern {
        pattern(
            "hexagons",
            &[
                ("first", n(1.0)),
                ("second", n(2.0)),
                ("third", n(3.0)),
                ("mortar", n(0.0)),
                ("joint", n(joint)),
            ],
        )
    }

    #[test]
    fn neighbours_differ_and_colours_come_equally_often() {
        let p = tiles(0.0);
        assert_eq!(p.eval(&at(0.0, 3.0, 0.0)), grey(1.0));
        let around: Vec<f64> = (0..6)
            .map(|i| {
                let a = f64::from(i) * std::f64::consts::FRAC_PI_3;
                p.eval(&at(2.0 * APOTHEM * cos(a), 0.0, 2.0 * APOTHEM * sin(a))).x
            })
            .collect();
        assert!(around.iter().all(|&c| c > 1.0), "{around:?}");
        assert!((0..6).all(|i| around[i] != around[(i + 1) % 6]), "{around:?}");
        let mut r = Random::new(1);
        let mut counts = [0; 3];
        for _ in 0..30_000 {
            let c = p.eval(&at(r.uniform(-50.0, 50.0), 0.0, r.uniform(-50.0, 50.0))).x;
            counts[c as usize - 1] += 1;
        }
        assert!(counts.iter().all(|c| (9500..10_500).contains(c)), "{counts:?}");
    }

    #[test]
    fn the_first_tile_is_a_regular_hexagon() {
        let p = tiles(0.0);
        // A corner lies at (0, 1), the middle of a side at (APOTHEM, 0).
        assert_eq!(p.eval(&at(0.0, 0.0, 0.999)), grey(1.0));
        assert_ne!(p.eval(&at(0.0, 0.0, 1.001)), grey(1.0));
        assert_eq!(p.eval(&at(APOTHEM - 0.001, 0.0, 0.0)), grey(1.0));
        assert_ne!(p.eval(&at(APOTHEM + 0.001, 0.0, 0.0)), grey(1.0));
        let joint = tiles(0.1);
        assert_eq!(joint.eval(&at(APOTHEM - 0.049, 0.0, 0.0)), grey(0.0));
        assert_eq!(joint.eval(&at(APOTHEM - 0.051, 0.0, 0.0)), grey(1.0));
    }
}
