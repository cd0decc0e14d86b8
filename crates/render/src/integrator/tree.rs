// SPDX-License-Identifier: MIT OR Apache-2.0
//! Rays whose values are awaited: a ray's value needs those of the rays that it causes.
//!
//! Rays of many samples are followed side by side. What is kept of a ray until its value is known is a
//! [`Node`]; when the last of the rays below it has brought its value, the node's own is worked out and handed
//! to the one above. Nodes that are done are used again, so that memory grows with the depth of the trees and
//! not with the number of rays.

use dioptric_math::Spectrum;

use super::media::Inside;
use super::recorder::Slot;

/// Who waits for a ray's value.
#[derive(Clone, Copy, Debug)]
pub(super) enum Above {
    /// The sample with this number in the batch.
    Sample(u32),
    /// The node with this index.
    Node(u32, Slot),
}

/// One ray.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node<I> {
    pub id: I,
    pub above: Above,
    /// What it shows without the rays that it causes.
    pub own: Spectrum,
    /// How many of the rays below are not done.
    pub waiting: u8,
    /// What multiplies its value for who waits for it.
    pub weight: Spectrum,
    /// Weights times values of the rays below that are done.
    pub below: [Spectrum; 2],
    /// The way from where it started to what it met.
    pub distance: f64,
    /// What it went through.
    pub inside: Inside,
}

/// The nodes of a batch.
#[derive(Debug)]
pub(super) struct Nodes<I> {
    nodes: Vec<Node<I>>,
    free: Vec<u32>,
}

impl<I: Copy> Nodes<I> {
    pub fn new(room: usize) -> Self {
        Self { nodes: Vec::with_capacity(room), free: Vec::with_capacity(room) }
    }

    pub fn add(&mut self, id: I, above: Above, weight: Spectrum, inside: Inside) -> u32 {
        let node = Node {
            id,
            above,
            own: Spectrum::ZERO,
            waiting: 0,
            weight,
            below: [Spectrum::ZERO; 2],
            distance: f64::INFINITY,
            inside,
        };
        match self.free.pop() {
            Some(index) => {
                self.nodes[index as usize] = node;
                index
            }
            None => {
                self.nodes.push(node);
                self.nodes.len() as u32 - 1
            }
        }
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
