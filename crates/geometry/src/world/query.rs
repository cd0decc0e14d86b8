// SPDX-License-Identifier: MIT OR Apache-2.0
//! The queries. All of them are one walk, [`World::visit`], with different things done at the objects.

use super::{Hit, Instance, Level, NO_TRANSFORM, Object, Surface, World};
use crate::bvh::lanes::apart;
use crate::bvh::{Counter, NoCount};
use crate::ray::{Contacts, Departure, HitId, Leaving, LocalRay, Ray};
use crate::shape::{Root, Shape, SurfacePoint};
use crate::shapes::AnyShape;
use crate::transform::Transform;

/// Surfaces further away than this many times the error of a ray's origin are not asked whether they
/// touch it: only a ray that leaves at less than a millionth of a radian could tell.
const CONTACT_REACH: f64 = 1e6;

impl World {
    /// The nearest hit with `0 <= t <= t_max`; of several at the same `t` the one with the lowest id.
    ///
    /// `departure` is the point that the ray leaves, if it leaves one: on that object the point itself
    /// is no hit, while another object's surface within the ray's error bound is hit at `t = 0`. A ray
    /// that is not finite hits nothing.
    #[must_use]
    pub fn closest(&self, ray: &Ray, t_max: f64, departure: Option<&Departure>) -> Option<Hit> {
        self.closest_counted(ray, t_max, departure, &mut NoCount)
    }

    /// [`Self::closest`], counting its tests.
    pub fn closest_counted<C: Counter>(
        &self,
        ray: &Ray,
        t_max: f64,
        departure: Option<&Departure>,
        counter: &mut C,
    ) -> Option<Hit> {
        self.nearest(ray, t_max, departure, Contacts::CROSSED, counter)
    }

    /// [`Self::closest`] for a ray that leaves a surface which others may touch.
    #[must_use]
    pub fn closest_past(
        &self,
        ray: &Ray,
        t_max: f64,
        departure: Option<&Departure>,
        contacts: Contacts,
    ) -> Option<Hit> {
        self.nearest(ray, t_max, departure, contacts, &mut NoCount)
    }

    #[inline]
    fn nearest<C: Counter>(
        &self,
        ray: &Ray,
        t_max: f64,
        departure: Option<&Departure>,
        contacts: Contacts,
        counter: &mut C,
    ) -> Option<Hit> {
        let Some(object) = self.single() else {
            return self.nearest_of_many(ray, t_max, departure, contacts, counter);
        };
        if !is_usable(ray, t_max) {
            return None;
        }
        counter.shapes(1);
        let local = single_ray(object, ray, t_max, departure);
        let root = match &object.shape {
            // What it comes to, and shorter.
            AnyShape::Mesh(mesh) if contacts == Contacts::CROSSED => mesh.intersect(&local)?,
            _ => meet(HitId::NO_INSTANCE, object, &local, contacts)?,
        };
        let id = HitId { instance: HitId::NO_INSTANCE, object: object.id, part: root.part };
        (root.t <= t_max).then_some(Hit { t: root.t, id })
    }

    #[inline(never)]
    fn nearest_of_many<C: Counter>(
        &self,
        ray: &Ray,
        t_max: f64,
        departure: Option<&Departure>,
        contacts: Contacts,
        counter: &mut C,
    ) -> Option<Hit> {
        let mut best: Option<Hit> = None;
        self.visit(ray, t_max, departure, counter, |instance, object, local| {
            Some(improve(&mut best, instance, object, local, t_max, contacts))
        });
        best
    }

    /// Whether anything is hit with `0 <= t < t_max`, strictly: a light's own point does not hide it.
    #[must_use]
    pub fn occluded(&self, ray: &Ray, t_max: f64, departure: Option<&Departure>) -> bool {
        self.occluded_counted(ray, t_max, departure, &mut NoCount)
    }

    /// [`Self::occluded`], counting its tests.
    pub fn occluded_counted<C: Counter>(
        &self,
        ray: &Ray,
        t_max: f64,
        departure: Option<&Departure>,
        counter: &mut C,
    ) -> bool {
        self.blocked(ray, t_max, departure, Contacts::CROSSED, counter)
    }

