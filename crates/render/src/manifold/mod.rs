// SPDX-License-Identifier: MIT OR Apache-2.0
//! Balls that gather light: which there are, and which of them a point asks for what it may send there.

pub mod bend;
pub mod ways;

use dioptric_geometry::{AnyShape, Bounds, HitId};
use dioptric_math::{DVec3, Spectrum};

use crate::bsdf;
use crate::integrator::optics::fresnel;
use crate::material::{Finish, Optics, Reflectance};
use crate::scene::Scene;
use bend::Bender;

/// Not more than so many ways over balls are asked for: the largest.
const MOST: usize = 16;
/// Each knows so many glowing things, or parts of them: the brightest.
const LAMPS: usize = 64;
/// Points that are so near to a ball's surface, or that lie within, ask nothing, in radii from its middle.
const NEAR: f64 = 1.0 + 1e-5;

/// What a ball does to the light of one of its ways.
#[derive(Clone, Copy, Debug)]
enum Weight {
    /// A mirror's, by the angle.
    Mirror(Reflectance),
    /// Glass, with its index over that around it: what it mirrors, times a colour.
    Outside(f64, Spectrum),
    /// What goes through it, times a colour, and absorbed on the way.
    Inside(f64, Spectrum, Spectrum),
}

/// A way of light over one ball: off it, or through it.
#[derive(Clone, Debug)]
pub struct Caster {
    /// The ball, as light meets it.
    pub bender: Bender,
    /// The ball's object.
    pub object: u32,
    /// Whether nothing is within it.
    pub alone: bool,
    weight: Weight,
    power: f64,
    /// What it is lit by: emitters, with the share of each.
    lamps: Vec<(u32, f64)>,
}

/// Which one a point asks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Picked {
    /// Its number.
    pub number: u16,
    /// The chance of it.
    pub chance: f64,
    /// What is left of the number that picked it, in `[0, 1)`.
    pub rest: f64,
    /// About how much all may matter.
    pub sum: f64,
}

/// A ball with all its ways.
#[derive(Clone, Debug)]
struct Ball {
    center: DVec3,
    radius: f64,
    power: f64,
    /// The first of its ways, and one more than the last.
    ways: [u16; 2],
}

/// All of a scene.
#[derive(Clone, Debug, Default)]
pub struct Casters {
    all: Vec<Caster>,
    balls: Vec<Ball>,
    /// By object, up to the last one that is a ball: its ways, as there.
    of: Vec<[u16; 2]>,
}

impl Caster {
    /// Whether light goes through it.
    #[must_use]
    pub const fn is_through(&self) -> bool {
        self.bender.pieces > 0
    }

    /// What is left of light that takes this way: at this cosine of incidence, and for this way within, in units of the file.
    #[inline]
    #[must_use]
    pub fn left(&self, cos: f64, chord: f64) -> Spectrum {
        match &self.weight {
            Weight::Mirror(reflect) => reflect.at(cos),
            Weight::Outside(index, color) => *color * fresnel(cos, 1.0 / index),
            Weight::Inside(index, color, absorption) => {
                let mirrored = fresnel(cos, 1.0 / index);
                let through = 1.0 - mirrored;
                let through = if self.bender.pieces > 1 { through * mirrored } else { through };
                let left = crate::integrator::media::absorbed(*absorption, chord);
                *color * left * (through * (1.0 - mirrored))
            }
        }
    }

    /// One of the things that light it, for a number in `[0, 1)`, and the chance of it.
    #[must_use]
    pub fn lamp(&self, pick: f64) -> Option<(u32, f64)> {
        let mut rest = pick;
        for &(emitter, share) in &self.lamps {
            if rest < share {
                return Some((emitter, share));
            }
            rest -= share;
        }
        self.lamps.last().copied()
    }

    /// The chance of one of the things that light it.
    #[must_use]
    pub fn chance_of_lamp(&self, emitter: u32) -> f64 {
        self.lamps.iter().find(|(e, _)| *e == emitter).map_or(0.0, |(_, share)| *share)
    }
}

impl Ball {
    /// About how much it may matter to a point that looks along a normal.
    #[inline]
    fn at(&self, point: DVec3, normal: DVec3) -> f64 {
        let way = self.center - point;
        let (d2, r) = (way.length_squared(), self.radius);
        let seen = d2 > (r * NEAR) * (r * NEAR) && way.dot(normal) > -r;
        if seen { self.power * (r * r) / d2 } else { 0.0 }
    }
}

impl Casters {
    /// Those of a scene.
    #[must_use]
    pub fn new(scene: &Scene) -> Self {
        let mut this = Self::default();
        let insides = &scene.insides;
        if insides.scatter || insides.borders || insides.overlap {
            return this;
        }
        let objects = 0..scene.objects.len() as u32;
        let mut all: Vec<Caster> = objects.flat_map(|object| ways(scene, object)).collect();
        let size = |c: &Caster| c.power * c.bender.radius * c.bender.radius;
        all.retain(|c| size(c) > 0.0);
        all.sort_by(|a, b| size(b).total_cmp(&size(a)));
        all.truncate(MOST);
        all.sort_by_key(|c| c.object);
        for caster in &mut all {
            caster.lamps = scene.sources.brightest(caster.bender.center, LAMPS);
            caster.alone = is_alone(scene, caster);
        }
        all.retain(|c| !c.lamps.is_empty() && (c.bender.pieces < 2 || c.alone));
        for (caster, i) in all.iter().zip(0_u16..) {
            let object = caster.object as usize;
            if this.of.len() <= object {
                this.of.resize(object + 1, [0; 2]);
                this.of[object] = [i, i];
                let Bender { center, radius, .. } = caster.bender;
                this.balls.push(Ball { center, radius, power: 0.0, ways: [i, i] });
            }
            this.of[object][1] = i + 1;
            if let Some(ball) = this.balls.last_mut() {
                ball.ways[1] = i + 1;
                ball.power += caster.power;
            }
        }
        this.all = all;
        this
    }

