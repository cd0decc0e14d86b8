// SPDX-License-Identifier: MIT OR Apache-2.0
//! One step of a path: what its ray brings, what the surface there gets from a source, and where the path goes on.

use dioptric_geometry::Ray;
use dioptric_geometry::world::{Hit, Query};
use dioptric_math::{DVec3, Spectrum, orthonormal_basis};
use serde_json::{Value, json};

use super::tell::{Told, What};
use super::volume::Way;
use super::{Path, Paths, Round, Task, Wave};
use crate::bsdf::{self, Bsdf, BsdfSample};
use crate::guide::{self, Aim};
use crate::integrator::media::{Medium, Sides};
use crate::integrator::point::Point;
use crate::integrator::record::record;
use crate::integrator::recorder::Recorder;
use crate::integrator::resolve::resolve;
use crate::material::Optics;
use crate::sampling::stream::Stream;
use crate::scene::{Answer, Scene};
use crate::setting::render::LightSampling;
use crate::source::shining;
use crate::wavelength;

/// Bounces before chance may end a path.
pub(super) const SURE: u32 = 3;
/// What a path carries is worth so much more than that of its first ray: ending it saves less work than it took to get
/// there. (By measurement: docs/performance.md.)
pub(super) const WORTH: f64 = 2.0;
/// Who carries nearly all of its light goes on for sure but for this share: in a white room nothing else would end it.
pub(super) const MOST: f64 = 0.98;

/// The frame of a point: z is the shading normal that faces the viewer.
struct Frame {
    x: DVec3,
    y: DVec3,
    z: DVec3,
}

impl Frame {
    fn new(z: DVec3) -> Self {
        let (x, y) = orthonormal_basis(z);
        Self { x, y, z }
    }

    fn to_local(&self, v: DVec3) -> DVec3 {
        DVec3::new(v.dot(self.x), v.dot(self.y), v.dot(self.z))
    }

    fn to_world(&self, v: DVec3) -> DVec3 {
        self.x * v.x + self.y * v.y + self.z * v.z
    }
}

/// A surface that a path has met, ready to scatter.
struct Vertex<'a, 'b> {
    point: Point<'a>,
    frame: Frame,
    /// Towards the viewer, in the frame.
    wo: DVec3,
    bsdf: &'b Bsdf,
    sides: Sides,
    solid: bool,
    /// Whether it is not there, by the priorities of things that overlap.
    hidden: bool,
}

/// The share of the first of two ways to find the same light, by their densities: the power heuristic with exponent 2
/// (Veach and Guibas 1995, equation 14).
#[inline(always)]
pub(super) fn share(own: f64, other: f64) -> f64 {
    // A ratio: squares of densities may be too large for numbers.
    let ratio = other / own;
    1.0 / (1.0 + ratio * ratio)
}

/// What light counts that a path has met, by the densities with which its last surface sent it there and with which a
/// question would have found it.
fn share_of_path(how: LightSampling, path: f64, question: impl FnOnce() -> f64) -> f64 {
    // Sharp surfaces ask nobody, and some light can't be asked for.
    if path == f64::INFINITY {
        return 1.0;
    }
    let question = question();
    if question == 0.0 {
        return 1.0;
    }
    match how {
        LightSampling::Both => share(path, question),
        LightSampling::Lights => 0.0,
        LightSampling::Surfaces => 1.0,
    }
}

/// The same for light that a question has found. Sharp lights are found by nothing else.
pub(super) fn share_of_question(how: LightSampling, question: f64, path: f64) -> f64 {
    if question == f64::INFINITY {
        return 1.0;
    }
    match how {
        LightSampling::Both => share(question, path),
        LightSampling::Lights => 1.0,
        LightSampling::Surfaces => 0.0,
    }
}

