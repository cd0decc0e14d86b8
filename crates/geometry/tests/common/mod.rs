// SPDX-License-Identifier: MIT OR Apache-2.0
//! One specimen or more of every registered shape, in nasty proportions, each with a slow and plain
//! description of the same surface to compare with.
//!
//! All numbers are short binary fractions and all scales powers of two, so that scaled and moved
//! specimens are exactly the same shape: what the batteries measure is the shapes' own rounding.

#![allow(dead_code)] // Every test file uses its own part of this one.

pub mod flat;
pub mod specimens;

use dioptric_geometry::shapes::SCHEMAS;
use dioptric_geometry::{AnyShape, LocalRay, LocalSurface, Root};
use dioptric_math::DVec3;
use dioptric_math::random::Random;
use dioptric_scene::args::make_node;
use dioptric_scene::{Args, Description, Diagnostic, Value};

/// About 1e6.
pub const MILLION: f64 = 1_048_576.0;

/// The reciprocal of that.
pub const TINY: f64 = 1.0 / MILLION;

/// Where a specimen stands: `p` of its own space is `(p + offset) scale` here.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    pub scale: f64,
    pub offset: DVec3,
}

impl Place {
    pub fn point(&self, p: DVec3) -> DVec3 {
        (p + self.offset) * self.scale
    }

    pub fn back(&self, p: DVec3) -> DVec3 {
        p / self.scale - self.offset
    }
}

/// A shape and what is known about it from elsewhere.
pub struct Specimen {
    pub name: &'static str,
    pub place: Place,
    pub shape: AnyShape,
    /// The largest and the smallest thing about it, in its own space.
    pub size: f64,
    pub feature: f64,
    /// A point inside.
    pub inside: Option<DVec3>,
    /// Points on edges, rims and seams, and others that are hard to hit by chance, in its own space.
    pub rims: Vec<DVec3>,
    /// Signed distance (above the surface: positive) in its own space, exact near the surface.
    pub plain: Box<dyn Fn(DVec3) -> f64>,
}

impl Specimen {
    /// Signed distance from the surface.
    pub fn distance(&self, p: DVec3) -> f64 {
        (self.plain)(self.place.back(p)) * self.place.scale
    }

    /// Slope of the distance, over steps of `h`: the normal, and shorter or longer at edges.
    pub fn gradient(&self, p: DVec3, h: f64) -> DVec3 {
        let slope = |d: DVec3| (self.distance(p + d * h) - self.distance(p - d * h)) / (2.0 * h);
        DVec3::new(slope(DVec3::X), slope(DVec3::Y), slope(DVec3::Z))
    }

    /// Whether there is an edge within about `h`.
    pub fn at_edge(&self, p: DVec3, h: f64) -> bool {
        (self.gradient(p, h).length() - 1.0).abs() > 1e-3
    }

    /// What the plain description itself gets wrong.
    pub fn slack(&self) -> f64 {
        f64::EPSILON * 8.0 * self.size * self.place.scale
    }

    /// Rounding of coordinates near the shape.
    pub fn rounding(&self) -> f64 {
        f64::EPSILON * (self.place.offset.length() + self.size) * self.place.scale
    }

    /// A point somewhere around the shape, near it in all directions.
    pub fn target(&self, r: &mut Random) -> DVec3 {
        if !self.rims.is_empty() && r.bits().is_multiple_of(4) {
            return self.place.point(self.rims[(r.bits() % self.rims.len() as u64) as usize]);
        }
        let b = self.shape.bounds();
        let half = DVec3::splat(self.size);
        let (low, high) = (b.min.max(self.place.point(-half)), b.max.min(self.place.point(half)));
        low + (high - low) * DVec3::new(r.unit(), r.unit(), r.unit())
    }

    /// A ray from outside towards the shape; its direction is of any length.
    pub fn ray(&self, r: &mut Random) -> LocalRay {
        let target = self.target(r);
        // One in eight comes from far away.
        let far = if r.bits().is_multiple_of(8) { 1e5 } else { 1.0 };
        let reach = self.size * self.place.scale * r.uniform(1.0, 4.0) * far;
        let origin = target + direction(r) * reach;
        let length = r.uniform(0.5, 2.0);
        ray(origin, (target - origin) * (length / reach))
    }
}

/// A ray without error that leaves nothing.
pub fn ray(origin: DVec3, direction: DVec3) -> LocalRay {
    LocalRay { origin, direction, error: 0.0, t_max: f64::INFINITY, leaving: None }
}

