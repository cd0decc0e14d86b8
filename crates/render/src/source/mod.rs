// SPDX-License-Identifier: MIT OR Apache-2.0
//! Where light comes from, for paths: lights, surfaces that glow, the sky; and how to find them.
//!
//! Each source is picked by a chance in proportion to about what it sends to the point, and a direction of it by a
//! density that its kind knows; both are known for light that a ray met by itself, so that the two ways of finding it
//! can be weighted (Veach and Guibas, "Optimally Combining Sampling Techniques for Monte Carlo Rendering",
//! SIGGRAPH 1995). What cannot be looked for has the density 0: rays find it, and it counts in full.

mod ball;
pub(crate) mod build;
mod choice;
mod emitter;
mod faces;
mod foci;
mod lanes;
mod patch;
mod place;
mod rectangle;
mod ring;
mod sheet;
mod sky;
#[cfg(test)]
mod tests;
mod tree;
mod triangles;
mod tube;

use dioptric_geometry::world::Hit;
use dioptric_geometry::{HitId, Ray, SurfacePoint};
use dioptric_math::{DVec3, Spectrum, normalize};

use crate::material::{Finish, Optics};
use crate::scene::Scene;
use choice::Choice;
use emitter::{Emitter, Lamp};
pub use foci::{Aims, Foci};
use lanes::Only;
use patch::Met;
use sky::Sky;

pub(crate) use lanes::Looks;

/// A direction in which a source was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SourceSample {
    /// Unit vector towards it, in the space of rays.
    pub direction: DVec3,
    /// How far it is, less what rounding may have added: nothing of the source itself is nearer. Infinite for the sky.
    pub distance: f64,
    /// Its radiance over the density: `pi` times what a sharp light makes arrive, over its chance.
    pub value: Spectrum,
    /// The density over solid angles with which this very direction is found by this source, its chance included;
    /// infinite for sharp lights, which nothing else can find.
    pub pdf: f64,
    /// Which one: its number in [`Sources`].
    pub source: u32,
}

/// All sources of a scene.
///
/// `normal`, wherever it is asked for, is the shading normal on the side from which the light is wanted: sources
/// behind it have no chance. Without one all sides count: in media, and at surfaces that let light through. The same
/// one must be given to [`Self::sample`] and for what a ray met that left the same point.
#[derive(Clone, Debug, Default)]
pub struct Sources {
    /// What is looked for: lights, the sky, objects that shine or each of their parts.
    choice: Choice,
    /// By emitter: the source that it is a part of.
    source_of: Vec<u32>,
    sources: Vec<What>,
    /// By object: what it is here, up to the last one that shines.
    objects: Vec<Shining>,
    /// By part, from where [`Shining::Parts`] says: the emitter.
    parts: Vec<u32>,
    sky: Option<u32>,
    /// The lights that have a size.
    sized: Vec<u32>,
    foci: Foci,
    only: Option<Only>,
}

/// A source by its place in the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum What {
    /// Its place in [`Scene::lights`].
    Light(u32),
    /// An object's id.
    Object(u32),
    /// The background.
    Sky,
}

/// How an object is looked for.
#[derive(Clone, Copy, Debug, Default)]
enum Shining {
    #[default]
    Not,
    /// As one emitter.
    Whole(u32),
    /// Each part by itself: from here on in [`Sources::parts`].
    Parts(u32),
}

/// No emitter.
const NONE: u32 = u32::MAX;

