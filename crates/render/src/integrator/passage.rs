// SPDX-License-Identifier: MIT OR Apache-2.0
//! Transparency by fixed shares, as in the report: `own * surface + (1 - own) * seen`, once, where the
//! ray enters. The way through the object, inner reflections included, counts as one bounce.

use dioptric_geometry::world::Hit;
use dioptric_geometry::{Departure, Ray};
use dioptric_math::Spectrum;
use serde_json::{Value, json};

use super::media::{Medium, absorbed};
use super::optics::{reflect, refract};
use super::recorder::{RayKind, Recorder};
use super::whitted::{Point, State, Whitted, coincide};
use crate::scene::Shading;

/// Inner reflections that are followed before the light is given up as lost.
pub const INNER_REFLECTIONS: u32 = 64;

/// How a way through an object ends.
enum End {
    /// The ray leaves the object.
    Outside(Ray, Departure),
    /// Another object is in the way inside.
    Inside(Ray, Departure),
    /// It was reflected too often.
    Lost,
}

/// The way through: how it ends, what is left of the light, and the corners for a recorder.
struct Passage {
    end: End,
    left: Spectrum,
    corners: Vec<Value>,
}

impl<'a, R: Recorder> Whitted<'a, R> {
    /// The value of a surface that lets through by shares.
    pub(super) fn through_by_shares(
        &mut self,
        point: &Point,
        share: f64,
        ior: f64,
        tint: Spectrum,
        absorption: Spectrum,
        state: &State,
    ) -> Spectrum {
        let medium = Medium { object: point.hit.id, ior, absorption };
        let solid = self.scene.world.shape(point.hit.id.object).is_some_and(|s| s.is_solid());
        // A pane has no inside: it looks the same from both sides.
        if solid && !point.outside {
            // From within (the camera is inside, or an object in there sent the ray): only the exit is left.
            // The way to here was weakened by whoever knows its length, if it was known to be inside.
            let passage = self.pass(self.leave(point, ior), &medium, point.ray.time);
            return self.beyond(passage, Spectrum::ONE, &medium, state);
        }
        let own = if share > 0.0 {
            let own = self.own(point) * share;
            self.recorder.scale(Spectrum::splat(share));
            own
        } else {
            Spectrum::ZERO
        };
        let passage = if solid {
            // Entering a denser object always succeeds; a thinner one may reflect all, which is then followed.
            match refract(point.ray.direction, point.normal, 1.0 / ior) {
                Some(direction) => {
                    let (ray, departure) = point.spawn(direction);
                    let start = if departure.outward {
                        Step::Out(ray, departure)
                    } else {
                        Step::In(ray, departure)
                    };
                    self.pass(start, &medium, point.ray.time)
                }
                None => {
                    let (ray, departure) = point.spawn(reflect(point.ray.direction, point.normal));
                    self.recorder.note("total_external_reflection", || json!(true));
                    Passage {
                        end: End::Outside(ray, departure),
                        left: Spectrum::ONE,
                        corners: Vec::new(),
                    }
                }
            }
        } else {
            // Without an inside there is no exit: straight on.
            let (ray, departure) = point.spawn(point.ray.direction);
            Passage { end: End::Outside(ray, departure), left: Spectrum::ONE, corners: Vec::new() }
        };
        own + self.beyond(passage, tint * (1.0 - share), &medium, state)
    }

    /// What is seen behind the object.
    fn beyond(
        &mut self,
        passage: Passage,
        weight: Spectrum,
        medium: &Medium,
        state: &State,
    ) -> Spectrum {
        let Passage { end, left, corners } = passage;
        self.recorder.note(
            "passage",
            || json!({"ior": medium.ior, "transmittance": left.to_array(), "corners": corners}),
        );
        let weight = weight * left;
        match end {
            End::Outside(ray, departure) => {
                let outer = self.media.leave(state.inside, &medium.object);
                self.follow(RayKind::Transmitted, (ray, departure), weight, state, outer)
            }
            End::Inside(ray, departure) => {
                let outer = self.media.leave(state.inside, &medium.object);
                let inside = self.media.enter(outer, *medium);
                self.follow(RayKind::Transmitted, (ray, departure), weight, state, inside)
            }
            End::Lost => {
                self.recorder.note("inner_reflection_limit", || json!(INNER_REFLECTIONS));
                Spectrum::ZERO
            }
        }
    }

