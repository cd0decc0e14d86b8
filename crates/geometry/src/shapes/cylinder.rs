// SPDX-License-Identifier: MIT OR Apache-2.0
//! The cylinder: a frustum with two equal radii.

use dioptric_math::DVec3;
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::frustum::{Frustum, ends, no_length, uv_doc};
use crate::bounds::Bounds;
use crate::ray::LocalRay;
use crate::shape::{Crossing, Described, LocalSurface, Root, Shape, SurfacePoint};

/// A cylinder with any axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder(Frustum);

static SCHEMA: Schema = Schema {
    kind: "cylinder",
    category: Category::Shape,
    summary: "a round column, closed or open",
    doc: concat!(
        "A round column from `base` to `top`, with a disc at each end. Give either `height` (then it stands along +y) or \
         `top`. `open = True` leaves the discs away: a tube without thickness, hit from outside and inside, that is not \
         solid.\n\n",
        uv_doc!(),
        "\n\nParts: side, disc at the base, disc at the top. The quadric is that of Glassner (ed.), \"An Introduction to \
         Ray Tracing\", 1989, chapter 2, clipped to the slab between the discs."
    ),
    params: &[
        Param::new("base", Type::Vec3, Default::Vec3([0.0; 3]), "The middle of the lower disc."),
        Param::new("radius", Type::Positive, Default::Number(1.0), "Distance from the axis."),
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
            "The middle of the other disc, instead of `height`.",
        ),
        Param::new("open", Type::Bool, Default::Bool(false), "Whether to leave the discs away."),
    ],
    example: "cylinder(base = (0, 0, 0), radius = 0.5, height = 2, material = matte(\"tomato\"))",
};

impl Cylinder {
    /// A cylinder from `base` to `base + length`; `None` where that is the same point.
    #[must_use]
    pub fn new(base: DVec3, length: DVec3, radius: f64, open: bool) -> Option<Self> {
        Frustum::new(base, length, radius, radius, open).map(Self)
    }
}

impl Cylinder {
    /// What it is.
    pub(crate) const fn frustum(&self) -> &Frustum {
        &self.0
    }

    /// See [`Frustum::tube`].
    pub(crate) fn tube(&self) -> (DVec3, DVec3, f64, f64) {
        self.0.tube()
    }
}

impl Cylinder {
    /// The middles of both ends, the radii there, and whether it has no discs.
    #[must_use]
    pub fn ends(&self) -> ([DVec3; 2], [f64; 2], bool) {
        self.0.ends()
    }
}

impl Described for Cylinder {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args) -> Result<Self, Diagnostic> {
        let (base, length) = ends(args)?;
        let radius = args.number("radius")?;
        Self::new(base, length, radius, args.bool("open")?).ok_or_else(|| no_length(args))
    }
}

impl Shape for Cylinder {
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
