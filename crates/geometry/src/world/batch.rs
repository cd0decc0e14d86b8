// SPDX-License-Identifier: MIT OR Apache-2.0
//! Many rays at once: the same answers as one by one, sooner where neighbours go the same way.

use super::{Hit, World};
use crate::ray::{Contacts, Departure, HitId, Ray};

/// One ray of a batch, with what [`World::closest_past`] takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Query {
    /// The ray.
    pub ray: Ray,
    /// How far it goes, in units of its direction.
    pub t_max: f64,
    /// The point that it leaves.
    pub departure: Option<Departure>,
    /// What becomes of other surfaces at that point.
    pub contacts: Contacts,
}

impl World {
    /// [`Self::closest_past`] for each query; `hits` is cleared first.
    pub fn closest_each(&self, queries: &[Query], hits: &mut Vec<Option<Hit>>) {
        hits.clear();
        hits.extend(
            queries
                .iter()
                .map(|q| self.closest_past(&q.ray, q.t_max, q.departure.as_ref(), q.contacts)),
        );
    }

    /// [`Self::blocker_past`] for each query, though perhaps not the same one; `blockers` is cleared first.
    pub fn blocker_each(&self, queries: &[Query], blockers: &mut Vec<Option<HitId>>) {
        blockers.clear();
        blockers.extend(
            queries
                .iter()
                .map(|q| self.blocker_past(&q.ray, q.t_max, q.departure.as_ref(), q.contacts)),
        );
    }
}