    /// Follows a ray inside of one object until it gets out. The exit belongs to the object that was
    /// entered, even where another surface coincides with it.
    fn pass(&mut self, start: Step, medium: &Medium, time: f64) -> Passage {
        let scene = self.scene;
        let mut left = Spectrum::ONE;
        let mut corners = Vec::new();
        let mut step = start;
        for _ in 0..=INNER_REFLECTIONS {
            let (ray, departure) = match step {
                Step::Out(ray, departure) => {
                    return Passage { end: End::Outside(ray, departure), left, corners };
                }
                Step::In(ray, departure) => (Ray { time, ..ray }, departure),
            };
            self.counts.inside += 1;
            let id = medium.object;
            let exit = scene.world.closest_of(
                &ray,
                f64::INFINITY,
                Some(&departure),
                id.instance,
                id.object,
            );
            let exit = exit.and_then(|hit| Some((hit, scene.shading(&ray, &hit)?)));
            let Some((hit, shading)) = exit else {
                // Rounding at an edge: the exit is where the ray already is.
                return Passage { end: End::Outside(ray, departure), left, corners };
            };
            if self.something_between(&ray, &departure, &hit, &shading) {
                return Passage { end: End::Inside(ray, departure), left, corners };
            }
            left *= absorbed(medium.absorption, hit.t / scene.root.scale());
            let at = Corner { ray, hit, shading };
            step = at.leave(medium.ior);
            if R::ENABLED {
                let reflected = matches!(step, Step::In(..));
                corners.push(json!({
                    "t": at.hit.t,
                    "point": at.shading.surface.point.to_array(),
                    "normal": at.shading.surface.normal.to_array(),
                    "event": if reflected { "total internal reflection" } else { "exit" },
                }));
            }
        }
        match step {
            Step::Out(ray, departure) => {
                Passage { end: End::Outside(ray, departure), left, corners }
            }
            Step::In(..) => Passage { end: End::Lost, left, corners },
        }
    }

    /// Whether another object lies inside, before the exit and not in the same place.
    fn something_between(
        &mut self,
        ray: &Ray,
        departure: &Departure,
        exit: &Hit,
        at_exit: &Shading,
    ) -> bool {
        let scene = self.scene;
        self.counts.inside += 1;
        scene
            .world
            .closest(ray, exit.t, Some(departure))
            .filter(|h| !h.id.same_object(&exit.id))
            .is_some_and(|other| {
                // What touches the surface from outside, where the ray came in, is not inside either.
                let touches_entry = other.t == 0.0;
                !touches_entry
                    && scene
                        .shading(ray, &other)
                        .is_some_and(|s| !coincide(ray, (&other, &s), (exit, at_exit)))
            })
    }

    /// The exit at a point that was hit from within.
    fn leave(&self, point: &Point, ior: f64) -> Step {
        let d = point.ray.direction;
        let direction = refract(d, point.normal, ior).unwrap_or_else(|| reflect(d, point.normal));
        let (ray, departure) = point.spawn(direction);
        if departure.outward { Step::Out(ray, departure) } else { Step::In(ray, departure) }
    }
}

/// Where a ray goes from the inner side of a surface.
enum Step {
    Out(Ray, Departure),
    In(Ray, Departure),
}

/// A point of the inner side.
struct Corner<'a> {
    ray: Ray,
    hit: Hit,
    shading: Shading<'a>,
}

impl Corner<'_> {
    fn leave(&self, ior: f64) -> Step {
        let s = &self.shading.surface;
        let d = self.ray.direction;
        let facing = if d.dot(s.normal) > 0.0 { -s.normal } else { s.normal };
        let (direction, outward) = match refract(d, facing, ior) {
            Some(direction) => (direction, true),
            None => (reflect(d, facing), false),
        };
        let ray = Ray { origin: s.point, direction, time: self.ray.time, error: s.error };
        let departure = Departure { from: self.hit.id, outward };
        if outward { Step::Out(ray, departure) } else { Step::In(ray, departure) }
    }
}
