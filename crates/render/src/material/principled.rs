// SPDX-License-Identifier: MIT OR Apache-2.0
//! One material for nearly everything, by the parameters of glTF and OpenPBR.

use dioptric_math::Spectrum;
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::shared::{exponent_of, shadow_pass, unit, unit_color};
use super::{Finish, Highlight, HighlightModel, Layers, Material, Optics};
use crate::build::Builder;
use crate::input::{ColorInput, NumberInput};
use crate::pattern::PatternPoint;

/// Fuzz over a coat over metal, glass and a dull ground, in shares.
#[derive(Clone, Debug)]
pub struct Principled {
    color: ColorInput,
    metallic: NumberInput,
    roughness: NumberInput,
    ior: f64,
    specular: NumberInput,
    transmission: NumberInput,
    coat: NumberInput,
    coat_roughness: NumberInput,
    fuzz: FuzzInput,
}

/// Fuzz by its parameters.
#[derive(Clone, Debug)]
pub(super) struct FuzzInput {
    amount: NumberInput,
    color: ColorInput,
    roughness: NumberInput,
}

/// `sheen_color`.
pub(super) const SHEEN_COLOR: Param =
    Param::new("sheen_color", Type::ColorPattern, Default::Number(1.0), "Colour of the fuzz.");

impl FuzzInput {
    /// Reads `sheen`, [`SHEEN_COLOR`], and the roughness by this name.
    pub(super) fn from_args(
        args: &Args,
        roughness: &str,
        builder: &mut Builder,
    ) -> Result<Self, Diagnostic> {
        Ok(Self {
            amount: builder.number(args, "sheen")?,
            color: builder.color(args, "sheen_color")?,
            roughness: builder.number(args, roughness)?,
        })
    }

    /// Its colour and roughness at a point.
    pub(super) fn at(&self, point: &PatternPoint) -> (Spectrum, f64) {
        let color = unit_color(&self.color, point) * unit(&self.amount, point);
        (color, unit(&self.roughness, point))
    }
}

static SCHEMA: Schema = Schema {
    kind: "principled",
    category: Category::Material,
    summary: "nearly everything, by the parameters of glTF and OpenPBR",
    doc: "A surface in layers, from below: a ground that is dull, clear or metal, in shares; a clear coat; fuzz. Its\n\
          parameters are those of glTF 2.0's metallic-roughness materials (with the extensions ior, specular,\n\
          transmission, clearcoat, sheen) and, but for prefixes, of OpenPBR 1.1; `emission` and `opacity` are there as\n\
          for all materials. `roughness` is squared to get the width of facets, as both have it: 0.3 is what 0.09 is\n\
          elsewhere.\n\n\
          - Metal (`metallic` of it) mirrors `base_color`, going to white at grazing angles by Schlick's curve.\n\
          - The rest mirrors by Fresnel's equations for `ior`, `specular` times as much at a right angle. Below, it\n\
            is clear (`transmission` of it), tinting by `base_color` what enters, or dull.\n\
          - A coat of index 1.5 mirrors besides, and fuzz shines where light grazes it (Estevez and Kulla, \"Production\n\
            Friendly Microfacet Sheen BRDF\", SIGGRAPH 2017 course).\n\n\
          In paths each layer takes from what is below what it sends back itself, both ways, so that what is white\n\
          loses next to nothing and light may go either way; what facets throw at each other is kept. In Whitted's\n\
          pictures one mirrored ray stands for all that mirrors, as rough as the coat where there is much of it, and\n\
          one refracted ray for what is clear; fuzz lightens the dull colour.",
    params: &[
        Param::new(
            "base_color",
            Type::ColorPattern,
            Default::Number(0.8),
            "Colour of the ground, each lane at most 1.",
        ),
        Param::new(
            "metallic",
            Type::UNIT_PATTERN,
            Default::Number(0.0),
            "How much of it is metal: 0 or 1 for most things.",
        ),
        Param::new(
            "roughness",
            Type::UNIT_PATTERN,
            Default::Number(0.5),
            "How rough the ground is: the square root of the GGX distribution's alpha.",
        ),
        Param::new(
            "ior",
            Type::Number { min: 1.0, max: 10.0 },
            Default::Number(1.5),
            "Index of refraction of what is no metal.",
        ),
        Param::new(
            "specular",
            Type::UNIT_PATTERN,
            Default::Number(1.0),
            "Multiplies what that mirrors at a right angle.",
        ),
        Param::new(
            "transmission",
            Type::UNIT_PATTERN,
            Default::Number(0.0),
            "How much of what is no metal is clear.",
        ),
        Param::new(
            "coat",
            Type::UNIT_PATTERN,
            Default::Number(0.0),
            "How much of a clear coat there is.",
        ),
        Param::new(
            "coat_roughness",
            Type::UNIT_PATTERN,
            Default::Number(0.0),
            "How rough the coat is, in the same way.",
        ),
        Param::new("sheen", Type::UNIT_PATTERN, Default::Number(0.0), "How much fuzz there is."),
        SHEEN_COLOR,
        Param::new(
            "sheen_roughness",
            Type::UNIT_PATTERN,
            Default::Number(0.3),
            "How far from upright its fibres stand: the wider, the less it shines at the rim only.",
        ),
    ],
    example: "sphere(center = (-1.1, 0.8, 0), radius = 0.8,\n       \
              material = principled(\"firebrick\", roughness = 0.6, coat = 1))\n\
              sphere(center = (1.1, 0.8, 0), radius = 0.8,\n       \
              material = principled(\"goldenrod\", metallic = 1, roughness = 0.35))",
};

