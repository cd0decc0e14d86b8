// SPDX-License-Identifier: MIT OR Apache-2.0
//! Photons for a [`Guide`]: light that sharp things (glass, mirrors) gather on dull ones.
//!
//! A place on a sharp thing is picked, a source is asked for from there as any point of a path asks, and what comes from it
//! is followed by the same steps as paths, over sharp surfaces only, until it meets one that is not. Nothing here needs to
//! be exact, as a guide only says where to look; but it must be the same each time.

use dioptric_geometry::world::Query;
use dioptric_geometry::{Bounds, Contacts, Departure, HitId, Ray};
use dioptric_math::{DVec3, Spectrum, orthonormal_basis, sin_cos};

use super::{Path, Paths, Round, TOGETHER};
use crate::bsdf;
use crate::film::Radiance;
use crate::guide::{Guide, Photon};
use crate::integrator::recorder::{RayKind, Recorder, Silent};
use crate::material::Optics;
use crate::pattern::PatternPoint;
use crate::sampling::Antialias;
use crate::sampling::stream::Stream;
use crate::scene::Scene;
use crate::stats::RayCounts;

/// Photons on their way and those that have come.
#[derive(Default)]
pub(super) struct Photons {
    /// What each of a batch began with.
    sent: Vec<Spectrum>,
    kept: Vec<Photon>,
}

/// A thing with a sharp surface: its number, and a ball around it.
struct Sharp {
    object: u32,
    center: DVec3,
    radius: f64,
}

/// The guide of a scene, from so many photons; nothing where nothing gathers light.
pub(crate) fn guide(scene: &Scene, count: u32) -> Option<Guide> {
    let things: Vec<Sharp> =
        (0..scene.objects.len() as u32).filter_map(|o| sharp(scene, o)).collect();
    if things.is_empty() || scene.sources.is_empty() {
        return None;
    }
    let (mut counts, mut silent) = (RayCounts::default(), Silent);
    let mut paths = Paths::new(scene, &mut counts, &mut silent);
    paths.photons = Some(Photons::default());
    paths.in_lanes = false;
    paths.radiances.resize(TOGETHER, Radiance::NOTHING);
    let mut round = Round::default();
    for first in (0..count).step_by(TOGETHER) {
        if let Some(photons) = &mut paths.photons {
            photons.sent.clear();
        }
        round.paths.clear();
        for number in first..count.min(first + TOGETHER as u32) {
            paths.send(&things, number, &mut round);
        }
        while !round.now.slots.is_empty() {
            paths.step(&mut round);
        }
    }
    Guide::new(&paths.photons.unwrap_or_default().kept)
}

/// An object, if it has a sharp surface and a size.
fn sharp(scene: &Scene, object: u32) -> Option<Sharp> {
    let info = scene.objects.get(object as usize)?;
    if scene.world.is_in_group(object) {
        return None;
    }
    let material = match info.combined {
        true => *scene.leaf_materials.get(info.material as usize)?,
        false => info.material,
    };
    let material = scene.materials.get(material as usize)?;
    let finish =
        material.uniform.unwrap_or_else(|| material.material.finish(&PatternPoint::NOWHERE));
    let sharp = match finish.optics {
        Optics::Dielectric { roughness, .. } => bsdf::is_smooth(roughness),
        Optics::Mirror { roughness, .. } => bsdf::is_smooth(roughness),
        Optics::Shares { .. } => !material.interior.border,
        Optics::Layered(layers) => {
            let coat = layers.coat == 0.0 || bsdf::is_smooth(layers.coat_alpha);
            layers.dull() == 0.0
                && bsdf::is_smooth(layers.alpha)
                && coat
                && layers.sheen == Spectrum::ZERO
        }
        Optics::Opaque => false,
    };
    let Bounds { min, max } = scene.world.shape(object)?.bounds();
    let id = HitId { instance: HitId::NO_INSTANCE, object, part: 0 };
    let place = scene.world.object_to_ray(id)?;
    let center = place.transform_point3((min + max) * 0.5);
    let corner = |i: u32| {
        let pick = |bit: u32, low: f64, high: f64| if i >> bit & 1 == 0 { low } else { high };
        let corner =
            DVec3::new(pick(0, min.x, max.x), pick(1, min.y, max.y), pick(2, min.z, max.z));
        (place.transform_point3(corner) - center).length()
    };
    let radius = (0..8).map(corner).fold(0.0, f64::max);
    (sharp && radius > 0.0 && radius.is_finite()).then_some(Sharp { object, center, radius })
}

