// SPDX-License-Identifier: MIT OR Apache-2.0
//! How surfaces scatter light, for paths: what [`crate::material::Finish`] means there.
//!
//! A [`Bsdf`] is a sum of [`Lobe`]s in the frame of a point: z is the shading normal on the side from which the
//! viewer looks, so `wo.z > 0`; `wi` goes towards the light, and through the surface where `wi.z < 0`. All
//! vectors have unit length. `eval` has the cosine in it: it is `f(wo, wi) |cos|`.
//! Densities are over solid angles.
//!
//! Names and order of arguments: `eval(wo, wi)`, `pdf(wo, wi)`, `sample(wo, pick, u)`. `wo` is always the direction
//! for which the Bsdf was made: what depends on it alone is worked out once. It may lie within the surface, or below
//! it by what rounding does.
//!
//! Ambient light and [`crate::material::Highlight`]s that stand for mirror images have no meaning here: paths
//! find what they stand for.

use dioptric_math::{DVec3, Spectrum};

use crate::integrator::optics::fresnel;
use crate::material::{Finish, Optics, Reflectance};
use coat::{Coat, Glaze, Ground};
use diffuse::Lambert;
use frosted::Frosted;
use ggx::SMOOTHEST;
use glass::{Glass, Interface};
use layered::{Cover, Under};
use loss::Sheen;
use mirror::{Mirror, RoughMirror};
use pane::Pane;
use shares::Passing;
use shine::Shine;
use uneven::Uneven;

#[cfg(test)]
mod battery;
mod coat;
mod diffuse;
mod frosted;
mod fuzz;
mod ggx;
mod glass;
mod layered;
mod lobe;
mod loss;
mod mirror;
mod often;
mod pane;
mod shares;
mod shine;
#[cfg(test)]
mod testing;
mod uneven;

pub(crate) use diffuse::{cosine_pdf, raised_disc};
pub(crate) use fuzz::FuzzShare;
pub(crate) use ggx::image;
pub use lobe::Lobe;

/// The sides of a surface, as a path meets it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sides {
    /// Index of refraction on the viewer's side over that on the other.
    pub eta: f64,
    /// Whether the viewer is outside of a solid, or the surface has no inside.
    pub outside: bool,
    /// Whether the object has an inside.
    pub solid: bool,
}

/// A direction that a surface scatters to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsdfSample {
    /// Where the light comes from; through the surface where its z is negative.
    pub wi: DVec3,
    /// `f |cos| / pdf` of all lobes together; of the one direction for a sharp lobe.
    pub weight: Spectrum,
    /// The density of all lobes together; infinite where the lobe is sharp (a mirror, smooth glass).
    pub pdf: f64,
}

impl BsdfSample {
    /// The only direction of its kind.
    const fn sharp(wi: DVec3, weight: Spectrum) -> Self {
        Self { wi, weight, pdf: f64::INFINITY }
    }

    /// Whether nothing but this lobe could have found the direction.
    #[must_use]
    pub fn is_sharp(&self) -> bool {
        self.pdf == f64::INFINITY
    }
}

/// Whether a surface of this roughness sends light to single directions.
pub(crate) fn is_smooth(roughness: f64) -> bool {
    roughness < SMOOTHEST
}

/// How many lobes a surface may have.
const MOST: usize = 6;

/// How a point scatters light: a sum of lobes, one of which is picked in proportion to what it sends to the viewer.
#[derive(Clone, Copy, Debug)]
pub struct Bsdf {
    lobes: [Lobe; MOST],
    /// The chance of each.
    shares: [f64; MOST],
    count: usize,
    /// Whether it has layers: then each lobe has a weight and lies under some of them.
    covered: bool,
    weights: [f64; MOST],
    under: [Under; MOST],
    cover: Cover,
}

/// A lobe that is not there.
const NO_LOBE: Lobe = Lobe::Lambert(Lambert { albedo: Spectrum::ZERO });

