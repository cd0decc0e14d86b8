// SPDX-License-Identifier: MIT OR Apache-2.0
//! Surfaces in layers. What lies below gets what the layers above leave of light on its way in, and of what it
//! sends back the same on the way out; light may go either way, and what is white loses next to nothing.
//!
//! A layer that sends back E(w) of light from w leaves `1 - max(E(wo), E(wi))` to mirrors below it, which send light
//! to where it is as steep as it came: all of it, where that is so. To a dull ground it leaves
//! `(1 - E(wo)) (1 - E(wi)) / (1 - mean of E)`, which is all at every angle (Kelemen and Szirmay-Kalos, "A Microfacet Based
//! Coupled Specular-Matte BRDF Model with Importance Sampling", Eurographics 2001 short papers, equation 6).

use dioptric_math::{DVec3, Spectrum};

use super::coat::{Coat, Glaze};
use super::diffuse::Lambert;
use super::fuzz::{Fuzz, FuzzShare};
use super::ggx::SMOOTHEST;
use super::glass::Interface;
use super::loss::Sheen;
use super::mirror::{Mirror, RoughMirror};
use super::{Bsdf, BsdfSample, Lobe, Sides};
use crate::integrator::optics::fresnel;
use crate::material::{COAT_IOR, Layers};

/// What lies over a lobe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Under {
    Nothing,
    Fuzz,
    /// Fuzz and coat.
    Coat,
    /// Fuzz, coat, and the surface of what is dull below.
    Surface,
}

/// What the layers send back, by direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cover {
    fuzz: FuzzShare,
    /// How much of it there is.
    fuzzy: f64,
    coat: Coat,
    coated: f64,
    surface: Coat,
    /// Whether the viewer is where the layers are.
    outside: bool,
    /// What fuzz, and fuzz and coat, send back to the viewer.
    to_viewer: [f64; 2],
}

impl Cover {
    /// No layers.
    pub const NONE: Self = Self {
        fuzz: FuzzShare::NONE,
        fuzzy: 0.0,
        coat: Coat::Smooth(1.0),
        coated: 0.0,
        surface: Coat::Smooth(1.0),
        outside: true,
        to_viewer: [0.0; 2],
    };

    fn new(layers: &Layers, outside: bool, wo: DVec3) -> Self {
        let mut cover = Self {
            fuzz: FuzzShare::new(layers.sheen_roughness),
            fuzzy: layers.sheen.max_element(),
            coat: coat(layers.coat_alpha, COAT_IOR),
            coated: layers.coat,
            surface: coat(layers.alpha, layers.mirror_ior()),
            outside,
            to_viewer: [0.0; 2],
        };
        cover.to_viewer = [cover.fuzz(wo.z), cover.top(wo.z)];
        cover
    }

    fn fuzz(&self, cos: f64) -> f64 {
        if self.fuzzy > 0.0 { self.fuzzy * self.fuzz.at(cos) } else { 0.0 }
    }

    fn top(&self, cos: f64) -> f64 {
        let coat = if self.coated > 0.0 { self.coated * self.coat.mirrors(cos) } else { 0.0 };
        1.0 - (1.0 - self.fuzz(cos)) * (1.0 - coat)
    }

    /// What all layers and the surface below leave of light from a direction with this cosine.
    fn left(&self, cos: f64) -> f64 {
        (1.0 - self.top(cos)) * (1.0 - self.surface.mirrors(cos))
    }

    /// The mean of that over light from everywhere.
    fn mean_left(&self) -> f64 {
        if self.fuzzy == 0.0 && self.coated == 0.0 {
            return 1.0 - self.surface.mean();
        }
        // Gauss and Legendre's rule with six points for int 2 mu left dmu, mu = x^2.
        const NODES: [(f64, f64); 6] = [
            (0.033_765_242_898_423_99, 0.085_662_246_189_585_17),
            (0.169_395_306_766_867_74, 0.180_380_786_524_069_3),
            (0.380_690_406_958_401_55, 0.233_956_967_286_345_52),
            (0.619_309_593_041_598_5, 0.233_956_967_286_345_52),
            (0.830_604_693_233_132_3, 0.180_380_786_524_069_3),
            (0.966_234_757_101_576, 0.085_662_246_189_585_17),
        ];
        NODES.iter().map(|(x, weight)| weight * 4.0 * x * x * x * self.left(x * x)).sum()
    }

    /// What is left to a lobe under layers of light from `wi`, and for mirrors of what they send to the viewer.
    #[inline]
    fn leaves(&self, under: Under, wi: DVec3) -> f64 {
        match under {
            Under::Nothing => 1.0,
            Under::Surface => self.left(wi.z),
            Under::Fuzz => 1.0 - self.to_viewer[0].max(self.fuzz(wi.z)),
            Under::Coat if self.outside && wi.z > 0.0 => {
                1.0 - self.to_viewer[1].max(self.top(wi.z))
            }
            Under::Coat if self.outside => 1.0 - self.to_viewer[1],
            Under::Coat if wi.z < 0.0 => 1.0 - self.top(-wi.z),
            Under::Coat => 1.0,
        }
    }
}