impl<R: Recorder> Paths<'_, '_, R> {
    /// Begins the way of a photon, if a source sends one to the place that its numbers pick.
    fn send(&mut self, things: &[Sharp], number: u32, round: &mut Round<R::Id>) {
        let scene = self.scene;
        // A place that no pixel has.
        let place = [u32::MAX, u32::MAX];
        let mut stream = Stream::new(Antialias::Sobol, place, number, scene.settings.seed);
        let [which, pick] = stream.next_2d();
        let thing = &things[((which * things.len() as f64) as usize).min(things.len() - 1)];
        let Some((id, point, normal, error)) =
            on_surface(scene, thing, stream.next_2d(), stream.next_2d())
        else {
            return;
        };
        let u = stream.next_2d();
        let Some(source) = scene.sources.sample(scene, point, Some(normal), pick, u) else {
            return;
        };
        let cos = normal.dot(source.direction);
        // What sharp lights gather no path can find.
        if source.pdf == f64::INFINITY || cos <= 0.0 {
            return;
        }
        let ray = Ray { origin: point, direction: source.direction, time: 0.0, error };
        let departure = Departure { from: id, outward: true };
        let contacts = Contacts { crossed: false, except: None };
        let query = Query::new(ray, source.distance, Some(departure), contacts);
        let seen = if scene.insides.borders {
            self.through_borders(&query, None, false) != Spectrum::ZERO
        } else {
            !scene.world.occluded_past(&ray, source.distance, Some(&departure), contacts)
        };
        if !seen {
            return;
        }
        let back = (2.0 * thing.radius).min(0.999 * source.distance);
        let value = source.value * (cos * thing.radius * thing.radius);
        let Some(photons) = &mut self.photons else { return };
        let sample = photons.sent.len() as u32;
        photons.sent.push(value);
        let ray = Ray::new(ray.at(back), -source.direction);
        let id = self.recorder.begin(None, RayKind::Camera, &ray);
        round.begin(Path::new(sample, id, None, stream), ray);
    }

    /// Keeps a photon that came to a dull surface by way of sharp ones.
    pub(super) fn keep_photon(&mut self, path: &Path<R::Id>, query: &Query, at: DVec3) {
        let Some(photons) = self.photons.as_mut().filter(|_| path.depth > 0) else { return };
        let value = path.throughput * photons.sent[path.sample as usize];
        let weight = (value.x + value.y + value.z) / 3.0;
        let (from, wavelength) = (query.ray.origin, path.wavelength);
        photons.kept.push(Photon { at, from, weight, wavelength });
    }
}

/// A place on a thing: where a line through the ball around it meets it first.
fn on_surface(
    scene: &Scene,
    thing: &Sharp,
    way: [f64; 2],
    off: [f64; 2],
) -> Option<(HitId, DVec3, DVec3, f64)> {
    let z = 1.0 - 2.0 * way[0];
    let (s, c) = sin_cos(std::f64::consts::TAU * way[1]);
    let r = (1.0 - z * z).max(0.0).sqrt();
    let direction = DVec3::new(r * c, r * s, z);
    let (x, y) = orthonormal_basis(direction);
    let (s, c) = sin_cos(std::f64::consts::TAU * off[1]);
    let off = (x * c + y * s) * (off[0].sqrt() * thing.radius);
    let ray = Ray::new(thing.center + off - direction * (2.0 * thing.radius), direction);
    let hit =
        scene.world.closest_of(&ray, f64::INFINITY, None, HitId::NO_INSTANCE, thing.object)?;
    let surface = scene.world.surface_point(&ray, &hit)?;
    // From outside; panes have two of that.
    let normal = if surface.normal.dot(direction) < 0.0 { surface.normal } else { -surface.normal };
    Some((hit.id, surface.point, normal, surface.error))
}
