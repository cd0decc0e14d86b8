// SPDX-License-Identifier: MIT OR Apache-2.0
//! One thing that sends light: a light, a surface that glows, the sky; and about how much of it arrives where.

use std::f64::consts::PI;

use dioptric_geometry::world::Hit;
use dioptric_geometry::{HitId, Ray};
use dioptric_math::bounds::gamma;
use dioptric_math::{DVec3, Spectrum};

use super::faces::{Face, Faces};
use super::patch::{Found, Met, Patch};
use super::sky::Sky;
use super::{brightness, shining};
use crate::light::AnyLight;
use crate::light::shared::cosine_within;
use crate::scene::Scene;

/// How much the highest part of something counts against its middle.
const HIGHEST: f64 = 0.2;

/// What can be looked for.
#[derive(Clone, Debug)]
pub(super) enum Emitter {
    Light(Box<Lamp>),
    Glow(Box<Glow>),
    Sky(Box<Sky>),
}

/// A light.
#[derive(Clone, Debug)]
pub(super) struct Lamp {
    pub light: AnyLight,
    /// Where it is looked for, if not where it says itself.
    pub patch: Option<Patch>,
}

impl Lamp {
    pub fn new(light: &AnyLight) -> Self {
        let surface = match light {
            AnyLight::Area(area) => area.surface(),
            _ => None,
        };
        let patch = surface.and_then(|(corner, edges)| {
            let mut faces = Vec::new();
            Face::parallelogram(corner, edges, 0, &mut faces);
            Faces::new(faces, false).map(Patch::Faces)
        });
        Self { light: light.clone(), patch }
    }

    /// The direction in which a part of it is found, the distance, the radiance over the density, and the density;
    /// infinite for one without a size.
    pub fn sample(&self, point: DVec3, u: [f64; 2]) -> Option<(DVec3, f64, Spectrum, f64)> {
        if let Some(patch) = &self.patch {
            let found = patch.sample(point, u)?;
            let pass = self.light.pass(point, found.direction)?;
            let value = pass.arriving * (PI * pass.density / found.density);
            return Some((found.direction, pass.distance, value, found.density));
        }
        let found = self.light.sample(point, u)?;
        let density = if self.light.is_sharp() {
            f64::INFINITY
        } else {
            self.light.pass(point, found.direction).map_or(0.0, |pass| pass.density)
        };
        Some((found.direction, found.distance, found.arriving * PI, density))
    }

    /// The distance, the radiance, and the density of [`Self::sample`], where a ray passes it.
    pub fn pass(&self, point: DVec3, direction: DVec3) -> Option<(f64, Spectrum, f64)> {
        let pass = self.light.pass(point, direction)?;
        let density = match &self.patch {
            Some(Patch::Faces(faces)) => {
                let normal = faces.faces().first().map_or(DVec3::ZERO, Face::normal);
                faces.density(point, &Met { direction, distance: pass.distance, normal })
            }
            _ => pass.density,
        };
        Some((pass.distance, pass.arriving * (PI * pass.density), density))
    }
}

/// An object that shines, or a part of it.
#[derive(Clone, Debug)]
pub(super) struct Glow {
    pub object: u32,
    pub patch: Patch,
    /// What it sends, where that is the same everywhere.
    pub uniform: Option<Spectrum>,
    pub reach: Reach,
    /// How many times the size of its coordinates its surface may be off.
    pub rounding: f64,
}

/// About where a surface is and what it sends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Reach {
    /// A ball around it.
    pub center: DVec3,
    pub radius: f64,
    /// From there to the sides of a box around it.
    pub half: DVec3,
    pub facing: Facing,
    /// What arrives at the distance 1 in front, or in the mean over all sides: the mean of the lanes of its radiance,
    /// times the area that it shows.
    pub power: f64,
}

/// To which sides a surface shines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Facing {
    /// To all.
    All,
    /// It is flat, with this normal: by the cosine to both sides.
    Both(DVec3),
    /// To the side of the normal only.
    Front(DVec3),
    /// Many that shine to the sides of their normals only: about this one, and the cosine and the sine of the widest
    /// angle to it.
    Cone(DVec3, [f64; 2]),
}

