// SPDX-License-Identifier: MIT OR Apache-2.0
//! A surface's own colour: ambient light, its own light, and each light's diffuse term and highlight
//! behind its shadow.

use dioptric_geometry::world::Hit;
use dioptric_geometry::{Departure, Ray};
use dioptric_math::{DVec3, Spectrum, normalize, pow, powi};
use serde_json::{Value, json};

use super::media::absorbed;
use super::recorder::Recorder;
use super::whitted::{Point, Whitted};
use crate::light::LightSample;
use crate::material::{Highlight, HighlightModel, Optics};
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
    visibility: Spectrum,
    blockers: Vec<Value>,
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
            self.tell(placed, n, &lit);
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
        // A light behind the surface sends nothing, and no ray is cast; NaN is behind.
        if !(cosine > 0.0) {
            return;
        }
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
        let (ray, departure) = point.spawn(light.direction);
        match self.scene.settings.shadows {
            Shadows::None => Spectrum::ONE,
            Shadows::Opaque => {
                self.counts.shadow += 1;
                let blocked = self.scene.world.occluded(&ray, light.distance, Some(&departure));
                if blocked { Spectrum::ZERO } else { Spectrum::ONE }
            }
            Shadows::Tinted => {
                self.counts.shadow += 1;
                self.tinted(&ray, light.distance, &departure)
            }
        }
    }

    /// The product of what every object in the way lets pass, each counted once where the ray enters it
    /// (or leaves it, if it starts inside), with the absorption along the way through it.
    fn tinted(&self, ray: &Ray, distance: f64, departure: &Departure) -> Spectrum {
        // Most rays meet nothing; only those that do pay for the list.
        if !self.scene.world.occluded(ray, distance, Some(departure)) {
            return Spectrum::ONE;
        }
        let mut hits = Vec::new();
        self.scene.world.hits(ray, distance, Some(departure), &mut hits);
        let mut passed = Spectrum::ONE;
        for (i, hit) in hits.iter().enumerate() {
            let Some(shading) = self.scene.shading(ray, hit) else { continue };
            let first_of_object = hits[..i].iter().all(|h| !h.id.same_object(&hit.id));
            let enters = shading.surface.normal.dot(ray.direction) < 0.0;
            if enters || first_of_object {
                passed *= shading.material.finish(&shading.point).shadow_pass;
            }
            if !enters {
                passed *= self.absorbed_inside(&hits[..i], hit, &shading);
            }
            if passed == Spectrum::ZERO {
                break;
            }
        }
        passed
    }

    /// Absorption between an object's exit and its last entry (the ray's start, if there is none).
    fn absorbed_inside(
        &self,
        before: &[Hit],
        exit: &Hit,
        shading: &crate::scene::Shading,
    ) -> Spectrum {
        let (Optics::Shares { absorption, .. } | Optics::Dielectric { absorption, .. }) =
            shading.material.finish(&shading.point).optics
        else {
            return Spectrum::ONE;
        };
        let entry = before.iter().rev().find(|h| h.id.same_object(&exit.id)).map_or(0.0, |h| h.t);
        absorbed(absorption, (exit.t - entry) / self.scene.root.scale())
    }

    /// Every object between a point and a light, nearest first, once each.
    fn list_blockers(&self, point: &Point, light: &LightSample, out: &mut Vec<Value>) {
        let (ray, departure) = point.spawn(light.direction);
        let mut hits = Vec::new();
        self.scene.world.hits(&ray, light.distance, Some(&departure), &mut hits);
        hits.retain(|h| h.t < light.distance);
        for (i, hit) in hits.iter().enumerate() {
            let name = self.scene.object_label(hit.id);
            let repeated = hits[..i].iter().any(|h| h.id.same_object(&hit.id))
                || out.iter().any(|b| b["object"] == json!(name) && b["t"] == json!(hit.t));
            if !repeated {
                let pass = self
                    .scene
                    .shading(&ray, hit)
                    .map(|s| s.material.finish(&s.point).shadow_pass.to_array());
                let pass = if self.scene.settings.shadows == Shadows::Tinted {
                    pass
                } else {
                    Some([0.0; 3])
                };
                out.push(json!({"object": name, "source": self.scene.object_source(hit.id), "t": hit.t, "passes": pass}));
            }
        }
    }

    fn tell(&mut self, placed: &PlacedLight, samples: u32, lit: &Lit) {
        let label = self.scene.description.label(placed.node);
        let source = self.scene.source(placed.node);
        let detail = |unshadowed: Spectrum| {
            json!({
                "unshadowed": unshadowed.to_array(),
                "visibility": lit.visibility.to_array(),
                "cosine": lit.cosine,
                "samples": samples,
                "behind": lit.cosine <= 0.0,
                "blockers": lit.blockers,
                "light_source": source,
            })
        };
        self.recorder
            .term("diffuse", lit.diffuse, || (Some(label.clone()), detail(lit.diffuse_unshadowed)));
        if lit.highlight_unshadowed != Spectrum::ZERO {
            self.recorder.term("highlight", lit.highlight, || {
                (Some(label), detail(lit.highlight_unshadowed))
            });
        }
    }
}

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
    if n.trunc() == n && (0.0..=4096.0).contains(&n) { powi(base, n as u32) } else { pow(base, n) }
}
