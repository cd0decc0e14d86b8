// SPDX-License-Identifier: MIT OR Apache-2.0
//! Building meshes: one pass over the triangles, the tree, and the packets in the order of its leaves.

use std::ops::Range;

use dioptric_math::DVec3;
use dioptric_math::bounds::gamma;
use rayon::prelude::*;

use super::closed::Boundary;
use super::line::{Corners, exact, normal};
use super::{LARGE, Mesh, Single, corners};
use crate::bounds::Bounds;
use crate::bvh::build::build_items;
use crate::bvh::item::{Item, extent, item, make_items, number};
use crate::bvh::triangles::{Packet, SIDE_BY_SIDE};
use crate::bvh::{Bvh, Costs};
use crate::mesh_data::MeshData;

/// Triangles are tested a packet at a time.
const COSTS: Costs = Costs { block: SIDE_BY_SIDE, visit: 0.4 };
/// How many times longer than the mean an edge is that makes a triangle large.
const LARGE_SIZE: f64 = 4.0;

/// What is summed up over triangles.
#[derive(Clone, Copy)]
struct Sums {
    boundary: Boundary,
    /// Six times the volume.
    volume: f64,
    tight: Bounds,
    edges: f64,
}

impl Default for Sums {
    fn default() -> Self {
        Self::NONE
    }
}

impl Sums {
    const NONE: Self =
        Self { boundary: Boundary::NONE, volume: 0.0, tight: Bounds::EMPTY, edges: 0.0 };

    fn and(self, other: &Self) -> Self {
        Self {
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
        let middle = DVec3::from(center.map(f64::from));
        let (mut bvh, items) = build_items(items, middle, COSTS);
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
            bounds: Bounds { min: tight.min - error, max: tight.max + error },
            error,
            single: Single::new(largest, edge, error, middle.abs().max_element()),
            closed,
            inverted: closed && sums.volume < 0.0,
        }
    }
}

/// Where the boxes have their origin: where the corners do, unless that is far away from them.
fn center(positions: &[[f32; 3]]) -> [f32; 3] {
    let run = |points: &[[f32; 3]]| {
        let finite = points.iter().filter(|p| p.iter().all(|x| x.is_finite()));
        Bounds::of(finite.map(|&p| exact(p)))
    };
    let b = if rayon::current_thread_index().is_some() {
        positions.par_chunks(1 << 14).map(run).reduce(|| Bounds::EMPTY, Bounds::union)
    } else {
        run(positions)
    };
    if b.is_empty() || b.center().abs().max_element() <= 16.0 * b.size().max_element() {
        return [0.0; 3];
    }
    b.center().to_array().map(|x| x as f32)
}

/// The items of a tree over those triangles that can be hit, and the sums.
fn items(data: &MeshData, center: [f32; 3]) -> (Vec<Item>, Sums) {
    let count = data.triangles.len().min(Bvh::MAX_ITEMS);
    let (items, runs) = make_items(count, |sums: &mut Sums, part| sums.add(data, part, center));
    (items, runs.iter().fold(Sums::NONE, Sums::and))
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
    // A little less, since boxes about a centre are rounded.
    let is_large = |item: &Item| f64::from(extent(item)) > edge * 0.999;
    let fill = |range: Range<usize>| {
        let mut packet = Packet::EMPTY;
        let own = items.get(range).unwrap_or_default();
        for (lane, part) in own.iter().map(number).enumerate() {
            if let Some(corners) = corners(data, part) {
                packet.set(lane, &corners, part);
            }
        }
        (packet, own.iter().any(is_large))
    };
    bvh.pack_leaves(SIDE_BY_SIDE, LARGE, fill)
}
