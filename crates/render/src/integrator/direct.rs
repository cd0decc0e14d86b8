// SPDX-License-Identifier: MIT OR Apache-2.0
//! A surface's own colour: ambient light, its own light, and each light's diffuse term and highlight
//! behind its shadow.

use dioptric_geometry::HitId;
use dioptric_geometry::world::Query;
use dioptric_math::{DVec3, Spectrum, normalize, powi, unit_power};
use serde_json::{Value, json};

use super::point::{Leg, Point};
use super::recorder::Recorder;
use super::whitted::{Met, Whitted};
use crate::material::{Highlight, HighlightModel};
use crate::scene::PlacedLight;
use crate::setting::render::Shadows;

/// Shadow rays that are cast together.
const TOGETHER: usize = 512;

/// What a recorder wants to know of one light at one point.
#[derive(Default)]
struct Told {
    diffuse_unshadowed: Spectrum,
    highlight_unshadowed: Spectrum,
    cosine: f64,
    /// Samples that are not behind the surface.
    in_front: u32,
    visibility: Spectrum,
    blockers: Vec<Blocker>,
}

/// An object between a point and a light.
struct Blocker {
    id: HitId,
    /// Where the nearest ray meets it.
    t: f64,
    /// What it lets pass: the sum over the rays that meet it.
    passes: Spectrum,
    rays: u32,
}

/// What one sample of a light adds to a point if nothing is between.
struct Task {
    /// Which of the points.
    of: usize,
    share: f64,
    diffuse: Spectrum,
    /// The light, already with its share.
    arriving: Spectrum,
}

/// One light's two terms at one point, behind its shadow.
#[derive(Clone, Copy, Default)]
struct Sum {
    diffuse: Spectrum,
    highlight: Spectrum,
}

/// Memory that lighting uses again.
#[derive(Default)]
pub(super) struct Scratch {
    queries: Vec<Query>,
    tasks: Vec<Task>,
    blockers: Vec<Option<HitId>>,
    sums: Vec<Sum>,
    told: Vec<Told>,
}

impl<R: Recorder> Whitted<'_, '_, R> {
    /// Works out the own colours: ambient, emission, and every light.
    pub(super) fn light(&mut self, points: &mut [Met], scratch: &mut Scratch) {
        let scene = self.scene;
        for met in points.iter_mut().filter(|met| met.wants_own) {
            let (id, finish) = (self.nodes[met.node].id, &met.point.finish);
            let mut sum = scene.ambient * finish.ambient;
            if sum != Spectrum::ZERO {
                self.recorder.term(id, "ambient", sum, || {
                    (None, json!({"ambient": scene.ambient.to_array(), "color": finish.ambient.to_array()}))
                });
            }
            if finish.emission != Spectrum::ZERO {
                sum += finish.emission;
                self.recorder.term(id, "emission", finish.emission, || (None, json!({})));
            }
            met.own = sum;
        }
        for placed in &scene.lights {
            self.one_light(points, placed, scratch);
        }
    }

    /// Adds the mean over the light's samples to each point.
    fn one_light(&mut self, points: &mut [Met], placed: &PlacedLight, scratch: &mut Scratch) {
        let n = placed.light.samples().max(1);
        let share = 1.0 / f64::from(n);
        scratch.sums.clear();
        scratch.sums.resize(points.len(), Sum::default());
        if R::ENABLED {
            scratch.told.clear();
            scratch.told.resize_with(points.len(), Told::default);
        }
        for of in 0..points.len() {
            let met = &mut points[of];
            if !lit(met) {
                continue;
            }
            if n > 1 {
                for u in met.stream.pairs(n) {
                    light_sample::<R>(met, of, placed, u, share, scratch);
                }
            } else if placed.light.is_sharp() {
                met.stream.skip();
                light_sample::<R>(met, of, placed, [0.5; 2], 1.0, scratch);
            } else {
                let u = met.stream.next_2d();
                light_sample::<R>(met, of, placed, u, 1.0, scratch);
            }
            if scratch.tasks.len() >= TOGETHER {
                self.cast_shadows(points, scratch);
            }
        }
        self.cast_shadows(points, scratch);
        for (of, met) in points.iter_mut().enumerate() {
            if lit(met) {
                let sum = scratch.sums[of];
                met.own += sum.diffuse + sum.highlight;
                if R::ENABLED {
                    let id = self.nodes[met.node].id;
                    self.tell(id, &met.point, placed, n, &sum, &mut scratch.told[of]);
                }
            }
        }
    }

