// SPDX-License-Identifier: MIT OR Apache-2.0
//! Outlines with many corners, concave ones and those with holes: a grid over the plane whose cells are
//! inside, outside, or near some edges. Near edges the exact test is made with those alone: the rest of the
//! outline is replaced by a few edges that lead around the cell, which makes no difference to who stands in it.

use dioptric_math::bounds::gamma;
use dioptric_math::{DVec2, DVec3};

use super::super::sheared::Shear;
use super::{Outline, Room, Spread, counts};

/// Side of the largest grid: a row's cells are the bits of a word.
const MOST: usize = 64;

/// The four points around the whole grid: corner `i` is to the right if `i` is 1 or 2, on top if it is 2 or 3.
type Frame = [DVec3; 4];

/// A row of cells, as bits.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Row {
    near: u64,
    /// Whether a cell is inside; for near ones, whether the parity of what replaces the outline is to be turned.
    inside: u64,
    /// How many near cells there are in the rows before.
    before: u32,
}

/// Edges of one ring, one after another, near to a cell, and how the frame's corners close the circle around the
/// cell.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Chain {
    /// The first edge's first corner.
    first: u32,
    edges: u16,
    /// Corners of the frame, in order, or [`NONE`].
    way: [u8; 2],
}

const NONE: u8 = 4;

/// The grid.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Cells {
    /// The plane's axes in units of cells: a point `p` is at `(p . across, p . up) - low`.
    across: DVec3,
    up: DVec3,
    low: DVec2,
    rows: Box<[Row]>,
    /// Where the chains of each near cell begin, and where the last one's end.
    starts: Box<[u32]>,
    chains: Box<[Chain]>,
    frame: Frame,
}

/// An edge on the grid.
#[derive(Clone, Copy)]
struct Edge {
    a: DVec2,
    b: DVec2,
}

impl Edge {
    /// Whether it counts for the half line from a point to the right.
    fn counts(&self, x: f64, y: f64) -> bool {
        (self.a.y > y) != (self.b.y > y) && self.x_at(y) > x
    }

    /// Where it crosses a height; the same number for the same edge, whoever asks.
    fn x_at(&self, y: f64) -> f64 {
        self.a.x + (self.b.x - self.a.x) * ((y - self.a.y) / (self.b.y - self.a.y))
    }

    /// From where to where it runs between two heights that it touches.
    fn between(&self, bottom: f64, top: f64) -> (f64, f64) {
        let (low, high) = if self.a.y <= self.b.y { (self.a, self.b) } else { (self.b, self.a) };
        let x0 = if low.y < bottom { self.x_at(bottom) } else { low.x };
        let x1 = if high.y > top { self.x_at(top) } else { high.x };
        // Rounding of almost level edges does not lead beyond their ends.
        let within = |x: f64| x.clamp(low.x.min(high.x), low.x.max(high.x));
        let (x0, x1) = (within(x0), within(x1));
        (x0.min(x1), x0.max(x1))
    }
}

impl Cells {
    /// A grid over an outline in the plane through `center` with these unit tangents. `None` where it could not be
    /// trusted.
    pub fn new(
        outline: &Outline,
        center: DVec3,
        (x, y): (DVec3, DVec3),
        spread: Spread,
    ) -> Option<(Room, Self)> {
        let n = outline.corners.len();
        // Few enough that a corner costs about as much memory as a triangle of a mesh.
        let side = match n {
            0..=12 => 8,
            13..=32 => 16,
            33..=96 => 32,
            _ => MOST,
        };
        let tangential = |p: &DVec3| DVec2::new((*p - center).dot(x), (*p - center).dot(y));
        let flat: Vec<DVec2> = outline.corners.iter().map(tangential).collect();
        let start = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        let (least, most) = flat.iter().fold(start, |(l, h), &p| (l.min(p), h.max(p)));
        // Half a cell stays free on every side.
        let cell = (most - least).max_element() / (side - 1) as f64;
        let (across, up) = (x / cell, y / cell);
        let low = least / cell - 0.5;
        // The frame's corners are rounded where the center is far away.
        let off = spread.off + gamma(32) * center.abs().max_element();
        let slack = cell / 64.0 + 16.0 * off;
        // In cells; rounding on the grid is far below. Half of it is for the ways around.
        let reach = 2.0 * slack / cell + 1e-6;
        if !(reach < 0.25) {
            return None;
        }
        let flat: Vec<DVec2> = flat.into_iter().map(|p| p / cell - low).collect();
        let (l, h) = (-2.0, side as f64 + 2.0);
        let frame = [(l, l), (h, l), (h, h), (l, h)].map(DVec2::from);
        let plan = Plan { outline, flat, side, reach, frame, rows: vec![], near: vec![] };
        let (rows, starts, chains) = plan.cells()?;
        let room = Room::new(Spread { off, ..spread }, slack);
        let place = |p: DVec2| center + (x * (p.x + low.x) + y * (p.y + low.y)) * cell;
        Some((room, Self { across, up, low, rows, starts, chains, frame: frame.map(place) }))
    }

