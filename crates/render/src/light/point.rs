// SPDX-License-Identifier: MIT OR Apache-2.0
//! A light at one point, shining everywhere.

use dioptric_math::{DVec3, Spectrum};
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::{Light, LightSample};
use crate::build::Builder;
use crate::setting::root::Root;

/// A light without a size.
#[derive(Clone, Debug)]
pub struct Point {
    position: DVec3,
    color: Spectrum,
    falloff: Falloff,
}

/// How a light weakens with distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Falloff {
    /// Not at all.
    None,
    /// By the distance squared, in the root's units: 1 at distance `1 / per_unit`.
    Square {
        /// Root units per unit of ray space.
        per_unit: f64,
    },
}

impl Falloff {
    /// The words of the `falloff` parameter.
    pub const NAMES: &'static [&'static str] = &["none", "square"];

    /// The falloff with this name.
    #[must_use]
    pub fn from_name(name: &str, root: &Root) -> Self {
        if name == "square" { Self::Square { per_unit: 1.0 / root.scale() } } else { Self::None }
    }

    /// The factor at a distance in the space of rays.
    #[must_use]
    pub fn at(self, distance: f64) -> f64 {
        match self {
            Self::None => 1.0,
            Self::Square { per_unit } => 1.0 / ((distance * per_unit) * (distance * per_unit)),
        }
    }
}

static SCHEMA: Schema = Schema {
    kind: "light",
    category: Category::Light,
    summary: "a point that shines in all directions",
    doc: "Casts hard shadows. Without falloff it is as bright far away as near, as in Whitted's pictures;\n\
          `falloff = \"square\"` weakens it by the square of the distance, as nature does: `intensity` is then\n\
          what arrives at distance 1.",
    params: &[
        Param::required("position", Type::Vec3, "Where it is."),
        Param::new("intensity", Type::NON_NEGATIVE, Default::Number(1.0), "Multiplies the colour."),
        Param::new("color", Type::Color, Default::Number(1.0), "Its colour."),
        Param::new(
            "falloff",
            Type::Choice(Falloff::NAMES),
            Default::Text("none"),
            "How it weakens with distance.",
        ),
    ],
    example: "",
};

impl Light for Point {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args, builder: &mut Builder, root: &Root) -> Result<Self, Diagnostic> {
        Ok(Self {
            position: root.point(args.vec3("position")?.into()),
            color: builder.constant_color(args, "color")? * args.number("intensity")?,
            falloff: Falloff::from_name(&args.text("falloff")?, root),
        })
    }

    fn sample(&self, point: DVec3, _u: [f64; 2]) -> Option<LightSample> {
        let way = self.position - point;
        let distance = way.length();
        let direction = dioptric_math::normalize(way)?;
        Some(LightSample { direction, distance, arriving: self.color * self.falloff.at(distance) })
    }
}
