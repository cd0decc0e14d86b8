// SPDX-License-Identifier: MIT OR Apache-2.0
//! `medium(...)`: what fills the space between things: air, water.

use dioptric_math::{Spectrum, exp};
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::root::Root;
use crate::material::{ANISOTROPY, SCATTERING, Scattering};

/// The schema of `medium`.
pub static SCHEMA: Schema = Schema {
    kind: "medium",
    category: Category::Setting,
    summary: "what fills the space between things, such as water",
    doc: "Glass bends light by the ratio of its index to that of what is around it: in water, `ior = 1.33`, a glass\n\
          ball bends little and a bubble (`glass(ior = 1)`) spreads light. With `absorption` what is seen at the\n\
          distance d is multiplied by exp(-absorption d) (Beer and Lambert); (0.45, 0.07, 0.02) is about that of\n\
          clear sea water per metre. Without this setting there is nothing: index 1, no absorption. Materials\n\
          of fixed shares (`clear`) give their index relative to what is around them, so that it does not change\n\
          them.\n\n\
          With `scattering` paths of light (`integrator = \"path\"`) see fog: lamps have halos and throw shafts. It has no end,\n\
          so that nothing of a sky or of a `directional` light comes through it: a box or a ball of `volume` around\n\
          the scene does end. Whitted's pictures do not scatter; `fog` fades there what is far.",
    params: &[
        Param::new(
            "ior",
            Type::Number { min: 0.1, max: 10.0 },
            Default::Number(1.0),
            "Index of refraction.",
        ),
        Param::new(
            "absorption",
            Type::Scale,
            Default::Number(0.0),
            "How strongly light fades, per unit of length; one number, or three for red, green and blue.",
        ),
        SCATTERING,
        ANISOTROPY,
    ],
    example: "medium(ior = 1.33, absorption = (0.16, 0.04, 0.01))\n\
              sphere(center = (0, 1, 0), radius = 1, material = glass(ior = 1))",
};

/// What fills the space between things.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surroundings {
    /// Index of refraction.
    pub ior: f64,
    /// Absorbed per unit of the file's length, per lane.
    pub absorption: Spectrum,
    /// How it scatters.
    pub scattering: Option<Scattering>,
    /// What light loses per unit of the space of rays.
    extinction: Spectrum,
}

impl Surroundings {
    /// Nothing: index 1, no absorption.
    pub const EMPTY: Self =
        Self { ior: 1.0, absorption: Spectrum::ZERO, scattering: None, extinction: Spectrum::ZERO };

    /// The medium that a node describes.
    ///
    /// # Errors
    /// An argument is wrong.
    pub fn from_args(args: &Args, root: &Root) -> Result<Self, Diagnostic> {
        let absorption = crate::material::absorption(args)?;
        Ok(Self {
            ior: args.number("ior")?,
            absorption,
            scattering: Scattering::from_args(args)?,
            extinction: absorption / root.scale(),
        })
    }

    /// The same where paths lose what is scattered, too.
    #[must_use]
    pub fn for_paths(self, root: &Root) -> Self {
        let scattered = self.scattering.map_or(Spectrum::ZERO, |s| s.coefficient);
        Self { extinction: (self.absorption + scattered) / root.scale(), ..self }
    }

    /// What light loses per unit of the space of rays.
    #[must_use]
    pub const fn extinction(&self) -> Spectrum {
        self.extinction
    }

    /// Whether all light is left after any distance.
    #[must_use]
    pub fn is_clear(&self) -> bool {
        self.extinction == Spectrum::ZERO
    }

    /// The share of light that is left after a distance in the space of rays; it may be infinite.
    #[must_use]
    pub fn transmittance(&self, distance: f64) -> Spectrum {
        if self.is_clear() {
            return Spectrum::ONE;
        }
        // A lane without absorption stays 1 at an infinite distance: 0 times infinity is no number.
        let lane = |a: f64| if a > 0.0 { exp(-a * distance) } else { 1.0 };
        Spectrum::from(self.extinction.to_array().map(lane))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::build::ColorReading;
    use crate::setting::testing::{scaled_root, with_args};
    use dioptric_scene::Value;

    #[test]
    fn light_fades_by_the_length_in_the_file() {
        for scale in [1e-6, 1.0, 1e6] {
            let arguments =
                [("ior", Value::Number(1.33)), ("absorption", Value::Vec3([0.5, 0.0, 2.0]))];
            let water = with_args(&SCHEMA, &arguments, ColorReading::Raw, |args, _| {
                Surroundings::from_args(args, &scaled_root(scale))
            })
            .unwrap();
            let left = water.transmittance(2.0 * scale);
            assert!((left.x - 0.367_879_441_171_442_33).abs() < 1e-12);
            assert_eq!(left.y, 1.0);
            assert!((left.z - 0.018_315_638_888_734_18).abs() < 1e-12);
            assert_eq!(water.transmittance(f64::INFINITY), Spectrum::Y);
        }
        assert_eq!(Surroundings::EMPTY.transmittance(f64::INFINITY), Spectrum::ONE);
    }

    #[test]
    fn light_cannot_grow() {
        let arguments = [("absorption", Value::Number(-1.0))];
        let wrong = with_args(&SCHEMA, &arguments, ColorReading::Raw, |args, _| {
            Surroundings::from_args(args, &scaled_root(1.0))
        });
        assert_eq!(
            wrong.unwrap_err().message,
            "absorption of medium: expected numbers of at least 0"
        );
    }
}