impl Sources {
    /// Everything in the scene that light can be looked for on.
    #[must_use]
    pub fn new(scene: &Scene) -> Self {
        let mut this = Self::default();
        let mut emitters = Vec::new();
        for (placed, index) in scene.lights.iter().zip(0..) {
            if !placed.light.is_sharp() {
                this.sized.push(emitters.len() as u32);
            }
            this.begin(What::Light(index));
            this.push(&mut emitters, Emitter::Light(Box::new(Lamp::new(&placed.light))));
        }
        if let Some(sky) = Sky::new(&scene.background) {
            this.begin(What::Sky);
            this.sky = Some(this.push(&mut emitters, Emitter::Sky(Box::new(sky))));
        }
        for object in 0..scene.objects.len() as u32 {
            let glows = build::glows(scene, object);
            let shining = match glows {
                build::Glows::None => continue,
                build::Glows::Whole(glow) => {
                    this.begin(What::Object(object));
                    Shining::Whole(this.push(&mut emitters, Emitter::Glow(glow)))
                }
                build::Glows::Parts(glows) => {
                    this.begin(What::Object(object));
                    let first = this.parts.len() as u32;
                    for glow in glows {
                        let emitter = glow
                            .map(|glow| this.push(&mut emitters, Emitter::Glow(Box::new(glow))));
                        this.parts.push(emitter.unwrap_or(NONE));
                    }
                    Shining::Parts(first)
                }
            };
            this.objects.resize(object as usize, Shining::Not);
            this.objects.push(shining);
        }
        if scene.insides.scatter {
            this.foci = Foci::new(emitters.iter());
        }
        this.choice = Choice::new(emitters);
        this.only = Only::of(&this.choice);
        this
    }

    /// Begins another source.
    fn begin(&mut self, what: What) {
        self.sources.push(what);
    }

    /// An emitter of the source that began last.
    fn push(&mut self, emitters: &mut Vec<Emitter>, emitter: Emitter) -> u32 {
        self.source_of.push(self.sources.len() as u32 - 1);
        emitters.push(emitter);
        emitters.len() as u32 - 1
    }

    /// Whether a ray may pass some: see [`Self::passed`].
    pub(crate) const fn can_be_passed(&self) -> bool {
        !self.sized.is_empty()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.sources.is_empty()
    }

    /// The sources near which a medium gets much light; none in scenes where nothing scatters.
    #[must_use]
    pub const fn foci(&self) -> &Foci {
        &self.foci
    }

    /// A source picked by `pick`, and a direction of it by `u`, all uniform in `[0, 1)`. Nothing where that
    /// direction brings no light.
    #[must_use]
    pub fn sample(
        &self,
        scene: &Scene,
        point: DVec3,
        normal: Option<DVec3>,
        pick: f64,
        u: [f64; 2],
    ) -> Option<SourceSample> {
        let (emitter, chance) = self.choice.pick(point, normal, pick)?;
        self.sample_of(scene, emitter, chance, point, normal, u)
    }

    /// [`Self::sample`] of an emitter that was picked by a chance.
    fn sample_of(
        &self,
        scene: &Scene,
        emitter: u32,
        chance: f64,
        point: DVec3,
        normal: Option<DVec3>,
        u: [f64; 2],
    ) -> Option<SourceSample> {
        let source = *self.source_of.get(emitter as usize)?;
        let sample = match self.choice.emitter(emitter)? {
            Emitter::Light(lamp) => {
                let (direction, distance, value, density) = lamp.sample(point, u)?;
                let (value, pdf) = (value / chance, chance * density);
                SourceSample { direction, distance, value, pdf, source }
            }
            Emitter::Glow(glow) => {
                let found = glow.patch.sample(point, u)?;
                let pdf = chance * found.density;
                let value = glow.radiance(scene, point, &found) * (1.0 / pdf);
                let distance = glow.short_of(point, &found);
                SourceSample { direction: found.direction, distance, value, pdf, source }
            }
            Emitter::Sky(sky) => {
                let (direction, density) = sky.sample(normal, u)?;
                let pdf = chance * density;
                let value = scene.background.radiance(direction) / pdf;
                SourceSample { direction, distance: f64::INFINITY, value, pdf, source }
            }
        };
        let usable = sample.value.is_finite() && sample.value.max_element() > 0.0;
        (usable && !sample.pdf.is_nan()).then_some(sample)
    }

