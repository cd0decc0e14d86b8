// SPDX-License-Identifier: MIT OR Apache-2.0
//! One way in which a surface scatters light, dispatched without a virtual call.

use dioptric_math::{DVec3, Spectrum};

use super::BsdfSample;
use super::coat::{Glaze, Ground};
use super::diffuse::Lambert;
use super::frosted::Frosted;
use super::fuzz::Fuzz;
use super::glass::Glass;
use super::mirror::{Mirror, RoughMirror};
use super::pane::Pane;
use super::shares::Passing;
use super::shine::Shine;
use super::uneven::Uneven;

/// A way in which a surface scatters light, made for one direction to the viewer.
#[derive(Clone, Copy, Debug)]
pub enum Lobe {
    /// Diffuse.
    Lambert(Lambert),
    /// Diffuse, of rough facets.
    Uneven(Uneven),
    /// A highlight of Phong's or Blinn's.
    Shine(Shine),
    /// A sharp mirror.
    Mirror(Mirror),
    /// A rough mirror.
    RoughMirror(RoughMirror),
    /// The diffuse ground under a coat.
    Ground(Ground),
    /// A rough coat.
    Glaze(Glaze),
    /// Fibres that stand up.
    Fuzz(Fuzz),
    /// A smooth dielectric.
    Glass(Glass),
    /// A rough dielectric.
    Frosted(Frosted),
    /// A rough pane without thickness.
    Pane(Pane),
    /// What is seen through things that are transparent by shares.
    Passing(Passing),
}

impl Lobe {
    /// Whether it scatters to single directions only: `eval_pdf` is 0 everywhere.
    #[inline]
    pub(super) fn is_sharp(&self) -> bool {
        matches!(self, Self::Mirror(_) | Self::Glass(_) | Self::Passing(_))
    }

    /// `f |cos|`, and the density with which `sample` finds `wi`.
    #[inline]
    pub(super) fn eval_pdf(&self, wo: DVec3, wi: DVec3) -> (Spectrum, f64) {
        match self {
            Self::Lambert(lobe) => lobe.eval_pdf(wi),
            Self::Uneven(lobe) => lobe.eval_pdf(wo, wi),
            Self::Shine(lobe) => lobe.eval_pdf(wo, wi),
            Self::RoughMirror(lobe) => lobe.eval_pdf(wo, wi),
            Self::Ground(lobe) => lobe.eval_pdf(wi),
            Self::Glaze(lobe) => lobe.eval_pdf(wo, wi),
            Self::Fuzz(lobe) => lobe.eval_pdf(wo, wi),
            Self::Frosted(lobe) => lobe.eval_pdf(wo, wi),
            Self::Pane(lobe) => lobe.eval_pdf(wo, wi),
            Self::Mirror(_) | Self::Glass(_) | Self::Passing(_) => (Spectrum::ZERO, 0.0),
        }
    }

    /// A direction where light comes from, for three uniform numbers.
    #[inline]
    pub(super) fn sample(&self, wo: DVec3, pick: f64, u: [f64; 2]) -> Option<BsdfSample> {
        match self {
            Self::Lambert(lobe) => lobe.sample(u),
            Self::Uneven(lobe) => lobe.sample(wo, pick, u),
            Self::Shine(lobe) => lobe.sample(wo, u),
            Self::Mirror(lobe) => Some(lobe.sample(wo)),
            Self::RoughMirror(lobe) => lobe.sample(wo, pick, u),
            Self::Ground(lobe) => lobe.sample(u),
            Self::Glaze(lobe) => lobe.sample(wo, u),
            Self::Fuzz(lobe) => lobe.sample(wo, u),
            Self::Glass(lobe) => lobe.sample(wo, pick),
            Self::Frosted(lobe) => lobe.sample(wo, pick, u),
            Self::Pane(lobe) => lobe.sample(wo, pick, u),
            Self::Passing(lobe) => Some(lobe.sample(wo)),
        }
    }
}
