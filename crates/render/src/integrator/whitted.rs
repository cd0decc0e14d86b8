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

use dioptric_geometry::world::{Bundle, Found, Query, Rays, Surfaces};
use dioptric_geometry::{Contacts, Ray};
use dioptric_math::{DVec3, Spectrum};
use serde_json::json;

use super::dielectric::Dielectric;
use super::direct::{Points, Scratch};
use super::front::Front;
use super::lit::{Block, Power, lanes};
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
use crate::lanes::{LANES, get, put};
use crate::material::{Finish, Optics, Reflectance};
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
    /// Whether nothing outside of all objects weakens light.
    pub(super) clear: bool,
    memory: Memory,
    /// Rays to be cast, the next ones last, and what is known of each.
    next: Rays,
    legs: Vec<Follow<R::Id>>,
    /// By the sample's number.
    pub(super) radiances: Vec<Radiance>,
}

/// A ray to be cast.
#[derive(Clone, Copy)]
pub(super) struct Follow<I> {
    pub way: Way<I>,
    /// Secondary bounces so far.
    depth: u32,
    /// The largest lane of the product of all weights so far.
    throughput: f64,
    pub stream: Stream,
}

/// A point that a ray met, by itself.
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
            clear: scene.fog.is_none() && scene.surroundings.is_clear(),
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
        let mut round = Round { finishes: Vec::new(), legs: Vec::new() };
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
        let Memory { rays, found, fronts, surfaces, answers, light, .. } = memory;
        self.next.take_last(ROUND, rays);
        round.legs.clear();
        if self.next.is_empty() {
            std::mem::swap(&mut self.legs, &mut round.legs);
        } else {
            round.legs.extend(self.legs.drain(self.next.len()..));
        }
        self.scene.world.closest_of_rays(rays, found);
        let Round { finishes, legs } = round;
        let count = found.len();
        finishes.resize_with(count.max(finishes.len()), Default::default);
        if fronts.len() < count {
            fronts.resize(count, Front::EMPTY);
        }
        light.lit.begin(count);
        let lit = light.lit.parts();
        for (at, legs) in legs.chunks_mut(LANES).enumerate() {
            let (front, finishes) = (&mut fronts[at], &mut finishes[at]);
            let (starts, block) = (&mut lit.rays[at], &mut lit.blocks[at]);
            let mut own =
                Sixteen { rays: &rays.bundles()[at], found: &mut found[at], front, starts, block };
            self.meet(&mut own, legs, finishes, (answers, surfaces));
            lit.live[at] = self.look(&mut own, legs, finishes);
        }
        self.light(&mut Points { finishes, legs }, light);
        let lit = light.lit.parts();
        for (at, legs) in legs.chunks(LANES).enumerate() {
            let (front, finishes) = (&mut fronts[at], &mut finishes[at]);
            let (starts, block) = (&mut lit.rays[at], &mut lit.blocks[at]);
            let own =
                Sixteen { rays: &rays.bundles()[at], found: &mut found[at], front, starts, block };
            self.scatter(&own, legs, finishes, answers);
        }
    }

    /// Finds out what sixteen rays met, and which way it faces.
    #[inline(always)]
    fn meet(
        &mut self,
        own: &mut Sixteen,
        legs: &[Follow<R::Id>],
        finishes: &mut [Option<Answer<'a>>; LANES],
        (answers, surfaces): (&mut Spare, &mut Surfaces),
    ) {
        let Sixteen { rays, found, front, starts, block } = own;
        let (scene, media) = (self.scene, &self.media);
        let certain = !scene.has_holes && media.is_empty();
        front.clear();
        let mut left = found.hit;
        if certain {
            // Most surfaces are found side by side.
            surfaces.clear();
            for lane in lanes(found.hit) {
                let id = &found.ids[lane];
                if let Some(finish) = scene.uniform(*id).filter(|finish| finish.present)
                    && scene.world.lay(id, lane, surfaces)
                {
                    finishes[lane] = Some(Answer::Same(finish));
                }
            }
            let known = surfaces.find(rays, &found.t);
            front.take(known, surfaces, starts);
            left &= !known;
        }
        for lane in lanes(left) {
            let Some(hit) = found.best(lane) else { continue };
            let (query, inside) = (|| rays.query(lane), legs[lane].way.inside);
            let met = resolve(scene, media, &rays.ray(lane), query, hit, inside, answers);
            if let Some((hit, shading)) = met {
                if !certain {
                    (found.ids[lane], found.t[lane]) = (hit.id, hit.t);
                }
                front.set(lane, &shading.surface, starts);
                finishes[lane] = Some(shading.finish);
            }
        }
        for (lane, leg) in legs.iter().enumerate() {
            if front.met & 1 << lane == 0 {
                let value = scene.background.radiance(rays.ray(lane).direction);
                self.recorder.term(leg.way.id, "background", value, || (None, json!({})));
                self.deliver(&leg.way, value, f64::INFINITY);
            }
        }
        front.turn(rays, found, starts, block);
    }

    /// Finds out what the materials of sixteen points answer, and what their optics need before they are lit; returns
    /// those that are to be lit.
    #[inline(always)]
    fn look(
        &mut self,
        own: &mut Sixteen,
        legs: &mut [Follow<R::Id>],
        finishes: &[Option<Answer<'a>>; LANES],
    ) -> u16 {
        let scene = self.scene;
        let Sixteen { rays, found, front, starts, block } = own;
        let met = front.met;
        block.power = Power::None;
        let first = finishes[met.trailing_zeros() as usize % LANES].as_ref();
        let alike = first.is_some_and(|first| {
            lanes(met)
                .all(|lane| finishes[lane].as_ref().is_some_and(|f| std::ptr::eq(&**f, &**first)))
        });
        let mut glow = Spectrum::ZERO;
        let mut live = 0;
        for lane in lanes(met) {
            let (bit, leg) = (1 << lane, &mut legs[lane]);
            let Some(answer) = &finishes[lane] else { continue };
            let finish: &Finish = answer;
            let id = found.ids[lane];
            if let Above::Sample(sample) = leg.way.above {
                let radiance = &mut self.radiances[sample as usize];
                radiance.alpha = 1.0;
                radiance.first.object = scene.layer_id(id);
                radiance.first.depth = found.t[lane];
                radiance.first.normal = block.normal(lane);
                radiance.first.albedo = finish.base;
            }
            if R::ENABLED {
                let medium = self.media.top(leg.way.inside);
                let point = front.point(lane, (rays, found), (starts, block), answer.clone());
                self.recorder.hit(leg.way.id, || record(scene, &point, leg.depth, medium));
            }
            let outside = || {
                let solid = scene.world.shape(id.object).is_some_and(|shape| shape.is_solid());
                front.outside & bit != 0 || !solid
            };
            let at_limit = leg.depth >= scene.settings.bounces;
            let mut alpha = 0.0;
            let wants_own = match finish.optics {
                Optics::Opaque => true,
                Optics::Layered(layers) => {
                    alpha = layers.mirror_alpha();
                    layers.clear() == 0.0 || outside()
                }
                Optics::Mirror { roughness, .. } => {
                    alpha = roughness;
                    true
                }
                Optics::Shares { .. } if at_limit => true,
                Optics::Shares { own, .. } => own > 0.0 && outside(),
                // Glass has nothing of its own to show but highlights, and those on its outside.
                Optics::Dielectric { .. } => outside(),
            };
            if at_limit || matches!(finish.optics, Optics::Opaque) {
                front.ends |= bit;
            } else if alpha > 0.0 {
                let (normal, direction) = (block.normal(lane), rays.ray(lane).direction);
                let facet = facet_for(normal, direction, alpha, &mut leg.stream);
                put(&mut front.facet, lane, facet);
                front.rough |= bit;
            } else if matches!(finish.optics, Optics::Mirror { .. }) {
                front.mirrors |= bit;
            }
            let mut value = Spectrum::ZERO;
            if wants_own {
                front.own |= bit;
                value = self.glow(leg.way.id, finish);
                if finish.diffuse != Spectrum::ZERO || finish.highlight.is_some() {
                    live |= bit;
                }
            }
            if !alike {
                block.set(lane, finish, value);
            }
            glow = value;
        }
        if let Some(finish) = first.filter(|_| alike) {
            block.set_all(finish, glow);
        }
        front.mirror(rays, block);
        live
    }

    /// The throughput of a further ray, which is counted; nothing where its weight is too small to matter by the scene's
    /// setting.
    #[inline(always)]
    fn goes_on(&mut self, before: f64, id: R::Id, kind: RayKind, weight: Spectrum) -> Option<f64> {
        let throughput = before * weight.max_element();
        if !(throughput > 0.0) || throughput < self.scene.settings.min_contribution {
            self.recorder.also(
                id,
                "not_followed",
                || json!({"kind": kind, "weight": weight.to_array()}),
            );
            return None;
        }
        match kind {
            RayKind::Camera => self.counts.camera += 1,
            RayKind::Reflected => self.counts.reflect += 1,
            RayKind::Transmitted => self.counts.refract += 1,
        }
        Some(throughput)
    }

    /// Casts a further ray, but for one that does not matter.
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
        let Some(throughput) = self.goes_on(met.throughput, id, kind, weight) else { return };
        let below = self.recorder.begin(Some((id, slot)), kind, &leg.ray);
        self.nodes[met.node].waiting += 1;
        let way = Way { id: below, above: Above::Node(met.node, slot), weight, inside };
        let stream = if slot == 0 { met.stream } else { met.stream.forked() };
        self.next.push(&leg.query(f64::INFINITY));
        self.legs.push(Follow { way, depth: met.depth + 1, throughput, stream });
    }

    /// Sends the rays that go on from sixteen points whose own colours are known.
    #[inline(always)]
    fn scatter(
        &mut self,
        own: &Sixteen,
        legs: &[Follow<R::Id>],
        finishes: &mut [Option<Answer<'a>>; LANES],
        answers: &mut Spare,
    ) {
        let Sixteen { rays, found, front, starts, block } = own;
        for lane in lanes(front.met) {
            let (bit, leg) = (1 << lane, &legs[lane]);
            let Some(finish) = finishes[lane].take() else { continue };
            let value = get(&block.own, lane);
            if front.ends & bit != 0 {
                if R::ENABLED && !matches!(finish.optics, Optics::Opaque) {
                    let limit = || json!(self.scene.settings.bounces);
                    self.recorder.note(leg.way.id, "bounce_limit", limit);
                }
                self.deliver(&leg.way, value, found.t[lane]);
            } else if let (true, Optics::Mirror { reflect, covers, .. }) =
                (front.mirrors & bit != 0, &finish.optics)
            {
                self.mirror(own, lane, leg, (reflect, *covers), value);
            } else {
                let point = front.point(lane, (rays, found), (starts, block), finish);
                let (facet, wants_own) = (front.facet(lane, block), front.own & bit != 0);
                let mut met = Met::new(point, leg, facet, (wants_own, value));
                self.split(&mut met);
                if let Answer::Here(answer) = met.point.finish {
                    answers.push(answer);
                }
                continue;
            }
            if let Answer::Here(answer) = finish {
                answers.push(answer);
            }
        }
    }

    /// Sends the one ray that is mirrored at a smooth surface.
    #[inline(always)]
    fn mirror(
        &mut self,
        of: &Sixteen,
        lane: usize,
        leg: &Follow<R::Id>,
        (reflect, covers): (&Reflectance, bool),
        mut own: Spectrum,
    ) {
        let id = leg.way.id;
        let weight = reflect.at(of.block.facing[lane % LANES]);
        if covers {
            // Lacquer: what is mirrored never reaches the colour below.
            own *= Spectrum::ONE - weight;
            self.recorder.scale(id, "coat", Spectrum::ONE - weight);
        }
        let distance = of.found.t[lane % LANES];
        let Some(throughput) = self.goes_on(leg.throughput, id, RayKind::Reflected, weight) else {
            self.deliver(&leg.way, own, distance);
            return;
        };
        let direction = get(&of.front.mirrored, lane);
        let below = if R::ENABLED {
            let ray = Ray { direction, ..of.starts.ray(lane) };
            self.recorder.begin(Some((id, 0)), RayKind::Reflected, &ray)
        } else {
            id
        };
        let node = self.nodes.add(&leg.way, own, 1, distance);
        let way = Way { id: below, above: Above::Node(node, 0), weight, inside: leg.way.inside };
        self.next.push_lane(of.starts, lane, direction, f64::INFINITY);
        self.legs.push(Follow { way, depth: leg.depth + 1, throughput, stream: leg.stream });
    }

    /// Sends the rays that go on from a point by itself.
    fn split(&mut self, met: &mut Met<R::Id>) {
        met.node = self.nodes.add(&met.way, Spectrum::ZERO, 0, met.point.hit.t);
        match met.point.finish.optics {
            Optics::Opaque => {}
            Optics::Mirror { reflect, covers, .. } => {
                let point = &met.point;
                let weight = reflect.at(-point.ray.direction.dot(met.facet));
                let mut own = met.own;
                if covers {
                    own *= Spectrum::ONE - weight;
                    self.recorder.scale(met.way.id, "coat", Spectrum::ONE - weight);
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

impl<'a, I: Copy> Met<'a, I> {
    fn new(point: Point<'a>, leg: &Follow<I>, facet: DVec3, own: (bool, Spectrum)) -> Self {
        let Follow { way, depth, throughput, stream } = *leg;
        let ((wants_own, own), node) = (own, u32::MAX);
        Self { point, way, depth, throughput, stream, node, wants_own, own, facet }
    }
}

/// Sixteen rays of a round, and what they met.
struct Sixteen<'r> {
    rays: &'r Bundle,
    found: &'r mut Found,
    front: &'r mut Front,
    /// Where further rays begin.
    starts: &'r mut Bundle,
    block: &'r mut Block,
}

impl Whitted<'_, '_, Silent> {
    /// Follows a scene's own samples, and appends their radiances to `out`; nothing if cancelled meanwhile.
    pub fn shoot(mut self, shots: &[Shot], cancel: &AtomicBool, out: &mut Vec<Radiance>) {
        let (scene, inside, before) = (self.scene, self.around_camera(), out.len());
        self.radiances = std::mem::take(out);
        self.radiances.resize(before + shots.len(), Radiance::NOTHING);
        self.nodes = Nodes::new(shots.len());
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
    /// What the materials answer at the points that rays met.
    finishes: Vec<[Option<Answer<'a>>; LANES]>,
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
    fronts: Vec<Front>,
    surfaces: Box<Surfaces>,
    /// Boxes for answers of materials with patterns.
    answers: Spare,
    light: Scratch,
}

thread_local! {
    static MEMORY: Cell<Memory> = Cell::default();
}

/// The normal of the facet that a sample meets: the surface's own where it is smooth.
pub(super) fn facet_for(normal: DVec3, direction: DVec3, alpha: f64, stream: &mut Stream) -> DVec3 {
    if alpha > 0.0 { facet_normal(normal, direction, alpha, stream.next_2d()) } else { normal }
}