impl Reach {
    /// About what a point receives; 0 only where that is nothing for sure.
    pub fn weight(&self, point: DVec3, normal: Option<DVec3>) -> f64 {
        let flat = self.flat();
        match (self.facing, normal, flat) {
            (Facing::All, Some(n), _) => return self.weight_all(point, n),
            (_, Some(n), Some(flat)) => return self.weight_flat(flat, point, n),
            _ => {}
        }
        let way = self.center - point;
        let d2 = way.length_squared();
        let r2 = self.radius * self.radius;
        if d2 <= r2 {
            return positive(self.power / r2);
        }
        let inverse = 1.0 / d2.sqrt();
        let cosine = |n: DVec3, height: f64| self.cosine(n, height, inverse);
        let out = match self.facing {
            Facing::All => 1.0,
            Facing::Both(n) => cosine(n, n.dot(way).abs()),
            Facing::Front(n) => cosine(n, -n.dot(way)),
            Facing::Cone(n, [cos, sin]) => {
                let room = n.abs().dot(self.half).min(self.radius);
                let most = ((room - n.dot(way)) * inverse).clamp(-1.0, 1.0);
                let turned = most * cos + (1.0 - most * most).sqrt() * sin;
                if most >= cos { 1.0 } else { turned.max(0.0) }
            }
        };
        let received = normal.map_or(1.0, |n| cosine(n, n.dot(way)));
        positive(self.power * (inverse * inverse) * out * received)
    }

    /// About the mean cosine, 0 only where all of it is below the plane: that of the middle, and some of the greatest
    /// that any part may have.
    #[inline(always)]
    fn cosine(&self, n: DVec3, height: f64, inverse: f64) -> f64 {
        let room = n.abs().dot(self.half).min(self.radius);
        (((1.0 - HIGHEST) * height.max(0.0) + HIGHEST * (height + room)) * inverse).clamp(0.0, 1.0)
    }

    /// [`Self::weight`] of what shines to all sides. (Without branches, for loops over many points.)
    #[inline(always)]
    pub fn weight_all(&self, point: DVec3, normal: DVec3) -> f64 {
        let way = self.center - point;
        let (d2, r2) = (way.length_squared(), self.radius * self.radius);
        let inverse = 1.0 / d2.sqrt();
        let received = self.cosine(normal, normal.dot(way), inverse);
        let far = self.power * (inverse * inverse) * received;
        positive(if d2 <= r2 { self.power / r2 } else { far })
    }

    /// [`Self::weight`] of something flat.
    #[inline(always)]
    pub fn weight_flat(&self, flat: Flat, point: DVec3, normal: DVec3) -> f64 {
        let way = self.center - point;
        let (d2, r2) = (way.length_squared(), self.radius * self.radius);
        let inverse = 1.0 / d2.sqrt();
        let height = flat.normal.dot(way);
        let height = if flat.both { height.abs() } else { -height };
        let out = self.cosine(flat.normal, height, inverse);
        let received = self.cosine(normal, normal.dot(way), inverse);
        let far = self.power * (inverse * inverse) * out * received;
        positive(if d2 <= r2 { self.power / r2 } else { far })
    }

    /// A ball, for what needs no more of it.
    #[inline(always)]
    pub const fn around(center: DVec3, radius: f64) -> Self {
        Self { center, radius, half: DVec3::ZERO, facing: Facing::All, power: 0.0 }
    }

    /// Its normal, if it is flat.
    pub fn flat(&self) -> Option<Flat> {
        match self.facing {
            Facing::Both(normal) => Some(Flat { normal, both: true }),
            Facing::Front(normal) => Some(Flat { normal, both: false }),
            Facing::All | Facing::Cone(..) => None,
        }
    }

    /// Whether a point on the front of this plane may receive something from something flat. (Without branches, for loops over many points.)
    #[inline(always)]
    pub fn reaches(&self, flat: Flat, point: DVec3, normal: DVec3) -> bool {
        let way = self.center - point;
        let room = |n: DVec3| n.abs().dot(self.half).min(self.radius);
        let near = way.length_squared() <= self.radius * self.radius;
        let out = flat.both | (room(flat.normal) > flat.normal.dot(way));
        near | (out & (normal.dot(way) + room(normal) > 0.0))
    }

