// SPDX-License-Identifier: MIT OR Apache-2.0
//! A surface that a path has met: what it gets from a source, and where the path goes on.

use dioptric_math::{DVec3, Spectrum, orthonormal_basis};
use serde_json::{Value, json};

use super::manifold::{Asking, NUMBERS, Over};
use super::tell::{Told, What};
use super::weights::{carries_on, share_of_question};
use super::{Path, Paths, Round, Task};
use crate::bsdf::{Bsdf, BsdfSample};
use crate::guide::{self, Aim};
use crate::integrator::media::Sides;
use crate::integrator::point::Point;
use crate::integrator::recorder::Recorder;
use crate::scene::Scene;
/// The frame of a point: z is the shading normal that faces the viewer.
pub(super) struct Frame {
    x: DVec3,
    y: DVec3,
    z: DVec3,
}

impl Frame {
    pub fn new(z: DVec3) -> Self {
        let (x, y) = orthonormal_basis(z);
        Self { x, y, z }
    }

    pub fn to_local(&self, v: DVec3) -> DVec3 {
        DVec3::new(v.dot(self.x), v.dot(self.y), v.dot(self.z))
    }

    fn to_world(&self, v: DVec3) -> DVec3 {
        self.x * v.x + self.y * v.y + self.z * v.z
    }
}

/// A surface that a path has met, ready to scatter.
pub(super) struct Vertex<'a, 'b> {
    pub point: Point<'a>,
    pub frame: Frame,
    /// Towards the viewer, in the frame.
    pub wo: DVec3,
    pub bsdf: &'b Bsdf,
    pub sides: Sides,
    pub solid: bool,
    /// Whether it is not there, by the priorities of things that overlap.
    pub hidden: bool,
}

impl<'a, R: Recorder> Paths<'a, '_, R> {
    /// Asks a source, and sends the path on unless chance ends it; whether it goes on.
    pub(super) fn scatter(
        &mut self,
        path: &Path<R::Id>,
        vertex: &Vertex,
        round: &mut Round<R::Id>,
    ) -> bool {
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
            if !scene.casters.is_empty() {
                self.ask_balls(path, vertex, aim.as_ref(), round);
            }
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
            over: Over::No,
            ..*path
        };
        if sharp && !scene.casters.is_empty() {
            let Point { ray, hit, outside, .. } = &vertex.point;
            next.over = self.over(path, ray, &hit.id, *outside, through);
        }
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
        next.stream = if scene.casters.is_empty() { stream } else { path.stream.ahead(NUMBERS) };
        round.go_on(Some((next, leg.query(f64::INFINITY))))
    }

    /// Asks for light over balls.
    fn ask_balls(
        &self,
        path: &Path<R::Id>,
        vertex: &Vertex,
        aim: Option<&Aim>,
        round: &mut Round<R::Id>,
    ) {
        let (Some(normal), None) = (vertex.light_side(), path.inside) else { return };
        let geometric = vertex.point.geometric();
        let asking = Asking { normal, geometric, query: vertex.point.to_light() };
        self.ask_over(path, &asking, round, |direction| {
            let wi = vertex.frame.to_local(direction);
            let (scattered, density) = vertex.bsdf.eval_pdf(vertex.wo, wi);
            match aim {
                Some(aim) => (scattered, guided(aim.density(direction), density)),
                None => (scattered, density),
            }
        });
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
