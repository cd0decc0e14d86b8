// SPDX-License-Identifier: MIT OR Apache-2.0
//! Whitted's picture: every surface shows its own colour under the lights, and rays go on where it
//! mirrors or lets through (Whitted, "An Improved Illumination Model for Shaded Display", CACM 23(6),
//! 1980). This file follows rays; [`super::direct`] lights a point, [`super::dielectric`] splits a ray at
//! glass and [`super::passage`] goes through objects with fixed shares.

use dioptric_geometry::Ray;
use dioptric_geometry::world::Hit;
use dioptric_math::{DVec3, Spectrum};
use serde_json::json;

use super::dielectric::Dielectric;
use super::media::{Inside, Media, Medium, absorbed};
use super::optics::{facet_normal, schlick};
use super::point::{Leg, Point, coincide};
use super::recorder::{HitRecord, RayKind, Recorder};
use crate::film::{FirstHit, Radiance};
use crate::material::Optics;
use crate::sampling::stream::Stream;
use crate::scene::{Scene, Shading};
use crate::stats::RayCounts;

/// One sample's tree of rays.
pub struct Whitted<'a, R> {
    /// What rays are cast into.
    pub(super) scene: &'a Scene,
    /// The sample's random numbers.
    pub(super) stream: &'a mut Stream,
    /// Rays cast so far.
    pub(super) counts: &'a mut RayCounts,
    /// Who listens.
    pub(super) recorder: &'a mut R,
    /// Transparent objects that this sample's rays have been in.
    pub(super) media: Media,
}

/// What a ray carries along the tree.
#[derive(Clone, Copy)]
pub(super) struct State {
    /// Secondary bounces so far.
    pub depth: u32,
    /// The largest lane of the product of all weights so far.
    pub throughput: f64,
    /// The innermost transparent object around the ray.
    pub inside: Inside,
}

impl<'a, R: Recorder> Whitted<'a, R> {
    /// Ready for one camera's ray.
    pub fn new(
        scene: &'a Scene,
        stream: &'a mut Stream,
        counts: &'a mut RayCounts,
        recorder: &'a mut R,
    ) -> Self {
        let media = Media::new(scene.surroundings.ior);
        Self { scene, stream, counts, recorder, media }
    }

    /// The radiance that a camera's ray brings, and what it met first.
    pub fn radiance(&mut self, ray: &Ray) -> Radiance {
        let mut first = FirstHit::NONE;
        let around = self.scene.around_camera.iter();
        let inside = around.fold(None, |inside, &medium| self.media.enter(inside, medium));
        let state = State { depth: 0, throughput: 1.0, inside };
        self.counts.camera += 1;
        self.recorder.begin(RayKind::Camera, ray);
        let color = self.value(ray, None, &state, Some(&mut first));
        self.recorder.end(Spectrum::ONE, color);
        let alpha = if first.object == FirstHit::NOTHING { 0.0 } else { 1.0 };
        Radiance { color, alpha, first }
    }

    /// Casts a further ray and returns its weighted value. Rays whose weight is too small to matter
    /// by the scene's setting are not cast.
    pub(super) fn follow(
        &mut self,
        kind: RayKind,
        leg: Leg,
        weight: Spectrum,
        state: &State,
        inside: Inside,
    ) -> Spectrum {
        let throughput = state.throughput * weight.max_element();
        if !(throughput > 0.0) || throughput < self.scene.settings.min_contribution {
            self.recorder
                .also("not_followed", || json!({"kind": kind, "weight": weight.to_array()}));
            return Spectrum::ZERO;
        }
        match kind {
            RayKind::Camera => self.counts.camera += 1,
            RayKind::Reflected => self.counts.reflect += 1,
            RayKind::Transmitted => self.counts.refract += 1,
        }
        self.recorder.begin(kind, &leg.ray);
        let state = State { depth: state.depth + 1, throughput, inside };
        let value = self.value(&leg.ray, Some(&leg), &state, None);
        self.recorder.end(weight, value);
        weight * value
    }

    /// What a ray sees: the surface or background, weakened by what lies between.
    fn value(
        &mut self,
        ray: &Ray,
        leg: Option<&Leg>,
        state: &State,
        first: Option<&mut FirstHit>,
    ) -> Spectrum {
        let (value, distance) = match self.nearest(ray, leg, state.inside) {
            Some((hit, shading)) => {
                let point = Point::new(ray, hit, shading, leg.map(|l| &l.departure));
                (self.surface(&point, state, first), hit.t)
            }
            None => {
                let value = self.scene.background.radiance(ray.direction);
                self.recorder.term("background", value, || (None, json!({})));
                (value, f64::INFINITY)
            }
        };
        self.attenuated(value, distance, state.inside)
    }