fn coat(alpha: f64, ior: f64) -> Coat {
    if alpha < SMOOTHEST { Coat::Smooth(1.0 / ior) } else { Coat::Rough(Sheen::new(alpha, ior)) }
}

/// What a coat's surface mirrors.
fn glaze(alpha: f64, ior: f64, wo: DVec3) -> Lobe {
    if alpha < SMOOTHEST {
        Lobe::Mirror(Mirror { weight: Spectrum::splat(fresnel(wo.z, 1.0 / ior)) })
    } else {
        Lobe::Glaze(Glaze::new(alpha, ior, wo))
    }
}

impl Bsdf {
    /// Becomes that of a surface in layers, whose ground has this colour.
    pub(super) fn layer(&mut self, color: Spectrum, layers: &Layers, sides: &Sides, wo: DVec3) {
        let (dull, clear) = (layers.dull(), layers.clear());
        self.cover = Cover::new(layers, sides.outside, wo);
        self.covered = true;
        if clear > 0.0 {
            let interface = Interface::new(sides, Spectrum::ONE, color);
            let lobe = Self::dielectric(interface, layers.alpha, sides, wo);
            self.place(lobe, clear, Under::Coat, interface.power());
        }
        if !sides.outside {
            // Whatever is opaque shows its back.
            let albedo = color * (1.0 - clear);
            let lobe = Lobe::Lambert(Lambert { albedo });
            self.place(lobe, 1.0, Under::Nothing, albedo.max_element());
            return;
        }
        if layers.metallic > 0.0 {
            let reflect = Layers::metal(color);
            let power = reflect.at(wo.z).max_element();
            let lobe = if layers.alpha < SMOOTHEST {
                Lobe::Mirror(Mirror { weight: reflect.at(wo.z) })
            } else {
                Lobe::RoughMirror(RoughMirror::new(layers.alpha, reflect, wo))
            };
            self.place(lobe, layers.metallic, Under::Coat, power);
        }
        if dull > 0.0 {
            let surface = self.cover.surface.mirrors(wo.z);
            let lobe = glaze(layers.alpha, layers.mirror_ior(), wo);
            self.place(lobe, dull, Under::Coat, surface);
            let left = self.cover.left(wo.z);
            let albedo = color * (left / self.cover.mean_left().max(1e-9));
            let power = color.max_element() * (1.0 - surface);
            self.place(Lobe::Lambert(Lambert { albedo }), dull, Under::Surface, power);
        }
        if layers.coat > 0.0 {
            let lobe = glaze(layers.coat_alpha, COAT_IOR, wo);
            self.place(lobe, layers.coat, Under::Fuzz, self.cover.coat.mirrors(wo.z));
        }
        if layers.sheen != Spectrum::ZERO {
            let lobe = Lobe::Fuzz(Fuzz::new(layers.sheen, layers.sheen_roughness, wo));
            self.place(lobe, 1.0, Under::Nothing, self.cover.to_viewer[0]);
        }
    }

    /// Adds a lobe with a weight, under layers.
    fn place(&mut self, lobe: Lobe, weight: f64, under: Under, power: f64) {
        let (at, seen) =
            (self.count, if under == Under::Nothing { 0.0 } else { self.cover.to_viewer[1] });
        self.add(lobe, power * weight * (1.0 - seen));
        if self.count > at {
            (self.weights[at], self.under[at]) = (weight, under);
        }
    }

    /// [`Self::eval_pdf`] of layers.
    pub(super) fn eval_pdf_in_layers(&self, wo: DVec3, wi: DVec3) -> (Spectrum, f64) {
        let mut sum = (Spectrum::ZERO, 0.0);
        for (i, lobe) in self.lobes[..self.count].iter().enumerate() {
            let (f, pdf) = lobe.eval_pdf(wo, wi);
            if pdf > 0.0 {
                sum.0 += f * (self.weights[i] * self.cover.leaves(self.under[i], wi));
                sum.1 += self.shares[i] * pdf;
            }
        }
        sum
    }

    /// [`Self::sample`] of layers.
    pub(super) fn sample_in_layers(&self, wo: DVec3, pick: f64, u: [f64; 2]) -> Option<BsdfSample> {
        let (mut lobe, mut rest) = (0, pick);
        while lobe + 1 < self.count && rest >= self.shares[lobe] {
            rest -= self.shares[lobe];
            lobe += 1;
        }
        let share = self.shares[lobe];
        let rest = (rest / share).clamp(0.0, 1.0 - f64::EPSILON);
        let sample = self.lobes[..self.count].get(lobe)?.sample(wo, rest, u)?;
        if sample.is_sharp() {
            let left = self.weights[lobe] * self.cover.leaves(self.under[lobe], sample.wi);
            return Some(BsdfSample { weight: sample.weight * (left / share), ..sample });
        }
        let (f, pdf) = self.eval_pdf_in_layers(wo, sample.wi);
        (pdf > 0.0).then(|| BsdfSample { wi: sample.wi, weight: f / pdf, pdf })
    }
}