    /// The lights with a size that a ray passes before `t_max`: they are no objects and block nothing. `each` gets
    /// the source, the distance, the radiance towards the ray's origin, and the density with which
    /// [`Self::sample`] finds that direction of that source from there.
    pub fn passed(
        &self,
        ray: &Ray,
        normal: Option<DVec3>,
        t_max: f64,
        mut each: impl FnMut(u32, f64, Spectrum, f64),
    ) {
        if self.sized.is_empty() {
            return;
        }
        let Some(direction) = normalize(ray.direction) else { return };
        let end = t_max * ray.direction.length();
        for &emitter in &self.sized {
            let Some(Emitter::Light(lamp)) = self.choice.emitter(emitter) else { continue };
            let Some((distance, radiance, density)) = lamp.pass(ray.origin, direction) else {
                continue;
            };
            // Those at infinity are seen where nothing is hit at all.
            if (distance < end || t_max == f64::INFINITY) && radiance.is_finite() {
                let chance = self.choice.chance(ray.origin, normal, emitter);
                let source = self.source_of.get(emitter as usize).copied().unwrap_or(NONE);
                each(source, distance, radiance, chance * density);
            }
        }
    }

    /// The density with which [`Self::sample`] finds from `point` the place of a glowing object that a ray from there
    /// along the unit vector `direction` hit; 0 where it cannot.
    #[must_use]
    pub fn density_of_hit(
        &self,
        _scene: &Scene,
        point: DVec3,
        normal: Option<DVec3>,
        hit: &Hit,
        surface: &SurfacePoint,
        direction: DVec3,
    ) -> f64 {
        let emitter = match self.objects.get(hit.id.object as usize) {
            Some(Shining::Whole(emitter)) => *emitter,
            Some(Shining::Parts(first)) => {
                let place = *first as usize + hit.id.part as usize;
                self.parts.get(place).copied().unwrap_or(NONE)
            }
            _ => return 0.0,
        };
        let Some(Emitter::Glow(glow)) = self.choice.emitter(emitter) else { return 0.0 };
        if hit.id.instance != HitId::NO_INSTANCE {
            return 0.0;
        }
        let chance = self.choice.chance(point, normal, emitter);
        if chance == 0.0 {
            return 0.0;
        }
        let distance = (surface.point - point).length();
        let met = Met { direction, distance, normal: surface.normal };
        let density = chance * glow.patch.density(point, &met);
        if density.is_finite() { density } else { 0.0 }
    }

    /// The same for the sky in a direction.
    #[must_use]
    pub fn density_of_sky(&self, point: DVec3, normal: Option<DVec3>, direction: DVec3) -> f64 {
        let Some(emitter) = self.sky else { return 0.0 };
        let Some(Emitter::Sky(sky)) = self.choice.emitter(emitter) else { return 0.0 };
        self.choice.chance(point, normal, emitter) * sky.density(normal, direction)
    }

    /// What a source is.
    #[must_use]
    pub fn what(&self, source: u32) -> Option<What> {
        self.sources.get(source as usize).copied()
    }

    /// What the scene calls a source.
    #[must_use]
    pub fn label(&self, scene: &Scene, source: u32) -> Option<String> {
        match self.what(source)? {
            What::Light(index) => {
                let placed = scene.lights.get(index as usize)?;
                Some(scene.description.label(placed.node))
            }
            What::Object(object) => {
                let instance = HitId::NO_INSTANCE;
                Some(scene.object_label(HitId { instance, object, part: 0 }))
            }
            What::Sky => Some("background".into()),
        }
    }
}

/// What a surface shines by itself, seen from outside or inside: transparent things shine on their outside. The light
/// of those that are transparent by shares is a part of their own share.
#[must_use]
pub fn shining(finish: &Finish, outside: bool) -> Spectrum {
    match finish.optics {
        _ if !finish.present => Spectrum::ZERO,
        Optics::Shares { own, .. } if outside => finish.emission * own,
        Optics::Shares { .. } | Optics::Dielectric { .. } | Optics::Layered(_) if !outside => {
            Spectrum::ZERO
        }
        _ => finish.emission,
    }
}

/// The mean of a colour's lanes: unlike its luminance no colour hides in it.
fn brightness(color: Spectrum) -> f64 {
    (color.x + color.y + color.z) * (1.0 / 3.0)
}
