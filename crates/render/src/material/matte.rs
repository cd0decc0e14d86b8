// SPDX-License-Identifier: MIT OR Apache-2.0
//! Paper, chalk, plaster: the same brightness from everywhere.

use dioptric_math::Spectrum;
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::shared::{AMBIENT, BUMP, BUMP_HEIGHT, bump, unit};
use super::{Bump, Finish, Material};
use crate::build::Builder;
use crate::input::{ColorInput, NumberInput};
use crate::pattern::PatternPoint;

/// Lambert's surface.
#[derive(Clone, Debug)]
pub struct Matte {
    color: ColorInput,
    ambient: NumberInput,
    bump: Option<Bump>,
}

static SCHEMA: Schema = Schema {
    kind: "matte",
    category: Category::Material,
    summary: "a dull surface, equally bright from everywhere",
    doc: "Reflects light by the cosine of its angle to the normal (Lambert, \"Photometria\", 1760):\n\
          `color (ambient x scene's ambient + sum of light x n.l)`.",
    params: &[
        Param::new(
            "color",
            Type::ColorPattern,
            Default::Number(0.8),
            "How much light it reflects.",
        ),
        AMBIENT,
        BUMP,
        BUMP_HEIGHT,
    ],
    example: "sphere(center = (0, 1, 0), radius = 1, material = matte(\"peru\"))",
};

impl Matte {
    /// A matte surface of one colour.
    #[must_use]
    pub const fn new(color: Spectrum) -> Self {
        Self { color: ColorInput::Constant(color), ambient: NumberInput::Constant(1.0), bump: None }
    }
}

impl Material for Matte {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args, builder: &mut Builder) -> Result<Self, Diagnostic> {
        Ok(Self {
            color: builder.color(args, "color")?,
            ambient: builder.number(args, "ambient")?,
            bump: bump(args, builder)?,
        })
    }

    fn finish(&self, point: &PatternPoint) -> Finish {
        let color = self.color.eval(point);
        Finish { ambient: color * unit(&self.ambient, point), ..Finish::matte(color) }
    }

    fn bump(&self) -> Option<&Bump> {
        self.bump.as_ref()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::testing::{build, point};
    use dioptric_math::Spectrum;
    use dioptric_scene::Value;

    #[test]
    fn the_ambient_share_leaves_the_diffuse_colour_alone() {
        let matte = build::<Matte>(&[
            ("color", Value::Vec3([0.2, 0.4, 0.8])),
            ("ambient", Value::Number(0.5)),
        ])
        .unwrap();
        let finish = matte.finish(&point());
        assert_eq!(finish.ambient, Spectrum::new(0.1, 0.2, 0.4));
        assert_eq!(finish.diffuse, Spectrum::new(0.2, 0.4, 0.8));
    }
}
