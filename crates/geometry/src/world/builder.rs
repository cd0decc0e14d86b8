// SPDX-License-Identifier: MIT OR Apache-2.0
//! Collecting objects, groups and instances, and putting them in order for the queries.

use dioptric_math::DAffine3;

use super::filter::Filter;
use super::{Instance, Level, NO_TRANSFORM, Object, Reach, World};
use crate::bounds::{Bounds, Middle};
use crate::bvh::Bvh;
use crate::ray::HitId;
use crate::shapes::AnyShape;
use crate::transform::Transform;

/// A group of objects that can have instances.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct GroupId(u32);

/// Why something cannot be placed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlacementError {
    /// The placement has no inverse, or numbers that are not finite.
    NoInverse,
    /// An instance was placed while a group was open: groups hold objects only.
    InsideGroup,
    /// The group belongs to another builder or is still open.
    UnknownGroup,
    /// There are 2^32 - 1 of them already.
    TooMany,
}

impl std::fmt::Display for PlacementError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::NoInverse => "the transform has no inverse",
            Self::InsideGroup => "an instance cannot be part of a group that is being built",
            Self::UnknownGroup => "the group of an instance is not known",
            Self::TooMany => "there are too many objects",
        })
    }
}

impl std::error::Error for PlacementError {}

/// Collects what a [`World`] holds.
#[derive(Clone, Debug)]
pub struct WorldBuilder {
    /// Index 0: the objects outside of groups.
    levels: Vec<Vec<Object>>,
    /// Indices into `levels`, the innermost last.
    open: Vec<u32>,
    transforms: Vec<Transform>,
    instances: Vec<Instance>,
    objects: u32,
}

impl Default for WorldBuilder {
    fn default() -> Self {
        Self {
            levels: vec![Vec::new()],
            open: Vec::new(),
            transforms: Vec::new(),
            instances: Vec::new(),
            objects: 0,
        }
    }
}

impl WorldBuilder {
    /// An empty world.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds an object to the group that is open, else to the world, and returns its id: ids count from
    /// 0 over all groups, in the order of these calls.
    ///
    /// # Errors
    /// The placement cannot be inverted, or there are too many objects.
    pub fn object(&mut self, shape: AnyShape, placement: DAffine3) -> Result<u32, PlacementError> {
        let id = self.objects;
        if id == HitId::NO_INSTANCE {
            return Err(PlacementError::TooMany);
        }
        let transform = self.keep(placement)?;
        let level = self.open.last().map_or(0, |&group| group as usize);
        if let Some(objects) = self.levels.get_mut(level) {
            objects.push(Object { shape, id, transform });
            self.objects += 1;
        }
        Ok(id)
    }

    /// Opens a new group: objects are added to it until [`Self::end_group`]. It is seen only where it
    /// has an instance.
    pub fn begin_group(&mut self) -> GroupId {
        let id = self.levels.len() as u32;
        self.levels.push(Vec::new());
        self.open.push(id);
        GroupId(id)
    }

    /// Closes the group that was opened last; objects go to the one around it again.
    pub fn end_group(&mut self) {
        self.open.pop();
    }

    /// Places a group in the world and returns the instance's id: ids count from 0 in the order of
    /// these calls.
    ///
    /// # Errors
    /// The placement cannot be inverted, the group is not known, or a group is open.
    pub fn instance(&mut self, group: GroupId, placement: DAffine3) -> Result<u32, PlacementError> {
        if group.0 as usize >= self.levels.len() {
            return Err(PlacementError::UnknownGroup);
        }
        if !self.open.is_empty() {
            return Err(PlacementError::InsideGroup);
        }
        let id = u32::try_from(self.instances.len()).map_err(|_| PlacementError::TooMany)?;
        if id == HitId::NO_INSTANCE {
            return Err(PlacementError::TooMany);
        }
        let transform = self.keep(placement)?;
        self.instances.push(Instance { group: group.0, id, transform });
        Ok(id)
    }

    /// Stores a placement unless it is the identity.
    fn keep(&mut self, placement: DAffine3) -> Result<u32, PlacementError> {
        if placement == DAffine3::IDENTITY {
            return Ok(NO_TRANSFORM);
        }
        let transform = Transform::new(placement).ok_or(PlacementError::NoInverse)?;
        let index = u32::try_from(self.transforms.len()).map_err(|_| PlacementError::TooMany)?;
        if index == NO_TRANSFORM {
            return Err(PlacementError::TooMany);
        }
        self.transforms.push(transform);
        Ok(index)
    }