    /// [`Self::occluded`] for a ray that leaves a surface which others may touch.
    #[must_use]
    pub fn occluded_past(
        &self,
        ray: &Ray,
        t_max: f64,
        departure: Option<&Departure>,
        contacts: Contacts,
    ) -> bool {
        self.blocked(ray, t_max, departure, contacts, &mut NoCount)
    }

    /// Any one of the things that [`Self::occluded_past`] asks for: which one is not specified, but it is the
    /// same for the same world and ray.
    #[must_use]
    pub fn blocker_past(
        &self,
        ray: &Ray,
        t_max: f64,
        departure: Option<&Departure>,
        contacts: Contacts,
    ) -> Option<HitId> {
        self.any(ray, t_max, departure, contacts, &mut NoCount)
    }

    fn blocked<C: Counter>(
        &self,
        ray: &Ray,
        t_max: f64,
        departure: Option<&Departure>,
        contacts: Contacts,
        counter: &mut C,
    ) -> bool {
        if contacts == Contacts::CROSSED
            && let Some(object) = self.single()
            && is_usable(ray, t_max)
        {
            // Whether there is a hit takes less than which one.
            let local = || single_ray(object, ray, t_max, departure);
            match &object.shape {
                AnyShape::Mesh(mesh) => {
                    counter.shapes(1);
                    return mesh.hides(&local());
                }
                AnyShape::Spheres(spheres) => {
                    counter.shapes(1);
                    return spheres.hides(&local());
                }
                _ => {}
            }
        }
        self.any(ray, t_max, departure, contacts, counter).is_some()
    }

    /// The nearest hit of instances alone.
    pub(super) fn nearest_instance(
        &self,
        ray: &Ray,
        t_max: f64,
        departure: Option<&Departure>,
        contacts: Contacts,
    ) -> Option<Hit> {
        let mut best = None;
        let at_top = scene_ray(ray, t_max)?;
        self.visit_instances(&at_top, t_max, departure, &mut NoCount, |instance, object, local| {
            Some(improve(&mut best, instance, object, local, t_max, contacts))
        });
        best
    }

    /// Any hit of instances alone.
    pub(super) fn any_instance(
        &self,
        ray: &Ray,
        t_max: f64,
        departure: Option<&Departure>,
        contacts: Contacts,
    ) -> Option<Hit> {
        let mut found = None;
        let at_top = scene_ray(ray, t_max)?;
        self.visit_instances(&at_top, t_max, departure, &mut NoCount, |instance, object, local| {
            found = blocked_by(instance, object, local, t_max, contacts);
            found.is_none().then_some(local.t_max)
        });
        found
    }

    #[inline]
    fn any<C: Counter>(
        &self,
        ray: &Ray,
        t_max: f64,
        departure: Option<&Departure>,
        contacts: Contacts,
        counter: &mut C,
    ) -> Option<HitId> {
        let Some(object) = self.single() else {
            return self.any_of_many(ray, t_max, departure, contacts, counter);
        };
        if !is_usable(ray, t_max) {
            return None;
        }
        counter.shapes(1);
        let local = single_ray(object, ray, t_max, departure);
        if let AnyShape::Mesh(mesh) = &object.shape
            && contacts == Contacts::CROSSED
        {
            let root = mesh.blocks(&local).filter(|root| root.t < t_max)?;
            let (instance, object) = (HitId::NO_INSTANCE, object.id);
            return Some(HitId { instance, object, part: root.part });
        }
        blocked_by(HitId::NO_INSTANCE, object, &local, t_max, contacts).map(|hit| hit.id)
    }

    #[inline(never)]
    fn any_of_many<C: Counter>(
        &self,
        ray: &Ray,
        t_max: f64,
        departure: Option<&Departure>,
        contacts: Contacts,
        counter: &mut C,
    ) -> Option<HitId> {
        let mut found = None;
        self.visit(ray, t_max, departure, counter, |instance, object, local| {
            found = blocked_by(instance, object, local, t_max, contacts);
            found.is_none().then_some(local.t_max)
        });
        found.map(|hit| hit.id)
    }