impl Material for Principled {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args, builder: &mut Builder) -> Result<Self, Diagnostic> {
        Ok(Self {
            color: builder.color(args, "base_color")?,
            metallic: builder.number(args, "metallic")?,
            roughness: builder.number(args, "roughness")?,
            ior: args.number("ior")?,
            specular: builder.number(args, "specular")?,
            transmission: builder.number(args, "transmission")?,
            coat: builder.number(args, "coat")?,
            coat_roughness: builder.number(args, "coat_roughness")?,
            fuzz: FuzzInput::from_args(args, "sheen_roughness", builder)?,
        })
    }

    fn finish(&self, point: &PatternPoint) -> Finish {
        let color = unit_color(&self.color, point);
        let squared = |input| {
            let r = unit(input, point);
            r * r
        };
        let (sheen, sheen_roughness) = self.fuzz.at(point);
        layered(
            color,
            Layers {
                ior: self.ior,
                specular: unit(&self.specular, point),
                metallic: unit(&self.metallic, point),
                alpha: squared(&self.roughness),
                transmission: unit(&self.transmission, point),
                coat: unit(&self.coat, point),
                coat_alpha: squared(&self.coat_roughness),
                sheen,
                sheen_roughness,
            },
        )
    }

    fn is_opaque(&self) -> bool {
        self.transmission.is_zero()
    }
}

/// How strong the highlight is that stands for the mirror image of a light, as of `metal` and `plastic`.
const GLINT: f64 = 0.5;

/// The answer of a surface in layers.
pub(super) fn layered(color: Spectrum, layers: Layers) -> Finish {
    let own = layers.fuzzy(color) * layers.dull();
    let mirrors = Spectrum::splat(layers.specular.max(layers.coat));
    let glint = (color * layers.metallic + mirrors * (1.0 - layers.metallic)) * GLINT;
    let highlight = (glint != Spectrum::ZERO).then(|| Highlight {
        model: HighlightModel::Blinn,
        color: glint,
        exponent: exponent_of(layers.mirror_alpha()),
        image: true,
    });
    let root = (layers.ior - 1.0) / (layers.ior + 1.0);
    let through = 1.0 - root * root; // one surface, at a right angle
    Finish {
        base: color,
        ambient: own,
        diffuse: own,
        highlight,
        optics: Optics::Layered(layers),
        shadow_pass: shadow_pass(None, color, layers.clear() * through * through),
        ..Finish::matte(Spectrum::ZERO)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::testing::{build, point};
    use dioptric_scene::Value;

    fn layers(arguments: &[(&str, Value)]) -> (Layers, Finish) {
        let finish = build::<Principled>(arguments).unwrap().finish(&point());
        let Optics::Layered(layers) = finish.optics else { panic!() };
        (layers, finish)
    }

    #[test]
    fn roughness_is_squared_and_shares_are_kept() {
        let (rough, _) = layers(&[("roughness", Value::Number(0.3)), ("coat", Value::Number(0.5))]);
        assert!((rough.alpha - 0.09).abs() < 1e-12 && rough.coat == 0.5);
        let (metal, finish) = layers(&[("metallic", Value::Number(1.0))]);
        assert_eq!((metal.dull(), metal.clear()), (0.0, 0.0));
        assert_eq!((finish.diffuse, finish.shadow_pass), (Spectrum::ZERO, Spectrum::ZERO));
        let (glass, finish) = layers(&[
            ("base_color", Value::Vec3([1.0, 0.5, 0.0])),
            ("transmission", Value::Number(1.0)),
        ]);
        assert_eq!((glass.dull(), glass.clear()), (0.0, 1.0));
        assert!((finish.shadow_pass - Spectrum::new(0.9216, 0.4608, 0.0)).length() < 1e-12);
    }

    #[test]
    fn fuzz_lightens_what_is_dull() {
        let (_, bare) = layers(&[("base_color", Value::Number(0.2))]);
        let (_, fuzzy) =
            layers(&[("base_color", Value::Number(0.2)), ("sheen", Value::Number(1.0))]);
        assert!(fuzzy.diffuse.x > bare.diffuse.x && fuzzy.diffuse.x < 1.0);
    }
}
