// SPDX-License-Identifier: MIT OR Apache-2.0
//! The box along the axes (in a file of another name: `box` is a word of Rust).

use dioptric_math::bounds::gamma;
use dioptric_math::{DVec2, DVec3};
use dioptric_scene::{Args, Category, Default, Diagnostic, Param, Schema, Type};

use super::convex::{Chord, root};
use crate::bounds::Bounds;
use crate::ray::{Leaving, LocalRay};
use crate::shape::{Crossing, Described, LocalSurface, Root, Shape};

/// All points between two corners. Part `2 k` is the face at the smaller coordinate of axis k, part
/// `2 k + 1` the one at the larger.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cuboid {
    min: DVec3,
    max: DVec3,
}

static SCHEMA: Schema = Schema {
    kind: "box",
    category: Category::Shape,
    summary: "a box along the axes",
    doc: "All points between two opposite corners. `transform = rotate(...)` turns it.\n\n\
          `uv`: 0 to 1 on each face, upright as seen from outside: v runs along +y on the four sides, along -z on the \
          top and along +z on the bottom; u runs to the right (+x in front, on the top and on the bottom).\n\n\
          Slabs after Kay and Kajiya, \"Ray Tracing Complex Scenes\", SIGGRAPH 1986; a hit lies exactly on its face.",
    params: &[
        Param::new(
            "min",
            Type::Vec3,
            Default::Vec3([-1.0; 3]),
            "The corner with the smallest coordinates.",
        ),
        Param::new(
            "max",
            Type::Vec3,
            Default::Vec3([1.0; 3]),
            "The corner with the largest coordinates.",
        ),
    ],
    example: "box(min = (-1, 0, -1), max = (1, 2, 1), material = matte(\"tomato\"))",
};

impl Cuboid {
    /// A box; every coordinate of `min` must be below that of `max`.
    #[must_use]
    pub const fn new(min: DVec3, max: DVec3) -> Self {
        Self { min, max }
    }

    /// The corners with the smallest and with the largest coordinates.
    #[must_use]
    pub const fn corners(&self) -> [DVec3; 2] {
        [self.min, self.max]
    }

    fn chord(&self, ray: &LocalRay) -> Chord {
        let mut chord = Chord::LINE;
        for axis in 0..3 {
            let (o, d) = (ray.origin[axis], ray.direction[axis]);
            let inverse = 1.0 / d;
            let part = 2 * axis as u32;
            let (low, high) = ((self.min[axis] - o) * inverse, (self.max[axis] - o) * inverse);
            // The sign of -0 matters: 1 / -0 is -inf. A ray within the plane of a face gives NaN there,
            // which clips nothing: the faces belong to the box.
            let (near, far) = if inverse.is_sign_negative() {
                ((high, part + 1), (low, part))
            } else {
                ((low, part), (high, part + 1))
            };
            if near.0 > chord.near.0 {
                chord.near = near;
            }
            if far.0 < chord.far.0 {
                chord.far = far;
            }
        }
        chord
    }

    /// The exit of a ray that goes inwards from a face.
    fn far_side(&self, ray: &LocalRay, leaving: Leaving) -> Option<Root> {
        let mut far = (f64::INFINITY, 0);
        for axis in 0..3 {
            let d = ray.direction[axis];
            let part = 2 * axis as u32 + u32::from(d > 0.0);
            let face = if d > 0.0 { self.max[axis] } else { self.min[axis] };
            if d != 0.0 && part != leaving.part {
                let t = (face - ray.origin[axis]) / d;
                if t < far.0 {
                    far = (t, part);
                }
            }
        }
        root(ray, far.0, far.1)
    }

    fn error(&self) -> f64 {
        gamma(4) * self.min.abs().max(self.max.abs()).max_element()
    }
}

impl Described for Cuboid {
    const SCHEMA: &'static Schema = &SCHEMA;

    fn from_args(args: &Args) -> Result<Self, Diagnostic> {
        let (min, max) = (args.vec3("min")?, args.vec3("max")?);
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            let (low, high) = (min[axis], max[axis]);
            if low == high {
                return Err(args
                    .error(
                        "max",
                        "flat-box",
                        format!("the box has no extent in {name}: min and max are both {low}"),
                    )
                    .help("for a flat shape use rectangle(corner, edge_u, edge_v)"));
            }
            if !(low < high) {
                return Err(args
                    .error(
                        "max",
                        "inside-out-box",
                        format!("max.{name} = {high} of the box is below min.{name} = {low}"),
                    )
                    .help("write the smaller coordinates in min and the larger ones in max"));
            }
        }
        Ok(Self::new(min.into(), max.into()))
    }
}

impl Shape for Cuboid {
    fn bounds(&self) -> Bounds {
        Bounds { min: self.min, max: self.max }
    }

    fn is_solid(&self) -> bool {
        true
    }

    fn is_convex(&self) -> bool {
        true
    }

    fn intersect(&self, ray: &LocalRay) -> Option<Root> {
        if let Some(leaving) = ray.leaving {
            return if leaving.outward { None } else { self.far_side(ray, leaving) };
        }
        let chord = self.chord(ray);
        if !chord.is_some() || chord.near.0 > ray.t_max {
            return None;
        }
        chord.first(ray, self.error(), |part| {
            let above = (ray.origin - self.max).max(self.min - ray.origin);
            let axis = (part / 2) as usize % 3;
            let own = if part % 2 == 0 {
                self.min[axis] - ray.origin[axis]
            } else {
                ray.origin[axis] - self.max[axis]
            };
            (own, above.max_element())
        })
    }

    fn crossings(&self, ray: &LocalRay, out: &mut Vec<Crossing>) {
        self.chord(ray).push_crossings(ray, out);
    }

    fn surface(&self, point: DVec3, part: u32) -> LocalSurface {
        let mut point = point.clamp(self.min, self.max);
        let axis = (part / 2) as usize % 3;
        let upper = part % 2 == 1;
        point[axis] = if upper { self.max[axis] } else { self.min[axis] };
        let sign = if upper { 1.0 } else { -1.0 };
        // u x v is the outward normal on each face.
        let (u, v) = match axis {
            0 => (DVec3::NEG_Z * sign, DVec3::Y),
            1 => (DVec3::X, DVec3::NEG_Z * sign),
            _ => (DVec3::X * sign, DVec3::Y),
        };
        let size = self.max - self.min;
        let relative = (point - self.min) / size;
        // The coordinate along a direction that points backwards counts from the other end.
        let along = |w: DVec3| {
            let x = relative.dot(w.abs());
            if w.element_sum() < 0.0 { 1.0 - x } else { x }
        };
        let mut normal = DVec3::ZERO;
        normal[axis] = sign;
        LocalSurface {
            point,
            error: 0.0,
            normal,
            shading_normal: normal,
            uv: DVec2::new(along(u), along(v)),
            dpdu: u * size,
            dpdv: v * size,
        }
    }
}
