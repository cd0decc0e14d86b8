// SPDX-License-Identifier: MIT OR Apache-2.0
//! Points of sixteen surfaces side by side: balls, flat things, the sides of cylinders and cones, and triangles, each kind in
//! loops without branches, to the bits of [`Shape::surface_point`](crate::Shape::surface_point). All other surfaces, and points
//! at which a length is out of range, are left to that.

use dioptric_math::DVec3;
use dioptric_math::bounds::gamma;
use dioptric_math::wide::{Kernel, wide};

use super::rays::{Bundle, Sixteen};
use super::{NO_TRANSFORM, World};
use crate::bvh::packet::rows::{LANES, Mask};
use crate::ray::HitId;
use crate::shapes::AnyShape;
use crate::shapes::frustum::{Frustum, SIDE};

/// A vector of each of sixteen.
type Vectors = [Sixteen; 3];

const ZERO: Vectors = [[0.0; LANES]; 3];

/// Sixteen surfaces, and points on them.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub struct Surfaces {
    /// The lanes of each kind.
    balls: Mask,
    flats: Mask,
    sides: Mask,
    triangles: Mask,
    /// Triangles with vertex normals.
    smooth: Mask,
    /// The middle of a ball, a point of something flat, the base of a side, a triangle's first corner.
    base: Vectors,
    /// The normal of what is flat, the axis of a side.
    axis: Vectors,
    /// The radius of a ball or at a side's base.
    radius: Sixteen,
    /// Of a side: the radius at the top, the height, and cosine and sine of the slope.
    slope: [Sixteen; 4],
    /// A triangle's other corners.
    corners: [Vectors; 2],
    /// Its vertex normals.
    normals: [Vectors; 3],
    /// The points.
    pub point: Vectors,
    /// Bounds on their errors.
    pub error: Sixteen,
    /// The surfaces' normals, and those to shade with.
    pub normal: Vectors,
    /// The normals to shade with.
    pub shading: Vectors,
}

impl Default for Surfaces {
    fn default() -> Self {
        Self::NOTHING
    }
}

impl Surfaces {
    /// None.
    pub const NOTHING: Self = Self {
        balls: 0,
        flats: 0,
        sides: 0,
        triangles: 0,
        smooth: 0,
        base: ZERO,
        axis: ZERO,
        radius: [0.0; LANES],
        slope: [[0.0; LANES]; 4],
        corners: [ZERO; 2],
        normals: [ZERO; 3],
        point: ZERO,
        error: [0.0; LANES],
        normal: ZERO,
        shading: ZERO,
    };

    /// Takes all away.
    #[inline(always)]
    pub const fn clear(&mut self) {
        (self.balls, self.flats, self.sides, self.triangles, self.smooth) = (0, 0, 0, 0, 0);
    }

    /// The points where rays arrive after the distances `t`; returns the lanes in which they are known.
    #[inline]
    pub fn find(&mut self, rays: &Bundle, t: &Sixteen) -> Mask {
        let laid = self.balls | self.flats | self.sides | self.triangles;
        if laid == 0 {
            return 0;
        }
        laid & !wide(Find { of: self, rays, t })
    }

    fn lay_frustum(&mut self, lane: usize, frustum: &Frustum) {
        let (base, axis, radius, slope, error) = frustum.numbers();
        put(&mut self.base, lane, base);
        put(&mut self.axis, lane, axis);
        self.radius[lane] = radius;
        for (column, number) in self.slope.iter_mut().zip(slope) {
            column[lane] = number;
        }
        self.error[lane] = error;
        self.sides |= 1 << lane;
    }
}

impl World {
    /// Puts the surface that was hit into a lane, and returns true, if it is of a kind that can lie there.
    #[inline]
    pub fn lay(&self, id: &HitId, lane: usize, out: &mut Surfaces) -> bool {
        let lane = lane % LANES;
        let Some(object) = self.object(id.object) else { return false };
        if id.instance != HitId::NO_INSTANCE || object.transform != NO_TRANSFORM {
            return false;
        }
        match &object.shape {
            AnyShape::Sphere(ball) => {
                let (center, radius, error) = ball.numbers();
                put(&mut out.base, lane, center);
                (out.radius[lane], out.error[lane]) = (radius, error);
                out.balls |= 1 << lane;
            }
            AnyShape::Polygon(polygon) => {
                let (point, normal, error) = polygon.numbers();
                put(&mut out.base, lane, point);
                put(&mut out.axis, lane, normal);
                out.error[lane] = error;
                out.flats |= 1 << lane;
            }
            AnyShape::Cylinder(cylinder) if id.part == SIDE => {
                out.lay_frustum(lane, cylinder.frustum());
            }
            AnyShape::Cone(cone) if id.part == SIDE => out.lay_frustum(lane, cone.frustum()),
            AnyShape::Triangle(triangle) => {
                let ([a, b, c], normal, normals) = triangle.numbers();
                put(&mut out.base, lane, a);
                put(&mut out.axis, lane, normal);
                put(&mut out.corners[0], lane, b);
                put(&mut out.corners[1], lane, c);
                if let Some(normals) = normals {
                    for (column, normal) in out.normals.iter_mut().zip(normals) {
                        put(column, lane, *normal);
                    }
                    out.smooth |= 1 << lane;
                }
                out.triangles |= 1 << lane;
            }
            _ => return false,
        }
        true
    }
}