/// A random unit vector; one in eight lies along an axis or in a coordinate plane.
pub fn direction(r: &mut Random) -> DVec3 {
    loop {
        let mut v = DVec3::new(r.uniform(-1.0, 1.0), r.uniform(-1.0, 1.0), r.uniform(-1.0, 1.0));
        let l2 = v.length_squared();
        if !(0.01..=1.0).contains(&l2) {
            continue;
        }
        let choice = r.bits() % 24;
        if choice < 3 {
            v[choice as usize] = 0.0;
            if choice == 0 {
                v[1] = 0.0;
            }
        }
        if v != DVec3::ZERO {
            return v / v.length();
        }
    }
}

/// Named arguments.
pub type Arguments<'a> = &'a [(&'a str, Value)];

/// Builds a shape as a scene file would.
pub fn build(kind: &str, args: Arguments) -> Result<AnyShape, Diagnostic> {
    build_of(&[], kind, |_| args.to_vec())
}

/// Builds a shape that is made of other ones: `args` gets their nodes.
pub fn build_of<'a>(
    parts: &[(&str, Arguments)],
    kind: &str,
    args: impl Fn(&[Value]) -> Vec<(&'a str, Value)>,
) -> Result<AnyShape, Diagnostic> {
    let mut description = Description::default();
    let mut push = |kind: &str, args: Arguments| {
        let schema = SCHEMAS.iter().find(|s| s.kind == kind).unwrap_or_else(|| panic!("no {kind}"));
        let node =
            make_node(schema, args).unwrap_or_else(|| panic!("{kind} takes other arguments"));
        description.push(node)
    };
    let nodes: Vec<Value> = parts.iter().map(|(k, a)| Value::Node(push(k, a))).collect();
    let id = push(kind, &args(&nodes));
    AnyShape::from_args(&Args::new(&description, id)).map(|s| s.unwrap())
}

/// Arguments for a shape at a place.
#[derive(Clone, Copy)]
pub struct At(pub Place);

impl At {
    pub fn point(self, p: DVec3) -> Value {
        Value::Vec3(self.0.point(p).into())
    }

    pub fn vector(self, v: DVec3) -> Value {
        Value::Vec3((v * self.0.scale).into())
    }

    pub fn length(self, x: f64) -> Value {
        Value::Number(x * self.0.scale)
    }

    pub fn points(self, points: &[DVec3]) -> Value {
        Value::List(points.iter().map(|&p| self.point(p)).collect())
    }

    pub fn make(
        self,
        (name, kind): (&'static str, &str),
        args: &[(&str, Value)],
        (size, feature): (f64, f64),
        inside: Option<DVec3>,
        rims: Vec<DVec3>,
        plain: impl Fn(DVec3) -> f64 + 'static,
    ) -> Specimen {
        let shape = build(kind, args).unwrap_or_else(|e| panic!("{name}: {}", e.message));
        let plain = Box::new(plain);
        Specimen { name, place: self.0, shape, size, feature, inside, rims, plain }
    }
}

/// Any length will do.
pub fn direction_value(v: DVec3) -> Value {
    Value::Vec3(v.into())
}

pub fn v3(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

/// Places of three sizes, at the origin and far away from it.
pub fn places(far: usize, seed: u64) -> Vec<Place> {
    let mut r = Random::new(seed);
    let mut places = Vec::new();
    for scale in [1.0 / MILLION, 1.0, MILLION] {
        places.push(Place { scale, offset: DVec3::ZERO });
        for _ in 0..far {
            places.push(Place { scale, offset: (direction(&mut r) * 1e5).round() });
        }
    }
    places
}

/// Every specimen at every place, `far` places far away for each size.
pub fn every(far: usize, mut test: impl FnMut(&Specimen, &mut Random)) {
    for (i, place) in places(far, 1).into_iter().enumerate() {
        let mut r = Random::new(100 + i as u64);
        for specimen in specimens::specimens(place) {
            test(&specimen, &mut r);
        }
    }
}

/// The nearest hit and its surface.
pub fn hit(s: &Specimen, ray: &LocalRay) -> Option<(Root, LocalSurface)> {
    let root = s.shape.intersect(ray)?;
    assert!(root.t >= 0.0 && root.t <= ray.t_max, "{}: t = {}", s.name, root.t);
    Some((root, s.shape.surface(ray.at(root.t), root.part)))
}
