// SPDX-License-Identifier: MIT OR Apache-2.0
//! Rays, what they leave, and the form in which a shape sees them.

use dioptric_math::DVec3;

/// A half-line in the space of the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts.
    pub origin: DVec3,
    /// Where it goes; of any length but zero, `t` is in units of it.
    pub direction: DVec3,
    /// When it is cast, in frames or seconds as the scene has it; 0 for still scenes.
    pub time: f64,
    /// A bound on the distance from `origin` to the exact point that is meant: 0 for a camera,
    /// [`crate::shape::LocalSurface::error`] carried to the scene for a ray that leaves a surface.
    pub error: f64,
}

impl Ray {
    /// A ray from an exactly known origin at time 0.
    #[must_use]
    pub const fn new(origin: DVec3, direction: DVec3) -> Self {
        Self { origin, direction, time: 0.0, error: 0.0 }
    }

    /// The point at distance `t`.
    #[inline]
    #[must_use]
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }
}

/// Which surface was hit, cheap to copy and compare.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct HitId {
    /// The instance, or [`HitId::NO_INSTANCE`] for an object at the top.
    pub instance: u32,
    /// The object.
    pub object: u32,
    /// The part of the object: side or cap, face of a box, leaf of a CSG tree, triangle of a mesh.
    pub part: u32,
}

impl HitId {
    /// The `instance` of objects that belong to none.
    pub const NO_INSTANCE: u32 = u32::MAX;

    /// Whether both are on the same object of the same instance.
    #[inline]
    #[must_use]
    pub const fn same_object(&self, other: &Self) -> bool {
        self.instance == other.instance && self.object == other.object
    }
}

/// The point that a ray leaves: found before, on this part of this object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Departure {
    /// The surface that is left.
    pub from: HitId,
    /// Whether the ray goes to the side of the geometric normal (out of a solid).
    pub outward: bool,
}

/// What becomes of other objects' surfaces that touch the very point which a ray leaves: a table under
/// glass, a poster on a wall.
///
/// A ray that goes on through the point crosses them. One that stays on the side from which its point
/// was reached (mirrored, or towards a light) does not. For both it is the other way round with the object
/// that was crossed last on the way to the point, if that was at the same place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Contacts {
    /// Whether they are hit, at `t = 0`.
    pub crossed: bool,
    /// The object for which it is the other way round.
    pub except: Option<HitId>,
}

impl Contacts {
    /// All are hit.
    pub const CROSSED: Self = Self { crossed: true, except: None };

    /// Whether an object that touches the point is hit.
    #[inline]
    #[must_use]
    pub fn crosses(&self, object: &HitId) -> bool {
        self.crossed != self.except.is_some_and(|e| e.same_object(object))
    }
}

/// A [`Departure`] as the left object itself sees it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Leaving {
    /// The part that is left.
    pub part: u32,
    /// Whether the ray goes to the side of the part's normal.
    pub outward: bool,
}

/// A ray in the space of one shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocalRay {
    /// Where it starts.
    pub origin: DVec3,
    /// Where it goes; not a unit vector in general, since `t` is the same as in the scene.
    pub direction: DVec3,
    /// A bound on the error of `origin`, in the shape's units.
    pub error: f64,
    /// The largest `t` of interest.
    pub t_max: f64,
    /// Set where the ray leaves a point of this very shape.
    pub leaving: Option<Leaving>,
}

impl LocalRay {
    /// A ray of the scene that leaves nothing and goes on for ever.
    #[must_use]
    pub const fn whole(ray: &Ray) -> Self {
        let Ray { origin, direction, error, .. } = *ray;
        Self { origin, direction, error, t_max: f64::INFINITY, leaving: None }
    }

    /// The point at distance `t`.
    #[inline]
    #[must_use]
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }

    /// Judges a root `t` of a surface that this ray does not leave: the `t` of the hit, or nothing.
    ///
    /// `speed` is `|direction . n|` with the surface's unit normal at the root, so that `-t * speed`
    /// is how far the origin lies beyond the surface; `surface_error` bounds the error of the root's
    /// own computation as a distance. A surface behind the origin by no more than the two errors is
    /// where the ray starts: it is hit at 0. That is so for planes; where a surface is curved or ends, the
    /// origin must be asked too ([`Self::starts_at`]), for a line that touches or slides along it far
    /// behind has no speed.
    #[inline]
    #[must_use]
    pub fn accept(&self, t: f64, speed: f64, surface_error: f64) -> Option<f64> {
        if t > 0.0 {
            (t <= self.t_max).then_some(t)
        } else {
            (-t * speed <= self.error + surface_error).then_some(0.0)
        }
    }

    /// Whether the ray starts on a surface: `nearest` is the point of it that is nearest to the origin,
    /// `surface_error` the bound on that point's error.
    #[must_use]
    pub fn starts_at(&self, nearest: DVec3, surface_error: f64) -> bool {
        (self.origin - nearest).length() <= self.error + surface_error
    }
}
