// SPDX-License-Identifier: MIT OR Apache-2.0
//! Transparency by fixed shares, as in the report: `own * surface + (1 - own) * seen`, once, where the
//! ray enters. The way through the object, inner reflections included, counts as one bounce.

use dioptric_geometry::world::Hit;
use dioptric_geometry::{Contacts, HitId, Ray, SurfacePoint};
use dioptric_math::Spectrum;
use serde_json::{Value, json};

use super::media::{Medium, absorbed};
use super::optics::facing;
use super::point::{Leg, coincide, leave, mirrored, refracted};
use super::recorder::{RayKind, Recorder};
use super::whitted::{Met, Whitted};
use crate::material::Optics;
use crate::scene::Shading;

/// Inner reflections that are followed before the light is given up as lost.
pub const INNER_REFLECTIONS: u32 = 64;

/// How a way through an object ends.
enum End {
    /// The ray leaves the object.
    Outside(Leg),
    /// Something is in the way inside: another object, or a part of this one that is not transparent.
    Inside(Leg),
    /// It was reflected too often.
    Lost,
}

/// The way through: how it ends, what is left of the light, and the corners for a recorder.
struct Passage {
    end: End,
    left: Spectrum,
    corners: Vec<Value>,
}

impl<R: Recorder> Whitted<'_, '_, R> {
    /// Sends the ray on through a surface that lets through by shares.
    pub(super) fn through_by_shares(
        &mut self,
        met: &Met<R::Id>,
        share: f64,
        ior: f64,
        tint: Spectrum,
        absorption: Spectrum,
    ) {
        let point = &met.point;
        let id = met.way.id;
        let priority = self.scene.interior(point.hit.id).priority;
        let medium = Medium { object: point.hit.id, ior, absorption, priority };
        let solid = point.is_solid(self.scene);
        if solid && !point.outside {
            // From within (the camera is inside, or an object in there sent the ray): only the exit is left.
            // The way to here was weakened by whoever knows its length, if it was known to be inside.
            let surface = &point.surface;
            let step = match exit(&point.ray, point.hit.id, surface, ior) {
                Step::Out(leg) => {
                    Step::Out(Leg { contacts: point.on(leg.ray.direction).contacts, ..leg })
                }
                Step::In(leg) => {
                    Step::In(Leg { contacts: point.back(leg.ray.direction).contacts, ..leg })
                }
            };
            let passage = self.pass(step, &medium);
            self.beyond(met, passage, Spectrum::ONE, &medium);
            return;
        }
        if met.wants_own {
            self.nodes[met.node].own = met.own * share;
            self.recorder.scale(id, "own share", Spectrum::splat(share));
        }
        let straight =
            |leg| Passage { end: End::Outside(leg), left: Spectrum::ONE, corners: Vec::new() };
        let passage = if solid {
            // Entering a denser object always succeeds; a thinner one may reflect all, which is then followed.
            match point.refracted(point.normal, 1.0 / ior) {
                Some(direction) => self.pass(Step::In(point.on(direction)), &medium),
                None => {
                    self.recorder.note(id, "total_external_reflection", || json!(true));
                    straight(point.back(point.mirrored(point.normal)))
                }
            }
        } else {
            // Without an inside there is no exit: straight on.
            straight(point.on(point.ray.direction))
        };
        self.beyond(met, passage, tint * (1.0 - share), &medium);
    }

    /// Sends the ray to what is seen behind the object.
    fn beyond(&mut self, met: &Met<R::Id>, passage: Passage, weight: Spectrum, medium: &Medium) {
        let Passage { end, left, corners } = passage;
        let id = met.way.id;
        self.recorder.note(
            id,
            "passage",
            || json!({"ior": medium.ior, "transmittance": left.to_array(), "corners": corners}),
        );
        let weight = weight * left;
        let outer = self.media.leave(met.way.inside, &medium.object);
        match end {
            End::Outside(leg) => self.follow(met, 0, RayKind::Transmitted, leg, weight, outer),
            End::Inside(leg) => {
                // Its index is relative to what is around it; for what is inside of it that counts too.
                let ior = medium.ior * self.media.ior(outer);
                let inside = self.media.enter(outer, Medium { ior, ..*medium });
                self.follow(met, 0, RayKind::Transmitted, leg, weight, inside);
            }
            End::Lost => {
                self.recorder.note(id, "inner_reflection_limit", || json!(INNER_REFLECTIONS));
            }
        }
    }