impl Bsdf {
    /// Scatters nothing.
    pub const BLACK: Self = Self {
        lobes: [NO_LOBE; MOST],
        shares: [1.0; MOST],
        count: 0,
        covered: false,
        weights: [1.0; MOST],
        under: [Under::Nothing; MOST],
        cover: Cover::NONE,
    };

    /// How a surface scatters light to a viewer in the direction `wo`.
    #[must_use]
    pub fn new(finish: &Finish, sides: &Sides, wo: DVec3) -> Self {
        let mut bsdf = Self::BLACK;
        bsdf.set(finish, sides, wo);
        bsdf
    }

    /// Becomes another one. (In place: lobes are large, and paths need one at every surface.)
    pub fn set(&mut self, finish: &Finish, sides: &Sides, wo: DVec3) {
        (self.count, self.covered) = (0, false);
        match finish.optics {
            Optics::Opaque => self.lit(finish, 1.0, wo),
            Optics::Mirror { reflect, roughness, covers: false } => {
                self.lit(finish, 1.0, wo);
                self.mirror(roughness, reflect, wo);
            }
            Optics::Mirror { reflect, roughness, covers: true } => {
                self.coated(finish.diffuse, reflect.at(1.0).max_element(), roughness, wo);
            }
            Optics::Shares { own, ior, tint, .. } => {
                let eta = match (sides.solid, sides.outside) {
                    (false, _) => 1.0,
                    (true, true) => 1.0 / ior,
                    (true, false) => ior,
                };
                let weight = if sides.outside {
                    self.lit(finish, own, wo);
                    tint * (1.0 - own)
                } else {
                    Spectrum::ONE
                };
                self.add(Lobe::Passing(Passing { eta, weight }), weight.max_element());
            }
            Optics::Dielectric { reflect, transmit, roughness, .. } => {
                let interface = Interface::new(sides, reflect, transmit);
                self.add(Self::dielectric(interface, roughness, sides, wo), interface.power());
            }
            Optics::Layered(layers) => self.layer(finish.base, &layers, sides, wo),
        }
        self.share_out();
    }

    fn dielectric(interface: Interface, alpha: f64, sides: &Sides, wo: DVec3) -> Lobe {
        // Facets between equal media bend nothing.
        match () {
            () if alpha < SMOOTHEST || (sides.eta - 1.0).abs() < 1e-6 => {
                Lobe::Glass(Glass { interface })
            }
            () if sides.solid => Lobe::Frosted(Frosted::new(interface, alpha, wo)),
            () => Lobe::Pane(Pane::new(interface, alpha, wo)),
        }
    }

    /// The light that a surface scatters by itself, times `share`.
    fn lit(&mut self, finish: &Finish, share: f64, wo: DVec3) {
        let albedo = finish.diffuse * share;
        if finish.unevenness > 0.0 {
            let lobe = Uneven::new(albedo, finish.unevenness, wo);
            self.add(Lobe::Uneven(lobe), albedo.max_element());
        } else {
            self.add(Lobe::Lambert(Lambert { albedo }), albedo.max_element());
        }
        if let Some(mut highlight) = finish.highlight.filter(|h| !h.image) {
            highlight.color *= share;
            let lobe = Shine { highlight };
            let power = lobe.power(wo);
            self.add(Lobe::Shine(lobe), power);
        }
    }

    fn mirror(&mut self, alpha: f64, reflect: Reflectance, wo: DVec3) {
        if alpha < SMOOTHEST {
            let weight = reflect.at(wo.z);
            self.add(Lobe::Mirror(Mirror { weight }), weight.max_element());
        } else {
            let lobe = RoughMirror::new(alpha, reflect, wo);
            let power = lobe.power(wo);
            self.add(Lobe::RoughMirror(lobe), power);
        }
    }

