// SPDX-License-Identifier: MIT OR Apache-2.0
//! Whitted's picture: every surface shows its own colour under the lights, and rays go on where it
//! mirrors or lets through (Whitted, "An Improved Illumination Model for Shaded Display", CACM 23(6),
//! 1980). This file follows rays; [`super::direct`] lights a point and [`super::passage`] goes through
//! objects with fixed shares.

use dioptric_geometry::world::Hit;
use dioptric_geometry::{Departure, Ray};
use dioptric_math::{DVec3, Spectrum};
use serde_json::json;

use super::media::{Inside, Media, Medium, absorbed};
use super::optics::{facet_normal, fresnel, reflect as mirror, refract, schlick};
use super::recorder::{HitRecord, RayKind, Recorder};
use crate::film::{FirstHit, Radiance};
use crate::material::{Finish, Optics};
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

/// A point being shaded, with the incoming ray.
pub(super) struct Point<'a> {
    pub ray: Ray,
    pub hit: Hit,
    pub shading: Shading<'a>,
    pub finish: Finish,
    /// The shading normal, facing the incoming ray.
    pub normal: DVec3,
    /// Whether the ray comes from the side of the geometric normal: from outside of a solid.
    pub outside: bool,
}

impl Point<'_> {
    /// A ray that leaves this point.
    pub fn spawn(&self, direction: DVec3) -> (Ray, Departure) {
        let s = &self.shading.surface;
        let ray = Ray { origin: s.point, direction, time: self.ray.time, error: s.error };
        (ray, Departure { from: self.hit.id, outward: direction.dot(s.normal) > 0.0 })
    }

    /// The geometric normal, facing the incoming ray.
    pub fn geometric(&self) -> DVec3 {
        if self.outside { self.shading.surface.normal } else { -self.shading.surface.normal }
    }
}

impl<'a, R: Recorder> Whitted<'a, R> {
    /// Ready for one camera's ray.
    pub fn new(
        scene: &'a Scene,
        stream: &'a mut Stream,
        counts: &'a mut RayCounts,
        recorder: &'a mut R,
    ) -> Self {
        Self { scene, stream, counts, recorder, media: Media::new(scene.surroundings.ior) }
    }

    /// The radiance that a camera's ray brings, and what it met first.
    pub fn radiance(&mut self, ray: &Ray) -> Radiance {
        let mut first = FirstHit::NONE;
        let state = State { depth: 0, throughput: 1.0, inside: None };
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
        (ray, departure): (Ray, Departure),
        weight: Spectrum,
        state: &State,
        inside: Inside,
    ) -> Spectrum {
        let throughput = state.throughput * weight.max_element();
        if !(throughput > 0.0) || throughput < self.scene.settings.min_contribution {
            self.recorder
                .note("not_followed", || json!({"kind": kind, "weight": weight.to_array()}));
            return Spectrum::ZERO;
        }
        match kind {
            RayKind::Camera => self.counts.camera += 1,
            RayKind::Reflected => self.counts.reflect += 1,
            RayKind::Transmitted => self.counts.refract += 1,
        }
        self.recorder.begin(kind, &ray);
        let value = self.value(
            &ray,
            Some(&departure),
            &State { depth: state.depth + 1, throughput, inside },
            None,
        );
        self.recorder.end(weight, value);
        weight * value
    }

