// SPDX-License-Identifier: MIT OR Apache-2.0
//! Surfaces that a few numbers describe, rectangles and balls, so that points on many of them can be found side by side,
//! in loops without branches.

use dioptric_math::DVec3;

/// A rectangle or a ball.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plain {
    /// The corner of a rectangle, the centre of a ball.
    pub base: DVec3,
    /// The edges of a rectangle.
    pub edges: [DVec3; 2],
    /// Their duals in its plane: `duals[i] . edges[j]` is 1 where i = j, else 0.
    pub duals: [DVec3; 2],
    /// Of a rectangle.
    pub normal: DVec3,
    /// Of a ball; 0 of a rectangle.
    pub radius: f64,
    /// A bound on the distance of computed points from the exact surface.
    pub error: f64,
}

impl Plain {
    /// A point of a surface near `reached`, and the normal there, to the bits that
    /// [`crate::Shape::surface_point`] gives; whether it fits: from some points the way to a ball's middle is too short
    /// or too long to be told so.
    #[inline(always)]
    #[must_use]
    pub fn nearest(&self, reached: DVec3) -> (DVec3, DVec3, bool) {
        let Self { base, edges, duals, normal, radius, .. } = *self;
        let offset = reached - base;
        let unit = |x: f64| x.clamp(0.0, 1.0);
        let (u, v) = (unit(offset.dot(duals[0])), unit(offset.dot(duals[1])));
        let flat = base + (edges[0] * u + edges[1] * v);
        let length2 = offset.length_squared();
        let away = offset / length2.sqrt();
        let round = base + away * radius;
        let ball = radius > 0.0;
        let pick = |a: f64, b: f64| if ball { a } else { b };
        let pick = |a: DVec3, b: DVec3| DVec3::new(pick(a.x, b.x), pick(a.y, b.y), pick(a.z, b.z));
        let fits = !ball | ((1e-200..=1e200).contains(&length2));
        (pick(round, flat), pick(away, normal), fits)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Shape;
    use crate::shapes::{rectangle::Rectangle, sphere::Sphere};
    use dioptric_math::random::Random;

    #[test]
    fn points_are_those_of_the_shapes() {
        let mut random = Random::new(3);
        let mut vector = |size: f64| DVec3::from([0; 3].map(|_| random.uniform(-size, size)));
        for _ in 0..2000 {
            let (corner, u, v) = (vector(5.0), vector(2.0), vector(2.0));
            let Some(rectangle) = Rectangle::new(corner, u, v) else { continue };
            let ball = Sphere::new(corner, u.length());
            let near = corner + u * vector(1.5).x + v * vector(1.5).x + vector(1e-6);
            for (plain, own) in [
                (rectangle.plain(), rectangle.surface_point(near, 0)),
                (ball.plain(), ball.surface_point(near, 0)),
            ] {
                let (point, normal, fits) = plain.nearest(near);
                assert!(fits && plain.error == own.error);
                assert_eq!((point, normal), (own.point, own.normal));
            }
        }
        let ball = Sphere::new(DVec3::ZERO, 1.0).plain();
        assert!(!ball.nearest(DVec3::ZERO).2 && !ball.nearest(DVec3::splat(1e150)).2);
    }
}
