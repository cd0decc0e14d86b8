// SPDX-License-Identifier: MIT OR Apache-2.0
//! Media that scatter: what a path gets from them on the way to its next surface, and where it turns within them.
//!
//! Each piece of way through such a medium is used twice. A place on it is picked where the medium gets much light, near
//! lamps and in their beams ([`Foci`](crate::source::Foci)) or near by, and a source is asked there. And the path itself
//! goes as far as chance says (by `exp(-extinction t)` of one lane, picked by what the path carries; what is found counts
//! by the density of all three lanes together) and either turns there, or comes through. Light that both can
//! find is weighted as ever; places on the way are a part of the densities.

use dioptric_geometry::world::Query;
use dioptric_geometry::{Contacts, Ray};
use dioptric_math::bounds::gamma;
use dioptric_math::{DVec3, Spectrum, exp, ln};
use serde_json::json;

use super::phase::Phase;
use super::tell::{Told, What};
use super::weights::{carries_on, share_of_question};
use super::{Path, Paths, Round, Task};
use crate::integrator::media::{Inside, Medium, absorbed};
use crate::integrator::point::Point;
use crate::integrator::recorder::Recorder;
use crate::integrator::shadow::Start;
use crate::material::Optics;
use crate::source::Aims;

/// Borders that a path may cross on one line: no scene has as many, but surfaces that coincide in threes might hand a
/// ray to each other.
const MOST_BORDERS: u32 = 10_000;
/// How often a source is asked for where the path itself might turn, and not near a lamp.
const ANYWHERE: f64 = 0.4;

/// What is around a path, per unit of the space of rays.
struct Murk {
    scattering: Spectrum,
    extinction: Spectrum,
    phase: Phase,
}

/// A piece of way through a murk.
struct Piece {
    extinction: [f64; 3],
    /// The chance of each lane.
    lanes: [f64; 3],
    end: f64,
    aims: Option<Aims>,
}

/// What became of a path in a murk.
pub(super) struct Way<I> {
    /// The chance with which it came through; `None` where it did not.
    pub through: Option<f64>,
    /// Where it turned to; `None` where it ended, too.
    pub turned: Option<(Path<I>, Query)>,
}

impl<I> Way<I> {
    /// Nothing was on it.
    pub const CLEAR: Self = Self::through(1.0);

    const fn through(chance: f64) -> Self {
        Self { through: Some(chance), turned: None }
    }
}

impl Piece {
    fn new(murk: &Murk, throughput: Spectrum, end: f64, aims: Option<Aims>) -> Self {
        let carried = throughput.max(Spectrum::ZERO);
        let sum = carried.x + carried.y + carried.z;
        let lanes = if sum > 0.0 { carried / sum } else { Spectrum::splat(1.0 / 3.0) };
        Self { extinction: murk.extinction.to_array(), lanes: lanes.to_array(), end, aims }
    }

    /// The sum of something over all lanes by their chances.
    fn mean(&self, of: impl Fn(f64) -> f64) -> f64 {
        self.lanes.iter().zip(self.extinction).map(|(lane, k)| lane * of(k)).sum()
    }

    /// The density with which the path turns at a place.
    fn density(&self, t: f64) -> f64 {
        self.mean(|k| if k > 0.0 { k * exp(-k * t) } else { 0.0 })
    }

    /// The chance to come through.
    fn chance_through(&self) -> f64 {
        self.mean(|k| if k > 0.0 { exp(-k * self.end) } else { 1.0 })
    }

    /// How far the path goes.
    fn sample(&self, [pick, u]: [f64; 2]) -> f64 {
        let k = self.extinction[pick_lane(&self.lanes, pick)];
        if k > 0.0 { -ln(1.0 - u) / k } else { f64::INFINITY }
    }

    /// The chances of the lanes to say where a source is asked for.
    fn asking(&self) -> [f64; 3] {
        let able = [0, 1, 2].map(|i| if self.extinction[i] > 0.0 { self.lanes[i] } else { 0.0 });
        let sum: f64 = able.iter().sum();
        if sum > 0.0 { able.map(|x| x / sum) } else { [0.0; 3] }
    }