    /// What a ray sees: the surface or background, weakened by what lies between.
    fn value(
        &mut self,
        ray: &Ray,
        departure: Option<&Departure>,
        state: &State,
        first: Option<&mut FirstHit>,
    ) -> Spectrum {
        let (value, distance) = match self.nearest(ray, departure, state.inside) {
            Some((hit, shading)) => (self.surface(ray, hit, shading, state, first), hit.t),
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
    fn nearest(
        &self,
        ray: &Ray,
        departure: Option<&Departure>,
        inside: Inside,
    ) -> Option<(Hit, Shading<'a>)> {
        let scene = self.scene;
        let hit = scene.world.closest(ray, f64::INFINITY, departure)?;
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
            self.recorder.scale(left);
            value *= left;
        }
        let Some(fog) = scene.fog.as_ref().filter(|_| inside.is_none()) else { return value };
        let left = fog.transmittance(distance);
        let glow = fog.color * (1.0 - left);
        self.recorder.scale(Spectrum::splat(left));
        self.recorder.term("fog", glow, || (None, json!({"transmittance": left})));
        value * left + glow
    }

    /// What a surface sends back along a ray.
    fn surface(
        &mut self,
        ray: &Ray,
        hit: Hit,
        shading: Shading<'_>,
        state: &State,
        first: Option<&mut FirstHit>,
    ) -> Spectrum {
        let finish = shading.material.finish(&shading.point);
        let s = &shading.surface;
        let normal = if ray.direction.dot(s.shading_normal) > 0.0 {
            -s.shading_normal
        } else {
            s.shading_normal
        };
        let outside = ray.direction.dot(s.normal) <= 0.0;
        if let Some(first) = first {
            *first = FirstHit {
                object: self.scene.layer_id(hit.id),
                depth: hit.t,
                normal,
                albedo: finish.base,
            };
        }
        let point = Point { ray: *ray, hit, shading, finish, normal, outside };
        let (scene, medium) = (self.scene, self.media.top(state.inside));
        self.recorder.hit(|| record(scene, &point, state, medium));

        if point.finish.optics == Optics::Opaque {
            return self.own(&point);
        }
        if state.depth >= self.scene.settings.bounces {
            self.recorder.note("bounce_limit", || json!(self.scene.settings.bounces));
            return self.own(&point);
        }
        match point.finish.optics {
            Optics::Opaque => self.own(&point),
            Optics::Mirror { reflect, grazing, roughness, covers } => {
                let facet = self.facet(&point, roughness);
                let weight = schlick(reflect, grazing, -ray.direction.dot(facet));
                let mut own = self.own(&point);
                if covers {
                    // Lacquer: what is mirrored never reaches the colour below.
                    own *= Spectrum::ONE - weight;
                    self.recorder.scale(Spectrum::ONE - weight);
                }
                let direction = above(&point, mirror(ray.direction, facet));
                own + self.follow(
                    RayKind::Reflected,
                    point.spawn(direction),
                    weight,
                    state,
                    state.inside,
                )
            }
            Optics::Shares { own, ior, tint, absorption } => {
                self.through_by_shares(&point, own, ior, tint, absorption, state)
            }
            Optics::Dielectric { ior, reflect, transmit, absorption, roughness } => {
                let medium = Medium { object: point.hit.id, ior, absorption };
                self.dielectric(&point, &medium, reflect, transmit, roughness, state)
            }
        }
    }

    /// The normal of the facet that this sample meets: the surface's own where it is smooth.
    fn facet(&mut self, point: &Point, alpha: f64) -> DVec3 {
        if alpha > 0.0 {
            facet_normal(point.normal, alpha, self.stream.next_2d())
        } else {
            point.normal
        }
    }

    /// Reflection and refraction by Fresnel at one interface.
    fn dielectric(
        &mut self,
        point: &Point,
        medium: &Medium,
        tint_reflected: Spectrum,
        tint_through: Spectrum,
        alpha: f64,
        state: &State,
    ) -> Spectrum {
        let scene = self.scene;
        let solid = scene.world.shape(point.hit.id.object).is_some_and(|s| s.is_solid());
        // Light of its own (highlights) and tints show on the outside only; a pane has no other side.
        let outer_side = point.outside || !solid;
        let mut value = if outer_side { self.own(point) } else { Spectrum::ZERO };
        let here = self.media.ior(state.inside);
        let (from, to, inside) = if !solid {
            // A pane without thickness: it mirrors, and what goes through goes straight on.
            (here, here * medium.ior, state.inside)
        } else if point.outside {
            (here, medium.ior, self.media.enter(state.inside, *medium))
        } else {
            // An object that the ray never entered (the camera is inside of it) is left all the same.
            let known = self.media.contains(state.inside, &medium.object);
            let outer = self.media.leave(state.inside, &medium.object);
            (if known { here } else { medium.ior }, self.media.ior(outer), outer)
        };
        let eta = from / to;
        let d = point.ray.direction;
        let facet = self.facet(point, alpha);
        let through = if solid { refract(d, facet, eta) } else { Some(d) };
        let reflected = if through.is_none() { 1.0 } else { fresnel(-d.dot(facet), eta) };
        self.recorder.note("fresnel", || {
            json!({"ior_from": from, "ior_to": to, "reflected": reflected, "total_internal_reflection": through.is_none()})
        });
        if reflected > 0.0 {
            let direction = above(point, mirror(d, facet));
            let tint = if outer_side { tint_reflected } else { Spectrum::ONE };
            value += self.follow(
                RayKind::Reflected,
                point.spawn(direction),
                tint * reflected,
                state,
                state.inside,
            );
        }
        if let Some(direction) = through.filter(|t| t.dot(point.geometric()) < 0.0) {
            let tint = if outer_side { tint_through } else { Spectrum::ONE };
            let weight = tint * (1.0 - reflected);
            value +=
                self.follow(RayKind::Transmitted, point.spawn(direction), weight, state, inside);
        }
        value
    }
}

/// What a recorder wants to know of a hit.
fn record(scene: &Scene, point: &Point, state: &State, medium: Option<&Medium>) -> HitRecord {
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
    put("bounce", json!(state.depth));
    if let Some(medium) = medium {
        put("medium", json!({"object": scene.object_label(medium.object), "ior": medium.ior}));
    }
    HitRecord {
        object: scene.object_label(point.hit.id),
        source: scene.object_source(point.hit.id),
        t: point.hit.t,
        detail,
    }
}

/// Whether two hits of one ray are the same point within their error bounds.
pub(super) fn coincide(ray: &Ray, a: (&Hit, &Shading), b: (&Hit, &Shading)) -> bool {
    let (sa, sb) = (&a.1.surface, &b.1.surface);
    let apart = (b.0.t - a.0.t).abs() * ray.direction.dot(sb.normal).abs();
    apart <= sa.error + sb.error + ray.error
}

/// A reflected direction that stays on its side of the true surface: normals that were bent (by bumps,
/// by vertex normals, by roughness) may send it below.
fn above(point: &Point, direction: DVec3) -> DVec3 {
    if direction.dot(point.geometric()) > 0.0 {
        direction
    } else {
        mirror(point.ray.direction, point.geometric())
    }
}
