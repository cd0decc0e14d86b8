// SPDX-License-Identifier: MIT OR Apache-2.0
//! Whitted's picture: every surface shows its own colour under the lights, and rays go on where it
//! mirrors or lets through (Whitted, "An Improved Illumination Model for Shaded Display", CACM 23(6),
//! 1980).
//!
//! Samples are followed in batches, a round at a time: cast all rays, light all points that they met, send the
//! rays that go on. So the rays that are cast together go similar ways, which is what makes casting them
//! fast. Each ray's value depends on its own sample alone.
//!
//! This file follows rays; [`super::direct`] lights points, [`super::dielectric`] splits a ray at glass and
//! [`super::passage`] goes through objects with fixed shares.

use std::sync::atomic::{AtomicBool, Ordering};

use dioptric_geometry::world::{Hit, Query};
use dioptric_geometry::{Contacts, Ray};
use dioptric_math::{DVec3, Spectrum};
use serde_json::json;

use super::dielectric::Dielectric;
use super::media::{Inside, Media, Medium, absorbed};
use super::optics::{facet_normal, schlick};
use super::point::{Leg, Point, coincide};
use super::record::record;
use super::recorder::{RayKind, Recorder, Slot};
use super::tree::{Above, Nodes};
use crate::film::{FirstHit, Radiance};
use crate::material::{Finish, Optics};
use crate::sampling::stream::Stream;
use crate::scene::{Answer, Scene, Shading};
use crate::stats::RayCounts;

/// Rays that are cast together.
const ROUND: usize = 512;

/// One batch of samples.
pub struct Whitted<'a, 'r, R: Recorder> {
    /// What rays are cast into.
    pub(super) scene: &'a Scene,
    /// Rays cast so far.
    pub(super) counts: &'r mut RayCounts,
    /// Who listens.
    pub(super) recorder: &'r mut R,
    /// Transparent objects that this batch's rays have been in.
    pub(super) media: Media,
    pub(super) nodes: Nodes<R::Id>,
    /// Rays to be cast, the next ones last, and what is known of each.
    queries: Vec<Query>,
    legs: Vec<Follow>,
    /// By the sample's number.
    radiances: Vec<Radiance>,
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

/// A ray to be cast.
#[derive(Clone, Copy)]
struct Follow {
    node: u32,
    state: State,
    stream: Stream,
}

/// A point that a ray met, on its way through a round.
pub(super) struct Met<'a> {
    pub point: Point<'a>,
    pub node: u32,
    pub state: State,
    pub stream: Stream,
    /// Whether its own colour is wanted.
    pub wants_own: bool,
    /// Its own colour.
    pub own: Spectrum,
    /// The normal of the facet that a mirrored ray meets.
    facet: DVec3,
}

impl<'a, 'r, R: Recorder> Whitted<'a, 'r, R> {
    /// Ready for one batch.
    pub fn new(scene: &'a Scene, counts: &'r mut RayCounts, recorder: &'r mut R) -> Self {
        Self {
            scene,
            counts,
            recorder,
            media: Media::new(scene.surroundings.ior),
            nodes: Nodes::new(ROUND),
            queries: Vec::with_capacity(ROUND),
            legs: Vec::with_capacity(ROUND),
            radiances: Vec::new(),
        }
    }

    /// The radiance that each camera's ray brings, and what it met first; nothing if cancelled meanwhile.
    pub fn radiances(
        mut self,
        rays: impl ExactSizeIterator<Item = Option<(Ray, Stream)>>,
        cancel: &AtomicBool,
    ) -> Vec<Radiance> {
        let around = self.scene.around_camera.iter();
        let inside = around.fold(None, |inside, &medium| self.media.enter(inside, medium));
        let state = State { depth: 0, throughput: 1.0, inside };
        self.radiances.resize(rays.len(), Radiance::NOTHING);
        for (ray, sample) in rays.zip(0..) {
            let Some((ray, stream)) = ray else { continue };
            self.counts.camera += 1;
            let id = self.recorder.begin(None, RayKind::Camera, &ray);
            let node = self.nodes.add(id, Above::Sample(sample), Spectrum::ONE, inside);
            let contacts = Contacts::CROSSED;
            self.queries.push(Query::new(ray, f64::INFINITY, None, contacts));
            self.legs.push(Follow { node, state, stream });
        }
        let mut round = Round::default();
        round.met.reserve(ROUND);
        while !self.legs.is_empty() {
            if cancel.load(Ordering::Relaxed) {
                return Vec::new();
            }
            self.round(&mut round);
        }
        self.radiances
    }