    fn coated(&mut self, albedo: Spectrum, reflectance: f64, alpha: f64, wo: DVec3) {
        let ior = coat::index(reflectance);
        let (coat, mirror) = if alpha < SMOOTHEST {
            let weight = Spectrum::splat(fresnel(wo.z, 1.0 / ior));
            (Coat::Smooth(1.0 / ior), Lobe::Mirror(Mirror { weight }))
        } else {
            (Coat::Rough(Sheen::new(alpha, ior)), Lobe::Glaze(Glaze::new(alpha, ior, wo)))
        };
        let ground = Ground::new(albedo, ior, coat, wo);
        self.add(Lobe::Ground(ground), ground.power());
        self.add(mirror, coat.mirrors(wo.z));
    }

    /// Adds a lobe that sends about `power` to the viewer of light from everywhere; none that sends nothing.
    #[inline]
    fn add(&mut self, lobe: Lobe, power: f64) {
        if power > 0.0 && self.count < MOST {
            self.lobes[self.count] = lobe;
            self.shares[self.count] = power;
            self.count += 1;
        }
    }

    /// Makes chances of powers.
    #[inline]
    fn share_out(&mut self) {
        if self.count < 2 {
            self.shares[0] = 1.0;
            return;
        }
        let shares = &mut self.shares[..self.count];
        let sum: f64 = shares.iter().sum();
        let even = 1.0 / shares.len() as f64;
        for share in shares {
            *share = if sum < f64::INFINITY { *share / sum } else { even };
        }
    }

    /// Whether it scatters to single directions only, or not at all: no light that is looked for can be seen in it.
    #[inline]
    #[must_use]
    pub fn is_sharp(&self) -> bool {
        self.lobes[..self.count].iter().all(Lobe::is_sharp)
    }

    /// Whether it scatters light from the far side in more than single directions: frosted glass.
    #[inline]
    #[must_use]
    pub fn is_translucent(&self) -> bool {
        self.lobes[..self.count].iter().any(|lobe| matches!(lobe, Lobe::Frosted(_)))
    }

    /// Whether it scatters nothing.
    #[inline]
    #[must_use]
    pub const fn is_black(&self) -> bool {
        self.count == 0
    }

    /// `f(wo, wi) |cos|`, without what goes to single directions.
    #[inline]
    #[must_use]
    pub fn eval(&self, wo: DVec3, wi: DVec3) -> Spectrum {
        self.eval_pdf(wo, wi).0
    }

    /// The density with which [`Self::sample`] finds `wi`, without what goes to single directions.
    #[inline]
    #[must_use]
    pub fn pdf(&self, wo: DVec3, wi: DVec3) -> f64 {
        self.eval_pdf(wo, wi).1
    }

    /// [`Self::eval`] and [`Self::pdf`]: together they cost little more than one.
    #[inline]
    #[must_use]
    pub fn eval_pdf(&self, wo: DVec3, wi: DVec3) -> (Spectrum, f64) {
        if self.covered {
            return self.eval_pdf_in_layers(wo, wi);
        }
        if self.count == 1 {
            return self.lobes[0].eval_pdf(wo, wi);
        }
        let mut sum = (Spectrum::ZERO, 0.0);
        for (lobe, share) in self.lobes[..self.count].iter().zip(&self.shares) {
            let (f, pdf) = lobe.eval_pdf(wo, wi);
            sum.0 += f;
            sum.1 += share * pdf;
        }
        sum
    }

