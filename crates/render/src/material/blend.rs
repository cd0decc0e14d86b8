// SPDX-License-Identifier: MIT OR Apache-2.0
//! A mixture of two materials: dusty glass, worn gilding, wet stone.

use dioptric_math::Spectrum;
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::patched::{common, part};
use super::shared::unit;
use super::{Dressed, Finish, Highlight, Interior, Material, Optics, Reflectance, Relief};
use crate::build::Builder;
use crate::input::NumberInput;
use crate::pattern::PatternPoint;

/// Some of one and some of another.
#[derive(Clone, Debug)]
pub struct Blend {
    first: Box<Dressed>,
    second: Box<Dressed>,
    amount: NumberInput,
}

static SCHEMA: Schema = Schema {
    kind: "blend",
    category: Category::Material,
    summary: "a mixture of two materials, more of the one here and of the other there",
    doc: "Answers light with `1 - amount` of `first` and `amount` of `second`, any two materials. Two that are dull\n\
          or mirror sharply are added up exactly. Of others each ray meets one, drawn by lot with these chances, so\n\
          that the mean is the mixture: with few samples that shows as grain. What bends their normals is drawn in\n\
          the same way, and added to what bends those of the whole.",
    params: &[
        Param::required("first", Type::Node(Category::Material), "What it is where `amount` is 0."),
        Param::required(
            "second",
            Type::Node(Category::Material),
            "What it is where `amount` is 1.",
        ),
        Param::new(
            "amount",
            Type::UNIT_PATTERN,
            Default::Number(0.5),
            "How much there is of the second.",
        ),
    ],
    example: "dusty = blend(mirror(), matte(\"tan\"), amount = gradient(0, 1, start = (0, 0, 0), end = (0, 2, 0)))\n\
              sphere(center = (0, 1, 0), radius = 1, material = dusty)",
};

impl Blend {
    /// What the lot of a point draws, and the point with the lot that is left.
    fn drawn(&self, point: &PatternPoint, amount: f64) -> (&Dressed, PatternPoint) {
        let (part, lot) = if point.lot < amount {
            (&self.second, point.lot / amount)
        } else {
            (&self.first, (point.lot - amount) / (1.0 - amount))
        };
        (part, PatternPoint { lot: lot.clamp(0.0, 1.0 - f64::EPSILON), ..*point })
    }
}

impl Material for Blend {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args, builder: &mut Builder) -> Result<Self, Diagnostic> {
        Ok(Self {
            first: part(args, "first", builder)?,
            second: part(args, "second", builder)?,
            amount: builder.number(args, "amount")?,
        })
    }

    fn finish(&self, point: &PatternPoint) -> Finish {
        let amount = unit(&self.amount, point);
        if amount > 0.0 && amount < 1.0 {
            let parts = [self.first.finish(point), self.second.finish(point)];
            if let Some(sum) = sum(&parts[0], &parts[1], amount) {
                return sum;
            }
        }
        let (part, point) = self.drawn(point, amount);
        part.finish(&point)
    }

    fn relief<'a>(&'a self, point: &PatternPoint, relief: &mut Relief<'a>) {
        let (part, point) = self.drawn(point, unit(&self.amount, point));
        part.relief(&point, relief);
    }

    fn is_opaque(&self) -> bool {
        self.first.is_opaque() && self.second.is_opaque()
    }

    fn may_shine(&self) -> bool {
        self.first.may_shine() || self.second.may_shine()
    }

    fn interior(&self) -> Interior {
        common(&self.first, &self.second)
    }

    fn is_by_lot(&self) -> bool {
        true
    }

    fn has_holes(&self) -> bool {
        self.first.has_holes() || self.second.has_holes()
    }
}