    /// The nearest hit. Inside of a transparent object its own surface comes before any other that
    /// coincides with it: the exit belongs to the object that was entered.
    fn nearest(&self, ray: &Ray, leg: Option<&Leg>, inside: Inside) -> Option<(Hit, Shading<'a>)> {
        let scene = self.scene;
        let departure = leg.map(|l| &l.departure);
        let hit = match leg {
            Some(l) => scene.world.closest_past(ray, f64::INFINITY, departure, l.contacts)?,
            None => scene.world.closest(ray, f64::INFINITY, None)?,
        };
        let shading = scene.shading(ray, &hit)?;
        if let Some(around) = self.media.top(inside).filter(|m| !m.object.same_object(&hit.id)) {
            let id = around.object;
            if let Some(exit) =
                scene.world.closest_of(ray, f64::INFINITY, departure, id.instance, id.object)
            {
                let at_exit = scene.shading(ray, &exit)?;
                if coincide(ray, (&hit, &shading), (&exit, &at_exit)) {
                    return Some((exit, at_exit));
                }
            }
        }
        Some((hit, shading))
    }

    /// Absorption by the innermost medium, and fog outside of all, over the distance of a ray.
    fn attenuated(&mut self, mut value: Spectrum, distance: f64, inside: Inside) -> Spectrum {
        let scene = self.scene;
        let left = match self.media.top(inside) {
            Some(medium) => absorbed(medium.absorption, distance / scene.root.scale()),
            None => scene.surroundings.transmittance(distance),
        };
        if left != Spectrum::ONE {
            self.recorder.note("absorption", || json!({"transmittance": left.to_array()}));
            self.recorder.scale("absorption", left);
            value *= left;
        }
        let Some(fog) = scene.fog.as_ref().filter(|_| inside.is_none()) else { return value };
        let left = fog.transmittance(distance);
        let glow = fog.color * (1.0 - left);
        self.recorder.scale("fog", Spectrum::splat(left));
        self.recorder.term("fog", glow, || (None, json!({"transmittance": left})));
        value * left + glow
    }

    /// What a surface sends back along a ray.
    fn surface(&mut self, point: &Point, state: &State, first: Option<&mut FirstHit>) -> Spectrum {
        if let Some(first) = first {
            *first = point.first_hit(self.scene);
        }
        let (scene, medium) = (self.scene, self.media.top(state.inside));
        self.recorder.hit(|| record(scene, point, state.depth, medium));

        if point.finish.optics == Optics::Opaque {
            return self.own(point);
        }
        if state.depth >= self.scene.settings.bounces {
            self.recorder.note("bounce_limit", || json!(self.scene.settings.bounces));
            // Glass has nothing of its own to show but highlights, and those on its outside.
            let hollow = matches!(point.finish.optics, Optics::Dielectric { .. });
            let within = hollow && !point.outside && point.is_solid(self.scene);
            return if within { Spectrum::ZERO } else { self.own(point) };
        }
        match point.finish.optics {
            Optics::Opaque => self.own(point),
            Optics::Mirror { reflect, grazing, roughness, covers } => {
                let facet = self.facet(point, roughness);
                let weight = schlick(reflect, grazing, -point.ray.direction.dot(facet));
                let mut own = self.own(point);
                if covers {
                    // Lacquer: what is mirrored never reaches the colour below.
                    own *= Spectrum::ONE - weight;
                    self.recorder.scale("coat", Spectrum::ONE - weight);
                }
                let leg = point.back(point.mirrored(facet));
                own + self.follow(RayKind::Reflected, leg, weight, state, state.inside)
            }
            Optics::Shares { own, ior, tint, absorption } => {
                self.through_by_shares(point, own, ior, tint, absorption, state)
            }
            Optics::Dielectric { ior, reflect, transmit, absorption, roughness } => {
                let medium = Medium { object: point.hit.id, ior, absorption };
                let how = Dielectric { reflect, transmit, roughness };
                self.dielectric(point, &medium, how, state)
            }
        }
    }

    /// The normal of the facet that this sample meets: the surface's own where it is smooth.
    pub(super) fn facet(&mut self, point: &Point, alpha: f64) -> DVec3 {
        if alpha > 0.0 {
            facet_normal(point.normal, point.ray.direction, alpha, self.stream.next_2d())
        } else {
            point.normal
        }
    }
}

/// What a recorder wants to know of a hit.
pub(super) fn record(
    scene: &Scene,
    point: &Point,
    depth: u32,
    medium: Option<&Medium>,
) -> HitRecord {
    let (s, p) = (&point.shading.surface, &point.shading.point);
    let mut detail = serde_json::Map::new();
    let mut put = |key: &str, value| drop(detail.insert(key.into(), value));
    put("point", json!(s.point.to_array()));
    put("point_in_file", json!(p.world.to_array()));
    put("point_in_object", json!(p.object.to_array()));
    put("normal", json!(s.normal.to_array()));
    put("shading_normal", json!(point.normal.to_array()));
    put("from_outside", json!(point.outside));
    put("uv", json!(s.uv.to_array()));
    put("pattern", json!(point.finish.base.to_array()));
    put("bounce", json!(depth));
    if let Some(medium) = medium {
        let object = scene.object_label(medium.object);
        let absorption = medium.absorption.to_array();
        put("medium", json!({"object": object, "ior": medium.ior, "absorption": absorption}));
    }
    HitRecord {
        object: scene.object_label(point.hit.id),
        source: scene.object_source(point.hit.id),
        t: point.hit.t,
        detail,
    }
}
