// SPDX-License-Identifier: MIT OR Apache-2.0
//! What flat lights have in common: a plane piece of which every part shines the same.

use dioptric_math::{DVec3, Spectrum, normalize};
use dioptric_scene::{Args, Default, Diagnostic, Param, Type};

use super::shared::{Falloff, cosine_within, samples, strength};
use super::{LightPass, LightPlace, LightSample, LightView};
use crate::build::Builder;
use crate::setting::root::Root;

/// `emits`.
pub(super) const EMITS: Param = Param::new(
    "emits",
    Type::Choice(&["everywhere", "front", "both"]),
    Default::Text("everywhere"),
    "Where it shines: \"everywhere\" the same, as if made of points; \"front\" or \"both\" sides, by the cosine \
     of the angle to its normal, as a panel does.",
);

/// To which sides a panel shines.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Emits {
    Everywhere,
    Front,
    Both,
}

/// A flat light; its parts are picked by two numbers that its kind of light maps onto it.
#[derive(Clone, Debug)]
pub(super) struct Panel {
    /// The point for (0, 0), in the space of rays.
    origin: DVec3,
    /// How the point moves with each of the two numbers.
    edges: [DVec3; 2],
    /// Unit normal of the front.
    normal: DVec3,
    emits: Emits,
    falloff: Falloff,
    strength: Spectrum,
    pub(super) samples: u32,
}

impl Panel {
    /// A panel from its origin and edges in the file's space, and the shared arguments; nothing where
    /// the edges span no area.
    pub(super) fn from_args(
        args: &Args,
        builder: &Builder,
        root: &Root,
        origin: DVec3,
        edges: [DVec3; 2],
    ) -> Result<Option<Self>, Diagnostic> {
        let edges = edges.map(|e| root.vector(e));
        // Unit edges first, so that neither tiny nor huge panels lose their normal.
        let (Some(u), Some(v)) = (normalize(edges[0]), normalize(edges[1])) else {
            return Ok(None);
        };
        let across = u.cross(v);
        if across.length() < 1e-12 {
            return Ok(None); // an angle, not a length: parallel within rounding
        }
        let side = if root.transform().is_mirror() { -1.0 } else { 1.0 };
        Ok(Some(Self {
            origin: root.point(origin),
            edges,
            normal: normalize(across).unwrap_or(DVec3::Z) * side,
            emits: match &*args.text("emits")? {
                "front" => Emits::Front,
                "both" => Emits::Both,
                _ => Emits::Everywhere,
            },
            falloff: Falloff::from_args(args, root)?,
            strength: strength(args, builder)?,
            samples: samples(args)?,
        }))
    }

    /// Where a ray passes it: `share` is the part's area over that of the parallelogram of the edges, `inside`
    /// says which `p` belong to it.
    pub(super) fn pass(
        &self,
        origin: DVec3,
        direction: DVec3,
        share: f64,
        inside: impl Fn([f64; 2]) -> bool,
    ) -> Option<LightPass> {
        let (way, rate) = (self.origin - origin, direction.dot(self.normal));
        let distance = way.dot(self.normal) / rate;
        if !(distance > 0.0 && distance.is_finite()) {
            return None;
        }
        // p in  p0 e0 + p1 e1 = across, by the reciprocal edges.
        let (across, [u, v]) = (direction * distance - way, self.edges);
        let span = u.cross(v);
        let area2 = span.length_squared();
        let p = [v.cross(span).dot(across) / area2, span.cross(u).dot(across) / area2];
        if !inside(p) {
            return None;
        }
        let density = distance * distance / (share * area2.sqrt() * rate.abs());
        let lit = self.lights(direction, distance)?;
        density.is_finite().then_some(LightPass { distance, arriving: lit, density })
    }

    /// A ball around it: its middle is at `p = (middle, middle)`, and both edges reach `reach` from there.
    fn ball(&self, middle: f64, reach: f64) -> (DVec3, f64) {
        let [u, v] = self.edges;
        // Of an area the corners are the farthest, of a disc the rim, which lies in the same circle.
        let radius = reach * (u + v).length().max((u - v).length());
        (self.origin + (u + v) * middle, radius)
    }

    /// Where it is; the numbers are those of [`Self::ball`].
    pub(super) fn place(&self, middle: f64, reach: f64) -> Option<LightPlace> {
        let (center, radius) = self.ball(middle, reach);
        let intensity = self.strength * self.falloff.at(1.0);
        self.falloff.weakens().then_some(LightPlace { center, radius, intensity })
    }

    /// What can be said of it at a point; the numbers are those of [`Self::ball`].
    pub(super) fn view(&self, point: DVec3, middle: f64, reach: f64) -> Option<LightView> {
        let (center, radius) = self.ball(middle, reach);
        let way = center - point;
        let distance = way.length();
        if !distance.is_finite() {
            return None;
        }
        let direction = normalize(way).unwrap_or(self.normal);
        let sine = (radius / distance).min(1.0);
        let out = -direction.dot(self.normal);
        let share = match self.emits {
            Emits::Everywhere => 1.0,
            Emits::Front => cosine_within(out, sine),
            Emits::Both => cosine_within(out.abs(), sine),
        };
        let arriving = self.strength * (share * self.falloff.at(distance.max(radius)));
        (share > 0.0).then_some(LightView { direction, sine, arriving })
    }

    /// Its corner and edges, if it shines by the cosine, as a surface does.
    pub(super) fn surface(&self) -> Option<(DVec3, [DVec3; 2])> {
        (self.emits != Emits::Everywhere).then_some((self.origin, self.edges))
    }

    /// What arrives from a direction and distance.
    fn lights(&self, direction: DVec3, distance: f64) -> Option<Spectrum> {
        let out = -direction.dot(self.normal);
        let share = match self.emits {
            Emits::Everywhere => 1.0,
            Emits::Front => out.max(0.0),
            Emits::Both => out.abs(),
        };
        let usable = share > 0.0 && distance.is_finite();
        usable.then(|| self.strength * (share * self.falloff.at(distance)))
    }

    /// What arrives from the part at `p`.
    pub(super) fn sample(&self, point: DVec3, p: [f64; 2]) -> Option<LightSample> {
        let way = self.origin + self.edges[0] * p[0] + self.edges[1] * p[1] - point;
        let (direction, distance) = (normalize(way)?, way.length());
        let arriving = self.lights(direction, distance)?;
        Some(LightSample { direction, distance, arriving })
    }
}