    /// Finds out what of the samples arrives, and adds it.
    fn cast_shadows(&mut self, points: &[Met], scratch: &mut Scratch) {
        let scene = self.scene;
        let Scratch { queries, tasks, blockers, sums, told } = scratch;
        let shadows = scene.settings.shadows;
        if shadows == Shadows::None {
            blockers.clear();
            blockers.resize(queries.len(), None);
        } else {
            self.counts.shadow += queries.len() as u64;
            scene.world.blocker_each(queries, blockers);
        }
        for ((query, task), blocker) in queries.iter().zip(tasks.iter()).zip(blockers.iter()) {
            let visibility = match blocker {
                None => Spectrum::ONE,
                Some(id) if shadows == Shadows::Opaque || scene.is_opaque(*id) => Spectrum::ZERO,
                Some(_) => {
                    Leg::of(query).map_or(Spectrum::ONE, |leg| scene.tinted(&leg, query.t_max))
                }
            };
            let sum = &mut sums[task.of];
            if visibility != Spectrum::ZERO {
                sum.diffuse += task.diffuse * visibility;
                // Only now: the highlight costs more than all the rest.
                let point = &points[task.of].point;
                if point.finish.highlight.is_some() {
                    let highlight = shine(point, query.ray.direction, task.arriving);
                    sum.highlight += highlight * visibility;
                }
            }
            if R::ENABLED {
                let told = &mut told[task.of];
                told.visibility += visibility * task.share;
                self.list_blockers(query, &mut told.blockers);
            }
        }
        queries.clear();
        tasks.clear();
    }

    /// Notes every object between a point and a light.
    fn list_blockers(&self, query: &Query, out: &mut Vec<Blocker>) {
        let opaque = match self.scene.settings.shadows {
            Shadows::None => return,
            Shadows::Opaque => true,
            Shadows::Tinted => false,
        };
        let mut met: Vec<Blocker> = Vec::new();
        let Some(leg) = Leg::of(query) else { return };
        self.scene.passages(&leg, query.t_max, |hit, factor| {
            let passes = if opaque { Spectrum::ZERO } else { factor };
            match met.iter_mut().find(|b| b.id.same_object(&hit.id)) {
                Some(known) => known.passes *= passes,
                None => met.push(Blocker { id: hit.id, t: hit.t, passes, rays: 1 }),
            }
            true
        });
        for new in met {
            match out.iter_mut().find(|b| b.id.same_object(&new.id)) {
                Some(known) => {
                    known.t = known.t.min(new.t);
                    known.passes += new.passes;
                    known.rays += 1;
                }
                None => out.push(new),
            }
        }
    }

    fn tell(
        &mut self,
        id: R::Id,
        point: &Point,
        placed: &PlacedLight,
        samples: u32,
        sum: &Sum,
        lit: &mut Told,
    ) {
        lit.blockers.sort_by(|a, b| a.t.total_cmp(&b.t).then(a.id.cmp(&b.id)));
        let scene = self.scene;
        let blocker = |b: &Blocker| {
            json!({
                "object": scene.object_label(b.id),
                "source": scene.object_source(b.id),
                "t": b.t,
                "passes": (b.passes / f64::from(b.rays)).to_array(),
                "rays": b.rays,
            })
        };
        let blockers: Vec<Value> = lit.blockers.iter().map(blocker).collect();
        let label = self.scene.description.label(placed.node);
        let source = self.scene.source(placed.node);
        let detail = |unshadowed: Spectrum| {
            json!({
                "unshadowed": unshadowed.to_array(),
                "visibility": lit.visibility.to_array(),
                "cosine": lit.cosine,
                "samples": samples,
                "behind": lit.in_front == 0,
                "blockers": blockers,
                "light_source": source,
            })
        };
        if point.finish.diffuse != Spectrum::ZERO {
            self.recorder.term(id, "diffuse", sum.diffuse, || {
                (Some(label.clone()), detail(lit.diffuse_unshadowed))
            });
        }
        if lit.highlight_unshadowed != Spectrum::ZERO {
            self.recorder.term(id, "highlight", sum.highlight, || {
                (Some(label), detail(lit.highlight_unshadowed))
            });
        }
    }
}

