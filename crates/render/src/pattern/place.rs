// SPDX-License-Identifier: MIT OR Apache-2.0
//! What most patterns have in common: where their cells lie, how two colours blend, how their
//! numbers are made safe.

use dioptric_math::{DVec3, Spectrum};
use dioptric_scene::{Args, Default, Diagnostic, Param, Type};

use super::{PatternPoint, Space};
use crate::input::ColorInput;

/// The `space` parameter of patterns that move with their object.
pub(super) const SPACE: Param = Param::new(
    "space",
    Type::Choice(Space::NAMES),
    Default::Text("object"),
    "Where the pattern lives: \"object\" moves with the object, \"world\" stays, \"uv\" lies on the surface.",
);

/// The `size` parameter of patterns whose directions can be left out.
pub(super) const SIZE: Param = Param::new(
    "size",
    Type::Scale,
    Default::Number(1.0),
    "Edge lengths of a cell; 0 leaves a direction out.",
);

/// The `size` parameter of patterns that fill space evenly: noise and its relatives.
pub(super) const FEATURE_SIZE: Param = Param::new(
    "size",
    Type::Scale,
    Default::Number(1.0),
    "Size of the features; three numbers stretch them.",
);

/// The `offset` parameter.
pub(super) const OFFSET: Param =
    Param::new("offset", Type::Vec3, Default::Vec3([0.0; 3]), "Where the pattern's origin lies.");

/// The `seed` parameter of random patterns.
pub(super) const SEED: Param = Param::new(
    "seed",
    Type::Integer { min: 0, max: 9_007_199_254_740_992 },
    Default::Number(0.0),
    "Another seed, another pattern of the same kind.",
);

/// The `low` parameter of patterns that go from one colour to another.
pub(super) const LOW: Param =
    Param::new("low", Type::ColorPattern, Default::Number(0.0), "Colour where the value is 0.");

/// The `high` parameter of patterns that go from one colour to another.
pub(super) const HIGH: Param =
    Param::new("high", Type::ColorPattern, Default::Number(1.0), "Colour where the value is 1.");

/// From a point to a pattern's own coordinates: which space, where from, and in what unit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    space: Space,
    offset: DVec3,
    size: DVec3,
}

impl Place {
    /// Reads `space`, `offset` and `size`.
    pub(super) fn from_args(args: &Args) -> Result<Self, Diagnostic> {
        let size = DVec3::from(args.vec3("size")?);
        if !(size.min_element() >= 0.0 && size.max_element() > 0.0) {
            let kind = args.node().schema.kind;
            return Err(args
                .error(
                    "size",
                    "wrong-value",
                    format!("size of {kind}: expected numbers of at least 0, not all 0"),
                )
                .help("write size = 0.5, or size = (1, 2, 1)"));
        }
        Ok(Self { space: space(args)?, offset: args.vec3("offset")?.into(), size })
    }

    /// The point in units of `size`; lanes that are left out are 0.
    pub(super) fn of(&self, point: &PatternPoint) -> DVec3 {
        let p = self.space.of(point) - self.offset;
        let lane = |x: f64, size: f64| if size > 0.0 { x / size } else { 0.0 };
        DVec3::new(lane(p.x, self.size.x), lane(p.y, self.size.y), lane(p.z, self.size.z))
    }

    /// The edge lengths of a cell; 0 where a direction is left out.
    pub(super) const fn size(&self) -> DVec3 {
        self.size
    }
}

/// Reads `space`.
pub(super) fn space(args: &Args) -> Result<Space, Diagnostic> {
    Ok(Space::from_name(&args.text("space")?).unwrap_or(Space::Object))
}

/// `(1 - t) a + t b` with t taken to 0..1; NaN is 0. At the ends only one of them is asked.
pub(super) fn blend(a: &ColorInput, b: &ColorInput, t: f64, point: &PatternPoint) -> Spectrum {
    if !(t > 0.0) {
        a.eval(point)
    } else if t >= 1.0 {
        b.eval(point)
    } else {
        a.eval(point) * (1.0 - t) + b.eval(point) * t
    }
}

/// 0 up to `edge`, 1 from `edge + width` on, and a smooth curve `3 t^2 - 2 t^3` between; a width of
/// 0 makes a sharp step.
pub(super) fn smooth_step(edge: f64, width: f64, x: f64) -> f64 {
    if width > 0.0 {
        let t = ((x - edge) / width).clamp(0.0, 1.0);
        t * t * (3.0 - 2.0 * t)
    } else if x >= edge {
        1.0
    } else {
        0.0
    }
}

/// Whether a whole number is even; right for negative ones and for those beyond any integer type.
pub(super) fn is_even(index: f64) -> bool {
    index.rem_euclid(2.0) == 0.0
}
