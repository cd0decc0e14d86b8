// SPDX-License-Identifier: MIT OR Apache-2.0
//! The cone and the cut cone: a frustum with two different radii.

use dioptric_math::DVec3;
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::frustum::{Frustum, ends, no_length, uv_doc};
use crate::bounds::Bounds;
use crate::ray::LocalRay;
use crate::shape::{Crossing, Described, LocalSurface, Root, Shape, SurfacePoint};

/// A cone or cut cone with any axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone(Frustum);

static SCHEMA: Schema = Schema {
    kind: "cone",
    category: Category::Shape,
    summary: "a cone, or a cone with its top cut off",
    doc: concat!(
        "A cone from the disc around `base` to its apex, or, with a `top_radius` above 0, to a second disc. Give either \
         `height` (then it stands along +y) or `top`, the apex or the middle of the second disc. `top_radius` may be \
         larger than `radius`, and one of the two may be 0. `open = True` leaves the discs away: a surface without \
         thickness, hit from outside and inside, that is not solid.\n\n",
        uv_doc!(),
        "\n\nParts: side, disc at the base, disc at the top. The quadric is that of Glassner (ed.), \"An Introduction to \
         Ray Tracing\", 1989, chapter 2, scaled by the slope's cosine and clipped to the slab between the discs; its \
         mirror image beyond the apex is no part of the cone."
    ),
    params: &[
        Param::new("base", Type::Vec3, Default::Vec3([0.0; 3]), "The middle of the lower disc."),
        Param::new("radius", Type::NON_NEGATIVE, Default::Number(1.0), "Radius at the base."),
        Param::new(
            "height",
            Type::Positive,
            Default::Absent,
            "Length along +y; 1 where `top` is not given either.",
        ),
        Param::new(
            "top",
            Type::Vec3,
            Default::Absent,
            "The apex, or the middle of the upper disc, instead of `height`.",
        ),
        Param::new("top_radius", Type::NON_NEGATIVE, Default::Number(0.0), "Radius at the top."),
        Param::new("open", Type::Bool, Default::Bool(false), "Whether to leave the discs away."),
    ],
    example: "cone(base = (-1, 0, 0), radius = 0.8, height = 2, material = matte(\"tomato\"))\n\
              cone(base = (1, 0, 0), radius = 0.8, height = 1.2, top_radius = 0.4, material = matte(\"gold\"))",
};

impl Cone {
    /// A cone from `base` to `base + length`; `None` where that is the same point or both radii are 0.
    #[must_use]
    pub fn new(
        base: DVec3,
        length: DVec3,
        radius: f64,
        top_radius: f64,
        open: bool,
    ) -> Option<Self> {
        if !(radius.max(top_radius) > 0.0) {
            return None;
        }
        Frustum::new(base, length, radius, top_radius, open).map(Self)
    }
}

impl Cone {
    /// What it is.
    pub(crate) const fn frustum(&self) -> &Frustum {
        &self.0
    }

    /// See [`Frustum::tube`].
    pub(crate) fn tube(&self) -> (DVec3, DVec3, f64, f64) {
        self.0.tube()
    }
}

impl Cone {
    /// The middles of both ends, the radii there, and whether it has no discs.
    #[must_use]
    pub fn ends(&self) -> ([DVec3; 2], [f64; 2], bool) {
        self.0.ends()
    }
}

impl Described for Cone {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args) -> Result<Self, Diagnostic> {
        let (base, length) = ends(args)?;
        let (radius, top_radius) = (args.number("radius")?, args.number("top_radius")?);
        if radius == 0.0 && top_radius == 0.0 {
            return Err(args
                .error("radius", "no-size", "radius and top_radius of the cone are both 0")
                .help("give one of the two ends a radius above 0"));
        }
        let open = args.bool("open")?;
        Self::new(base, length, radius, top_radius, open).ok_or_else(|| no_length(args))
    }
}

impl Shape for Cone {
    fn bounds(&self) -> Bounds {
        self.0.bounds()
    }

    fn is_solid(&self) -> bool {
        !self.0.is_open()
    }

    fn is_convex(&self) -> bool {
        true
    }

    fn intersect(&self, ray: &LocalRay) -> Option<Root> {
        self.0.intersect(ray)
    }

    fn crossings(&self, ray: &LocalRay, out: &mut Vec<Crossing>) {
        self.0.crossings(ray, out);
    }

    fn surface(&self, point: DVec3, part: u32) -> LocalSurface {
        self.0.surface(point, part)
    }

    fn surface_point(&self, point: DVec3, part: u32) -> SurfacePoint {
        self.0.surface_point(point, part)
    }
}
