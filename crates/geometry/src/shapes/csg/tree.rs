// SPDX-License-Identifier: MIT OR Apache-2.0
//! Which parts of a line lie inside a combination of solids.
//!
//! All crossings of the line with all solids are sorted by `t`, and a gate for each operation counts
//! how many of its parts the line is in (Roth, "Ray casting for modeling solids", Computer Graphics
//! and Image Processing 18(2), 1982). Crossings that their own error bounds cannot tell apart are one
//! event: only the state before and after it counts, so that faces which coincide leave no slivers.

use std::cell::Cell;
use std::ops::Range;

use dioptric_math::DVec3;
use dioptric_math::bounds::gamma;

use super::Leaf;
use crate::bounds::Bounds;
use crate::ray::{Leaving, LocalRay};
use crate::shape::Crossing;

/// How a gate combines its parts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Rule {
    /// Inside at least one.
    Any,
    /// Inside all (of those that are subtracted: outside).
    All,
}

/// Where a solid's or a gate's answer goes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Output {
    /// The gate that it is a part of; `None` for the last gate.
    pub gate: Option<u32>,
    /// Whether it is subtracted there.
    pub negated: bool,
}

/// One operation.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gate {
    pub rule: Rule,
    pub parts: u32,
    pub output: Output,
    /// The number of true parts where the line is in no solid.
    pub at_rest: u32,
}

impl Gate {
    fn value(&self, true_parts: u32) -> bool {
        match self.rule {
            Rule::Any => true_parts > 0,
            Rule::All => true_parts == self.parts,
        }
    }

    /// The value where the line is in no solid.
    pub fn value_at_rest(&self) -> bool {
        self.value(self.at_rest)
    }
}

/// One crossing of one solid.
#[derive(Clone, Copy, Debug)]
struct Item {
    t: f64,
    leaf: u32,
    part: u32,
    enters: bool,
    /// Bound on the error of `t`; NaN where not yet known.
    slack: f64,
}

/// Memory that is used again by the next ray of the thread.
#[derive(Default)]
struct Scratch {
    items: Vec<Item>,
    crossings: Vec<Crossing>,
    /// True parts of each gate.
    counts: Vec<u32>,
}

thread_local! {
    static SCRATCH: Cell<Scratch> = Cell::default();
}

/// A passage through the combination's surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Passage {
    pub t: f64,
    pub leaf: u32,
    pub part: u32,
    pub enters: bool,
}

/// Crossings nearer to each other than this, relative to the distances involved, are looked at closely.
const NEAR: f64 = 1e-7;

/// Calls `found` with the passages of the line through the combination in order, until it returns
/// `false`. Of a ray that leaves a point of leaf `left`, only with those beyond the point.
pub(super) fn passages(
    leaves: &[Leaf],
    gates: &[Gate],
    ray: &LocalRay,
    left: Option<(u32, Leaving)>,
    mut found: impl FnMut(Passage) -> bool,
) {
    let mut scratch = SCRATCH.take();
    let mut walk = Walk { leaves, gates, ray, scratch: &mut scratch, departs: left.is_some() };
    walk.collect();
    let start = walk.depart(left);
    walk.run(left, start, &mut found);
    SCRATCH.set(scratch);
}

struct Walk<'a> {
    leaves: &'a [Leaf],
    gates: &'a [Gate],
    ray: &'a LocalRay,
    scratch: &'a mut Scratch,
    departs: bool,
}

