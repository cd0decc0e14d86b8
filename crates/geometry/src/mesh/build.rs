// SPDX-License-Identifier: MIT OR Apache-2.0
//! Building meshes: one pass over the triangles, the tree, and the packets in the order of its leaves.

use dioptric_math::DVec3;
use dioptric_math::bounds::gamma;
use rayon::prelude::*;

use super::closed::Boundary;
use super::line::{Corners, exact, normal};
use super::{LARGE, Mesh, corners};
use crate::bounds::Bounds;
use crate::bvh::build::build_items;
use crate::bvh::item::{Item, extent, item, number};
use crate::bvh::triangles::{Packet, SIDE_BY_SIDE};
use crate::bvh::{Bvh, Costs};
use crate::memory;
use crate::mesh_data::MeshData;

/// Triangles are tested a packet at a time.
const COSTS: Costs = Costs { block: SIDE_BY_SIDE, visit: 0.4 };
/// How many times longer than the mean an edge is that makes a triangle large.
const LARGE_SIZE: f64 = 4.0;
/// Triangles that one thread takes in a row. Sums depend on it, and so must not depend on the threads.
const RUN: usize = 1 << 13;

/// What is summed up over triangles.
#[derive(Clone, Copy)]
struct Sums {
    kept: usize,
    boundary: Boundary,
    /// Six times the volume.
    volume: f64,
    tight: Bounds,
    edges: f64,
}

impl Sums {
    const NONE: Self =
        Self { kept: 0, boundary: Boundary::NONE, volume: 0.0, tight: Bounds::EMPTY, edges: 0.0 };

    fn and(self, other: &Self) -> Self {
        Self {
            kept: self.kept + other.kept,
            boundary: self.boundary.and(other.boundary),
            volume: self.volume + other.volume,
            tight: self.tight.union(other.tight),
            edges: self.edges + other.edges,
        }
    }
}

impl Mesh {
    pub(super) fn build(data: MeshData) -> Self {
        let center = center(&data.positions);
        let (items, sums) = items(&data, center);
        let (mut bvh, items) = build_items(items, DVec3::from(center.map(f64::from)), COSTS);
        let edge = LARGE_SIZE * sums.edges / items.len().max(1) as f64;
        let packets = packets(&data, &mut bvh, &items, edge);
        let tight = sums.tight;
        let largest =
            if tight.is_empty() { 0.0 } else { tight.min.abs().max(tight.max.abs()).max_element() };
        let error = gamma(16) * largest;
        let closed = sums.boundary.is_closed() && !items.is_empty();
        Self {
            data,
            bvh,
            packets,
            count: items.len(),
            edge,
            bounds: Bounds { min: tight.min - error, max: tight.max + error },
            largest,
            error,
            closed,
            inverted: closed && sums.volume < 0.0,
        }
    }
}

/// Where the boxes have their origin: where the corners do, unless that is far away from them.
fn center(positions: &[[f32; 3]]) -> [f32; 3] {
    let finite = positions.iter().filter(|p| p.iter().all(|x| x.is_finite()));
    let b = Bounds::of(finite.map(|&p| exact(p)));
    if b.is_empty() || b.center().abs().max_element() <= 16.0 * b.size().max_element() {
        return [0.0; 3];
    }
    b.center().to_array().map(|x| x as f32)
}

/// The items of a tree over those triangles that can be hit, and the sums.
fn items(data: &MeshData, center: [f32; 3]) -> (Vec<Item>, Sums) {
    let count = data.triangles.len().min(Bvh::MAX_ITEMS);
    let mut items: Vec<Item> = vec![[0.0; 8]; count];
    memory::advise(&items);
    let run = |(index, items): (usize, &mut [Item])| {
        let mut sums = Sums::NONE;
        let parts = (index * RUN) as u32..;
        for part in parts.take(items.len()) {
            if let Some(item) = sums.add(data, part, center) {
                items[sums.kept] = item;
                sums.kept += 1;
            }
        }
        sums
    };
    let runs: Vec<Sums> = if rayon::current_thread_index().is_some() {
        items.par_chunks_mut(RUN).enumerate().map(run).collect()
    } else {
        items.chunks_mut(RUN).enumerate().map(run).collect()
    };
    let sums = runs.iter().fold(Sums::NONE, Sums::and);
    if sums.kept < count {
        let mut end = 0;
        for (index, run) in runs.iter().enumerate() {
            let start = index * RUN;
            items.copy_within(start..start + run.kept, end);
            end += run.kept;
        }
        items.truncate(end);
    }
    (items, sums)
}

impl Sums {
    /// Adds a triangle; its item, if it can be hit.
    #[inline(always)]
    fn add(&mut self, data: &MeshData, part: u32, center: [f32; 3]) -> Option<Item> {
        let corners = corners(data, part)?;
        self.boundary.add(&corners);
        if normal(&corners) == DVec3::ZERO {
            return None;
        }
        let (a, b, c) = (exact(corners[0]), exact(corners[1]), exact(corners[2]));
        self.volume += a.dot(b.cross(c));
        let (min, max) = (a.min(b).min(c), a.max(b).max(c));
        self.tight = self.tight.union(Bounds { min, max });
        self.edges += (max - min).max_element();
        let [low, high] = ranges(&corners);
        if center == [0.0; 3] {
            return Some(item(low, high, part));
        }
        let apart = |x: [f32; 3]| [x[0] - center[0], x[1] - center[1], x[2] - center[2]];
        Some(item(apart(low).map(f32::next_down), apart(high).map(f32::next_up), part))
    }
}

/// The smallest and the largest coordinates.
#[inline(always)]
fn ranges([a, b, c]: &Corners) -> [[f32; 3]; 2] {
    let low = |i: usize| a[i].min(b[i]).min(c[i]);
    let high = |i: usize| a[i].max(b[i]).max(c[i]);
    [[low(0), low(1), low(2)], [high(0), high(1), high(2)]]
}

/// Packets of the triangles of each leaf, to which the tree's leaves then point.
fn packets(data: &MeshData, bvh: &mut Bvh, items: &[Item], edge: f64) -> Vec<Packet> {
    let mut runs: Vec<(u32, u32)> = Vec::with_capacity(items.len() / 4);
    bvh.map_leaves(|range| {
        let first = runs.len();
        let own = items.get(range.clone()).unwrap_or_default();
        // A little less, since boxes about a centre are rounded.
        let large = own.iter().any(|item| f64::from(extent(item)) > edge * 0.999);
        for start in range.clone().step_by(SIDE_BY_SIDE) {
            runs.push((start as u32, range.end.min(start + SIDE_BY_SIDE) as u32));
        }
        (if large { first | LARGE } else { first }, runs.len() - first)
    });
    let fill = |&(start, end): &(u32, u32)| {
        let mut packet = Packet::EMPTY;
        let own = items.get(start as usize..end as usize).unwrap_or_default();
        for (lane, part) in own.iter().map(number).enumerate() {
            if let Some(corners) = corners(data, part) {
                packet.set(lane, &corners, part);
            }
        }
        packet
    };
    let mut packets = memory::with_capacity(runs.len());
    if rayon::current_thread_index().is_some() {
        packets.par_extend(runs.par_iter().with_min_len(256).map(fill));
    } else {
        packets.extend(runs.iter().map(fill));
    }
    packets
}