    /// Where to ask a source, for a number in `[0, 1)`.
    fn sample_question(&self, u: f64) -> Option<f64> {
        let mut u = u;
        if let Some(aims) = &self.aims {
            if u >= ANYWHERE {
                return Some(aims.sample((u - ANYWHERE) / (1.0 - ANYWHERE)));
            }
            u /= ANYWHERE;
        }
        let asking = self.asking();
        let lane = pick_lane(&asking, u);
        if !(asking[lane] > 0.0) {
            return None;
        }
        let before: f64 = asking[..lane].iter().sum();
        let u = ((u - before) / asking[lane]).clamp(0.0, 1.0 - f64::EPSILON);
        let k = self.extinction[lane];
        Some((-ln(1.0 - u * lost(k * self.end)) / k).min(self.end))
    }

    /// The density of [`Self::sample_question`].
    fn density_of_question(&self, t: f64) -> f64 {
        let one = |(share, k): (f64, f64)| {
            if share > 0.0 { share * k * exp(-k * t) / lost(k * self.end) } else { 0.0 }
        };
        let anywhere: f64 = self.asking().into_iter().zip(self.extinction).map(one).sum();
        match &self.aims {
            Some(aims) => ANYWHERE * anywhere + (1.0 - ANYWHERE) * aims.density(t),
            None => anywhere,
        }
    }
}

/// The lane that a number in `[0, 1)` picks.
fn pick_lane(chances: &[f64; 3], pick: f64) -> usize {
    let mut rest = pick;
    let mut last = 0;
    for (lane, &chance) in chances.iter().enumerate() {
        if chance > 0.0 {
            last = lane;
            if rest < chance {
                return lane;
            }
            rest -= chance;
        }
    }
    last
}

/// `1 - exp(-x)`, also where that is small.
fn lost(x: f64) -> f64 {
    if x < 1e-5 { x * (1.0 - 0.5 * x) } else { 1.0 - exp(-x) }
}