impl Walk<'_> {
    /// Gathers the crossings of all leaves, and the state before the first of them.
    fn collect(&mut self) {
        let Scratch { items, counts, .. } = &mut *self.scratch;
        items.clear();
        counts.clear();
        counts.extend(self.gates.iter().map(|gate| gate.at_rest));
        let inverse = self.ray.direction.recip();
        for (leaf, index) in self.leaves.iter().zip(0..) {
            if !meets(&leaf.bounds, self.ray.origin, inverse) {
                continue;
            }
            let local = leaf.to_local(self.ray);
            let crossings = &mut self.scratch.crossings;
            crossings.clear();
            leaf.shape.crossings(&local, crossings);
            let inside_before = match crossings.first() {
                Some(first) => !first.enters,
                None => !leaf.bounds.is_finite() && contains(leaf, &local, crossings),
            };
            for c in self.scratch.crossings.iter().filter(|c| c.t.is_finite()) {
                let Crossing { t, part, enters } = *c;
                self.scratch.items.push(Item { t, leaf: index, part, enters, slack: f64::NAN });
            }
            if inside_before {
                self.toggle(leaf.output, true);
            }
        }
        self.scratch.items.sort_by(|a, b| a.t.total_cmp(&b.t).then(a.leaf.cmp(&b.leaf)));
    }

    /// Sets the crossing that the ray leaves to exactly 0: of those with its part and sense the nearest.
    fn depart(&mut self, left: Option<(u32, Leaving)>) -> Option<usize> {
        let (index, leaving) = left?;
        let leaf = self.leaves.get(index as usize)?;
        // Going out of the combination is going into a solid that is subtracted from it.
        let enters = leaving.outward == leaf.subtracted;
        let items = &mut self.scratch.items;
        let (mut at, item) = items
            .iter_mut()
            .enumerate()
            .filter(|(_, i)| i.leaf == index && i.part == leaving.part && i.enters == enters)
            .min_by(|(_, a), (_, b)| a.t.abs().total_cmp(&b.t.abs()))?;
        item.t = 0.0;
        // Keep the order: zero may have passed a neighbour.
        while at > 0 && items[at - 1].t > 0.0 {
            items.swap(at - 1, at);
            at -= 1;
        }
        while at + 1 < items.len() && items[at + 1].t < 0.0 {
            items.swap(at, at + 1);
            at += 1;
        }
        Some(at)
    }

    /// Goes through the events. `start` is the crossing that is left, if it was found.
    fn run(
        &mut self,
        left: Option<(u32, Leaving)>,
        start: Option<usize>,
        found: &mut impl FnMut(Passage) -> bool,
    ) {
        let outward = left.map(|(_, leaving)| leaving.outward);
        let mut inside = self.value();
        // Before the point that is left nothing is reported.
        let mut silent = outward.is_some();
        let mut next = 0;
        while next < self.scratch.items.len() {
            let event = self.event(next);
            next = event.end;
            let is_start = start.is_some_and(|s| event.contains(&s));
            if let Some(outward) = outward
                && silent
                && start.is_none()
                && self.scratch.items[event.start].t > 0.0
            {
                // The crossing that is left was lost to rounding: the ray is where it said it goes.
                (silent, inside) = (false, !outward);
            }
            for i in event.clone() {
                let item = self.scratch.items[i];
                if let Some(leaf) = self.leaves.get(item.leaf as usize) {
                    self.toggle(leaf.output, item.enters);
                }
            }
            if let Some(outward) = outward
                && is_start
            {
                (silent, inside) = (false, !outward);
                continue;
            }
            let value = self.value();
            if value == inside {
                continue;
            }
            inside = value;
            if silent {
                continue;
            }
            if let Some(passage) = self.passage(event, value)
                && !found(passage)
            {
                return;
            }
        }
    }

    /// The items from `first` on that are one event: each within the error bounds of the one before,
    /// no solid twice.
    fn event(&mut self, first: usize) -> Range<usize> {
        let mut end = first + 1;
        while end < self.scratch.items.len() {
            let [a, b] = [self.scratch.items[end - 1], self.scratch.items[end]];
            let speed = self.ray.direction.abs().max_element();
            let extent = self.leaves.get(b.leaf as usize).map_or(0.0, |leaf| leaf.extent);
            let scale = self.ray.origin.abs().max_element() + b.t.abs() * speed + extent;
            let gap = b.t - a.t;
            if gap * speed > NEAR * scale {
                break;
            }
            if self.scratch.items[first..end].iter().any(|i| i.leaf == b.leaf) {
                break;
            }
            if gap > self.slack(end - 1) + self.slack(end) {
                break;
            }
            end += 1;
        }
        first..end
    }

    /// Bound on the error of an item's `t`, relative to those of the other solids.
    fn slack(&mut self, index: usize) -> f64 {
        let item = self.scratch.items[index];
        if !item.slack.is_nan() {
            return item.slack;
        }
        let slack = self.leaves.get(item.leaf as usize).map_or(0.0, |leaf| {
            // All solids see the same ray; only the point that is left is known better than that.
            let ray_error = if self.departs { self.ray.error } else { 0.0 };
            let (error, speed) = leaf.error_and_speed(self.ray, item.t, item.part, ray_error);
            error / speed
        });
        // Along a surface nothing can be told apart.
        let slack = if slack.is_nan() { f64::INFINITY } else { slack };
        self.scratch.items[index].slack = slack;
        slack
    }

    /// The passage of an event: the lowest solid whose own crossing has the sense of the whole.
    fn passage(&self, event: Range<usize>, enters: bool) -> Option<Passage> {
        let item = self.scratch.items.get(event)?.iter().filter(|item| {
            self.leaves
                .get(item.leaf as usize)
                .is_some_and(|l| (item.enters != l.subtracted) == enters)
        });
        let item = item.min_by_key(|item| item.leaf)?;
        Some(Passage { t: item.t, leaf: item.leaf, part: item.part, enters })
    }

    fn value(&self) -> bool {
        match (self.gates.first(), self.scratch.counts.first()) {
            (Some(gate), Some(&count)) => gate.value(count),
            _ => false,
        }
    }

    /// Tells a gate that one of its parts changed, and the gates behind it as far as they change.
    fn toggle(&mut self, output: Output, inside: bool) {
        let (mut output, mut value) = (output, inside);
        while let Some(index) = output.gate {
            let index = index as usize;
            let (Some(gate), Some(count)) =
                (self.gates.get(index), self.scratch.counts.get_mut(index))
            else {
                return;
            };
            let before = gate.value(*count);
            *count = if value != output.negated { *count + 1 } else { count.saturating_sub(1) };
            let after = gate.value(*count);
            if before == after {
                return;
            }
            (output, value) = (gate.output, after);
        }
    }
}

/// Whether the whole line may meet a box. The bounds of leaves are padded when they are made.
fn meets(b: &Bounds, origin: DVec3, inverse: DVec3) -> bool {
    let (mut near, mut far) = (f64::NEG_INFINITY, f64::INFINITY);
    for axis in 0..3 {
        let pad = gamma(256) * (origin[axis].abs() + b.min[axis].abs().max(b.max[axis].abs()));
        let t0 = (b.min[axis] - pad - origin[axis]) * inverse[axis];
        let t1 = (b.max[axis] + pad - origin[axis]) * inverse[axis];
        // f64's own min and max leave NaN (a line in the plane of a face) out.
        near = near.max(t0.min(t1));
        far = far.min(t0.max(t1));
    }
    near <= far
}

/// Whether a solid holds the origin of a line that crosses it nowhere, as seen along the axes.
fn contains(leaf: &Leaf, line: &LocalRay, crossings: &mut Vec<Crossing>) -> bool {
    let mut inside = false;
    for direction in DVec3::AXES {
        crossings.clear();
        leaf.shape.crossings(&LocalRay { direction, ..*line }, crossings);
        if let Some(first) = crossings.first() {
            inside =
                crossings.iter().rfind(|c| c.t <= 0.0).map_or(!first.enters, |last| last.enters);
            break;
        }
    }
    crossings.clear();
    inside
}
