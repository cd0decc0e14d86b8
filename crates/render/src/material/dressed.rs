// SPDX-License-Identifier: MIT OR Apache-2.0
//! What every material may have besides its own answer: light of its own, holes, and what bends its normals.

use dioptric_math::Spectrum;
use dioptric_scene::{Args, Diagnostic};

use super::shared::unit;
use super::{AnyMaterial, Finish, Interior};
use crate::build::Builder;
use crate::input::{ColorInput, NumberInput};
use crate::pattern::PatternPoint;

/// A material with what is common to all of them.
#[derive(Clone, Debug)]
pub struct Dressed {
    material: AnyMaterial,
    /// Light of its own besides that of the material.
    emission: ColorInput,
    strength: f64,
    /// The chance to be there.
    opacity: NumberInput,
    bump: Option<Bump>,
    normal_map: Option<NormalMap>,
}

/// A bump map: the surface is displaced along its normal by `height`, in object units; only the
/// shading normal changes.
#[derive(Clone, Debug)]
pub struct Bump {
    /// The height.
    pub height: NumberInput,
    /// Multiplies the height.
    pub scale: f64,
}

/// A map of normals in the directions of u, of v and of the surface's own normal, lanes from 0 to 1 for -1 to 1.
#[derive(Clone, Debug)]
pub struct NormalMap {
    /// The lanes.
    pub lanes: ColorInput,
    /// Multiplies the parts along u and v.
    pub strength: f64,
}

/// What bends the normal at a point: heights that add up, and the outermost map of normals.
#[derive(Clone, Debug, Default)]
pub struct Relief<'a> {
    /// The heights.
    pub bumps: Vec<&'a Bump>,
    /// The normals.
    pub normals: Option<&'a NormalMap>,
}

impl Relief<'_> {
    /// Whether nothing bends.
    #[must_use]
    pub fn is_flat(&self) -> bool {
        self.bumps.is_empty() && self.normals.is_none()
    }
}

impl From<AnyMaterial> for Dressed {
    fn from(material: AnyMaterial) -> Self {
        Self {
            material,
            emission: ColorInput::Constant(Spectrum::ZERO),
            strength: 1.0,
            opacity: NumberInput::Constant(1.0),
            bump: None,
            normal_map: None,
        }
    }
}

impl Dressed {
    /// The material that a node describes.
    ///
    /// # Errors
    /// The node is no material, or its arguments make none.
    pub fn from_args(args: &Args, builder: &mut Builder) -> Result<Self, Diagnostic> {
        Ok(Self {
            material: AnyMaterial::from_args(args, builder)?,
            emission: builder.color(args, "emission")?,
            strength: args.number("emission_strength")?,
            opacity: builder.number(args, "opacity")?,
            bump: bump(args, builder)?,
            normal_map: normal_map(args, builder)?,
        })
    }

    /// Whether everything that it has of these is what it has without a word.
    fn is_plain(&self) -> bool {
        matches!(self.opacity, NumberInput::Constant(1.0)) && !self.emits()
    }

    fn emits(&self) -> bool {
        let black = matches!(self.emission, ColorInput::Constant(Spectrum::ZERO));
        !black && self.strength > 0.0
    }

    /// The answer at a point.
    #[must_use]
    pub fn finish(&self, point: &PatternPoint) -> Finish {
        if self.is_plain() {
            return self.material.finish(point);
        }
        let opacity = unit(&self.opacity, point);
        if point.lot >= opacity {
            return Finish::HOLE;
        }
        let mut finish = self.material.finish(&PatternPoint { lot: point.lot / opacity, ..*point });
        if finish.present {
            finish.emission += self.emission.eval(point) * self.strength;
        }
        finish
    }