    /// Casts the rays that came last, and shades what they meet.
    fn round(&mut self, round: &mut Round<'a>) {
        let first = self.legs.len().saturating_sub(ROUND);
        let scene = self.scene;
        scene.world.closest_each(&self.queries[first..], &mut round.hits);
        round.queries.clear();
        round.queries.extend(self.queries.drain(first..));
        round.legs.clear();
        round.legs.extend(self.legs.drain(first..));
        let mut met = std::mem::take(&mut round.met);
        for ((query, leg), hit) in round.queries.iter().zip(&round.legs).zip(&round.hits) {
            let spare = &mut round.answers;
            match hit.and_then(|hit| self.resolve(query, hit, leg.state.inside, spare)) {
                Some((hit, shading)) => {
                    self.nodes[leg.node].distance = hit.t;
                    let point = Point::new(&query.ray, hit, shading, query.departure().as_ref());
                    met.push(self.meet(point, leg));
                }
                None => {
                    let value = scene.background.radiance(query.ray.direction);
                    let node = &mut self.nodes[leg.node];
                    node.own = value;
                    self.recorder.term(node.id, "background", value, || (None, json!({})));
                    self.settle(leg.node);
                }
            }
        }
        self.light(&mut met, &mut round.light);
        for met in &mut met {
            self.scatter(met);
        }
        for met in met.drain(..) {
            if let Answer::Here(answer) = met.point.finish {
                round.answers.push(answer);
            }
        }
        round.met = met;
    }

    /// Casts a further ray and returns true. Rays whose weight is too small to matter by the scene's setting
    /// are not cast.
    pub(super) fn follow(
        &mut self,
        met: &Met,
        slot: Slot,
        kind: RayKind,
        leg: Leg,
        weight: Spectrum,
        inside: Inside,
    ) {
        let id = self.nodes[met.node].id;
        let throughput = met.state.throughput * weight.max_element();
        if !(throughput > 0.0) || throughput < self.scene.settings.min_contribution {
            self.recorder.also(
                id,
                "not_followed",
                || json!({"kind": kind, "weight": weight.to_array()}),
            );
            return;
        }
        match kind {
            RayKind::Camera => self.counts.camera += 1,
            RayKind::Reflected => self.counts.reflect += 1,
            RayKind::Transmitted => self.counts.refract += 1,
        }
        let state = State { depth: met.state.depth + 1, throughput, inside };
        let below = self.recorder.begin(Some((id, slot)), kind, &leg.ray);
        let node = self.nodes.add(below, Above::Node(met.node, slot), weight, inside);
        self.nodes[met.node].waiting += 1;
        let stream = if slot == 0 { met.stream } else { met.stream.forked() };
        self.queries.push(leg.query(f64::INFINITY));
        self.legs.push(Follow { node, state, stream });
    }

    /// Works out the value of a node that waits for nothing, and of those above that waited only for it.
    pub(super) fn settle(&mut self, mut index: u32) {
        loop {
            let node = &self.nodes[index];
            if node.waiting > 0 {
                return;
            }
            let (id, above, weight) = (node.id, node.above, node.weight);
            let (distance, inside) = (node.distance, node.inside);
            let value = node.own + node.below[0] + node.below[1];
            let value = self.attenuated(id, value, distance, inside);
            self.nodes.release(index);
            match above {
                Above::Sample(sample) => {
                    self.recorder.end(id, Spectrum::ONE, value);
                    let radiance = &mut self.radiances[sample as usize];
                    radiance.color = value;
                    let hit = radiance.first.object != FirstHit::NOTHING;
                    radiance.alpha = if hit { 1.0 } else { 0.0 };
                    return;
                }
                Above::Node(above, slot) => {
                    let parent = &mut self.nodes[above];
                    parent.below[usize::from(slot)] = weight * value;
                    parent.waiting -= 1;
                    self.recorder.end(id, weight, value);
                    index = above;
                }
            }
        }
    }