    /// The nearest hit of one object alone: the exit of glass belongs to the object that was entered.
    /// `instance` is [`HitId::NO_INSTANCE`] for an object outside of groups.
    #[must_use]
    pub fn closest_of(
        &self,
        ray: &Ray,
        t_max: f64,
        departure: Option<&Departure>,
        instance: u32,
        object: u32,
    ) -> Option<Hit> {
        let at_top = scene_ray(ray, t_max)?;
        let found = self.object(object)?;
        let of_instance = match instance {
            HitId::NO_INSTANCE => None,
            id => self.transform(self.instance(id)?.transform),
        };
        let mut local = into(of_instance, &at_top);
        local = into(self.transform(found.transform), &local);
        local.leaving = departure
            .filter(|d| d.from.instance == instance && d.from.object == object)
            .map(leaving);
        let root = found.shape.intersect(&local).filter(|root| root.t <= t_max)?;
        Some(Hit { t: root.t, id: HitId { instance, object, part: root.part } })
    }

    /// The surface at a hit of `ray`, without coordinates: [`Self::surface`] to the last bit. `None` where the
    /// hit is not of this world.
    #[must_use]
    pub fn surface_point(&self, ray: &Ray, hit: &Hit) -> Option<SurfacePoint> {
        let object = self.object(hit.id.object)?;
        let of_instance = match hit.id.instance {
            HitId::NO_INSTANCE => None,
            id => self.transform(self.instance(id)?.transform),
        };
        let of_object = self.transform(object.transform);
        if of_instance.is_none() && of_object.is_none() {
            return Some(object.shape.surface_point(ray.at(hit.t), hit.id.part));
        }
        let local = into(of_object, &into(of_instance, &LocalRay::whole(ray)));
        let own = object.shape.surface_point(local.at(hit.t), hit.id.part);
        let placed = of_object.map_or(own, |t| t.surface_point_to_world(&own));
        Some(of_instance.map_or(placed, |t| t.surface_point_to_world(&placed)))
    }

    /// [`Self::surface_point`], inlined where that is short.
    #[inline(always)]
    #[must_use]
    pub fn surface_point_inline(&self, ray: &Ray, hit: &Hit) -> Option<SurfacePoint> {
        let object = self.object(hit.id.object)?;
        if hit.id.instance == HitId::NO_INSTANCE && object.transform == NO_TRANSFORM {
            return Some(object.shape.surface_point_inline(ray.at(hit.t), hit.id.part));
        }
        self.surface_point(ray, hit)
    }

    /// The surface at a hit of `ray`. `None` where the hit is not of this world.
    #[must_use]
    pub fn surface(&self, ray: &Ray, hit: &Hit) -> Option<Surface> {
        let object = self.object(hit.id.object)?;
        let of_instance = match hit.id.instance {
            HitId::NO_INSTANCE => None,
            id => self.transform(self.instance(id)?.transform),
        };
        let of_object = self.transform(object.transform);
        let local = into(of_object, &into(of_instance, &LocalRay::whole(ray)));
        let own = object.shape.surface(local.at(hit.t), hit.id.part);
        let placed = of_object.map_or(own, |t| t.surface_to_world(&own));
        let s = of_instance.map_or(placed, |t| t.surface_to_world(&placed));
        Some(Surface {
            point: s.point,
            error: s.error,
            normal: s.normal,
            shading_normal: s.shading_normal,
            uv: s.uv,
            dpdu: s.dpdu,
            dpdv: s.dpdv,
            local_point: own.point,
            local_normal: own.normal,
        })
    }

    /// The object of a world that has only one, and no transforms: a mesh.
    #[inline]
    fn single(&self) -> Option<&Object> {
        match self.objects.as_slice() {
            [object]
                if self.transforms.is_empty()
                    && self.instances.is_empty()
                    && self.levels.len() == 1 =>
            {
                Some(object)
            }
            _ => None,
        }
    }

