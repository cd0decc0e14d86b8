// SPDX-License-Identifier: MIT OR Apache-2.0
//! Constructive solid geometry: the union, intersection and difference of solids as one shape.

mod build;
mod tree;

use dioptric_math::DVec3;
use dioptric_math::bounds::gamma;
use dioptric_scene::{Args, Category, Diagnostic, NodeId, Param, Schema, Type};

use super::AnyShape;
use crate::bounds::Bounds;
use crate::ray::{Leaving, LocalRay};
use crate::shape::{Crossing, Described, LocalSurface, Root, Shape};
use crate::transform::Transform;
use tree::{Gate, Output, Passage, passages};

pub use build::{Content, CsgError, Operand, Operation};

/// Bits of a part's number that belong to the leaf's own part.
const PART_BITS: u32 = 8;
const PART_MASK: u32 = (1 << PART_BITS) - 1;

const SHAPES: &Type = &Type::List(&Type::Node(Category::Shape));

static UNION_SCHEMA: Schema = Schema {
    kind: "union",
    category: Category::Shape,
    summary: "what is in any of several solids",
    doc: "One solid without inner walls: glass spheres in a union are one piece of glass. The parts are closed shapes,\n\
          groups of them, or other unions, intersections and differences, each with its own transform and\n\
          material. Where faces of two parts coincide, the one that stands first in the list is seen.\n\n\
          `uv`: of the part that is seen.",
    params: &[Param::required("shapes", *SHAPES, "The parts.")],
    example: "union([sphere(center = (-0.5, 1, 0)), sphere(center = (0.5, 1, 0))], material = glass())",
};

static INTERSECTION_SCHEMA: Schema = Schema {
    kind: "intersection",
    category: Category::Shape,
    summary: "what is in all of several solids",
    doc: "The space that all parts have in common: two spheres make a lens. Parts, materials and uv as in `union`.",
    params: &[Param::required("shapes", *SHAPES, "The parts.")],
    example: "intersection([sphere(center = (0, 1, -0.8)), sphere(center = (0, 1, 0.8))], material = glass())",
};

static DIFFERENCE_SCHEMA: Schema = Schema {
    kind: "difference",
    category: Category::Shape,
    summary: "a solid without what is in others",
    doc: "The first solid with the others cut out. The cut shows the material and uv of what cut it; a part without a\n\
          material has the difference's. Parts as in `union`.",
    params: &[
        Param::required("shape", Type::Node(Category::Shape), "The solid that is cut."),
        Param::required("minus", *SHAPES, "What is cut out of it."),
    ],
    example: "difference(box(min = (-1, 0, -1), max = (1, 2, 1)), sphere(center = (0, 1, 0), radius = 1.3), material = matte(\"gold\"))",
};

const KINDS: [&Schema; 3] = [&UNION_SCHEMA, &INTERSECTION_SCHEMA, &DIFFERENCE_SCHEMA];

/// `union(...)`.
pub type Union = Csg<0>;
/// `intersection(...)`.
pub type Intersection = Csg<1>;
/// `difference(...)`.
pub type Difference = Csg<2>;

/// A combination of solids; `KIND` is which of the three words made it.
#[derive(Clone, Debug)]
pub struct Csg<const KIND: usize> {
    leaves: Vec<Leaf>,
    /// The first one gives the answer.
    gates: Vec<Gate>,
    bounds: Bounds,
    convex: bool,
}

/// A solid in its place.
#[derive(Clone, Debug)]
struct Leaf {
    shape: AnyShape,
    transform: Option<Transform>,
    bounds: Bounds,
    /// The largest coordinate of the bounds.
    extent: f64,
    output: Output,
    /// Whether its inside is the outside of the whole: an odd number of subtractions.
    subtracted: bool,
    /// The node that made it, then those around it, up to the one that made the whole.
    path: Vec<NodeId>,
}

impl Leaf {
    fn to_local(&self, ray: &LocalRay) -> LocalRay {
        let (origin, error, direction) = match &self.transform {
            None => (ray.origin, 0.0, ray.direction),
            Some(t) => {
                let (origin, error) = t.point_to_local(ray.origin, 0.0);
                (origin, error, t.direction_to_local(ray.direction))
            }
        };
        LocalRay { origin, direction, error, t_max: f64::INFINITY, leaving: None }
    }

    fn surface(&self, point: DVec3, part: u32) -> LocalSurface {
        let mut s = match &self.transform {
            None => self.shape.surface(point, part),
            Some(t) => {
                t.surface_to_world(&self.shape.surface(t.point_to_local(point, 0.0).0, part))
            }
        };
        if self.subtracted {
            s.normal = -s.normal;
            s.shading_normal = -s.shading_normal;
        }
        s
    }

    /// At a crossing of this leaf: a bound on how far the computed point lies off the surface, and
    /// `|direction . normal|`. The ray's own error counts where it is given.
    fn error_and_speed(&self, ray: &LocalRay, t: f64, part: u32, ray_error: f64) -> (f64, f64) {
        let local = self.to_local(ray);
        let s = self.shape.surface(local.at(t), part);
        let shrink = self.transform.as_ref().map_or(1.0, |t| t.norms().1);
        let rounding = gamma(32) * local.origin.abs().max(s.point.abs()).max_element();
        // Both are distances across the surface in the leaf's space, where `t` is the same.
        (ray_error * shrink + local.error + s.error + rounding, local.direction.dot(s.normal).abs())
    }