    /// The hit that counts, and what is needed to shade it. Inside of a transparent object its own surface
    /// comes before any other that coincides with it: the exit belongs to the object that was entered.
    fn resolve(
        &self,
        query: &Query,
        hit: Hit,
        inside: Inside,
        spare: &mut Spare,
    ) -> Option<(Hit, Shading<'a>)> {
        let (scene, ray) = (self.scene, &query.ray);
        let shading = scene.shading_in(ray, &hit, |finish| match spare.pop() {
            Some(mut answer) => {
                *answer = finish;
                answer
            }
            None => Box::new(finish),
        })?;
        if let Some(around) = self.media.top(inside).filter(|m| !m.object.same_object(&hit.id)) {
            let id = around.object;
            let departure = query.departure();
            let departure = departure.as_ref();
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
    fn attenuated(
        &mut self,
        id: R::Id,
        mut value: Spectrum,
        distance: f64,
        inside: Inside,
    ) -> Spectrum {
        let scene = self.scene;
        let left = match self.media.top(inside) {
            Some(medium) => absorbed(medium.absorption, distance / scene.root.scale()),
            None => scene.surroundings.transmittance(distance),
        };
        if left != Spectrum::ONE {
            self.recorder.note(id, "absorption", || json!({"transmittance": left.to_array()}));
            self.recorder.scale(id, "absorption", left);
            value *= left;
        }
        let Some(fog) = scene.fog.as_ref().filter(|_| inside.is_none()) else { return value };
        let left = fog.transmittance(distance);
        let glow = fog.color * (1.0 - left);
        self.recorder.scale(id, "fog", Spectrum::splat(left));
        self.recorder.term(id, "fog", glow, || (None, json!({"transmittance": left})));
        value * left + glow
    }

    /// A point that was met, and what its optics need before it is lit.
    fn meet(&mut self, point: Point<'a>, leg: &Follow) -> Met<'a> {
        let Follow { node, state, mut stream } = *leg;
        let scene = self.scene;
        if let Above::Sample(sample) = self.nodes[node].above {
            self.radiances[sample as usize].first = point.first_hit(scene);
        }
        let id = self.nodes[node].id;
        let medium = self.media.top(state.inside);
        self.recorder.hit(id, || record(scene, &point, state.depth, medium));
        let mut facet = point.normal;
        let solid = || point.is_solid(scene);
        let at_limit = state.depth >= scene.settings.bounces;
        let wants_own = match point.finish.optics {
            Optics::Opaque => true,
            Optics::Mirror { roughness, .. } => {
                if !at_limit {
                    facet = facet_for(&point, roughness, &mut stream);
                }
                true
            }
            Optics::Shares { .. } if at_limit => true,
            Optics::Shares { own, .. } => (point.outside || !solid()) && own > 0.0,
            // Glass has nothing of its own to show but highlights, and those on its outside.
            Optics::Dielectric { .. } => point.outside || !solid(),
        };
        Met { point, node, state, stream, wants_own, own: Spectrum::ZERO, facet }
    }

    /// Sends the rays that go on from a point whose own colour is known.
    fn scatter(&mut self, met: &mut Met) {
        let id = self.nodes[met.node].id;
        let at_limit = met.state.depth >= self.scene.settings.bounces;
        if met.point.finish.optics == Optics::Opaque {
            self.nodes[met.node].own = met.own;
            self.settle(met.node);
            return;
        }
        let optics = met.point.finish.optics;
        if at_limit {
            self.recorder.note(id, "bounce_limit", || json!(self.scene.settings.bounces));
        }
        match optics {
            _ if at_limit => self.nodes[met.node].own = met.own,
            Optics::Opaque => {}
            Optics::Mirror { reflect, grazing, covers, .. } => {
                let point = &met.point;
                let weight = schlick(reflect, grazing, -point.ray.direction.dot(met.facet));
                let mut own = met.own;
                if covers {
                    // Lacquer: what is mirrored never reaches the colour below.
                    own *= Spectrum::ONE - weight;
                    self.recorder.scale(id, "coat", Spectrum::ONE - weight);
                }
                self.nodes[met.node].own = own;
                let leg = point.back(point.mirrored(met.facet));
                self.follow(met, 0, RayKind::Reflected, leg, weight, met.state.inside);
            }
            Optics::Shares { own, ior, tint, absorption } => {
                self.through_by_shares(met, own, ior, tint, absorption);
            }
            Optics::Dielectric { ior, reflect, transmit, absorption, roughness } => {
                let medium = Medium { object: met.point.hit.id, ior, absorption };
                let how = Dielectric { reflect, transmit, roughness };
                self.dielectric(met, &medium, how);
            }
        }
        self.settle(met.node);
    }
}

/// Boxes that are used again.
type Spare = Vec<Box<Finish>>;

/// Memory that the rounds of a batch use again.
#[derive(Default)]
struct Round<'a> {
    met: Vec<Met<'a>>,
    /// Boxes for answers of materials with patterns.
    answers: Spare,
    queries: Vec<Query>,
    legs: Vec<Follow>,
    hits: Vec<Option<Hit>>,
    light: super::direct::Scratch,
}

/// The normal of the facet that a sample meets: the surface's own where it is smooth.
pub(super) fn facet_for(point: &Point, alpha: f64, stream: &mut Stream) -> DVec3 {
    if alpha > 0.0 {
        facet_normal(point.normal, point.ray.direction, alpha, stream.next_2d())
    } else {
        point.normal
    }
}