    /// A direction where light comes from: `pick` chooses a lobe and `u` the direction in it, all in `[0, 1)`.
    /// `None` where light is lost.
    #[inline]
    #[must_use]
    pub fn sample(&self, wo: DVec3, pick: f64, u: [f64; 2]) -> Option<BsdfSample> {
        if self.covered {
            return self.sample_in_layers(wo, pick, u);
        }
        if self.count < 2 {
            return if self.count == 1 { self.lobes[0].sample(wo, pick, u) } else { None };
        }
        let (mut lobe, mut rest) = (0, pick);
        while lobe + 1 < self.count && rest >= self.shares[lobe] {
            rest -= self.shares[lobe];
            lobe += 1;
        }
        let share = self.shares[lobe];
        let rest = (rest / share).clamp(0.0, 1.0 - f64::EPSILON);
        let sample = self.lobes[lobe].sample(wo, rest, u)?;
        if sample.is_sharp() {
            return Some(BsdfSample { weight: sample.weight / share, ..sample });
        }
        let (f, pdf) = self.eval_pdf(wo, sample.wi);
        (pdf > 0.0).then(|| BsdfSample { wi: sample.wi, weight: f / pdf, pdf })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::{Highlight, HighlightModel};

    const OUTSIDE: Sides = Sides { eta: 1.0, outside: true, solid: true };

    fn glossy(image: bool) -> Finish {
        let model = HighlightModel::Blinn;
        let highlight = Highlight { model, color: Spectrum::ONE, exponent: 20.0, image };
        Finish { highlight: Some(highlight), ..Finish::matte(Spectrum::splat(0.5)) }
    }

    #[test]
    fn what_gives_nothing_is_no_lobe() {
        let black = Bsdf::new(&Finish::matte(Spectrum::ZERO), &OUTSIDE, DVec3::Z);
        assert!(black.is_black() && black.is_sharp());
        assert_eq!(black.sample(DVec3::Z, 0.5, [0.5; 2]), None);
        assert_eq!(black.eval_pdf(DVec3::Z, DVec3::Z), (Spectrum::ZERO, 0.0));
        assert_eq!(Bsdf::new(&glossy(false), &OUTSIDE, DVec3::Z).count, 2);
        // A highlight that stands for a mirror image is found by mirroring.
        let mirrored = Bsdf::new(&glossy(true), &OUTSIDE, DVec3::Z);
        assert!(matches!(mirrored.lobes[..mirrored.count], [Lobe::Lambert(_)]));
    }

    #[test]
    fn things_transparent_by_shares_have_their_own_share_outside_only() {
        let optics = Optics::Shares {
            own: 0.25,
            ior: 1.5,
            tint: Spectrum::new(1.0, 0.5, 0.0),
            absorption: Spectrum::ZERO,
        };
        let clear = Finish { optics, ..glossy(false) };
        let wo = DVec3::new(0.6, 0.0, 0.8);
        let bsdf = Bsdf::new(&clear, &OUTSIDE, wo);
        assert_eq!(bsdf.count, 3);
        let on = bsdf.sample(wo, 0.999, [0.5; 2]).unwrap();
        assert!(on.is_sharp() && (on.wi.x + 0.4).abs() < 1e-12);
        let expected = Spectrum::new(0.75, 0.375, 0.0) / bsdf.shares[2];
        assert!((on.weight - expected).length() < 1e-12);
        let lambert = Finish { highlight: None, ..Finish::matte(Spectrum::splat(0.125)) };
        let (f, _) = Bsdf::new(&lambert, &OUTSIDE, wo).eval_pdf(wo, DVec3::Z);
        let sum = bsdf.eval(wo, DVec3::Z);
        assert!(sum.x > f.x && sum.x - f.x < 0.25 / 3.0);
        let inside = Bsdf::new(&clear, &Sides { outside: false, ..OUTSIDE }, DVec3::Z);
        assert!(inside.is_sharp() && inside.count == 1);
        assert_eq!(inside.sample(DVec3::Z, 0.2, [0.5; 2]).unwrap().weight, Spectrum::ONE);
        // A pane has two outsides and does not bend.
        let pane = Bsdf::new(&clear, &Sides { solid: false, ..OUTSIDE }, wo);
        assert_eq!(pane.sample(wo, 0.999, [0.5; 2]).unwrap().wi, -wo);
    }
}