impl World {
    /// The normal of a polygon outside of groups that lies as it was described, and a bound on the errors of its points.
    #[inline]
    #[must_use]
    pub fn pane(&self, id: &HitId) -> Option<(DVec3, f64)> {
        let object = self.object(id.object)?;
        match &object.shape {
            AnyShape::Polygon(polygon)
                if id.instance == HitId::NO_INSTANCE && object.transform == NO_TRANSFORM =>
            {
                let (_, normal, error) = polygon.numbers();
                Some((normal, error))
            }
            _ => None,
        }
    }
}

#[inline(always)]
fn put(of: &mut Vectors, lane: usize, value: DVec3) {
    let lane = lane % LANES;
    (of[0][lane], of[1][lane], of[2][lane]) = (value.x, value.y, value.z);
}

/// Finds points; a bit for each that must be found by itself.
struct Find<'a> {
    of: &'a mut Surfaces,
    rays: &'a Bundle,
    t: &'a Sixteen,
}

impl Kernel for Find<'_> {
    type Output = Mask;

    #[inline(always)]
    fn run(self) -> Mask {
        let Self { of, rays, t } = self;
        let Surfaces { balls, flats, sides, triangles, smooth, .. } = *of;
        let (mut at, mut offset) = (ZERO, ZERO);
        for axis in 0..3 {
            let (o, d) = (&rays.origin[axis], &rays.direction[axis]);
            for i in 0..LANES {
                at[axis][i] = o[i] + d[i] * t[i];
                offset[axis][i] = at[axis][i] - of.base[axis][i];
            }
        }
        let mut odd = 0;
        if balls != 0 {
            odd |= of.on_balls(&offset, &chosen(balls)) & balls;
        }
        if flats != 0 {
            of.on_flats(&offset, &chosen(flats));
        }
        if sides != 0 {
            odd |= of.on_sides(&offset, &chosen(sides)) & sides;
        }
        if triangles != 0 {
            odd |= of.on_triangles(&at, &chosen(triangles), &chosen(smooth)) & triangles;
        }
        odd
    }
}

impl Surfaces {
    #[inline(always)]
    fn on_balls(&mut self, offset: &Vectors, own: &[bool; LANES]) -> Mask {
        let (mut normal, mut point) = (*offset, ZERO);
        let odd = normalize(&mut normal);
        for axis in 0..3 {
            for i in 0..LANES {
                point[axis][i] = self.base[axis][i] + normal[axis][i] * self.radius[i];
            }
        }
        self.keep(own, &point, &normal, &normal);
        odd
    }

    #[inline(always)]
    fn on_flats(&mut self, offset: &Vectors, own: &[bool; LANES]) {
        let (mut height, mut point) = ([0.0; LANES], ZERO);
        dot(offset, &self.axis, &mut height);
        for axis in 0..3 {
            let normal = &self.axis[axis];
            for i in 0..LANES {
                let along = offset[axis][i] - normal[i] * height[i];
                point[axis][i] = self.base[axis][i] + along;
            }
        }
        let normal = self.axis;
        self.keep(own, &point, &normal, &normal);
    }

    #[inline(always)]
    fn on_sides(&mut self, offset: &Vectors, own: &[bool; LANES]) -> Mask {
        let [top_radius, height, cos, sin] = self.slope;
        let (mut y, mut length, mut along) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
        let (mut outward, mut point, mut normal) = (ZERO, ZERO, ZERO);
        dot(offset, &self.axis, &mut y);
        for axis in 0..3 {
            for i in 0..LANES {
                outward[axis][i] = offset[axis][i] - self.axis[axis][i] * y[i];
            }
        }
        dot(&outward.clone(), &outward, &mut length);
        for length in &mut length {
            *length = length.sqrt();
        }
        let mut odd = normalize(&mut outward);
        // Next to the axis that is mostly rounding and need not be at right angles to it.
        dot(&outward, &self.axis, &mut along);
        for (outward, axis) in outward.iter_mut().zip(&self.axis) {
            for i in 0..LANES {
                outward[i] -= axis[i] * along[i];
            }
        }
        odd |= normalize(&mut outward);
        // To the nearest point of the side's line, and not beyond its ends.
        let mut rho = [0.0; LANES];
        for i in 0..LANES {
            let radius = self.radius[i];
            let above = cos[i] * length[i] - (cos[i] * radius - sin[i] * y[i]);
            let nearest = y[i] - sin[i] * above;
            let nearest = if nearest < 0.0 { 0.0 } else { nearest };
            y[i] = if nearest > height[i] { height[i] } else { nearest };
            let v = y[i] / height[i];
            rho[i] = radius * (1.0 - v) + top_radius[i] * v;
        }
        for k in 0..3 {
            let (out, axis) = (&outward[k], &self.axis[k]);
            for i in 0..LANES {
                normal[k][i] = out[i] * cos[i] + axis[i] * sin[i];
                point[k][i] = self.base[k][i] + (axis[i] * y[i] + out[i] * rho[i]);
            }
        }
        self.keep(own, &point, &normal, &normal);
        odd
    }