    /// Whether there are none.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// One of them.
    #[must_use]
    pub fn get(&self, number: u16) -> Option<&Caster> {
        self.all.get(usize::from(number))
    }

    /// The way over a ball with so many pieces within.
    #[must_use]
    pub fn of(&self, object: u32, pieces: u8) -> Option<u16> {
        let [from, to] = *self.of.get(object as usize)?;
        (from..to).find(|&i| self.all[usize::from(i)].bender.pieces == pieces)
    }

    /// Which one a point asks that looks along a normal, for a number in `[0, 1)`.
    #[must_use]
    pub fn pick(&self, point: DVec3, normal: DVec3, pick: f64) -> Option<Picked> {
        let mut weights = [0.0; MOST];
        let mut sum = 0.0;
        for (ball, weight) in self.balls.iter().zip(&mut weights) {
            *weight = ball.at(point, normal);
            sum += *weight;
        }
        let (mut rest, mut last) = (pick * sum, None);
        for (ball, &weight) in self.balls.iter().zip(&weights) {
            if weight > 0.0 {
                last = Some((ball, weight, rest));
                if rest < weight {
                    break;
                }
                rest -= weight;
            }
        }
        let (ball, weight, rest) = last?;
        let mut rest = (rest / weight).min(1.0 - f64::EPSILON) * ball.power;
        let [from, to] = ball.ways;
        let mut number = from;
        while number + 1 < to && rest >= self.all[usize::from(number)].power {
            rest -= self.all[usize::from(number)].power;
            number += 1;
        }
        let own = self.all[usize::from(number)].power;
        let rest = (rest / own).min(1.0 - f64::EPSILON);
        Some(Picked { number, chance: weight / sum * (own / ball.power), rest, sum })
    }

    /// The chance of one.
    #[must_use]
    pub fn chance(&self, point: DVec3, normal: DVec3, number: u16) -> f64 {
        let (mut sum, mut own) = (0.0, 0.0);
        for ball in &self.balls {
            let weight = ball.at(point, normal);
            sum += weight;
            if (ball.ways[0]..ball.ways[1]).contains(&number) {
                own = weight * (self.all[usize::from(number)].power / ball.power);
            }
        }
        if own > 0.0 { own / sum } else { 0.0 }
    }
}

/// The ways over an object, if it is a ball that has some.
fn ways(scene: &Scene, object: u32) -> Vec<Caster> {
    let found = || {
        let info = scene.objects.get(object as usize)?;
        let material = scene.materials.get(info.material as usize)?;
        if info.combined || material.holes || material.by_lot || scene.world.is_in_group(object) {
            return None;
        }
        let finish = material.uniform.as_ref()?;
        let interior = &material.interior;
        if interior.dispersion.is_some() || interior.scattering.is_some() {
            return None;
        }
        let AnyShape::Sphere(sphere) = scene.world.shape(object)? else { return None };
        let id = HitId { instance: HitId::NO_INSTANCE, object, part: 0 };
        let place = scene.world.object_to_ray(id)?;
        let scale = crate::source::build::similarity(&place.matrix3)?;
        let bender = Bender {
            center: place.transform_point3(sphere.center()),
            radius: sphere.radius() * scale,
            index: 1.0,
            pieces: 0,
        };
        Some(of_ball(scene, object, bender, finish))
    };
    found().unwrap_or_default()
}

fn of_ball(scene: &Scene, object: u32, bender: Bender, finish: &Finish) -> Vec<Caster> {
    let caster = |index, pieces, weight, power: f64| Caster {
        bender: Bender { index, pieces, ..bender },
        object,
        alone: false,
        weight,
        power,
        lamps: Vec::new(),
    };
    match finish.optics {
        Optics::Mirror { reflect, roughness, covers: false } if bsdf::is_smooth(roughness) => {
            vec![caster(1.0, 0, Weight::Mirror(reflect), reflect.at(1.0).max_element())]
        }
        Optics::Dielectric { ior, reflect, transmit, absorption, roughness }
            if bsdf::is_smooth(roughness) =>
        {
            let index = ior / scene.surroundings.ior;
            if !(index > 1.0 + 1e-3) {
                return Vec::new();
            }
            // What smooth glass mirrors: more at grazing angles.
            let mirrored = 2.0 * fresnel(1.0, 1.0 / index);
            let absorption = absorption / scene.root.scale();
            let inside = Weight::Inside(index, transmit, absorption);
            let (back, on) = (reflect.max_element(), transmit.max_element());
            vec![
                caster(index, 0, Weight::Outside(index, reflect), mirrored * back),
                caster(index, 1, inside, on),
                caster(index, 2, inside, mirrored * on),
            ]
        }
        _ => Vec::new(),
    }
}

/// Whether nothing can be within a ball, by the boxes around all other things.
fn is_alone(scene: &Scene, caster: &Caster) -> bool {
    let Bender { center, radius, .. } = caster.bender;
    let world = &scene.world;
    world.instance_count() == 0
        && (0..world.object_count() as u32).all(|object| {
            let id = HitId { instance: HitId::NO_INSTANCE, object, part: 0 };
            let found = world.shape(object).zip(world.object_to_ray(id));
            object == caster.object
                || found.is_some_and(|(shape, place)| {
                    let corners = shape.bounds().corners();
                    let bounds = Bounds::of(corners.map(|c| place.transform_point3(c)));
                    let nearest = center.max(bounds.min).min(bounds.max);
                    (nearest - center).length() > radius * (1.0 - 1e-9)
                })
        })
}