    /// Adds what bends the normal at a point.
    pub fn relief<'a>(&'a self, point: &PatternPoint, relief: &mut Relief<'a>) {
        relief.bumps.extend(&self.bump);
        relief.normals = relief.normals.or(self.normal_map.as_ref());
        let lot = if self.is_plain() {
            point.lot
        } else {
            (point.lot / unit(&self.opacity, point)).min(1.0 - f64::EPSILON)
        };
        self.material.relief(&PatternPoint { lot, ..*point }, relief);
    }

    /// See [`super::Material::is_opaque`].
    #[must_use]
    pub fn is_opaque(&self) -> bool {
        self.material.is_opaque() && !self.has_holes()
    }

    /// See [`super::Material::may_shine`].
    #[must_use]
    pub fn may_shine(&self) -> bool {
        self.material.may_shine() || self.emits()
    }

    /// See [`super::Material::interior`].
    #[must_use]
    pub fn interior(&self) -> Interior {
        self.material.interior()
    }

    /// See [`super::Material::is_by_lot`].
    #[must_use]
    pub fn is_by_lot(&self) -> bool {
        // A constant 0 is a hole everywhere.
        let sure = |x: f64| x == 1.0 || x == 0.0;
        let lot = !matches!(self.opacity, NumberInput::Constant(x) if sure(x));
        lot || self.material.is_by_lot()
    }

    /// See [`super::Material::has_holes`].
    #[must_use]
    pub fn has_holes(&self) -> bool {
        !matches!(self.opacity, NumberInput::Constant(1.0)) || self.material.has_holes()
    }
}

/// A constant height changes nothing.
fn bump(args: &Args, builder: &mut Builder) -> Result<Option<Bump>, Diagnostic> {
    if !args.is_written("bump") {
        return Ok(None);
    }
    let height = builder.number(args, "bump")?;
    let scale = args.number("bump_height")?;
    let flat = matches!(height, NumberInput::Constant(_)) || scale == 0.0;
    Ok((!flat).then_some(Bump { height, scale }))
}

fn normal_map(args: &Args, builder: &mut Builder) -> Result<Option<NormalMap>, Diagnostic> {
    if !args.is_written("normal_map") {
        return Ok(None);
    }
    let lanes = builder.data(args, "normal_map")?;
    if matches!(lanes, ColorInput::Constant(_)) {
        return Err(args
            .error("normal_map", "wrong-value", "normal_map: one colour bends nothing")
            .help("write a pattern, such as image(\"normals.png\")"));
    }
    Ok(Some(NormalMap { lanes, strength: args.number("normal_strength")? }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::build::ColorReading;
    use crate::material::Material;
    use crate::material::matte::Matte;
    use crate::material::testing::point;
    use crate::setting::testing::with_args;
    use dioptric_scene::Value;

    fn dressed(arguments: &[(&str, Value)]) -> Result<Dressed, Diagnostic> {
        with_args(Matte::SCHEMA, arguments, ColorReading::Raw, Dressed::from_args)
    }

    #[test]
    fn it_shines_besides_what_it_reflects() {
        let lamp = dressed(&[
            ("emission", Value::Vec3([1.0, 0.5, 0.0])),
            ("emission_strength", Value::Number(4.0)),
        ]);
        let lamp = lamp.unwrap();
        let finish = lamp.finish(&point());
        assert_eq!(finish.emission, Spectrum::new(4.0, 2.0, 0.0));
        assert_eq!(finish.diffuse, Spectrum::splat(0.8));
        assert!(lamp.may_shine() && !lamp.is_by_lot() && lamp.is_opaque());
        assert!(!dressed(&[]).unwrap().may_shine());
    }

    #[test]
    fn it_is_there_by_its_chance() {
        let half = dressed(&[("opacity", Value::Number(0.25))]).unwrap();
        assert!(half.is_by_lot() && half.has_holes() && !half.is_opaque());
        for i in 0..100 {
            let lot = f64::from(i) / 100.0;
            let finish = half.finish(&PatternPoint { lot, ..point() });
            assert_eq!(finish.present, i < 25, "{lot}");
            assert_eq!(finish.shadow_pass == Spectrum::ONE, i >= 25, "{lot}");
        }
        let gone = dressed(&[("opacity", Value::Number(0.0))]).unwrap();
        assert!(!gone.is_by_lot() && gone.has_holes() && !gone.finish(&point()).present);
        assert!(!dressed(&[]).unwrap().has_holes());
    }

    #[test]
    fn one_colour_is_no_map_of_normals() {
        let why = dressed(&[("normal_map", Value::Vec3([0.5, 0.5, 1.0]))]).unwrap_err();
        assert_eq!(why.message, "normal_map: one colour bends nothing");
    }
}