    #[inline(always)]
    fn on_triangles(&mut self, at: &Vectors, own: &[bool; LANES], smooth: &[bool; LANES]) -> Mask {
        let Self { base, axis: normal, corners: [second, third], normals, .. } = &*self;
        let (mut a, mut b, mut c) = (*base, *second, *third);
        let (mut e, mut f) = (*second, *third);
        for axis in 0..3 {
            for i in 0..LANES {
                a[axis][i] -= at[axis][i];
                b[axis][i] -= at[axis][i];
                c[axis][i] -= at[axis][i];
                e[axis][i] -= base[axis][i];
                f[axis][i] -= base[axis][i];
            }
        }
        let mut weights = [[0.0; LANES]; 3];
        for (weight, (p, q)) in weights.iter_mut().zip([(&b, &c), (&c, &a), (&a, &b)]) {
            cross_dot(p, q, normal, weight);
        }
        let mut odd = 0;
        let [u, v, w] = &mut weights;
        for i in 0..LANES {
            let sum = u[i] + v[i] + w[i];
            let part = |x: f64| if x / sum > 0.0 { x / sum } else { 0.0 };
            let (p, q, r) = (part(u[i]), part(v[i]), part(w[i]));
            let sum = p + q + r;
            odd |= Mask::from(!(sum > 0.0)) << i;
            (u[i], v[i], w[i]) = (p / sum, q / sum, r / sum);
        }
        let (mut point, mut shading, mut error) = (ZERO, ZERO, [0.0; LANES]);
        for axis in 0..3 {
            let [first, second, third] = normals;
            for i in 0..LANES {
                let (a, e, f) = (base[axis][i], e[axis][i], f[axis][i]);
                point[axis][i] = a + (e * v[i] + f * w[i]);
                let size = a.abs() + e.abs() + f.abs();
                error[i] = if size > error[i] { size } else { error[i] };
                shading[axis][i] =
                    first[axis][i] * u[i] + second[axis][i] * v[i] + third[axis][i] * w[i];
            }
        }
        let (bent, normal) = (normalize(&mut shading), self.axis);
        for i in 0..LANES {
            odd |= bent & Mask::from(smooth[i]) << i;
            self.error[i] = if own[i] { gamma(8) * error[i] } else { self.error[i] };
        }
        for (shading, flat) in shading.iter_mut().zip(normal) {
            for i in 0..LANES {
                shading[i] = if smooth[i] { shading[i] } else { flat[i] };
            }
        }
        self.keep(own, &point, &normal, &shading);
        odd
    }

    /// Takes over points and normals of some lanes.
    #[inline(always)]
    fn keep(&mut self, own: &[bool; LANES], point: &Vectors, normal: &Vectors, shading: &Vectors) {
        let pairs =
            [(&mut self.point, point), (&mut self.normal, normal), (&mut self.shading, shading)];
        for (to, from) in pairs {
            for (to, from) in to.iter_mut().zip(from) {
                for i in 0..LANES {
                    to[i] = if own[i] { from[i] } else { to[i] };
                }
            }
        }
    }
}

/// The bits one by one.
#[inline(always)]
fn chosen(bits: Mask) -> [bool; LANES] {
    let mut own = [false; LANES];
    for (i, own) in own.iter_mut().enumerate() {
        *own = bits & 1 << i != 0;
    }
    own
}

/// Products of vectors, in the order in which they are taken one by one.
#[inline(always)]
fn dot(a: &Vectors, b: &Vectors, out: &mut Sixteen) {
    for i in 0..LANES {
        out[i] = a[0][i] * b[0][i] + a[1][i] * b[1][i] + a[2][i] * b[2][i];
    }
}