    /// Follows a ray inside of one object until it gets out. The exit belongs to the object that was
    /// entered, even where another surface coincides with it.
    fn pass(&mut self, start: Step, medium: &Medium) -> Passage {
        let scene = self.scene;
        let mut left = Spectrum::ONE;
        let mut corners = Vec::new();
        let mut step = start;
        for _ in 0..=INNER_REFLECTIONS {
            let leg = match step {
                Step::Out(leg) => return Passage { end: End::Outside(leg), left, corners },
                Step::In(leg) => leg,
            };
            self.counts.inside += 1;
            let Leg { ray, departure, .. } = &leg;
            let id = medium.object;
            let hit =
                scene.world.closest_of(ray, f64::INFINITY, Some(departure), id.instance, id.object);
            let Some((hit, shading)) = hit.and_then(|hit| Some((hit, scene.shading(ray, &hit)?)))
            else {
                // Rounding at an edge: the exit is where the ray already is.
                return Passage { end: End::Outside(leg), left, corners };
            };
            if !lets_out(&shading) || self.something_between(&leg, &hit, &shading) {
                return Passage { end: End::Inside(leg), left, corners };
            }
            left *= absorbed(medium.absorption, hit.t / scene.root.scale());
            step = exit(ray, hit.id, &shading.surface, medium.ior);
            if R::ENABLED {
                let reflected = matches!(step, Step::In(..));
                corners.push(json!({
                    "t": hit.t,
                    "point": shading.surface.point.to_array(),
                    "normal": shading.surface.normal.to_array(),
                    "event": if reflected { "total internal reflection" } else { "exit" },
                }));
            }
        }
        match step {
            Step::Out(leg) => Passage { end: End::Outside(leg), left, corners },
            Step::In(..) => Passage { end: End::Lost, left, corners },
        }
    }

    /// Whether another object lies inside, before the exit and not in the same place.
    fn something_between(&mut self, leg: &Leg, exit: &Hit, at_exit: &Shading) -> bool {
        let scene = self.scene;
        self.counts.inside += 1;
        scene
            .world
            .closest_past(&leg.ray, exit.t, Some(&leg.departure), leg.contacts)
            .filter(|h| !h.id.same_object(&exit.id))
            .is_some_and(|other| {
                scene
                    .shading(&leg.ray, &other)
                    .is_some_and(|s| !coincide(&leg.ray, (&other, &s), (exit, at_exit)))
            })
    }
}

/// Where a ray goes from the inner side of a surface.
enum Step {
    Out(Leg),
    In(Leg),
}

/// Whether what is met from within is transparent by shares too: patches and parts of combined solids may
/// differ.
fn lets_out(shading: &Shading) -> bool {
    matches!(shading.finish.optics, Optics::Shares { .. })
}

/// How a ray goes on at a point that was hit from within, of an object with this relative index.
fn exit(ray: &Ray, from: HitId, s: &SurfacePoint, ior: f64) -> Step {
    let d = ray.direction;
    let normal = facing(d, s.normal, s.shading_normal);
    let geometric = facing(d, s.normal, s.normal);
    match refracted(d, normal, geometric, ior) {
        Some(direction) => Step::Out(leave(ray, from, s, direction)),
        None => {
            let leg = leave(ray, from, s, mirrored(d, normal, geometric));
            Step::In(Leg { contacts: Contacts { crossed: false, except: None }, ..leg })
        }
    }
}
