// SPDX-License-Identifier: MIT OR Apache-2.0
//! What a surface that is not sharp asks of light that comes to it over a ball: a manifold of ways, all of which are found
//! (Hanika, Droske and Fascione, "Manifold Next Event Estimation", EGSR 2015; for balls the way is known but for an angle).
//!
//! A place on a source is picked as the ball's middle sees it, the ways from there over the ball are solved for, and each counts
//! by the density with which its direction was found. A path that went that way by itself knows the same density, so that both count by
//! how likely they were to find it, as everywhere else.

use dioptric_geometry::world::{Bundle, Hit, Query};
use dioptric_geometry::{Contacts, Departure, HitId, Ray, SurfacePoint};
use dioptric_math::bounds::gamma;
use dioptric_math::{DVec3, Spectrum};

use super::tell::{Told, What};
use super::weights::{share_of_path, share_of_question};
use super::{Path, Paths, Round, Task};
use crate::bsdf::cosine_pdf;
use crate::integrator::recorder::Recorder;
use crate::lanes::get;
use crate::manifold::bend::Bender;
use crate::manifold::ways::{Branch, Ways};

/// How soon points ask: those for which balls fill so much of a quarter of all directions ask for sure, while their path carries
/// all of its light. (By measurement: docs/performance.md.)
const EAGER: f64 = 1.0;
/// By how much a ray to a ball is kept short of it, relatively: rounding where it grazes the ball.
const SHORT: f64 = 1e-7;
/// Requests for numbers of a point that asks: its own come first.
pub(super) const NUMBERS: usize = 6;

/// Whether a path is on its way over a ball that its last dull surface has asked about.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Over {
    #[default]
    No,
    /// It is within this object, on this piece of its way.
    Within(u32, u8),
    /// It has left the ball.
    Past(u16),
}

/// Where a path left its last dull surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Anchor {
    from: DVec3,
    normal: DVec3,
    direction: DVec3,
    density: f64,
}

impl Anchor {
    pub const NOTHING: Self =
        Self { from: DVec3::ZERO, normal: DVec3::ZERO, direction: DVec3::ZERO, density: 0.0 };
}

/// A point that asks.
pub(super) struct Asking {
    /// The shading normal, and the geometric one, on the side of the viewer.
    pub normal: DVec3,
    pub geometric: DVec3,
    /// A ray to a light, but for its direction and length.
    pub query: Query,
}

/// A question that was picked, with all of it that its answers have in common.
#[derive(Clone, Copy)]
struct Ask {
    normal: DVec3,
    geometric: DVec3,
    query: Query,
    /// What the path carries, times what the source sends.
    light: Spectrum,
    /// The density with which the source's place was found, all chances included.
    density: f64,
    caster: u16,
    emitter: u32,
    source: u32,
}

/// Questions of matte points, which are answered sixteen at a time.
pub(super) struct Asks<I> {
    ways: Ways,
    /// For a question that is answered at once.
    single: Ways,
    /// With the path as it came, and the colour of the surface.
    asks: Vec<(Ask, Path<I>, Spectrum)>,
}

impl<I> Asks<I> {
    pub const fn new() -> Self {
        Self { ways: Ways::EMPTY, single: Ways::EMPTY, asks: Vec::new() }
    }
}

/// Light over a ball that may arrive.
pub(super) struct Bends<I> {
    /// With the number of pieces of the way.
    tasks: Vec<(Task<I>, usize)>,
    legs: Vec<Query>,
    told: Vec<Told>,
}

impl<I> Bends<I> {
    pub const fn new() -> Self {
        Self { tasks: Vec::new(), legs: Vec::new(), told: Vec::new() }
    }
}

impl<R: Recorder> Paths<'_, '_, R> {
    /// What a path is on that a ball has mirrored or let through.
    pub(super) fn over(
        &mut self,
        path: &Path<R::Id>,
        ray: &Ray,
        id: &HitId,
        outside: bool,
        through: bool,
    ) -> Over {
        let casters = &self.scene.casters;
        if id.instance != HitId::NO_INSTANCE || self.anchors.is_empty() {
            return Over::No;
        }
        let object = id.object;
        if let Over::Within(ball, pieces) = path.over {
            return match through {
                _ if ball != object || outside => Over::No,
                true => casters.of(object, pieces).map_or(Over::No, Over::Past),
                false => Over::Within(ball, pieces.saturating_add(1)),
            };
        }
        let asked = outside && path.density < f64::INFINITY && path.inside.is_none();
        let (Some(normal), true) = (path.normal, asked) else { return Over::No };
        let Some(number) = casters.of(object, u8::from(through)) else { return Over::No };
        let Ray { origin: from, direction, .. } = *ray;
        let density = path.density;
        self.anchors[path.sample as usize] = Anchor { from, normal, direction, density };
        if through { Over::Within(object, 1) } else { Over::Past(number) }
    }