    /// Builds the trees. Uses the pool of threads that it is called in, if any; the world is the same
    /// for any number of threads.
    #[must_use]
    pub fn build(self) -> World {
        let Self { levels: groups, transforms, mut instances, .. } = self;
        let transform = |index: u32| transforms.get(index as usize);
        let mut objects: Vec<Object> = Vec::new();
        let mut levels = Vec::with_capacity(groups.len());
        for mut group in groups {
            let (level, order) = Level::build(group.len(), objects.len(), |i| {
                group.get(i).map_or(NOTHING, |o| {
                    place(o.shape.bounds(), Reach::NONE, transform(o.transform))
                })
            });
            permute(&mut group, order);
            if objects.is_empty() {
                objects = group;
            } else {
                objects.append(&mut group);
            }
            levels.push(level);
        }
        let (instance_level, order) = Level::build(instances.len(), 0, |i| {
            let found = instances.get(i).and_then(|i| Some((i, levels.get(i.group as usize)?)));
            found.map_or(NOTHING, |(i, level): (_, &Level)| {
                place(level.bounds, level.reach, transform(i.transform))
            })
        });
        permute(&mut instances, order);
        if let Some(top) = levels.first_mut() {
            let center = top.bvh.center();
            let bounded = objects.get(..top.bounded).unwrap_or_default();
            top.filters = bounded
                .iter()
                .map(|o| {
                    let moved = transform(o.transform);
                    let (placed, _) = place(o.shape.bounds(), Reach::NONE, moved);
                    Filter::new(&o.shape, &placed, moved.is_some(), center)
                })
                .collect();
        }
        World {
            place_of: invert(objects.iter().map(|o| o.id)),
            instance_place_of: invert(instances.iter().map(|i| i.id)),
            objects,
            transforms,
            levels,
            instances,
            instance_level,
        }
    }
}

const NOTHING: (Bounds, Reach) = (Bounds::EMPTY, Reach::NONE);

/// The box of a thing in its place, and its reach seen from there.
fn place(local: Bounds, reach: Reach, transform: Option<&Transform>) -> (Bounds, Reach) {
    let own = if local.is_finite() { largest(&local) } else { 0.0 };
    let Some(transform) = transform else {
        return (local, Reach { extent: reach.extent + own, ..reach });
    };
    let bounds = transform.bounds_to_world(local);
    let (stretch, shrink) = transform.norms();
    let away = transform.to_local().translation.abs().max_element();
    let placed = if bounds.is_finite() { largest(&bounds) } else { 0.0 };
    let seen = Reach {
        amplify: stretch * shrink * reach.amplify,
        extent: stretch * (away * reach.amplify + reach.extent + own) + placed,
    };
    (bounds, seen)
}

/// The largest coordinate of a finite box.
fn largest(b: &Bounds) -> f64 {
    b.min.abs().max(b.max.abs()).max_element()
}

impl Level {
    /// Builds the tree over things whose boxes and reaches `place` gives, and returns the order in which
    /// they must be put: the tree's, then the unbounded, then the empty ones. `first` is where they
    /// will begin.
    fn build(
        count: usize,
        first: usize,
        place: impl Fn(usize) -> (Bounds, Reach),
    ) -> (Self, Vec<u32>) {
        let mut finite = Bounds::EMPTY;
        let mut reach = Reach::NONE;
        let mut middle = Middle::NONE;
        for (b, r) in (0..count).map(&place) {
            reach = reach.or(r);
            if b.is_finite() && !b.is_empty() {
                finite = finite.union(b);
                middle.add(&b);
            }
        }
        let center = middle.of(&finite);
        let (mut bounded, mut unbounded, mut empty) = (Vec::new(), Vec::new(), Vec::new());
        let mut bounds = finite;
        for index in 0..count as u32 {
            let (b, _) = place(index as usize);
            let nothing = b.is_empty() && !(b.min.is_nan() || b.max.is_nan());
            if nothing {
                empty.push(index);
            } else if bounded.len() < Bvh::MAX_ITEMS && Bvh::can_hold(&b, center) {
                bounded.push(index);
            } else {
                unbounded.push(index);
                bounds = if b.is_empty() { Bounds::EVERYTHING } else { bounds.union(b) };
            }
        }
        let boxes = bounded.iter().map(|&i| place(i as usize).0);
        let (bvh, order) = Bvh::build(boxes, center);
        let mut all: Vec<u32> =
            order.into_iter().filter_map(|i| bounded.get(i as usize).copied()).collect();
        let level = Self {
            bvh,
            first,
            bounded: bounded.len(),
            unbounded: unbounded.len(),
            bounds,
            reach,
            filters: Vec::new(),
        };
        all.extend(unbounded);
        all.extend(empty);
        (level, all)
    }
}

/// Puts `things[order[i]]` at `i`, cycle by cycle, without a second array of things.
fn permute<T>(things: &mut [T], mut order: Vec<u32>) {
    for start in 0..order.len() {
        let mut at = start;
        loop {
            let from = order[at] as usize;
            order[at] = at as u32;
            if from == start {
                break;
            }
            things.swap(at, from);
            at = from;
        }
    }
}

/// Where each id is.
fn invert(ids: impl ExactSizeIterator<Item = u32>) -> Vec<u32> {
    let mut places = vec![0; ids.len()];
    for (id, place) in ids.zip(0..) {
        if let Some(slot) = places.get_mut(id as usize) {
            *slot = place;
        }
    }
    places
}
