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

use std::cell::Cell;
use std::sync::atomic::{AtomicBool, Ordering};

use dioptric_geometry::world::{Found, Query, Rays};
use dioptric_geometry::{Contacts, Ray};
use dioptric_math::{DVec3, Spectrum};
use serde_json::json;

use super::dielectric::Dielectric;
use super::direct::Scratch;
use super::lit::{LANES, lanes};
use super::media::{Inside, Media, Medium};
use super::optics::facet_normal;
use super::point::{Leg, Point};
use super::record::record;
use super::recorder::{RayKind, Recorder, Silent, Slot};
use super::resolve::{Spare, resolve};
use super::tree::{Above, Nodes, Way};
use crate::camera::Places;
use crate::film::Radiance;
use crate::job::Shot;
use crate::material::Optics;
use crate::picture::place;
use crate::sampling::stream::Stream;
use crate::scene::{Answer, Scene};
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
    memory: Memory,
    /// Rays to be cast, the next ones last, and what is known of each.
    next: Rays,
    legs: Vec<Follow<R::Id>>,
    /// By the sample's number.
    pub(super) radiances: Vec<Radiance>,
}

/// A ray to be cast.
#[derive(Clone, Copy)]
struct Follow<I> {
    way: Way<I>,
    /// Secondary bounces so far.
    depth: u32,
    /// The largest lane of the product of all weights so far.
    throughput: f64,
    stream: Stream,
}

/// A point that a ray met, on its way through a round.
pub(super) struct Met<'a, I> {
    pub point: Point<'a>,
    pub way: Way<I>,
    depth: u32,
    throughput: f64,
    pub stream: Stream,
    /// What waits for the rays that it causes; nothing before they are sent.
    pub node: u32,
    /// Whether its own colour is wanted.
    pub wants_own: bool,
    /// Its own colour.
    pub own: Spectrum,
    /// The normal of the facet that a mirrored ray meets.
    pub facet: DVec3,
}

