// SPDX-License-Identifier: MIT OR Apache-2.0
//! What the inside of a thing does to the light that goes through it, besides absorbing it.

use dioptric_math::Spectrum;
use dioptric_scene::{Args, Default, Diagnostic, Param, Type};

use super::shared::coefficients;
use crate::wavelength::Cauchy;

/// `scattering`.
pub(crate) const SCATTERING: Param = Param::new(
    "scattering",
    Type::Scale,
    Default::Number(0.0),
    "How much light is scattered inside, per unit of length, by paths of light: after a distance d the share \
     exp(-scattering d) has not been. One number, or three for red, green and blue.",
);

/// `anisotropy`.
pub(crate) const ANISOTROPY: Param = Param::new(
    "anisotropy",
    Type::Number { min: -0.999, max: 0.999 },
    Default::Number(0.0),
    "Where it is scattered to, as the mean cosine of the angle by which it is turned (Henyey and Greenstein's g): \
     0 all round, towards 1 ahead, as haze and milk do, below 0 back.",
);

/// `priority`.
pub(crate) const PRIORITY: Param = Param::new(
    "priority",
    Type::Integer { min: -1_000_000, max: 1_000_000 },
    Default::Number(0.0),
    "Where it overlaps with others, the inside of the highest priority is there; among equal ones, of the one that \
     light entered last.",
);

/// A medium that scatters, the same everywhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scattering {
    /// What is scattered per unit of the file's length, per lane; not 0.
    pub coefficient: Spectrum,
    /// The mean cosine of the angle by which it is turned.
    pub mean_cosine: f64,
}

impl Scattering {
    /// Reads [`SCATTERING`] and [`ANISOTROPY`]; nothing where nothing is scattered.
    ///
    /// # Errors
    /// A coefficient is negative.
    pub(crate) fn from_args(args: &Args) -> Result<Option<Self>, Diagnostic> {
        let coefficient = coefficients(args, "scattering", "is scattered")?;
        let mean_cosine = args.number("anisotropy")?;
        Ok((coefficient != Spectrum::ZERO).then_some(Self { coefficient, mean_cosine }))
    }
}

/// The inside of a material: the same at all its points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interior {
    /// How it scatters.
    pub scattering: Option<Scattering>,
    /// Whether its surface does nothing at all: only the inside is there.
    pub border: bool,
    /// How its index of refraction depends on the wavelength.
    pub dispersion: Option<Cauchy>,
    /// Of things that overlap, whose inside is there.
    pub priority: i32,
}

impl Interior {
    /// Of things whose surface is all that counts, and of clear ones.
    pub const PLAIN: Self = Self { scattering: None, border: false, dispersion: None, priority: 0 };
}
