// SPDX-License-Identifier: MIT OR Apache-2.0
//! A surface's own colour: ambient light, its own light, and each light's diffuse term and highlight
//! behind its shadow.

use dioptric_geometry::HitId;
use dioptric_math::{DVec3, Spectrum, normalize, pow, powi};
use serde_json::{Value, json};

use super::point::Point;
use super::recorder::Recorder;
use super::whitted::Whitted;
use crate::light::LightSample;
use crate::material::{Highlight, HighlightModel};
use crate::scene::PlacedLight;
use crate::setting::render::Shadows;

/// One light's two terms, before and behind its shadow.
#[derive(Default)]
struct Lit {
    diffuse: Spectrum,
    highlight: Spectrum,
    diffuse_unshadowed: Spectrum,
    highlight_unshadowed: Spectrum,
    cosine: f64,
    /// Samples that are not behind the surface.
    in_front: u32,
    visibility: Spectrum,
    /// For a recorder only.
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

impl<'a, R: Recorder> Whitted<'a, R> {
    /// The lit sum: ambient, emission, and every light.
    pub(super) fn own(&mut self, point: &Point) -> Spectrum {
        let scene = self.scene;
        let finish = &point.finish;
        let mut sum = scene.ambient * finish.ambient;
        if sum != Spectrum::ZERO {
            self.recorder.term("ambient", sum, || {
                (None, json!({"ambient": scene.ambient.to_array(), "color": finish.ambient.to_array()}))
            });
        }
        if finish.emission != Spectrum::ZERO {
            sum += finish.emission;
            self.recorder.term("emission", finish.emission, || (None, json!({})));
        }
        if finish.diffuse == Spectrum::ZERO && finish.highlight.is_none() {
            return sum;
        }
        for placed in &scene.lights {
            sum += self.one_light(point, placed);
        }
        sum
    }

    /// The mean over the light's samples.
    fn one_light(&mut self, point: &Point, placed: &PlacedLight) -> Spectrum {
        let n = placed.light.samples().max(1);
        let mut lit = Lit::default();
        if n == 1 {
            let u = self.stream.next_2d();
            self.light_sample(point, placed, u, 1.0, &mut lit);
        } else {
            let share = 1.0 / f64::from(n);
            for u in self.stream.pairs(n) {
                self.light_sample(point, placed, u, share, &mut lit);
            }
        }
        if R::ENABLED {
            self.tell(point, placed, n, &mut lit);
        }
        lit.diffuse + lit.highlight
    }

    fn light_sample(
        &mut self,
        point: &Point,
        placed: &PlacedLight,
        u: [f64; 2],
        share: f64,
        lit: &mut Lit,
    ) {
        let Some(light) = placed.light.sample(point.shading.surface.point, u) else { return };
        let cosine = point.normal.dot(light.direction);
        lit.cosine += share * cosine;
        // A light behind the surface sends nothing, and no ray is cast; NaN is behind. A bent normal (bumps,
        // vertex normals) may see a light that the true surface hides.
        if !(cosine > 0.0 && point.geometric().dot(light.direction) > 0.0) {
            return;
        }
        lit.in_front += 1;
        let arriving = light.arriving * share;
        let diffuse = point.finish.diffuse * arriving * cosine;
        let highlight = match &point.finish.highlight {
            Some(h) => {
                h.color
                    * arriving
                    * strength(h, point.normal, light.direction, -point.ray.direction)
            }
            None => Spectrum::ZERO,
        };
        lit.diffuse_unshadowed += diffuse;
        lit.highlight_unshadowed += highlight;
        if diffuse + highlight == Spectrum::ZERO {
            return;
        }
        let visibility = self.visibility(point, &light);
        lit.visibility += visibility * share;
        lit.diffuse += diffuse * visibility;
        lit.highlight += highlight * visibility;
        if R::ENABLED {
            self.list_blockers(point, &light, &mut lit.blockers);
        }
    }

    /// What of a light passes on its way to a point: 1 where nothing is between.
    fn visibility(&mut self, point: &Point, light: &LightSample) -> Spectrum {
        let leg = point.back(light.direction);
        let scene = self.scene;
        let departure = Some(&leg.departure);
        match scene.settings.shadows {
            Shadows::None => Spectrum::ONE,
            Shadows::Opaque => {
                self.counts.shadow += 1;
                let world = &scene.world;
                let blocked =
                    world.occluded_past(&leg.ray, light.distance, departure, leg.contacts);
                if blocked { Spectrum::ZERO } else { Spectrum::ONE }
            }
            Shadows::Tinted => {
                self.counts.shadow += 1;
                scene.tinted(&leg, light.distance)
            }
        }
    }

    /// Notes every object between a point and a light.
    fn list_blockers(&self, point: &Point, light: &LightSample, out: &mut Vec<Blocker>) {
        let opaque = match self.scene.settings.shadows {
            Shadows::None => return,
            Shadows::Opaque => true,
            Shadows::Tinted => false,
        };
        let mut met: Vec<Blocker> = Vec::new();
        self.scene.passages(&point.back(light.direction), light.distance, |hit, factor| {
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

    fn tell(&mut self, point: &Point, placed: &PlacedLight, samples: u32, lit: &mut Lit) {
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
            self.recorder.term("diffuse", lit.diffuse, || {
                (Some(label.clone()), detail(lit.diffuse_unshadowed))
            });
        }
        if lit.highlight_unshadowed != Spectrum::ZERO {
            self.recorder.term("highlight", lit.highlight, || {
                (Some(label), detail(lit.highlight_unshadowed))
            });
        }
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
    // Most exponents are small whole numbers: squaring is much faster than the general power.
    let whole = n.trunc() == n && (0.0..=4096.0).contains(&n);
    let strength = if whole { powi(base, n as u32) } else { pow(base, n) };
    if strength < FAINTEST { 0.0 } else { strength }
}
