// SPDX-License-Identifier: MIT OR Apache-2.0
//! Surfaces in layers: one mirrored ray for all that mirrors, and one that goes through what is clear.

use dioptric_math::Spectrum;

use super::media::Medium;
use super::optics::fresnel;
use super::recorder::{RayKind, Recorder};
use super::whitted::{Met, Whitted};
use crate::material::Layers;

impl<R: Recorder> Whitted<'_, '_, R> {
    /// Sends the rays that a surface in layers mirrors and lets through.
    pub(super) fn layered(&mut self, met: &Met<R::Id>, layers: &Layers) {
        let (id, point) = (met.way.id, &met.point);
        let (d, color) = (point.ray.direction, point.finish.base);
        let clear = layers.clear();
        let weight = layers.mirrors(color, -d.dot(met.facet));
        let rest = Spectrum::ONE - weight;
        self.nodes[met.node].own = met.own * rest;
        self.recorder.scale(id, "layers", rest);
        if clear == 0.0 {
            let leg = point.back(point.mirrored(met.facet));
            self.follow(met, 0, RayKind::Reflected, leg, weight, met.way.inside);
            return;
        }
        let solid = point.is_solid(self.scene);
        let outside = point.outside || !solid;
        let (ior, priority) = (layers.ior, self.scene.interior(point.hit.id).priority);
        let medium = Medium { object: point.hit.id, ior, absorption: Spectrum::ZERO, priority };
        let sides = self.media.sides(met.way.inside, &medium, point.outside, solid);
        let eta = sides.eta();
        let on = if solid { point.refracted(met.facet, eta) } else { Some(d) };
        let back = on.map_or(1.0, |_| fresnel(-d.dot(met.facet), eta));
        // From within nothing but the clear share is met.
        let [weight, through] = if outside {
            [weight, color * rest * clear]
        } else {
            [Spectrum::splat(back * clear), Spectrum::splat((1.0 - back) * clear)]
        };
        let leg = point.back(point.mirrored(met.facet));
        self.follow(met, 0, RayKind::Reflected, leg, weight, sides.near);
        if let Some(direction) = on {
            let leg = point.on(direction);
            self.follow(met, 1, RayKind::Transmitted, leg, through, sides.far);
        }
    }
}