    pub fn memory_bytes(&self) -> usize {
        size_of_val(&*self.rows) + size_of_val(&*self.starts) + size_of_val(&*self.chains)
    }

    /// Whether a point of the plane (relative to its center), for which there is [`Room`], is inside, unless it
    /// is in a cell near to edges.
    #[inline]
    pub fn encloses(&self, p: DVec3) -> Result<bool, Near> {
        let at = DVec2::new(p.dot(self.across), p.dot(self.up)) - self.low;
        let side = self.rows.len() as f64;
        if !(at.cmpge(DVec2::ZERO).all() && at.cmplt(DVec2::splat(side)).all()) {
            return Ok(false);
        }
        let Some(row) = self.rows.get(at.y as usize) else { return Ok(false) };
        let bit = 1_u64 << (at.x as u32 % u64::BITS);
        let inside = row.inside & bit != 0;
        if row.near & bit == 0 {
            return Ok(inside);
        }
        Err(Near { index: row.before + (row.near & (bit - 1)).count_ones(), turn: inside })
    }

    /// The outline's exact test for a ray that passes the plane in a near cell.
    pub fn is_passed(
        &self,
        near: Near,
        outline: &Outline,
        origin: DVec3,
        direction: DVec3,
    ) -> bool {
        let shear = Shear::new(origin, direction);
        let start = |i: u32| self.starts.get(i as usize).map_or(0, |&s| s as usize);
        let chains = self.chains.get(start(near.index)..start(near.index + 1)).unwrap_or_default();
        let mut inside = near.turn;
        for chain in chains {
            let first = chain.first as usize;
            let (start, end) = outline.ring_of(first);
            let (Some(before), Some(after)) =
                (outline.corners.get(start..first), outline.corners.get(first..end))
            else {
                continue;
            };
            let mut corners = after.iter().chain(before).chain(after);
            let Some(&first) = corners.next() else { continue };
            let first = shear.project(first);
            let mut a = first;
            let mut step = |b: DVec2| {
                inside ^= counts(a, b);
                a = b;
            };
            corners.take(chain.edges as usize).for_each(|&corner| step(shear.project(corner)));
            for &i in &chain.way {
                if let Some(&corner) = self.frame.get(i as usize) {
                    step(shear.project(corner));
                }
            }
            step(first);
        }
        inside
    }
}

/// A cell near to some edges.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Near {
    index: u32,
    turn: bool,
}

/// What [`Cells`] are made of: rows, where chains start, chains.
type Parts = (Box<[Row]>, Box<[u32]>, Box<[Chain]>);

/// The outline while the grid is made.
struct Plan<'a> {
    outline: &'a Outline,
    /// The corners on the grid.
    flat: Vec<DVec2>,
    side: usize,
    /// Edges that come closer to a cell than this are near.
    reach: f64,
    frame: [DVec2; 4],
    rows: Vec<Row>,
    /// Cells and the edges that are near to them (each the number of its first corner), sorted.
    near: Vec<(u32, u32)>,
}

