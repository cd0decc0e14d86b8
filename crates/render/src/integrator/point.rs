// SPDX-License-Identifier: MIT OR Apache-2.0
//! A point being shaded, and the rays that leave it.

use dioptric_geometry::world::{Hit, Query};
use dioptric_geometry::{Contacts, Departure, HitId, Ray, SurfacePoint};
use dioptric_math::DVec3;
use dioptric_math::bounds::gamma;

use super::optics::{facing, reflect, refract};
use crate::film::FirstHit;
use crate::scene::{Answer, Scene, Shading};

/// A ray that leaves a surface.
#[derive(Clone, Copy)]
pub(super) struct Leg {
    pub ray: Ray,
    pub departure: Departure,
    /// What becomes of other surfaces at the same place.
    pub contacts: Contacts,
}

impl Leg {
    /// The question what is within a distance.
    pub fn query(&self, t_max: f64) -> Query {
        Query::new(self.ray, t_max, Some(self.departure), self.contacts)
    }
}

/// A point being shaded, with the incoming ray.
pub(super) struct Point<'a> {
    pub ray: Ray,
    pub hit: Hit,
    pub surface: SurfacePoint,
    pub finish: Answer<'a>,
    /// The shading normal, facing the incoming ray, on the side of [`Self::geometric`].
    pub normal: DVec3,
    /// Whether the ray comes from the side of the geometric normal: from outside of a solid.
    pub outside: bool,
    /// The object that the incoming ray crossed last, if that was at this very place.
    pub arrived: Option<HitId>,
}

impl<'a> Point<'a> {
    /// The point where a ray that left `departure` hit something.
    #[inline(always)]
    pub fn new(ray: &Ray, hit: Hit, shading: Shading<'a>, departure: Option<&Departure>) -> Self {
        let Shading { surface, finish } = shading;
        let outside = ray.direction.dot(surface.normal) <= 0.0;
        let arrived = departure.filter(|_| touches(ray, &hit, &surface)).map(|d| d.from);
        let normal = facing(ray.direction, surface.normal, surface.shading_normal);
        Self { ray: *ray, hit, surface, finish, normal, outside, arrived }
    }

    /// Whether the object has an inside.
    pub fn is_solid(&self, scene: &Scene) -> bool {
        scene.world.shape(self.hit.id.object).is_some_and(|s| s.is_solid())
    }

    /// What layers and adaptive sampling keep of a camera ray's hit.
    pub fn first_hit(&self, scene: &Scene) -> FirstHit {
        FirstHit {
            object: scene.layer_id(self.hit.id),
            depth: self.hit.t,
            normal: self.normal,
            albedo: self.finish.base,
        }
    }

    /// A ray that goes back to the side from which the incoming one came.
    pub fn back(&self, direction: DVec3) -> Leg {
        self.spawn(direction, false)
    }

    /// A ray that goes on through the surface.
    pub fn on(&self, direction: DVec3) -> Leg {
        self.spawn(direction, true)
    }

    /// A ray to a light in front of the surface, but for its direction and length.
    pub fn to_light(&self) -> Query {
        let Ray { time, .. } = self.ray;
        let SurfacePoint { point: origin, error, .. } = self.surface;
        let ray = Ray { origin, direction: DVec3::ZERO, time, error };
        let departure = Departure { from: self.hit.id, outward: self.outside };
        let contacts = Contacts { crossed: false, except: self.arrived };
        Query::new(ray, 0.0, Some(departure), contacts)
    }

    fn spawn(&self, direction: DVec3, crossed: bool) -> Leg {
        let contacts = Contacts { crossed, except: self.arrived };
        Leg { contacts, ..leave(&self.ray, self.hit.id, &self.surface, direction) }
    }

    /// The geometric normal, facing the incoming ray.
    #[inline(always)]
    pub fn geometric(&self) -> DVec3 {
        if self.outside { self.surface.normal } else { -self.surface.normal }
    }

    /// The incoming direction mirrored at a facet, on this side of the true surface.
    pub fn mirrored(&self, facet: DVec3) -> DVec3 {
        mirrored(self.ray.direction, facet, self.geometric())
    }

    /// The incoming direction refracted at a facet, on the other side of the true surface; `None` where
    /// all is reflected.
    pub fn refracted(&self, facet: DVec3, eta: f64) -> Option<DVec3> {
        refracted(self.ray.direction, facet, self.geometric(), eta)
    }
}

/// A ray that leaves a surface and crosses all that touches it.
pub(super) fn leave(incoming: &Ray, from: HitId, s: &SurfacePoint, direction: DVec3) -> Leg {
    Leg {
        ray: Ray { origin: s.point, direction, time: incoming.time, error: s.error },
        departure: Departure { from, outward: direction.dot(s.normal) > 0.0 },
        contacts: Contacts::CROSSED,
    }
}

/// Mirrored at `n`; at the true normal where `n`, bent by bumps, by vertex normals or by roughness, would
/// send it below the surface.
pub(super) fn mirrored(direction: DVec3, n: DVec3, geometric: DVec3) -> DVec3 {
    let r = reflect(direction, n);
    if r.dot(geometric) > 0.0 { r } else { reflect(direction, geometric) }
}

/// Refracted at `n`; at the true normal where `n` would leave it above the surface.
pub(super) fn refracted(direction: DVec3, n: DVec3, geometric: DVec3, eta: f64) -> Option<DVec3> {
    let below = |t: &DVec3| t.dot(geometric) < 0.0;
    let t = refract(direction, n, eta)?;
    if below(&t) { Some(t) } else { refract(direction, geometric, eta).filter(below) }
}

/// Whether a hit is where its ray begins, within the error bounds.
#[inline(always)]
pub(super) fn touches(ray: &Ray, hit: &Hit, s: &SurfacePoint) -> bool {
    touches_at(ray, hit.t, s.normal, s.error)
}

/// The same of a hit at `t`, on a surface with this normal and bound on the error of the point.
#[inline(always)]
pub(super) fn touches_at(ray: &Ray, t: f64, normal: DVec3, error: f64) -> bool {
    t * ray.direction.dot(normal).abs() <= error + ray.error
}

/// Whether two hits of one ray are the same point within their error bounds, the rounding of `t` included.
pub(super) fn coincide(ray: &Ray, a: (&Hit, &Shading), b: (&Hit, &Shading)) -> bool {
    let (sa, sb) = (&a.1.surface, &b.1.surface);
    let apart = (b.0.t - a.0.t).abs() * ray.direction.dot(sb.normal).abs();
    let rounding = gamma(16) * (a.0.t.max(b.0.t) + ray.origin.abs().max_element());
    apart <= sa.error + sb.error + ray.error + rounding
}