impl<'a, 'r, R: Recorder> Whitted<'a, 'r, R> {
    /// Ready for one batch.
    pub fn new(scene: &'a Scene, counts: &'r mut RayCounts, recorder: &'r mut R) -> Self {
        let mut memory = MEMORY.take();
        let mut next = std::mem::take(&mut memory.next);
        next.clear();
        Self {
            scene,
            counts,
            recorder,
            media: Media::new(scene.surroundings.ior),
            nodes: Nodes::new(0),
            memory,
            next,
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
        let inside = self.around_camera();
        self.radiances.resize(rays.len(), Radiance::NOTHING);
        for (ray, sample) in rays.zip(0..) {
            let Some((ray, stream)) = ray else { continue };
            self.next.push(&Query::new(ray, f64::INFINITY, None, Contacts::CROSSED));
            self.counts.camera += 1;
            let id = self.recorder.begin(None, RayKind::Camera, &ray);
            self.follow_camera(id, sample, stream, inside);
        }
        if self.run(cancel) { self.radiances } else { Vec::new() }
    }

    /// What the camera is inside of.
    fn around_camera(&mut self) -> Inside {
        let around = self.scene.around_camera.iter();
        around.fold(None, |inside, &medium| self.media.enter(inside, medium))
    }

    /// Notes where the value of a camera's ray goes.
    #[inline]
    fn follow_camera(&mut self, id: R::Id, sample: u32, stream: Stream, inside: Inside) {
        let way = Way { id, above: Above::Sample(sample), weight: Spectrum::ONE, inside };
        self.legs.push(Follow { way, depth: 0, throughput: 1.0, stream });
    }

    /// Follows all rays to their ends; false if cancelled meanwhile.
    fn run(&mut self, cancel: &AtomicBool) -> bool {
        let mut round = Round { met: Vec::new(), legs: Vec::new() };
        let mut memory = std::mem::take(&mut self.memory);
        let mut complete = true;
        while complete && !self.legs.is_empty() {
            self.round(&mut round, &mut memory);
            complete = !cancel.load(Ordering::Relaxed);
        }
        memory.next = std::mem::take(&mut self.next);
        MEMORY.set(memory);
        complete
    }

    /// Casts the rays that came last, and shades what they meet.
    fn round(&mut self, round: &mut Round<'a, R::Id>, memory: &mut Memory) {
        let scene = self.scene;
        let Memory { rays, found, answers, light, .. } = memory;
        self.next.take_last(ROUND, rays);
        round.legs.clear();
        if self.next.is_empty() {
            std::mem::swap(&mut self.legs, &mut round.legs);
        } else {
            round.legs.extend(self.legs.drain(self.next.len()..));
        }
        scene.world.closest_of_rays(rays, found);
        let mut met = std::mem::take(&mut round.met);
        met.reserve(round.legs.len());
        for (i, leg) in round.legs.iter().enumerate() {
            let rays = &rays.bundles()[i / LANES];
            let hit = found[i / LANES].best(i);
            let (media, inside) = (&self.media, leg.way.inside);
            let resolved = hit.and_then(|hit| {
                let query = || rays.query(i);
                resolve(scene, media, &rays.ray(i), query, hit, inside, answers)
            });
            match resolved {
                Some((hit, shading)) => {
                    let query = rays.query(i);
                    let point = Point::new(&query.ray, hit, shading, query.departure().as_ref());
                    met.push(self.meet(point, leg));
                }
                None => {
                    let value = scene.background.radiance(rays.ray(i).direction);
                    self.recorder.term(leg.way.id, "background", value, || (None, json!({})));
                    self.deliver(leg.way, value, f64::INFINITY);
                }
            }
        }
        self.light(&mut met, light);
        for met in &mut met {
            self.scatter(met);
        }
        for met in met.drain(..) {
            if let Answer::Here(answer) = met.point.finish {
                answers.push(answer);
            }
        }
        round.met = met;
    }

    /// Casts a further ray and returns true. Rays whose weight is too small to matter by the scene's setting
    /// are not cast.
    pub(super) fn follow(
        &mut self,
        met: &Met<R::Id>,
        slot: Slot,
        kind: RayKind,
        leg: Leg,
        weight: Spectrum,
        inside: Inside,
    ) {
        let id = met.way.id;
        let throughput = met.throughput * weight.max_element();
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
        let below = self.recorder.begin(Some((id, slot)), kind, &leg.ray);
        self.nodes[met.node].waiting += 1;
        let way = Way { id: below, above: Above::Node(met.node, slot), weight, inside };
        let stream = if slot == 0 { met.stream } else { met.stream.forked() };
        self.next.push(&leg.query(f64::INFINITY));
        self.legs.push(Follow { way, depth: met.depth + 1, throughput, stream });
    }

    /// A point that was met, and what its optics need before it is lit.
    #[inline(always)]
    fn meet(&mut self, point: Point<'a>, leg: &Follow<R::Id>) -> Met<'a, R::Id> {
        let Follow { way, depth, throughput, mut stream } = *leg;
        let scene = self.scene;
        if let Above::Sample(sample) = way.above {
            self.radiances[sample as usize].first = point.first_hit(scene);
        }
        let medium = self.media.top(way.inside);
        self.recorder.hit(way.id, || record(scene, &point, depth, medium));
        let mut facet = point.normal;
        let solid = || point.is_solid(scene);
        let at_limit = depth >= scene.settings.bounces;
        let wants_own = match point.finish.optics {
            Optics::Opaque => true,
            Optics::Layered(layers) => {
                if !at_limit {
                    facet = facet_for(&point, layers.mirror_alpha(), &mut stream);
                }
                point.outside || layers.clear() == 0.0 || !solid()
            }
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
        let own = Spectrum::ZERO;
        Met { point, way, depth, throughput, stream, node: u32::MAX, wants_own, own, facet }
    }

    /// Sends the rays that go on from a point whose own colour is known.
    fn scatter(&mut self, met: &mut Met<R::Id>) {
        let id = met.way.id;
        if matches!(met.point.finish.optics, Optics::Opaque) {
            self.deliver(met.way, met.own, met.point.hit.t);
            return;
        }
        if met.depth >= self.scene.settings.bounces {
            self.recorder.note(id, "bounce_limit", || json!(self.scene.settings.bounces));
            self.deliver(met.way, met.own, met.point.hit.t);
            return;
        }
        met.node = self.nodes.add(met.way, met.point.hit.t);
        match met.point.finish.optics {
            Optics::Opaque => {}
            Optics::Mirror { reflect, covers, .. } => {
                let point = &met.point;
                let weight = reflect.at(-point.ray.direction.dot(met.facet));
                let mut own = met.own;
                if covers {
                    // Lacquer: what is mirrored never reaches the colour below.
                    own *= Spectrum::ONE - weight;
                    self.recorder.scale(id, "coat", Spectrum::ONE - weight);
                }
                self.nodes[met.node].own = own;
                let leg = point.back(point.mirrored(met.facet));
                self.follow(met, 0, RayKind::Reflected, leg, weight, met.way.inside);
            }
            Optics::Layered(layers) => self.layered(met, &layers),
            Optics::Shares { own, ior, tint, absorption } => {
                self.through_by_shares(met, own, ior, tint, absorption);
            }
            Optics::Dielectric { ior, reflect, transmit, absorption, roughness } => {
                let object = met.point.hit.id;
                let priority = self.scene.interior(object).priority;
                let medium = Medium { object, ior, absorption, priority };
                let how = Dielectric { reflect, transmit, roughness };
                self.dielectric(met, &medium, how);
            }
        }
        self.settle(met.node);
    }
}

impl Whitted<'_, '_, Silent> {
    /// Follows a scene's own samples, and appends their radiances to `out`; nothing if cancelled meanwhile.
    pub fn shoot(mut self, shots: &[Shot], cancel: &AtomicBool, out: &mut Vec<Radiance>) {
        let (scene, inside, before) = (self.scene, self.around_camera(), out.len());
        self.radiances = std::mem::take(out);
        self.radiances.resize(before + shots.len(), Radiance::NOTHING);
        let mut places = Places::CORNER;
        for (first, shots) in (before as u32..).step_by(LANES).zip(shots.chunks(LANES)) {
            let mut streams = [shots[0].stream; LANES];
            for (lane, (shot, stream)) in shots.iter().zip(&mut streams).enumerate() {
                *stream = shot.stream;
                let at = place(scene, &shot.sample, stream);
                (places.x[lane], places.y[lane], places.lens[lane]) = at;
            }
            let seen = self.next.append(shots.len(), |rays| scene.camera.rays(&places, rays));
            for lane in lanes(seen) {
                self.counts.camera += 1;
                self.follow_camera((), first + lane as u32, streams[lane], inside);
            }
        }
        if !self.run(cancel) {
            self.radiances.truncate(before);
        }
        *out = self.radiances;
    }
}

/// Memory that the rounds of a batch use again.
struct Round<'a, I> {
    met: Vec<Met<'a, I>>,
    legs: Vec<Follow<I>>,
}

/// Memory that batches use again: asking for it and filling it takes as long as some shading.
#[derive(Default)]
struct Memory {
    /// Of the rays to be cast.
    next: Rays,
    /// The rays of a round, and what they hit.
    rays: Rays,
    found: Vec<Found>,
    /// Boxes for answers of materials with patterns.
    answers: Spare,
    light: Scratch,
}

thread_local! {
    static MEMORY: Cell<Memory> = Cell::default();
}

/// The normal of the facet that a sample meets: the surface's own where it is smooth.
pub(super) fn facet_for(point: &Point, alpha: f64, stream: &mut Stream) -> DVec3 {
    if alpha > 0.0 {
        facet_normal(point.normal, point.ray.direction, alpha, stream.next_2d())
    } else {
        point.normal
    }
}