/// `(p x q) . n`.
#[inline(always)]
fn cross_dot(p: &Vectors, q: &Vectors, n: &Vectors, out: &mut Sixteen) {
    for i in 0..LANES {
        let x = p[1][i] * q[2][i] - q[1][i] * p[2][i];
        let y = p[2][i] * q[0][i] - q[2][i] * p[0][i];
        let z = p[0][i] * q[1][i] - q[0][i] * p[1][i];
        out[i] = x * n[0][i] + y * n[1][i] + z * n[2][i];
    }
}

/// Unit vectors; a bit for each whose square is too large or too small for that.
#[inline(always)]
fn normalize(v: &mut Vectors) -> Mask {
    let (mut square, mut length) = ([0.0; LANES], [0.0; LANES]);
    let [x, y, z] = &*v;
    for i in 0..LANES {
        square[i] = x[i] * x[i] + y[i] * y[i] + z[i] * z[i];
        length[i] = square[i].sqrt();
    }
    for v in v.iter_mut() {
        for i in 0..LANES {
            v[i] /= length[i];
        }
    }
    let mut odd = 0;
    for (i, square) in square.iter().enumerate() {
        let fits = (*square >= 1e-200) & (*square <= 1e200);
        odd |= Mask::from(!fits) << i;
    }
    odd
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ray::Ray;
    use crate::shapes::{
        cone::Cone, cylinder::Cylinder, polygon::Polygon, sphere::Sphere, triangle::Triangle,
    };
    use crate::world::{Hit, Query, WorldBuilder};
    use crate::{Contacts, SurfacePoint};
    use dioptric_math::DAffine3;
    use dioptric_math::random::Random;

    /// Points of sixteen surfaces are those of one after the other, to the last bit.
    #[test]
    fn sixteen_points_are_what_one_is() {
        let mut random = Random::new(8);
        let mut vector = |size: f64| DVec3::from([0; 3].map(|_| random.uniform(-size, size)));
        let (mut known, mut hits) = (0, 0);
        let mut builder = WorldBuilder::new();
        let mut add = |shape: AnyShape| assert!(builder.object(shape, DAffine3::IDENTITY).is_ok());
        for i in 0..400 {
            let (a, b, c) = (vector(4.0), vector(1.5), vector(1.5));
            let (p, q, open) = (vector(0.3).x.abs(), vector(0.4).x.abs(), i % 3 == 0);
            let cylinder = || Cylinder::new(a, b, p, open).map(|s| AnyShape::Cylinder(Box::new(s)));
            let cone = || Cone::new(a, b, p, q, open).map(|s| AnyShape::Cone(Box::new(s)));
            let flat = || Triangle::new([a, a + b, a + c]);
            let smooth = || flat().map(|t| t.with_normals([b.cross(c) + b, c.cross(b), a]));
            let triangle = || if open { flat() } else { smooth() };
            let polygon = || Polygon::new([vec![a, a + b, a + b + c, a + c]]).ok();
            let shape = match i % 5 {
                0 => Some(AnyShape::Sphere(Sphere::new(a, p))),
                1 => cylinder(),
                2 => cone(),
                3 => triangle().map(|s| AnyShape::Triangle(Box::new(s))),
                _ => polygon().map(|s| AnyShape::Polygon(Box::new(s))),
            };
            shape.into_iter().for_each(&mut add);
        }
        let world = builder.build();
        let mut surfaces = Surfaces::NOTHING;
        for _ in 0..300 {
            surfaces.clear();
            let (mut rays, mut t, mut found) = (Bundle::EMPTY, [0.0; LANES], [None; LANES]);
            for lane in 0..LANES {
                let ray = Ray::new(vector(6.0), vector(1.0));
                rays.set(lane, &Query::new(ray, 1e9, None, Contacts::CROSSED));
                let hit: Option<Hit> = world.closest(&ray, f64::INFINITY, None);
                let Some(hit) = hit.filter(|hit| world.lay(&hit.id, lane, &mut surfaces)) else {
                    continue;
                };
                (t[lane], found[lane]) = (hit.t, Some((ray, hit)));
            }
            let bits = surfaces.find(&rays, &t);
            for (lane, (ray, hit)) in found.iter().enumerate().filter_map(|(i, f)| Some((i, (*f)?)))
            {
                hits += 1;
                if bits & 1 << lane == 0 {
                    continue;
                }
                known += 1;
                let get = |v: &Vectors| DVec3::new(v[0][lane], v[1][lane], v[2][lane]);
                let new = SurfacePoint {
                    point: get(&surfaces.point),
                    error: surfaces.error[lane],
                    normal: get(&surfaces.normal),
                    shading_normal: get(&surfaces.shading),
                };
                assert_eq!(Some(new), world.surface_point(&ray, &hit));
            }
        }
        assert!(known > 1000 && known == hits, "{known} of {hits}");
    }
}
