// SPDX-License-Identifier: MIT OR Apache-2.0
//! Rays whose values are awaited: a ray's value needs those of the rays that it causes.
//!
//! Rays of many samples are followed side by side. What is kept of a ray that causes others until its value is known is
//! a [`Node`]; when the last of the rays below it has brought its value, the node's own is worked out and handed
//! to the one above. Nodes that are done are used again, so that memory grows with the depth of the trees and
//! not with the number of rays.

use dioptric_math::Spectrum;
use serde_json::json;

use super::media::Inside;
use super::recorder::{Recorder, Slot};
use super::whitted::Whitted;

/// Who waits for a ray's value.
#[derive(Clone, Copy, Debug)]
pub(super) enum Above {
    /// The sample with this number in the batch.
    Sample(u32),
    /// The node with this index.
    Node(u32, Slot),
}

/// Where a ray's value goes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Way<I> {
    pub id: I,
    pub above: Above,
    /// What multiplies its value for who waits for it.
    pub weight: Spectrum,
    /// What it goes through.
    pub inside: Inside,
}

/// One ray that causes others.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node<I> {
    pub way: Way<I>,
    /// What it shows without the rays that it causes.
    pub own: Spectrum,
    /// How many of the rays below are not done.
    pub waiting: u8,
    /// Weights times values of the rays below that are done.
    pub below: [Spectrum; 2],
    /// The way from where it started to what it met.
    pub distance: f64,
}

/// Nodes that room is made for at once.
const MORE: usize = 64;

/// The nodes of a batch.
#[derive(Debug)]
pub(super) struct Nodes<I> {
    nodes: Vec<Node<I>>,
    free: Vec<u32>,
}

impl<I: Copy> Nodes<I> {
    pub fn new(room: usize) -> Self {
        Self { nodes: Vec::with_capacity(room), free: Vec::new() }
    }

    /// A ray that causes others; nothing of it is known yet but what it shows by itself and what it went through.
    #[inline(always)]
    pub fn add(&mut self, way: &Way<I>, own: Spectrum, waiting: u8, distance: f64) -> u32 {
        let below = [Spectrum::ZERO; 2];
        let index = match self.free.pop() {
            Some(index) => index,
            None => self.grow(way),
        };
        // One by one: what is put together elsewhere and copied as a whole makes the processor wait.
        let node = &mut self.nodes[index as usize];
        node.way.id = way.id;
        node.way.above = way.above;
        node.way.weight = way.weight;
        node.way.inside = way.inside;
        (node.own.x, node.own.y, node.own.z) = (own.x, own.y, own.z);
        (node.waiting, node.below, node.distance) = (waiting, below, distance);
        index
    }

    /// Makes room for some more nodes; the place of the first of them.
    #[cold]
    #[inline(never)]
    fn grow(&mut self, way: &Way<I>) -> u32 {
        let (first, zero) = (self.nodes.len(), Spectrum::ZERO);
        let node = Node { way: *way, own: zero, waiting: 0, below: [zero; 2], distance: 0.0 };
        self.nodes.resize(first + MORE, node);
        self.free.extend((first as u32 + 1..(first + MORE) as u32).rev());
        first as u32
    }

    /// Gives the place of a node that is done to the next one.
    pub fn release(&mut self, index: u32) {
        self.free.push(index);
    }
}

impl<I> std::ops::Index<u32> for Nodes<I> {
    type Output = Node<I>;

    fn index(&self, index: u32) -> &Node<I> {
        &self.nodes[index as usize]
    }
}

impl<I> std::ops::IndexMut<u32> for Nodes<I> {
    fn index_mut(&mut self, index: u32) -> &mut Node<I> {
        &mut self.nodes[index as usize]
    }
}

impl<R: Recorder> Whitted<'_, '_, R> {
    /// Works out the value of a node that waits for nothing, and hands it on.
    pub(super) fn settle(&mut self, index: u32) {
        let node = &self.nodes[index];
        if node.waiting == 0 {
            let (way, distance) = (node.way, node.distance);
            let value = node.own + node.below[0] + node.below[1];
            self.nodes.release(index);
            self.deliver(&way, value, distance);
        }
    }

    /// Hands the value of what a ray met to those who wait for it, and theirs if they wait for nothing else.
    #[inline(always)]
    pub(super) fn deliver(&mut self, way: &Way<R::Id>, value: Spectrum, distance: f64) {
        if let Above::Sample(sample) = way.above
            && self.clear
            && way.inside.is_none()
        {
            self.recorder.end(way.id, Spectrum::ONE, value);
            self.radiances[sample as usize].color = value;
            return;
        }
        // Number by number: what is put together in memory and read as a whole makes the processor wait.
        self.deliver_up(way, value.x, value.y, value.z, distance);
    }

    #[inline(never)]
    fn deliver_up(&mut self, way: &Way<R::Id>, r: f64, g: f64, b: f64, mut distance: f64) {
        let (mut way, mut value) = (*way, Spectrum::new(r, g, b));
        loop {
            value = self.attenuated(way.id, value, distance, way.inside);
            match way.above {
                Above::Sample(sample) => {
                    self.recorder.end(way.id, Spectrum::ONE, value);
                    self.radiances[sample as usize].color = value;
                    return;
                }
                Above::Node(above, slot) => {
                    let node = &mut self.nodes[above];
                    node.below[usize::from(slot)] = way.weight * value;
                    node.waiting -= 1;
                    self.recorder.end(way.id, way.weight, value);
                    if node.waiting > 0 {
                        return;
                    }
                    (way, distance) = (node.way, node.distance);
                    value = node.own + node.below[0] + node.below[1];
                    self.nodes.release(above);
                }
            }
        }
    }

    /// Absorption by the innermost medium, and fog outside of all, over the distance of a ray.
    #[inline(always)]
    fn attenuated(
        &mut self,
        id: R::Id,
        mut value: Spectrum,
        distance: f64,
        inside: Inside,
    ) -> Spectrum {
        if self.clear && inside.is_none() {
            return value;
        }
        let scene = self.scene;
        let left = self.media.transmittance(scene, inside, distance);
        if left != Spectrum::ONE {
            self.recorder.note(id, "absorption", || json!({"transmittance": left.to_array()}));
            self.recorder.scale(id, "absorption", left);
            value *= left;
        }
        let Some(fog) = scene.fog.as_ref().filter(|_| inside.is_none()) else { return value };
        let left = fog.transmittance(distance);
        let glow = fog.color * (1.0 - left);
        self.recorder.scale(id, "fog", Spectrum::splat(left));
        self.recorder.term(id, "fog", glow, || (None, json!({"transmittance": left})));
        value * left + glow
    }
}