impl Plan<'_> {
    /// The edge from a corner to the next one of its ring.
    fn edge(&self, i: usize, (start, end): (usize, usize)) -> Edge {
        let next = if i + 1 < end { i + 1 } else { start };
        let at = |i: usize| self.flat.get(i).copied().unwrap_or_default();
        Edge { a: at(i), b: at(next) }
    }

    /// Notes for every edge the cells that it comes near to, and for every row what is inside in the middle of it.
    fn lay_edges(&mut self) {
        let whole = |x: f64| x.clamp(0.0, self.side as f64 - 1.0) as usize;
        let reach = self.reach;
        let mut rows = vec![Row::default(); self.side];
        let mut near = Vec::with_capacity(8 * self.side + 4 * self.flat.len());
        for ring in self.outline.rings() {
            for i in ring.0..ring.1 {
                let edge = self.edge(i, ring);
                let (bottom, top) = (edge.a.y.min(edge.b.y), edge.a.y.max(edge.b.y));
                let (first, last) = (whole(bottom - reach), whole(top + reach));
                for (y, row) in rows.iter_mut().enumerate().take(last + 1).skip(first) {
                    let bottom = y as f64;
                    let (left, right) = edge.between(bottom - reach, bottom + 1.0 + reach);
                    let cells = whole(left - reach)..=whole(right + reach);
                    near.extend(cells.map(|x| ((y * self.side + x) as u32, i as u32)));
                    // Counts to the right come in pairs, so those to the left do as well. At 1/2 or more the
                    // difference is exact.
                    let middle = bottom + 0.5;
                    if edge.counts(f64::NEG_INFINITY, middle) {
                        let first = (edge.x_at(middle) - 0.5).ceil() as u32;
                        row.inside ^= u64::MAX.checked_shl(first).unwrap_or(0);
                    }
                }
            }
        }
        near.sort_unstable();
        (self.rows, self.near) = (rows, near);
    }

    /// The cells; `None` where there are more edges in one than a chain can count.
    fn cells(mut self) -> Option<Parts> {
        self.lay_edges();
        let (mut starts, mut chains) = (vec![], vec![]);
        let mut cells = self.near.chunk_by(|a, b| a.0 == b.0).peekable();
        let mut rows = self.rows.clone();
        for (y, row) in rows.iter_mut().enumerate() {
            row.before = starts.len() as u32;
            let end = ((y + 1) * self.side) as u32;
            while let Some(edges) = cells.next_if(|edges| edges.first().is_some_and(|e| e.0 < end))
            {
                let x = edges.first()?.0 as usize % self.side;
                row.near |= 1 << x;
                starts.push(chains.len() as u32);
                let middle = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
                row.inside ^= u64::from(self.close(edges, middle, &mut chains)?) << x;
            }
        }
        starts.push(chains.len() as u32);
        Some((rows.into(), starts.into(), chains.into()))
    }

    /// Makes chains of a cell's edges and closes them. Whether their parity at the middle is odd: where the
    /// outline's is the same, it is so in the whole cell, since what differs keeps away from the cell.
    fn close(&self, edges: &[(u32, u32)], middle: DVec2, out: &mut Vec<Chain>) -> Option<bool> {
        let (mut odd, mut parts) = (false, Vec::<(usize, usize)>::new());
        let mut edges = edges.iter().map(|e| e.1 as usize).peekable();
        while let Some(&next) = edges.peek() {
            let ring = self.outline.ring_of(next);
            let (start, end) = ring;
            while let Some(i) = edges.next_if(|&i| i < end) {
                odd ^= self.edge(i, ring).counts(middle.x, middle.y);
                match parts.last_mut() {
                    Some((first, count)) if *first + *count == i => *count += 1,
                    _ => parts.push((i, 1)),
                }
            }
            // The ring has no end.
            if let [(head, more), .., (first, count)] = parts.as_mut_slice()
                && (*head, *first + *count) == (start, end)
            {
                *count += *more;
                parts.remove(0);
            }
            for (first, edges) in parts.drain(..) {
                let last = first + edges;
                let last = if last < end { last } else { last - (end - start) };
                let at = |i: usize| self.flat.get(i).copied().unwrap_or_default();
                let (from, to) = (at(last), at(first));
                let way = if first == last { [NONE; 2] } else { self.way(from, to, middle) };
                let corners = way.iter().filter_map(|&i| self.frame.get(i as usize).copied());
                let mut a = from;
                for b in corners.chain([to]) {
                    odd ^= Edge { a, b }.counts(middle.x, middle.y);
                    a = b;
                }
                out.push(Chain { first: first as u32, edges: u16::try_from(edges).ok()?, way });
            }
        }
        Some(odd)
    }

    /// How to go from one point to another around the cell with this middle, both being outside of its reach:
    /// between points that are on the same side of it there is nothing in the way.
    fn way(&self, from: DVec2, to: DVec2, middle: DVec2) -> [u8; 2] {
        // Sides in order around the cell: below, right, above, left. Corner i of the frame ends side i - 1 and
        // begins side i.
        let side = |p: DVec2| {
            let (r, far) = (p - middle, 0.5 + 0.5 * self.reach);
            [-r.y > far, r.x > far, r.y > far, -r.x > far]
        };
        let (a, b) = (side(from), side(to));
        if (0..4).any(|i| a[i] && b[i]) {
            return [NONE; 2];
        }
        let (a, b) =
            (a.iter().position(|&s| s).unwrap_or(0), b.iter().position(|&s| s).unwrap_or(0));
        // The corner between neighbouring sides begins the later one.
        if b == (a + 1) % 4 {
            [b as u8, NONE]
        } else if a == (b + 1) % 4 {
            [a as u8, NONE]
        } else {
            [((a + 1) % 4) as u8, b as u8]
        }
    }
}