/// Whether a path goes on that carries little: the chance of that, which its throughput is divided by.
pub(super) fn carries_on<I>(next: &mut Path<I>, stream: &mut Stream) -> Option<f64> {
    if next.depth <= SURE {
        return Some(1.0);
    }
    let [chance, _] = stream.next_2d();
    let goes_on = (next.throughput.max_element() / next.squeezed * WORTH).min(MOST);
    if chance >= goes_on {
        return None;
    }
    next.throughput /= goes_on;
    Some(goes_on)
}

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
        now: &Wave<R::Id>,
        number: usize,
        query: &Query,
        hit: Option<Hit>,
        bsdf: &mut Bsdf,
        round: &mut Round<R::Id>,
    ) -> bool {
        let scene = self.scene;
        let mut path = now.paths[number];
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
            if round.matte.push(number, &path, path.throughput, &point) {
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

    fn see_sky(&mut self, path: &Path<R::Id>, query: &Query) {
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
        let weight = share_of_path(scene.settings.light_sampling, path.density, || {
            scene.sources.density_of_hit(
                scene,
                path.from(query),
                path.normal,
                &point.hit,
                &point.surface,
                ray.direction,
            )
        });
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

    /// Asks a source, and sends the path on unless chance ends it; whether it goes on.
    fn scatter(&mut self, path: &Path<R::Id>, vertex: &Vertex, round: &mut Round<R::Id>) -> bool {
        let scene = self.scene;
        let mut stream = path.stream;
        let [pick_source, pick_lobe] = stream.next_2d();
        let mut aim = None;
        if vertex.bsdf.is_sharp() {
            stream.skip();
        } else {
            aim = scene.guide.as_ref().and_then(|g| g.aim(vertex.point.surface.point));
            let u = stream.next_2d();
            self.ask_source(path, vertex, aim.as_ref(), pick_source, u, round);
        }
        let u = stream.next_2d();
        let mut hint = if vertex.bsdf.is_sharp() { path.hint } else { 0.0 };
        let sampled = match &aim {
            Some(aim) => vertex.sample_guided(aim, pick_lobe, u, &mut hint),
            None => vertex.bsdf.sample(vertex.wo, pick_lobe, u),
        };
        let outgoing = sampled.and_then(|sample| Some((sample, vertex.outgoing(&sample)?)));
        let Some((sample, (through, direction))) = outgoing.filter(|(sample, _)| {
            let throughput = path.throughput * sample.weight;
            throughput.max_element() > 0.0 && throughput.is_finite()
        }) else {
            self.recorder.also(path.id, "bounces", || vertex.told(scene, path.depth));
            self.recorder.note(path.id, "ended", || json!("absorbed"));
            return false;
        };
        let throughput = path.throughput * sample.weight;
        let sharp = sample.is_sharp();
        let mut next = Path {
            throughput,
            density: sample.pdf,
            normal: vertex.light_side(),
            depth: path.depth + 1,
            trail: path.trail.then(sharp),
            walked: 0.0,
            hint,
            ..*path
        };
        let leg = if through {
            self.counts.refract += 1;
            next.inside = vertex.sides.far;
            if vertex.solid && vertex.point.finish.optics.bends().is_some() {
                next.squeezed *= vertex.squeeze();
            }
            vertex.point.on(direction)
        } else {
            self.counts.reflect += 1;
            next.inside = vertex.sides.near;
            vertex.point.back(direction)
        };
        let Some(goes_on) = carries_on(&mut next, &mut stream) else {
            self.recorder.also(path.id, "bounces", || vertex.told(scene, path.depth));
            self.recorder.note(path.id, "ended", || json!("by chance: it carried too little"));
            return false;
        };
        self.recorder.also(path.id, "bounces", || {
            let how = match (through, sharp) {
                (false, true) => "mirrors",
                (false, false) => "scatters",
                (true, true) => "lets through",
                (true, false) => "lets through and scatters",
            };
            let mut told = vertex.told(scene, path.depth);
            told["how"] = json!(how);
            told["weight"] = json!(sample.weight.to_array());
            if goes_on < 1.0 {
                told["goes_on"] = json!(goes_on);
            }
            told
        });
        next.stream = stream;
        round.go_on(Some((next, leg.query(f64::INFINITY))))
    }

    /// Picks a source and asks whether it is seen.
    fn ask_source(
        &mut self,
        path: &Path<R::Id>,
        vertex: &Vertex,
        aim: Option<&Aim>,
        pick: f64,
        u: [f64; 2],
        round: &mut Round<R::Id>,
    ) {
        let scene = self.scene;
        let point = &vertex.point;
        let from = point.surface.point;
        let Some(source) = scene.sources.sample(scene, from, vertex.light_side(), pick, u) else {
            return;
        };
        let wi = vertex.frame.to_local(source.direction);
        let front = point.geometric().dot(source.direction) > 0.0;
        if front != (wi.z > 0.0) {
            return;
        }
        let (scattered, density) = vertex.bsdf.eval_pdf(vertex.wo, wi);
        if scattered == Spectrum::ZERO {
            return;
        }
        let density = match aim {
            Some(aim) => guided(aim.density(source.direction), density),
            None => density,
        };
        let weight = share_of_question(scene.settings.light_sampling, source.pdf, density);
        if weight == 0.0 {
            return;
        }
        let inside = if front { vertex.sides.near } else { vertex.sides.far };
        let clear = self.clear_to_source(inside, source.distance);
        let value = path.throughput * scattered * source.value * weight * clear;
        if !(value.max_element() > 0.0 && value.is_finite()) {
            return;
        }
        let mut query = if front {
            point.to_light()
        } else {
            point.on(source.direction).query(source.distance)
        };
        query.ray.direction = source.direction;
        query.t_max = source.distance;
        let value = self.clamped(path.depth + 1, value);
        round.shadows.push(query);
        let sharp = source.pdf == f64::INFINITY;
        round.tasks.push(Task { sample: path.sample, id: path.id, value, sharp, inside });
        if R::ENABLED {
            let told =
                Told::asked(What::Light(source.source), path.trail.then(false), weight, value);
            round.told.push(told);
        }
    }
}

/// The density of directions that a guide and the surface find together.
fn guided(guide: f64, own: f64) -> f64 {
    guide::SHARE * guide + (1.0 - guide::SHARE) * own
}

impl Vertex<'_, '_> {
    /// A direction from a guide or from the surface itself, counted by both. A guide may say which wavelength to expect.
    fn sample_guided(
        &self,
        aim: &Aim,
        pick: f64,
        u: [f64; 2],
        hint: &mut f64,
    ) -> Option<BsdfSample> {
        let (wi, scattered, guide, own);
        if pick < guide::SHARE {
            let (direction, wavelength) = aim.sample(pick / guide::SHARE, u)?;
            *hint = wavelength;
            wi = self.frame.to_local(direction);
            (scattered, own) = self.bsdf.eval_pdf(self.wo, wi);
            guide = aim.density(direction);
        } else {
            let pick = (pick - guide::SHARE) / (1.0 - guide::SHARE);
            let sample = self.bsdf.sample(self.wo, pick.min(1.0 - f64::EPSILON), u)?;
            if sample.is_sharp() {
                return Some(BsdfSample { weight: sample.weight / (1.0 - guide::SHARE), ..sample });
            }
            (wi, scattered, own) = (sample.wi, sample.weight * sample.pdf, sample.pdf);
            guide = aim.density(self.frame.to_world(wi));
        }
        let pdf = guided(guide, own);
        let usable = pdf > 0.0 && pdf < f64::INFINITY && scattered != Spectrum::ZERO;
        usable.then(|| BsdfSample { wi, weight: scattered / pdf, pdf })
    }

    /// Whether a sample goes through the surface, and its direction; nothing where a bent normal sends it to the
    /// wrong side. Sharp ones are turned at the true surface instead.
    fn outgoing(&self, sample: &BsdfSample) -> Option<(bool, DVec3)> {
        let through = sample.wi.z < 0.0;
        let direction = self.frame.to_world(sample.wi);
        let geometric = self.point.geometric();
        let height = direction.dot(geometric);
        if (height < 0.0) == through && height != 0.0 {
            return Some((through, direction));
        }
        (sample.is_sharp() && height != 0.0)
            .then(|| (through, direction - geometric * (2.0 * height)))
    }

    /// The normal of the side from which light is wanted; none where it is from both.
    fn light_side(&self) -> Option<DVec3> {
        (!self.bsdf.is_translucent()).then_some(self.point.normal)
    }

    /// The surface, for `why`.
    fn told(&self, scene: &Scene, depth: u32) -> Value {
        let point = &self.point;
        json!({
            "bounce": depth,
            "object": scene.object_label(point.hit.id),
            "source": scene.object_source(point.hit.id),
            "t": point.hit.t,
            "point": point.surface.point.to_array(),
            "normal": point.normal.to_array(),
        })
    }

    /// What going through does to radiance: the ratio of the indices squared.
    fn squeeze(&self) -> f64 {
        let eta = self.sides.eta();
        eta * eta
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_ways_to_find_light_add_up_to_one() {
        for how in [LightSampling::Both, LightSampling::Lights, LightSampling::Surfaces] {
            for (path, question) in [(1.0, 1.0), (1e-3, 5.0), (1e200, 1e-200), (3.0, 1e300)] {
                let sum =
                    share_of_path(how, path, || question) + share_of_question(how, question, path);
                assert!((sum - 1.0).abs() < 1e-12, "{how:?} {path} {question}: {sum}");
            }
            assert_eq!(share_of_path(how, f64::INFINITY, || 2.0), 1.0);
            assert_eq!(share_of_path(how, 2.0, || 0.0), 1.0);
            assert_eq!(share_of_question(how, f64::INFINITY, 2.0), 1.0);
        }
        assert!(share_of_path(LightSampling::Both, 10.0, || 1.0) > 0.99);
    }
}