    /// Calls `test` with every object that the ray may hit at `t <= t_max`: its instance, itself and
    /// the ray in its space. `test` returns the new `t_max`, or `None` to end the walk.
    pub(super) fn visit<C: Counter>(
        &self,
        ray: &Ray,
        t_max: f64,
        departure: Option<&Departure>,
        counter: &mut C,
        mut test: impl FnMut(u32, &Object, &LocalRay) -> Option<f64>,
    ) -> Option<f64> {
        let at_top = scene_ray(ray, t_max)?;
        let mut t_max = t_max;
        if let Some(top) = self.levels.first() {
            let departure = departure.filter(|d| d.from.instance == HitId::NO_INSTANCE);
            t_max =
                self.visit_objects(top, &at_top, t_max, departure, counter, |object, local| {
                    test(HitId::NO_INSTANCE, object, local)
                })?;
        }
        if self.instances.is_empty() {
            return Some(t_max);
        }
        self.visit_instances(&at_top, t_max, departure, counter, test)
    }

    /// The same for the objects of instances alone.
    fn visit_instances<C: Counter>(
        &self,
        at_top: &LocalRay,
        mut t_max: f64,
        departure: Option<&Departure>,
        counter: &mut C,
        mut test: impl FnMut(u32, &Object, &LocalRay) -> Option<f64>,
    ) -> Option<f64> {
        let mut visit_instance = |instance: &Instance, t_max: f64, counter: &mut C| {
            let Some(level) = self.levels.get(instance.group as usize) else { return Some(t_max) };
            let inside = into(self.transform(instance.transform), at_top);
            let departure = departure.filter(|d| d.from.instance == instance.id);
            self.visit_objects(level, &inside, t_max, departure, counter, |object, local| {
                test(instance.id, object, local)
            })
        };
        let level = &self.instance_level;
        let (bounded, rest) = self.instances.split_at_checked(level.bounded)?;
        for instance in rest.iter().take(level.unbounded) {
            t_max = visit_instance(instance, t_max, counter)?;
        }
        let box_ray = level.box_ray(at_top.origin, at_top.direction, at_top.error);
        level.bvh.visit(&box_ray, t_max, counter, |range, mut t_max, counter| {
            for instance in bounded.get(range).unwrap_or_default() {
                t_max = visit_instance(instance, t_max, counter)?;
            }
            Some(t_max)
        })
    }

    /// The same for one group: `ray` is in its space, `departure` from one of its objects.
    #[inline]
    fn visit_objects<C: Counter>(
        &self,
        level: &Level,
        ray: &LocalRay,
        t_max: f64,
        departure: Option<&Departure>,
        counter: &mut C,
        mut test: impl FnMut(&Object, &LocalRay) -> Option<f64>,
    ) -> Option<f64> {
        let mut own = *ray;
        let mut visit_object = |object: &Object, t_max: f64, counter: &mut C| {
            counter.shapes(1);
            let left = departure.filter(|d| d.from.object == object.id).map(leaving);
            match self.transform(object.transform) {
                None => {
                    own.t_max = t_max;
                    own.leaving = left;
                    test(object, &own)
                }
                Some(transform) => {
                    let mut local = into(Some(transform), ray);
                    local.t_max = t_max;
                    local.leaving = left;
                    test(object, &local)
                }
            }
        };
        let objects = self.objects.get(level.first..)?;
        let (bounded, rest) = objects.split_at_checked(level.bounded)?;
        let mut t_max = t_max;
        for object in rest.iter().take(level.unbounded) {
            t_max = visit_object(object, t_max, counter)?;
        }
        // A tree over one or two tells no more than they do themselves.
        if let [_] | [_, _] = bounded {
            for object in bounded {
                t_max = visit_object(object, t_max, counter)?;
            }
            return Some(t_max);
        }
        let box_ray = level.box_ray(ray.origin, ray.direction, ray.error);
        level.bvh.visit(&box_ray, t_max, counter, |range, mut t_max, counter| {
            for object in bounded.get(range).unwrap_or_default() {
                t_max = visit_object(object, t_max, counter)?;
            }
            Some(t_max)
        })
    }
}

/// Keeps the hit of an object if it comes before the best one; returns how far is still of interest.
#[inline]
fn improve(
    best: &mut Option<Hit>,
    instance: u32,
    object: &Object,
    local: &LocalRay,
    t_max: f64,
    contacts: Contacts,
) -> f64 {
    if let Some(root) = meet(instance, object, local, contacts) {
        let hit = Hit { t: root.t, id: HitId { instance, object: object.id, part: root.part } };
        if hit.t <= t_max && hit.comes_before(*best) {
            *best = Some(hit);
            return hit.t;
        }
    }
    local.t_max
}

