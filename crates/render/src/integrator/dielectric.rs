// SPDX-License-Identifier: MIT OR Apache-2.0
//! Glass: reflection and refraction by Fresnel at one interface, with the media that the ray is in.

use dioptric_math::Spectrum;
use serde_json::json;

use super::media::Medium;
use super::optics::fresnel;
use super::recorder::{RayKind, Recorder};
use super::whitted::{Met, Whitted, facet_for};

/// What tints and spreads the two rays.
#[derive(Clone, Copy)]
pub(super) struct Dielectric {
    pub reflect: Spectrum,
    pub transmit: Spectrum,
    pub roughness: f64,
}

impl<R: Recorder> Whitted<'_, '_, R> {
    /// Splits a ray at a dielectric's surface.
    pub(super) fn dielectric(&mut self, met: &mut Met<R::Id>, medium: &Medium, how: Dielectric) {
        let id = met.way.id;
        let facet =
            facet_for(met.point.normal, met.point.ray.direction, how.roughness, &mut met.stream);
        let met = &*met;
        let (point, inside) = (&met.point, met.way.inside);
        let solid = point.is_solid(self.scene);
        // Light of its own (highlights) and tints are met on the outside; a pane has two outsides.
        let outside = point.outside || !solid;
        let sides = self.media.sides(inside, medium, point.outside, solid);
        if self.media.is_hidden(&sides, medium, point.outside) {
            self.recorder.note(id, "hidden", || json!("by a thing of a higher priority"));
            self.recorder.scale(id, "hidden", Spectrum::ZERO);
            let leg = point.on(point.ray.direction);
            self.follow(met, 1, RayKind::Transmitted, leg, Spectrum::ONE, sides.far);
            return;
        }
        self.nodes[met.node].own = met.own;
        let eta = sides.eta();
        let d = point.ray.direction;
        let through = if solid { point.refracted(facet, eta) } else { Some(d) };
        let mut reflected = if through.is_none() { 1.0 } else { fresnel(-d.dot(facet), eta) };
        if !solid {
            // To and fro between the two faces of a thin pane: r + (1-r)^2 r + (1-r)^2 r^3 + ...
            // (Born and Wolf, "Principles of Optics", 7th ed., section 7.6.1, without interference.)
            reflected = 2.0 * reflected / (1.0 + reflected);
        }
        self.recorder.note(id, "fresnel", || {
            json!({
                "ior_from": sides.ior[0],
                "ior_to": sides.ior[1],
                "reflected": reflected,
                "total_internal_reflection": through.is_none(),
            })
        });
        let (tint_back, tint_on) =
            if outside { (how.reflect, how.transmit) } else { (Spectrum::ONE, Spectrum::ONE) };
        if reflected > 0.0 {
            let leg = point.back(point.mirrored(facet));
            self.follow(met, 0, RayKind::Reflected, leg, tint_back * reflected, sides.near);
        }
        if let Some(direction) = through {
            let weight = tint_on * (1.0 - reflected);
            let leg = point.on(direction);
            self.follow(met, 1, RayKind::Transmitted, leg, weight, sides.far);
        }
    }
}