impl<'a, R: Recorder> Paths<'a, '_, R> {
    /// What scatters around a path.
    fn murk(&self, inside: Inside) -> Option<Murk> {
        let scene = self.scene;
        let (scattering, extinction) = match self.media.top(inside) {
            Some(Medium { object, absorption, .. }) => {
                let scale = scene.root.scale();
                (scene.interior(*object).scattering?, *absorption / scale)
            }
            None => (scene.surroundings.scattering?, scene.surroundings.extinction()),
        };
        let phase = Phase { g: scattering.mean_cosine };
        let scattering = scattering.coefficient / scene.root.scale();
        Some(Murk { scattering, extinction, phase })
    }

    /// What a medium adds on the way to `end`, and whether the path turns before.
    pub(super) fn scatter_inside(
        &mut self,
        path: &mut Path<R::Id>,
        query: &Query,
        end: f64,
        round: &mut Round<R::Id>,
    ) -> Way<R::Id> {
        let Some(murk) = self.murk(path.inside).filter(|_| end > 0.0) else { return Way::CLEAR };
        let Ray { origin, direction, .. } = query.ray;
        let least = murk.extinction.min_element();
        let aims = self.scene.sources.foci().aims(origin, direction, end, least);
        let piece = Piece::new(&murk, path.throughput, end, aims);
        self.ask_along(path, query, &murk, &piece, round);
        let t = piece.sample(path.stream.next_2d());
        if t >= end {
            // The directions are not needed; what follows keeps its numbers.
            path.stream.skip();
            return Way::through(piece.chance_through());
        }
        Way { through: None, turned: self.turn(path, query, &murk, &piece, t) }
    }

    /// Asks a source at a place of the medium.
    fn ask_along(
        &mut self,
        path: &mut Path<R::Id>,
        query: &Query,
        murk: &Murk,
        piece: &Piece,
        round: &mut Round<R::Id>,
    ) {
        let scene = self.scene;
        let [place, pick] = path.stream.next_2d();
        let u = path.stream.next_2d();
        if path.depth > scene.settings.bounces {
            return;
        }
        let Some(t) = piece.sample_question(place) else { return };
        let asked = piece.density_of_question(t);
        let from = within(&query.ray, t);
        let Some(source) = scene.sources.sample(scene, from.origin, None, pick, u) else { return };
        let scattered = murk.phase.eval(query.ray.direction.dot(source.direction));
        let pdf = source.pdf * (asked / piece.density(t));
        let weight = share_of_question(scene.settings.light_sampling, pdf, scattered);
        let left = absorbed(murk.extinction, t) * murk.scattering / asked;
        let clear = self.clear_to_source(path.inside, source.distance);
        let value = path.throughput * left * source.value * clear * (scattered * weight);
        if !(value.max_element() > 0.0 && value.is_finite()) {
            return;
        }
        let value = self.clamped(path.depth + 1, value);
        let ray = Ray { direction: source.direction, ..from };
        round.shadows.push(Query::new(ray, source.distance, None, Contacts::CROSSED));
        let sharp = source.pdf == f64::INFINITY;
        let inside = path.inside;
        round.tasks.push(Task { sample: path.sample, id: path.id, value, sharp, inside });
        if R::ENABLED {
            let trail = path.trail.then_volume();
            round.told.push(Told::asked(What::Light(source.source), trail, weight, value));
        }
    }

    /// The path turns at a place of the medium.
    fn turn(
        &mut self,
        path: &Path<R::Id>,
        query: &Query,
        murk: &Murk,
        piece: &Piece,
        t: f64,
    ) -> Option<(Path<R::Id>, Query)> {
        let scene = self.scene;
        if path.depth == 0 {
            self.radiances[path.sample as usize].alpha = 1.0;
        }
        let density = piece.density(t);
        let weight = absorbed(murk.extinction, t) * murk.scattering / density;
        let mut stream = path.stream;
        let (direction, scattered) = murk.phase.sample(query.ray.direction, stream.next_2d());
        let from = within(&query.ray, t);
        let mut next = Path {
            throughput: path.throughput * weight,
            density: scattered * (density / piece.density_of_question(t)),
            normal: None,
            depth: path.depth + 1,
            trail: path.trail.then_volume(),
            walked: 0.0,
            ..*path
        };
        let told = || {
            let medium = self.media.top(path.inside);
            json!({
                "bounce": path.depth,
                "object": medium.map_or_else(|| "medium".into(), |m| scene.object_label(m.object)),
                "t": t,
                "point": from.origin.to_array(),
                "how": "scatters inside",
                "weight": weight.to_array(),
            })
        };
        let ended = if path.depth > scene.settings.bounces {
            Some("at the limit of bounces")
        } else if !(next.throughput.max_element() > 0.0 && next.throughput.is_finite()) {
            Some("absorbed")
        } else if carries_on(&mut next, &mut stream).is_none() {
            Some("by chance: it carried too little")
        } else {
            None
        };
        self.recorder.also(path.id, "bounces", told);
        if let Some(why) = ended {
            self.recorder.note(path.id, "ended", || json!(why));
            return None;
        }
        self.counts.reflect += 1;
        next.stream = stream;
        let ray = Ray { direction, ..from };
        Some((next, Query::new(ray, f64::INFINITY, None, Contacts::CROSSED)))
    }

    /// Takes a path through a border that does nothing.
    pub(super) fn cross_border(
        &mut self,
        path: &Path<R::Id>,
        point: &Point<'a>,
    ) -> Option<(Path<R::Id>, Query)> {
        let inside = self.beyond_border(path.inside, point, point.outside);
        Self::go_on(path, point, inside)
    }

    /// Straight on, with this around.
    pub(super) fn go_on(
        path: &Path<R::Id>,
        point: &Point<'a>,
        inside: Inside,
    ) -> Option<(Path<R::Id>, Query)> {
        if path.borders >= MOST_BORDERS {
            return None;
        }
        let leg = point.on(point.ray.direction);
        let walked = path.walked + point.hit.t;
        let next = Path { inside, walked, borders: path.borders + 1, ..*path };
        Some((next, leg.query(f64::INFINITY)))
    }

    /// What is around a ray that went in or out.
    fn beyond_border(&mut self, inside: Inside, point: &Point, into: bool) -> Inside {
        let Optics::Shares { absorption, .. } = point.finish.optics else { return inside };
        let object = point.hit.id;
        let outer = self.media.leave(inside, &object);
        if !point.is_solid(self.scene) {
            return inside;
        }
        if !into {
            return outer;
        }
        let scene = self.scene;
        let absorption = scene.extinction(object, absorption);
        let (ior, priority) = (self.media.ior(outer), scene.interior(object).priority);
        self.media.enter(outer, Medium { object, ior, absorption, priority })
    }

    /// What of a source comes through borders that do nothing, and the media between them.
    pub(super) fn through_borders(
        &mut self,
        query: &Query,
        inside: Inside,
        sharp: bool,
    ) -> Spectrum {
        let scene = self.scene;
        let (mut hits, departure) = (Vec::new(), query.departure());
        scene.world.hits(&query.ray, query.t_max, departure.as_ref(), &mut hits);
        let start = Start::of(query);
        let (mut left, mut inside, mut at) = (Spectrum::ONE, inside, 0.0);
        for hit in hits.iter().filter(|hit| hit.t < query.t_max) {
            let Some(shading) = scene.shading(&query.ray, hit) else { continue };
            if !shading.finish.present || start.stays_off(hit, &shading.surface) {
                continue;
            }
            if !scene.interior(hit.id).border {
                return if sharp { self.shadowed(query, &hit.id, true) } else { Spectrum::ZERO };
            }
            left *= self.transmittance(inside, hit.t - at);
            at = hit.t;
            let point = Point::new(&query.ray, *hit, shading, None);
            inside = self.beyond_border(inside, &point, point.outside);
        }
        left * self.transmittance(inside, query.t_max - at)
    }

    /// What is left of a source's light, if no border can be between.
    pub(super) fn clear_to_source(&self, inside: Inside, distance: f64) -> Spectrum {
        if self.scene.insides.borders {
            return Spectrum::ONE;
        }
        self.transmittance(inside, distance)
    }
}

