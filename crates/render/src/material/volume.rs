// SPDX-License-Identifier: MIT OR Apache-2.0
//! An inside without a surface: fog in a room, smoke, a cloud.

use dioptric_math::Spectrum;
use dioptric_scene::{Args, Category, Diagnostic, Schema};

use super::interior::{ANISOTROPY, Interior, PRIORITY, SCATTERING, Scattering};
use super::shared::{ABSORPTION, absorption};
use super::{Finish, Material, Optics};
use crate::build::Builder;
use crate::pattern::PatternPoint;

/// A medium with a border that is not seen.
#[derive(Clone, Copy, Debug)]
pub struct Volume {
    absorption: Spectrum,
    scattering: Option<Scattering>,
    priority: i32,
}

static SCHEMA: Schema = Schema {
    kind: "volume",
    category: Category::Material,
    summary: "fog, smoke, a cloud: an inside without a surface",
    doc: "Fills a solid with a medium. Its surface neither mirrors nor bends light. Paths of light are scattered inside:\n\
          after a distance d the share exp(-(scattering + absorption) d) has come straight on (Beer and Lambert).\n\
          Lamps throw shafts of light into it, and what it scatters lights other things; where\n\
          `scattering` is large against `absorption` it is white like a cloud. `scattering / (scattering + absorption)`\n\
          is its albedo, `1 / (scattering + absorption)` the way that light goes in it between two\n\
          encounters, in the mean. Other things may be inside, and reach in and out.\n\n\
          Light is turned by Henyey and Greenstein's phase function (\"Diffuse radiation in the Galaxy\", Astrophysical\n\
          Journal 93, 1941). A box or a ball of it around the whole scene, the camera inside, is a fog that ends, so that\n\
          the sky and the sun shine through; `medium(scattering = ...)` is one that never ends.\n\n\
          Whitted's pictures do not scatter: they show the absorption only, and take it for a surface that casts\n\
          the shadow of a clear thing.",
    params: &[SCATTERING, ABSORPTION, ANISOTROPY, PRIORITY],
    example: "# In Whitted's model, as here, only absorption shows; see the manual's page on paths.\n\
              sphere(center = (0, 1, 0), radius = 1, material = volume(scattering = 2, absorption = (0.2, 0.5, 0.9)))",
};

impl Material for Volume {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args, _: &mut Builder) -> Result<Self, Diagnostic> {
        Ok(Self {
            absorption: absorption(args)?,
            scattering: Scattering::from_args(args)?,
            priority: args.integer("priority")? as i32,
        })
    }

    fn finish(&self, _: &PatternPoint) -> Finish {
        Finish {
            optics: Optics::Shares {
                own: 0.0,
                ior: 1.0,
                tint: Spectrum::ONE,
                absorption: self.absorption,
            },
            shadow_pass: Spectrum::ONE,
            ..Finish::matte(Spectrum::ZERO)
        }
    }

    fn is_opaque(&self) -> bool {
        false
    }

    fn interior(&self) -> Interior {
        let Self { scattering, priority, .. } = *self;
        Interior { scattering, border: true, priority, ..Interior::PLAIN }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::testing::{build, point};
    use dioptric_scene::Value;

    #[test]
    fn it_is_all_inside() {
        let smoke = build::<Volume>(&[
            ("scattering", Value::Vec3([1.0, 0.0, 2.0])),
            ("anisotropy", Value::Number(0.7)),
        ])
        .unwrap();
        let scattering = Scattering { coefficient: Spectrum::new(1.0, 0.0, 2.0), mean_cosine: 0.7 };
        let expected = |scattering| Interior { scattering, border: true, ..Interior::PLAIN };
        assert_eq!(smoke.interior(), expected(Some(scattering)));
        assert_eq!(smoke.finish(&point()).shadow_pass, Spectrum::ONE);
        let clear = build::<Volume>(&[]).unwrap();
        assert_eq!(clear.interior(), expected(None));
    }

    #[test]
    fn light_cannot_be_scattered_less_than_not_at_all() {
        let wrong = build::<Volume>(&[("scattering", Value::Vec3([1.0, -1.0, 1.0]))]).unwrap_err();
        assert_eq!(wrong.message, "scattering of volume: expected numbers of at least 0");
    }
}