    /// The share of light that a path has met by itself over a ball.
    pub(super) fn share_over(
        &self,
        path: &Path<R::Id>,
        ray: &Ray,
        hit: &Hit,
        surface: &SurfacePoint,
    ) -> f64 {
        let Over::Past(number) = path.over else { return 1.0 };
        let scene = self.scene;
        let Some(caster) = scene.casters.get(number) else { return 1.0 };
        let Anchor { from, normal, direction, density } = self.anchors[path.sample as usize];
        share_of_path(scene.settings.light_sampling, density, || {
            let Bender { center, radius, .. } = caster.bender;
            let way = surface.point - center;
            let distance = way.length();
            let to = way / distance;
            let found = scene.sources.density_of_place(center, hit, surface, to);
            let Some((emitter, own)) = found.filter(|_| distance > radius) else { return 0.0 };
            let chance =
                scene.casters.chance(from, normal, number) * caster.chance_of_lamp(emitter);
            let (to, onward) = ((to, distance), ray.direction);
            let spread = caster.bender.spread(from, direction, to, onward, surface.normal);
            let question = chance * own * spread;
            if question.is_finite() { question } else { 0.0 }
        })
    }

    /// Picks a ball and a place of a source that may send light over it. Not all points ask: those that carry little, and for which
    /// all balls are small, by chance, for the others of their kind too.
    fn pick_over(
        &self,
        path: &Path<R::Id>,
        asking: &Asking,
        ways: &mut Ways,
        lane: usize,
    ) -> Option<Ask> {
        let scene = self.scene;
        let mut stream = path.stream.ahead(NUMBERS - 2);
        let [pick, goes] = stream.next_2d();
        let from = asking.query.ray.origin;
        let picked = scene.casters.pick(from, asking.normal, pick)?;
        let asks = (path.throughput.max_element() / path.squeezed * picked.sum * EAGER).min(1.0);
        if !(goes < asks) {
            return None;
        }
        let caster = scene.casters.get(picked.number)?;
        if path.depth + 1 + u32::from(caster.bender.pieces) > scene.settings.bounces {
            return None;
        }
        let (emitter, share) = caster.lamp(picked.rest)?;
        let Bender { center, radius, .. } = caster.bender;
        let place = scene.sources.place(scene, emitter, center, stream.next_2d())?;
        if place.distance <= radius {
            return None;
        }
        ways.set(lane, &caster.bender, from, (place.direction, place.distance), place.normal);
        Some(Ask {
            normal: asking.normal,
            geometric: asking.geometric,
            query: asking.query,
            light: path.throughput * place.radiance / asks,
            density: picked.chance * share * place.density,
            caster: picked.number,
            emitter,
            source: place.source,
        })
    }

    /// Asks for light over a ball. `scatter` says what the surface makes of light from a direction, and the density with
    /// which it would go there itself.
    pub(super) fn ask_over(
        &self,
        path: &Path<R::Id>,
        asking: &Asking,
        round: &mut Round<R::Id>,
        mut scatter: impl FnMut(DVec3) -> (Spectrum, f64),
    ) {
        let Round { asks: Asks { single: ways, .. }, bends, .. } = round;
        let Some(ask) = self.pick_over(path, asking, ways, 0) else { return };
        let usable = ways.begin(1);
        for branch in Branch::ALL {
            if ways.solve(branch, usable) != 0 {
                self.bring(path, &ask, ways, 0, bends, &mut scatter);
            }
        }
    }

    /// Keeps a question of a matte point until there are sixteen.
    #[inline]
    pub(super) fn ask_over_soon(
        &self,
        path: &Path<R::Id>,
        albedo: Spectrum,
        asking: &Asking,
        asks: &mut Asks<R::Id>,
        bends: &mut Bends<R::Id>,
    ) {
        let lane = asks.asks.len();
        let Some(ask) = self.pick_over(path, asking, &mut asks.ways, lane) else { return };
        asks.asks.push((ask, *path, albedo));
        if asks.asks.len() == Bundle::LANES {
            self.answer(asks, bends);
        }
    }

