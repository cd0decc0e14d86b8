// SPDX-License-Identifier: MIT OR Apache-2.0
//! What flat lights have in common: a plane piece of which every part shines the same.

use dioptric_math::{DVec3, Spectrum, normalize};
use dioptric_scene::{Args, Default, Diagnostic, Param, Type};

use super::LightSample;
use super::shared::{Falloff, samples, strength};
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

    /// What arrives from the part at `p`.
    pub(super) fn sample(&self, point: DVec3, p: [f64; 2]) -> Option<LightSample> {
        let way = self.origin + self.edges[0] * p[0] + self.edges[1] * p[1] - point;
        let (direction, distance) = (normalize(way)?, way.length());
        let out = -direction.dot(self.normal);
        let share = match self.emits {
            Emits::Everywhere => 1.0,
            Emits::Front => out.max(0.0),
            Emits::Both => out.abs(),
        };
        let usable = share > 0.0 && distance.is_finite();
        usable.then(|| LightSample {
            direction,
            distance,
            arriving: self.strength * (share * self.falloff.at(distance)),
        })
    }
}