/// A ray from a place on another one, but for its direction.
fn within(ray: &Ray, t: f64) -> Ray {
    let origin = ray.at(t);
    let size = ray.origin.abs().max_element() + t;
    Ray { origin, direction: DVec3::ZERO, time: ray.time, error: ray.error + gamma(4) * size }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn murk(extinction: [f64; 3]) -> Murk {
        let extinction = Spectrum::from(extinction);
        Murk { scattering: extinction * 0.5, extinction, phase: Phase { g: 0.0 } }
    }

    #[test]
    fn places_have_the_density_that_is_said() {
        for (extinction, end) in
            [([0.5, 2.0, 9.0], 3.0), ([0.0, 1e-7, 0.3], 2.0), ([0.1, 0.0, 0.7], f64::INFINITY)]
        {
            let piece = Piece::new(&murk(extinction), Spectrum::new(0.2, 1.0, 0.4), end, None);
            let n = 200_000;
            let (mut turned, mut asked, mut through) = (0.0, 0.0, 0.0);
            let f = |t: f64| exp(-0.8 * t) * t;
            for i in 0..n {
                let v = (f64::from(i) + 0.5) / f64::from(n);
                // A lattice of two dimensions.
                let t = piece.sample([(f64::from(i) * 0.618_033_988_749_894_8).fract(), v]);
                if t < end {
                    turned += f(t) / piece.density(t);
                } else {
                    through += 1.0;
                }
                let t = piece.sample_question(v).unwrap();
                asked += f(t) / piece.density_of_question(t);
            }
            let exact = |t: f64| (1.0 - exp(-0.8 * t) * (1.0 + 0.8 * t)) / 0.64;
            let exact = if end.is_finite() { exact(end) } else { 1.0 / 0.64 };
            for sum in [turned, asked] {
                assert!((sum / f64::from(n) / exact - 1.0).abs() < 0.01, "{extinction:?} {sum}");
            }
            assert!((through / f64::from(n) - piece.chance_through()).abs() < 0.003);
        }
    }

    #[test]
    fn places_are_found_as_often_as_they_say() {
        let cases =
            [([0.5, 2.0, 9.0], 3.0), ([0.0, 1e-7, 0.3], 2.0), ([0.1, 0.0, 0.7], f64::INFINITY)];
        for (i, (extinction, end)) in cases.into_iter().enumerate() {
            let piece = Piece::new(&murk(extinction), Spectrum::new(0.2, 1.0, 0.4), end, None);
            let turned = crate::statistics::judge_line(
                1.0,
                |t| if t < end { piece.density(t) } else { 0.0 },
                |r| Some(piece.sample([r.unit(), r.unit()])).filter(|t| *t < end),
                10 + i as u64,
            );
            turned.check(&format!("turned {extinction:?}"), 6);
            let asked = crate::statistics::judge_line(
                1.0,
                |t| if t < end { piece.density_of_question(t) } else { 0.0 },
                |r| piece.sample_question(r.unit()),
                20 + i as u64,
            );
            asked.check(&format!("asked {extinction:?}"), 6);
        }
    }

    #[test]
    fn what_is_clear_is_asked_nothing() {
        let piece = Piece::new(&murk([0.0, 0.0, 1.0]), Spectrum::new(1.0, 1.0, 0.0), 2.0, None);
        assert_eq!(piece.sample_question(0.3), None);
        assert_eq!(piece.sample([0.9, 0.9]), f64::INFINITY);
        assert_eq!(piece.chance_through(), 1.0);
    }
}
