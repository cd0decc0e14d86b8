// SPDX-License-Identifier: MIT OR Apache-2.0
//! What a recorder is told of one light at one point.

use dioptric_geometry::HitId;
use dioptric_geometry::world::Query;
use dioptric_math::Spectrum;
use serde_json::{Value, json};

use super::direct::Asked;
use super::recorder::Recorder;
use super::shadow::Start;
use super::whitted::Whitted;
use crate::material::Finish;
use crate::setting::render::Shadows;

/// What a recorder wants to know of one light at one point.
#[derive(Default)]
pub(super) struct Told {
    pub diffuse_unshadowed: Spectrum,
    pub highlight_unshadowed: Spectrum,
    pub cosine: f64,
    /// Samples that are not behind the surface.
    pub in_front: u32,
    pub visibility: Spectrum,
    pub blockers: Vec<Blocker>,
}

/// An object between a point and a light.
pub(super) struct Blocker {
    id: HitId,
    /// Where the nearest ray meets it.
    t: f64,
    /// What it lets pass: the sum over the rays that meet it.
    passes: Spectrum,
    rays: u32,
}

/// One light's two terms at one point, behind its shadow.
#[derive(Clone, Copy, Default)]
pub(super) struct Sum {
    pub diffuse: Spectrum,
    pub highlight: Spectrum,
}

impl<R: Recorder> Whitted<'_, '_, R> {
    /// Notes every object between a point and a light.
    pub(super) fn list_blockers(&self, query: &Query, out: &mut Vec<Blocker>) {
        let opaque = match self.scene.settings.shadows {
            Shadows::None => return,
            Shadows::Opaque => true,
            Shadows::Tinted => false,
        };
        let mut met: Vec<Blocker> = Vec::new();
        let (mut hits, departure) = (Vec::new(), query.departure());
        self.scene.world.hits(&query.ray, query.t_max, departure.as_ref(), &mut hits);
        self.scene.passages(&Start::of(query), query.t_max, hits.iter(), |hit, factor| {
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

    /// Tells of one light at one point.
    pub(super) fn tell(
        &mut self,
        id: R::Id,
        finish: &Finish,
        asked: Asked,
        sum: &Sum,
        lit: &mut Told,
    ) {
        let Asked { placed, samples, .. } = asked;
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
        if finish.diffuse != Spectrum::ZERO {
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