/// Whether a point is lit by lights at all.
fn lit(met: &Met) -> bool {
    let finish = &met.point.finish;
    met.wants_own && (finish.diffuse != Spectrum::ZERO || finish.highlight.is_some())
}

/// Takes one sample of a light, and asks for the ray to it if it could add something.
#[inline]
fn light_sample<R: Recorder>(
    met: &Met,
    of: usize,
    placed: &PlacedLight,
    u: [f64; 2],
    share: f64,
    scratch: &mut Scratch,
) {
    let point = &met.point;
    let Some(light) = placed.light.sample(point.surface.point, u) else { return };
    let cosine = point.normal.dot(light.direction);
    if R::ENABLED {
        scratch.told[of].cosine += share * cosine;
    }
    // A light behind the surface sends nothing, and no ray is cast; NaN is behind. A bent normal (bumps,
    // vertex normals) may see a light that the true surface hides.
    if !(cosine > 0.0 && point.geometric().dot(light.direction) > 0.0) {
        return;
    }
    let arriving = light.arriving * share;
    let diffuse = point.finish.diffuse * arriving * cosine;
    if R::ENABLED {
        let told = &mut scratch.told[of];
        told.in_front += 1;
        told.diffuse_unshadowed += diffuse;
        told.highlight_unshadowed += shine(point, light.direction, arriving);
    }
    if diffuse == Spectrum::ZERO && shine(point, light.direction, arriving) == Spectrum::ZERO {
        return;
    }
    let mut query = met.shadow;
    query.ray.direction = light.direction;
    query.t_max = light.distance;
    scratch.queries.push(query);
    scratch.tasks.push(Task { of, share, diffuse, arriving });
}

/// A light's highlight at a point.
#[inline]
fn shine(point: &Point, to_light: DVec3, arriving: Spectrum) -> Spectrum {
    match &point.finish.highlight {
        Some(h) => h.color * arriving * strength(h, point.normal, to_light, -point.ray.direction),
        None => Spectrum::ZERO,
    }
}

/// A highlight that is a smaller share of its light is none: nobody could see what its shadow ray costs.
const FAINTEST: f64 = 1e-9;

/// How strong a highlight is for a normal, the direction to the light and the one to the viewer.
fn strength(highlight: &Highlight, normal: DVec3, to_light: DVec3, to_viewer: DVec3) -> f64 {
    let base = match highlight.model {
        // r . v with r = 2 (n . l) n - l, without making r.
        HighlightModel::Phong => {
            2.0 * normal.dot(to_light) * normal.dot(to_viewer) - to_light.dot(to_viewer)
        }
        HighlightModel::Blinn => {
            normalize(to_light + to_viewer).map_or(0.0, |half| half.dot(normal))
        }
    };
    let (base, n) = (base.clamp(0.0, 1.0), highlight.exponent);
    if base == 0.0 && n > 0.0 {
        return 0.0;
    }
    // Most exponents are small whole numbers: squaring is even faster than the power of numbers up to 1.
    let whole = n.trunc() == n && (0.0..=4096.0).contains(&n);
    let strength = if whole { powi(base, n as u32) } else { unit_power(base, n) };
    if strength < FAINTEST { 0.0 } else { strength }
}