    /// Whether a ray starts on this part, within an error in the leaf's space.
    fn starts_at(&self, ray: &LocalRay, part: u32, error: f64) -> bool {
        let local = self.to_local(ray);
        let nearest = self.shape.surface(local.origin, part).point;
        LocalRay { error, ..local }.starts_at(nearest, 0.0)
    }
}

impl<const KIND: usize> Csg<KIND> {
    /// The nodes of the solids in it, in the order of their numbers: leaf `part >> 8` is the one that
    /// was hit. Nodes that appear twice are two leaves.
    pub fn leaf_nodes(&self) -> impl Iterator<Item = Option<NodeId>> + '_ {
        self.leaves.iter().map(|leaf| leaf.path.first().copied())
    }

    /// The node of the leaf that a part belongs to, then the nodes around it, innermost first; the last
    /// one is the node of the whole. Empty for combinations that were not made from a description.
    #[must_use]
    pub fn path(&self, part: u32) -> &[NodeId] {
        self.leaves.get((part >> PART_BITS) as usize).map_or(&[], |leaf| &leaf.path)
    }

    fn walk(&self, ray: &LocalRay, found: impl FnMut(Passage) -> bool) {
        let left = ray.leaving.map(|l| {
            (l.part >> PART_BITS, Leaving { part: l.part & PART_MASK, outward: l.outward })
        });
        passages(&self.leaves, &self.gates, ray, left, found);
    }
}

fn part_of(p: &Passage) -> u32 {
    p.leaf << PART_BITS | (p.part & PART_MASK)
}

impl<const KIND: usize> Described for Csg<KIND> {
    const SCHEMA: &'static Schema = KINDS[KIND];

    fn from_args(args: &Args) -> Result<Self, Diagnostic> {
        let operand = build::read(args)?;
        Self::new(operand).map_err(|e| args.error_here("wrong-value", e.to_string()).help(e.help()))
    }
}

impl<const KIND: usize> Shape for Csg<KIND> {
    fn bounds(&self) -> Bounds {
        self.bounds
    }

    fn is_solid(&self) -> bool {
        true
    }

    fn is_convex(&self) -> bool {
        self.convex
    }

    fn intersect(&self, ray: &LocalRay) -> Option<Root> {
        if self.convex && ray.leaving.is_some_and(|l| l.outward) {
            return None;
        }
        let mut root = None;
        self.walk(ray, |p| {
            let t = if p.t > 0.0 {
                (p.t <= ray.t_max).then_some(p.t)
            } else if ray.leaving.is_some() {
                // At the point that is left, or behind it.
                None
            } else {
                self.leaves.get(p.leaf as usize).and_then(|leaf| {
                    let (error, speed) = leaf.error_and_speed(ray, p.t, p.part, ray.error);
                    let t = LocalRay { error: 0.0, ..*ray }.accept(p.t, speed, error);
                    t.filter(|_| leaf.starts_at(ray, p.part, error))
                })
            };
            root = t.map(|t| Root { t, part: part_of(&p) });
            // Go on past what lies behind.
            root.is_none() && p.t <= 0.0
        });
        root
    }

    fn crossings(&self, ray: &LocalRay, out: &mut Vec<Crossing>) {
        self.walk(&LocalRay { leaving: None, ..*ray }, |p| {
            out.push(Crossing { t: p.t, part: part_of(&p), enters: p.enters });
            true
        });
    }

    fn surface(&self, point: DVec3, part: u32) -> LocalSurface {
        match self.leaves.get((part >> PART_BITS) as usize) {
            Some(leaf) => leaf.surface(point, part & PART_MASK),
            None => LocalSurface {
                point,
                error: 0.0,
                normal: DVec3::Y,
                shading_normal: DVec3::Y,
                uv: dioptric_math::DVec2::ZERO,
                dpdu: DVec3::X,
                dpdv: DVec3::Z,
            },
        }
    }
}

impl AnyShape {
    /// For a combination of solids: see [`Csg::path`]. Empty for all other shapes.
    #[must_use]
    pub fn csg_path(&self, part: u32) -> &[NodeId] {
        match self {
            Self::Union(s) => s.path(part),
            Self::Intersection(s) => s.path(part),
            Self::Difference(s) => s.path(part),
            _ => &[],
        }
    }

    /// For a combination of solids: the nodes of its leaves, see [`Csg::leaf_nodes`]. Empty for all
    /// other shapes.
    #[must_use]
    pub fn csg_leaf_nodes(&self) -> Vec<NodeId> {
        match self {
            Self::Union(s) => s.leaf_nodes().flatten().collect(),
            Self::Intersection(s) => s.leaf_nodes().flatten().collect(),
            Self::Difference(s) => s.leaf_nodes().flatten().collect(),
            _ => Vec::new(),
        }
    }
}