/// The sum of two answers where there is one that is as good as both: all their terms add up.
fn sum(a: &Finish, b: &Finish, amount: f64) -> Option<Finish> {
    let mix = |x: Spectrum, y: Spectrum| x * (1.0 - amount) + y * amount;
    let same_roughness =
        a.unevenness == b.unevenness || a.diffuse == Spectrum::ZERO || b.diffuse == Spectrum::ZERO;
    if !(a.present && b.present && same_roughness) {
        return None;
    }
    let weight = mix(mirrors(a)?, mirrors(b)?);
    Some(Finish {
        base: mix(a.base, b.base),
        ambient: mix(a.ambient, b.ambient),
        diffuse: mix(a.diffuse, b.diffuse),
        unevenness: if a.diffuse == Spectrum::ZERO { b.unevenness } else { a.unevenness },
        highlight: highlights(a.highlight, b.highlight, amount)?,
        emission: mix(a.emission, b.emission),
        present: true,
        optics: if weight == Spectrum::ZERO {
            Optics::Opaque
        } else {
            let reflect = Reflectance::constant(weight);
            Optics::Mirror { reflect, roughness: 0.0, covers: false }
        },
        shadow_pass: mix(a.shadow_pass, b.shadow_pass),
    })
}

/// How much is mirrored sharply at any angle, if that is all that there is besides the own colour.
fn mirrors(finish: &Finish) -> Option<Spectrum> {
    match finish.optics {
        Optics::Opaque => Some(Spectrum::ZERO),
        Optics::Mirror {
            reflect: Reflectance::Curve { normal, grazing },
            roughness: 0.0,
            covers: false,
        } if normal == grazing => Some(normal),
        _ => None,
    }
}

/// Of two highlights of one shape, or of one only.
fn highlights(
    a: Option<Highlight>,
    b: Option<Highlight>,
    amount: f64,
) -> Option<Option<Highlight>> {
    let scaled = |h: Highlight, share: f64| Highlight { color: h.color * share, ..h };
    match (a, b) {
        (None, None) => Some(None),
        (Some(a), None) => Some(Some(scaled(a, 1.0 - amount))),
        (None, Some(b)) => Some(Some(scaled(b, amount))),
        (Some(a), Some(b)) => {
            let color = a.color * (1.0 - amount) + b.color * amount;
            (Highlight { color: b.color, ..a } == b).then_some(Some(Highlight { color, ..a }))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::build::ColorReading;
    use crate::material::testing::point;
    use crate::setting::testing::with_node;
    use dioptric_scene::args::make_node;
    use dioptric_scene::{Description, Schema};

    fn blend(
        parts: [(&'static Schema, Vec<(&str, dioptric_scene::Value)>); 2],
        amount: f64,
    ) -> Blend {
        use dioptric_scene::Value;
        let mut scene = Description::default();
        let [a, b] =
            parts.map(|(schema, args)| Value::Node(scene.push(make_node(schema, &args).unwrap())));
        let args = [("first", a), ("second", b), ("amount", Value::Number(amount))];
        let id = scene.push(make_node(&SCHEMA, &args).unwrap());
        with_node(&scene, id, ColorReading::Raw, Blend::from_args).unwrap()
    }

    #[test]
    fn dull_ones_and_sharp_mirrors_add_up() {
        use crate::material::{matte::Matte, mirror::Mirror};
        let quarter = blend([(Matte::SCHEMA, vec![]), (Mirror::SCHEMA, vec![])], 0.25);
        let finish = quarter.finish(&point());
        assert!((finish.diffuse - Spectrum::splat(0.6)).length() < 1e-12);
        let Optics::Mirror { reflect, .. } = finish.optics else { panic!() };
        assert!((reflect.at(0.3) - Spectrum::splat(0.2375)).length() < 1e-12);
    }

    #[test]
    fn others_are_drawn_by_their_shares_and_what_is_left_of_the_lot_is_uniform() {
        use crate::material::{glass::Glass, matte::Matte};
        let mixed = blend([(Matte::SCHEMA, vec![]), (Glass::SCHEMA, vec![])], 0.3);
        for i in 0..100 {
            let lot = (f64::from(i) + 0.5) / 100.0;
            let at = PatternPoint { lot, ..point() };
            let glass = matches!(mixed.finish(&at).optics, Optics::Dielectric { .. });
            assert_eq!(glass, i < 30, "{lot}");
            let (_, left) = mixed.drawn(&at, 0.3);
            let expected = if i < 30 { lot / 0.3 } else { (lot - 0.3) / 0.7 };
            assert!((left.lot - expected).abs() < 1e-12);
        }
        assert!(mixed.is_by_lot() && !mixed.is_opaque());
    }
}
