// SPDX-License-Identifier: MIT OR Apache-2.0
//! One step of a path: what its ray brings, and the surface that it meets.

use dioptric_geometry::Ray;
use dioptric_geometry::world::{Hit, Query};
use dioptric_math::{DVec3, Spectrum};
use serde_json::json;

use super::manifold::Over;
use super::scatter::{Frame, Vertex};
use super::tell::{Told, What};
use super::volume::Way;
use super::weights::share_of_path;
use super::{Path, Paths, Round, Wave};
use crate::bsdf::{self, Bsdf};
use crate::integrator::media::{Medium, Sides};
use crate::integrator::point::Point;
use crate::integrator::record::record;
use crate::integrator::recorder::Recorder;
use crate::integrator::resolve::resolve;
use crate::material::Optics;
use crate::scene::Answer;
use crate::source::shining;
use crate::wavelength;

impl<I> Path<I> {
    /// Where its line began: with its ray, but for borders that do nothing.
    fn from(&self, query: &Query) -> DVec3 {
        let Ray { origin, direction, .. } = query.ray;
        if self.walked == 0.0 { origin } else { origin - direction * self.walked }
    }
}

impl<'a, R: Recorder> Paths<'a, '_, R> {
    /// What a path's ray met; whether the path goes on.
    pub(super) fn meet(
        &mut self,
        now: &Wave,
        number: usize,
        query: &Query,
        hit: Option<Hit>,
        bsdf: &mut Bsdf,
        round: &mut Round<R::Id>,
    ) -> bool {
        let scene = self.scene;
        let mut path = round.paths[now.slots[number] as usize];
        let found = hit.and_then(|hit| {
            resolve(scene, &self.media, &query.ray, || *query, hit, path.inside, &mut round.spare)
        });
        let t = found.as_ref().map_or(f64::INFINITY, |(hit, _)| hit.t);
        let way = if scene.insides.scatter {
            self.scatter_inside(&mut path, query, t, round)
        } else {
            Way::CLEAR
        };
        self.pass_lights(&path, query, t);
        self.cross_space(&mut path, t);
        let Some((hit, shading)) = found else {
            self.see_sky(&path, query);
            if way.through.is_none() {
                return round.go_on(way.turned);
            }
            self.recorder.note(path.id, "ended", || json!("outside of the scene"));
            return false;
        };
        let point = Point::new(&query.ray, hit, shading, query.departure().as_ref());
        if scene.insides.borders && scene.interior(point.hit.id).border {
            let Some(chance) = way.through else { return round.go_on(way.turned) };
            path.throughput /= chance;
            return round.go_on(self.cross_border(&path, &point));
        }
        if path.depth == 0 {
            let mut first = point.first_hit(scene);
            first.depth += path.walked;
            self.radiances[path.sample as usize].first = first;
            let medium = self.media.top(path.inside);
            self.recorder.hit(path.id, || {
                let mut told = record(scene, &point, 0, medium);
                told.t += path.walked;
                told
            });
        }
        self.see_glow(&path, query, &point);
        // The ray after the last bounce brings only what shines by itself: the other half of direct light.
        let last = path.depth > scene.settings.bounces;
        let (goes_on, finish) = if way.through.is_none() {
            (round.go_on(way.turned), point.finish)
        } else if last && !scene.insides.overlap {
            self.recorder.note(path.id, "ended", || json!("at the limit of bounces"));
            (false, point.finish)
        } else if self.in_lanes && !last && point.finish.is_matte() {
            if round.matte.push(&path, path.throughput, &point) {
                self.scatter_matte(now, round);
            }
            (true, point.finish)
        } else {
            path.throughput /= way.through.unwrap_or(1.0);
            if scene.insides.disperse && path.wavelength == 0.0 {
                self.disperse(&mut path, &point);
            }
            let vertex = self.vertex(&path, point, bsdf);
            let goes_on = if vertex.hidden {
                // No question comes through what seems to be there.
                path.density = f64::INFINITY;
                round.go_on(Self::go_on(&path, &vertex.point, vertex.sides.far))
            } else if self.photons.is_some() && !vertex.bsdf.is_sharp() {
                self.keep_photon(&path, query, vertex.point.surface.point);
                false
            } else if last {
                self.recorder.note(path.id, "ended", || json!("at the limit of bounces"));
                false
            } else {
                self.scatter(&path, &vertex, round)
            };
            (goes_on, vertex.point.finish)
        };
        if let Answer::Here(answer) = finish {
            round.spare.push(answer);
        }
        goes_on
    }

    /// Lights with a size that the ray passes: they are no objects. From the camera they are not seen, as in
    /// Whitted's pictures.
    fn pass_lights(&mut self, path: &Path<R::Id>, query: &Query, t: f64) {
        if path.depth == 0 {
            return;
        }
        let scene = self.scene;
        let walked = path.walked;
        let ray = Ray { origin: path.from(query), ..query.ray };
        scene.sources.passed(
            &ray,
            path.normal,
            walked + t,
            |source, distance, radiance, density| {
                if distance < walked {
                    return;
                }
                let weight = share_of_path(scene.settings.light_sampling, path.density, || density);
                let clear = self.transmittance(path.inside, distance - walked);
                let value = path.throughput * clear * radiance * weight;
                self.add(path, value, || Told::seen(What::Light(source), path.trail, weight));
            },
        );
    }

    /// The way to what the ray met.
    fn cross_space(&mut self, path: &mut Path<R::Id>, t: f64) {
        let left = self.transmittance(path.inside, t);
        if let Some(fog) = self.scene.fog.as_ref().filter(|_| path.inside.is_none()) {
            let glow = path.throughput * fog.color * (1.0 - fog.transmittance(t));
            self.add(path, glow, || Told::seen(What::Fog, path.trail, 1.0));
        }
        path.throughput *= left;
    }

    pub(super) fn see_sky(&mut self, path: &Path<R::Id>, query: &Query) {
        let scene = self.scene;
        let radiance = scene.background.radiance(query.ray.direction);
        if radiance == Spectrum::ZERO {
            return;
        }
        let (from, direction) = (path.from(query), query.ray.direction);
        let weight = share_of_path(scene.settings.light_sampling, path.density, || {
            scene.sources.density_of_sky(from, path.normal, direction)
        });
        self.add(path, path.throughput * radiance * weight, || {
            Told::seen(What::Sky, path.trail, weight)
        });
    }

    /// Light of the surface's own.
    fn see_glow(&mut self, path: &Path<R::Id>, query: &Query, point: &Point) {
        if point.finish.emission == Spectrum::ZERO {
            return;
        }
        let scene = self.scene;
        let emission = shining(&point.finish, point.outside || !point.is_solid(scene));
        if emission == Spectrum::ZERO {
            return;
        }
        let Query { ray, .. } = query;
        let weight = if path.over == Over::No {
            share_of_path(scene.settings.light_sampling, path.density, || {
                scene.sources.density_of_hit(
                    scene,
                    path.from(query),
                    path.normal,
                    &point.hit,
                    &point.surface,
                    ray.direction,
                )
            })
        } else {
            self.share_over(path, ray, &point.hit, &point.surface)
        };
        let what = What::Object(point.hit.id);
        self.add(path, path.throughput * emission * weight, || {
            Told::seen(what, path.trail, weight)
        });
    }

    /// How the surface scatters, seen along the ray.
    fn vertex<'b>(
        &mut self,
        path: &Path<R::Id>,
        point: Point<'a>,
        bsdf: &'b mut Bsdf,
    ) -> Vertex<'a, 'b> {
        let solid = point.is_solid(self.scene);
        let (sides, hidden) = match point.finish.optics {
            Optics::Dielectric { ior, absorption, .. } => {
                let medium = self.medium(path, &point, ior, absorption);
                let sides = self.media.sides(path.inside, &medium, point.outside, solid);
                (sides, self.media.is_hidden(&sides, &medium, point.outside))
            }
            // Its index is relative to what is around it.
            Optics::Shares { ior, absorption, .. } => {
                let outer = self.media.leave(path.inside, &point.hit.id);
                let ior = ior * self.media.ior(outer);
                let medium = self.medium(path, &point, ior, absorption);
                (self.media.sides(path.inside, &medium, point.outside, solid), false)
            }
            Optics::Layered(layers) if layers.clear() > 0.0 => {
                let medium = self.medium(path, &point, layers.ior, Spectrum::ZERO);
                let sides = self.media.sides(path.inside, &medium, point.outside, solid);
                (sides, self.media.is_hidden(&sides, &medium, point.outside))
            }
            Optics::Opaque | Optics::Mirror { .. } | Optics::Layered(_) => {
                (Sides { ior: [1.0; 2], near: path.inside, far: path.inside }, false)
            }
        };
        let frame = Frame::new(point.normal);
        let wo = frame.to_local(-point.ray.direction);
        let seen = bsdf::Sides { eta: sides.eta(), outside: point.outside || !solid, solid };
        bsdf.set(&point.finish, &seen, wo);
        Vertex { point, frame, wo, bsdf, sides, solid, hidden }
    }

    /// The inside of what a path has met, for its wavelength.
    fn medium(&self, path: &Path<R::Id>, point: &Point, ior: f64, absorption: Spectrum) -> Medium {
        let object = point.hit.id;
        let interior = self.scene.interior(object);
        let ior = match interior.dispersion {
            Some(cauchy) if path.wavelength > 0.0 => cauchy.ior(path.wavelength),
            _ => ior,
        };
        let absorption = self.scene.extinction(object, absorption);
        Medium { object, ior, absorption, priority: interior.priority }
    }

    /// Picks a wavelength for a path that has met something which bends each by its own angle.
    fn disperse(&mut self, path: &mut Path<R::Id>, point: &Point) {
        let scene = self.scene;
        let bends = matches!(point.finish.optics, Optics::Dielectric { .. });
        if !bends || scene.interior(point.hit.id).dispersion.is_none() {
            return;
        }
        let (wavelength, weight) =
            wavelength::pick(path.throughput, path.hint, path.stream.next_1d());
        path.wavelength = wavelength;
        path.throughput *= weight;
        // What the camera is in was entered without one.
        path.inside = self.media.with_indices(path.inside, &|medium| {
            let dispersion = scene.interior(medium.object).dispersion;
            dispersion.map_or(medium.ior, |cauchy| cauchy.ior(wavelength))
        });
        self.recorder.note(path.id, "wavelength", || json!(wavelength * 1e3));
    }
}