    /// Answers the questions of matte points.
    pub(super) fn answer(&self, asks: &mut Asks<R::Id>, bends: &mut Bends<R::Id>) {
        let Asks { ways, asks, .. } = asks;
        if asks.is_empty() {
            return;
        }
        let lanes = u16::MAX >> (Bundle::LANES - asks.len());
        let usable = ways.begin(lanes);
        for branch in Branch::ALL {
            let mut found = ways.solve(branch, usable);
            while found != 0 {
                let lane = found.trailing_zeros() as usize % Bundle::LANES;
                found &= found - 1;
                let (ask, path, albedo) = &asks[lane];
                self.bring(path, ask, ways, lane, bends, &mut |direction| {
                    let density = cosine_pdf(direction.dot(ask.normal));
                    (*albedo * density, density)
                });
            }
        }
        asks.clear();
    }

    /// What a way brings if nothing is between.
    fn bring(
        &self,
        path: &Path<R::Id>,
        ask: &Ask,
        ways: &Ways,
        lane: usize,
        bends: &mut Bends<R::Id>,
        scatter: &mut impl FnMut(DVec3) -> (Spectrum, f64),
    ) {
        let scene = self.scene;
        let Some(caster) = scene.casters.get(ask.caster) else { return };
        let wi = get(&ways.direction, lane);
        if !(wi.dot(ask.geometric) > 0.0 && wi.dot(ask.normal) > 0.0) {
            return;
        }
        let density = ask.density * ways.spread[lane];
        let (scattered, own) = scatter(wi);
        let weight = share_of_question(scene.settings.light_sampling, density, own);
        let (length, reach) = (ways.length[lane], ways.reach[lane]);
        let clear = self.transmittance(None, length + reach);
        let left = caster.left(ways.cos[lane], ways.chord[lane]);
        let value = ask.light * scattered * left * clear * (weight / density);
        if !(value.max_element() > 0.0 && value.is_finite()) {
            return;
        }
        let (exit, onward) = (get(&ways.exit, lane), get(&ways.onward, lane));
        let first = bends.legs.len();
        let r = caster.bender.radius;
        let mut there = ask.query;
        there.ray.direction = wi;
        there.t_max = (length - SHORT * (length + r)).max(0.0);
        bends.legs.push(there);
        let error = gamma(64) * (caster.bender.center.abs().max_element() + r);
        let from = HitId { instance: HitId::NO_INSTANCE, object: caster.object, part: 0 };
        let leave = |origin, direction, t_max, outward| {
            let ray = Ray { origin, direction, time: there.ray.time, error };
            let contacts = Contacts { crossed: caster.is_through(), except: None };
            Query::new(ray, t_max, Some(Departure { from, outward }), contacts)
        };
        if caster.is_through() && !caster.alone {
            let met = there.ray.origin + wi * length;
            let chord = ways.chord[lane];
            bends.legs.push(leave(met, (exit - met) / chord, chord * (1.0 - SHORT), false));
        }
        let normal = get(&ways.normal, lane);
        let short = scene.sources.short_of(ask.emitter, exit, onward, reach, normal);
        bends.legs.push(leave(exit, onward, short, true));
        let depth = path.depth + 2 + u32::from(caster.bender.pieces);
        let value = self.clamped(depth, value);
        let task = Task { sample: path.sample, id: path.id, value, sharp: false, inside: None };
        bends.tasks.push((task, bends.legs.len() - first));
        if R::ENABLED {
            let trail =
                (0..=caster.bender.pieces).fold(path.trail.then(false), |t, _| t.then(true));
            bends.told.push(Told::asked(What::Light(ask.source), trail, weight, value));
        }
    }

    /// Adds what arrives over balls.
    pub(super) fn cast_bends(&mut self, round: &mut Round<R::Id>) {
        let Round { bends, blockers, .. } = round;
        if bends.tasks.is_empty() {
            return;
        }
        let scene = self.scene;
        self.counts.shadow += bends.legs.len() as u64;
        scene.world.blocker_each(&bends.legs, blockers);
        let mut first = 0;
        for (i, (task, count)) in bends.tasks.iter().enumerate() {
            let legs = first..first + count;
            first += count;
            let (mut visible, mut blocked) = (Spectrum::ONE, None);
            for (query, blocker) in bends.legs[legs.clone()].iter().zip(&blockers[legs]) {
                if let Some(id) = blocker {
                    visible *= self.shadowed(query, id, task.sharp);
                    blocked = Some(*id);
                }
            }
            let value = task.value * visible;
            if visible != Spectrum::ZERO {
                self.radiances[task.sample as usize].color += value;
            }
            if R::ENABLED {
                let told = &bends.told[i];
                self.recorder
                    .term(task.id, told.name, value, || told.of_source(scene, visible, blocked));
            }
        }
        bends.tasks.clear();
        bends.legs.clear();
        bends.told.clear();
    }
}