    /// How far a ray may go that must not reach what was found at a distance: less by what rounding of the ray's
    /// origin, of the surface (so many times its coordinates) and of the way to it can do. All of them are offsets in
    /// proportion to coordinates, and an offset of the surface moves the point where a ray meets it by as much over the
    /// cosine. (Where the ray nearly touches a sphere, its distance from the middle decides, and the way is off by the
    /// root of the offset times the radius at most, which is what the least cosine stands for.)
    #[inline(always)]
    pub fn short_of(
        &self,
        rounding: f64,
        point: DVec3,
        direction: &DVec3,
        distance: f64,
        normal: DVec3,
    ) -> f64 {
        let size = point.abs().max_element() + self.center.abs().max_element() + self.radius;
        let offset = gamma(256) * rounding * size;
        let least = (offset / size.min(distance + self.radius)).min(1.0).sqrt();
        let cosine = direction.dot(normal).abs().max(least);
        (distance - offset / cosine).max(0.0)
    }
}

/// The normal of something flat, and whether it shines on both sides of itself.
#[derive(Clone, Copy, Debug)]
pub(super) struct Flat {
    pub normal: DVec3,
    pub both: bool,
}

impl Reach {
    /// Whether a point is nearer to the middle than so many times the radius.
    pub fn is_near(&self, point: DVec3, times: f64) -> bool {
        let r = self.radius * times;
        (self.center - point).length_squared() < r * r
    }
}

/// A weight that can be added to others: NaN is nothing.
#[inline(always)]
fn positive(weight: f64) -> f64 {
    if weight > 0.0 { weight.min(1e200) } else { 0.0 }
}

impl Emitter {
    /// About what a point receives from it, for choosing: 0 only where that is nothing for sure.
    pub fn weight(&self, point: DVec3, normal: Option<DVec3>) -> f64 {
        let weight = match self {
            Self::Light(lamp) => lamp.light.view(point).map_or(0.0, |view| {
                let cos = |n: DVec3| cosine_within(n.dot(view.direction), view.sine);
                let received = normal.map_or(1.0, cos);
                PI * brightness(view.arriving) * received
            }),
            Self::Glow(glow) => glow.reach.weight(point, normal),
            Self::Sky(sky) => sky.weight(normal),
        };
        positive(weight)
    }

    /// Whether a point may receive something from it.
    pub fn reaches(&self, point: DVec3, normal: Option<DVec3>) -> bool {
        if let (Self::Glow(glow), Some(normal)) = (self, normal)
            && let Some(flat) = glow.reach.flat()
        {
            return glow.reach.reaches(flat, point, normal);
        }
        self.weight(point, normal) > 0.0
    }

    /// Where it is and what it sends, if that weakens with distance.
    pub fn reach(&self) -> Option<Reach> {
        match self {
            Self::Light(lamp) => lamp.light.place().map(|place| Reach {
                center: place.center,
                radius: place.radius,
                half: DVec3::splat(place.radius),
                facing: Facing::All,
                power: PI * brightness(place.intensity),
            }),
            Self::Glow(glow) => Some(glow.reach),
            Self::Sky(_) => None,
        }
    }
}

impl Glow {
    /// What it sends to a point from what was found of it.
    pub fn radiance(&self, scene: &Scene, point: DVec3, found: &Found) -> Spectrum {
        if let Some(radiance) = self.uniform {
            return radiance;
        }
        let ray = Ray::new(point, found.direction);
        let id = HitId { instance: HitId::NO_INSTANCE, object: self.object, part: found.part };
        let Some(shading) = scene.shading(&ray, &Hit { t: found.distance, id }) else {
            return Spectrum::ZERO;
        };
        let solid = scene.world.shape(self.object).is_some_and(|shape| shape.is_solid());
        let outside = !solid || found.direction.dot(shading.surface.normal) <= 0.0;
        shining(&shading.finish, outside)
    }

    /// How far a ray may go that must not reach what was found.
    pub fn short_of(&self, point: DVec3, found: &Found) -> f64 {
        let Found { direction, distance, normal, .. } = found;
        self.reach.short_of(self.rounding, point, direction, *distance, *normal)
    }
}

/// A ball around some points.
pub(super) fn ball_around(points: impl Iterator<Item = DVec3> + Clone) -> (DVec3, f64) {
    let (low, high) = points
        .clone()
        .fold((DVec3::splat(f64::INFINITY), DVec3::splat(f64::NEG_INFINITY)), |(low, high), p| {
            (low.min(p), high.max(p))
        });
    let center = low + (high - low) * 0.5;
    let radius = points.fold(0.0, |r: f64, p| r.max((p - center).length()));
    (center, radius * (1.0 + 1e-9))
}