/// Any hit of an object before `t_max`.
#[inline]
fn blocked_by(
    instance: u32,
    object: &Object,
    local: &LocalRay,
    t_max: f64,
    contacts: Contacts,
) -> Option<Hit> {
    let root = block(instance, object, local, contacts).filter(|root| root.t < t_max)?;
    Some(Hit { t: root.t, id: HitId { instance, object: object.id, part: root.part } })
}

/// Any root of an object before `t_max`, judged as by [`meet`].
#[inline]
pub(super) fn block(
    instance: u32,
    object: &Object,
    ray: &LocalRay,
    contacts: Contacts,
) -> Option<Root> {
    let root = object.shape.blocks(ray)?;
    let far = root.t * ray.direction.abs().max_element() > CONTACT_REACH * ray.error;
    if contacts == Contacts::CROSSED || far || ray.leaving.is_some() {
        return Some(root);
    }
    meet(instance, object, ray, contacts)
}

/// The nearest root of an object. A surface that touches the point which the ray leaves and is not to be
/// crossed is left as that point's own surface is.
#[inline]
pub(super) fn meet(
    instance: u32,
    object: &Object,
    ray: &LocalRay,
    contacts: Contacts,
) -> Option<Root> {
    let root = object.shape.intersect(ray)?;
    let far = root.t * ray.direction.abs().max_element() > CONTACT_REACH * ray.error;
    if contacts == Contacts::CROSSED || far || ray.leaving.is_some() {
        return Some(root);
    }
    let surface = object.shape.surface_point(ray.at(root.t), root.part);
    let rising = ray.direction.dot(surface.normal);
    let touches = root.t * rising.abs() <= ray.error + surface.error;
    let id = HitId { instance, object: object.id, part: root.part };
    if !touches || contacts.crosses(&id) {
        return Some(root);
    }
    let leaving = Some(Leaving { part: root.part, outward: rising > 0.0 });
    object.shape.intersect(&LocalRay { leaving, ..*ray })
}

/// The ray as the only object sees it.
#[inline]
fn single_ray(object: &Object, ray: &Ray, t_max: f64, departure: Option<&Departure>) -> LocalRay {
    LocalRay {
        origin: apart(&ray.origin),
        direction: apart(&ray.direction),
        error: ray.error,
        t_max,
        leaving: departure
            .filter(|d| d.from.instance == HitId::NO_INSTANCE && d.from.object == object.id)
            .map(leaving),
    }
}

/// Whether a ray is finite and goes somewhere.
#[inline]
fn is_usable(ray: &Ray, t_max: f64) -> bool {
    let (o, d) = (apart(&ray.origin).abs(), apart(&ray.direction).abs());
    let length = d.x + d.y + d.z;
    // Nearly always so, and the shorter question.
    let finite = o.x + o.y + o.z + length < f64::MAX
        || (ray.origin.is_finite() && ray.direction.is_finite());
    finite && length > 0.0 && ray.error >= 0.0 && t_max >= 0.0
}

/// The ray as a local one; `None` unless it is finite and goes somewhere.
#[inline]
pub(super) fn scene_ray(ray: &Ray, t_max: f64) -> Option<LocalRay> {
    is_usable(ray, t_max).then_some(LocalRay {
        origin: ray.origin,
        direction: ray.direction,
        error: ray.error,
        t_max,
        leaving: None,
    })
}

/// A ray in the space of something that is placed in the ray's present space.
pub(super) fn into(transform: Option<&Transform>, ray: &LocalRay) -> LocalRay {
    let Some(transform) = transform else { return *ray };
    let (origin, error) = transform.point_to_local(ray.origin, ray.error);
    LocalRay { origin, direction: transform.direction_to_local(ray.direction), error, ..*ray }
}

pub(super) fn leaving(departure: &Departure) -> Leaving {
    Leaving { part: departure.from.part, outward: departure.outward }
}
