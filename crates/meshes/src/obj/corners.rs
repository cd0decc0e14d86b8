// SPDX-License-Identifier: MIT OR Apache-2.0
//! The corners of faces, which name place, surface coordinates and normal separately, as one index for each
//! combination that occurs.

use std::collections::HashMap;

/// Stands for no surface coordinates or no normal.
pub const NONE: u32 = u32::MAX;

/// Corners at one position that are looked through one by one; more are looked up in a table.
const CHAIN: usize = 16;

/// What a face says about one corner: indices of its position, its surface coordinates and its normal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Corner {
    pub position: u32,
    pub uv: u32,
    pub normal: u32,
}

/// All combinations, numbered in the order in which they first occur. While faces name positions alone, a
/// corner's number is its position's and nothing is stored.
#[derive(Debug, Default)]
pub struct Corners {
    pub list: Vec<Corner>,
    /// For each corner another one at the same position, or [`NONE`].
    next: Vec<u32>,
    /// For each position the first corner there, or [`NONE`].
    first: Vec<u32>,
    /// Corners at positions that have more than [`CHAIN`].
    table: HashMap<Corner, u32>,
    has_any: bool,
}

impl Corners {
    /// Whether faces name more than positions.
    pub fn are_needed(&self) -> bool {
        self.has_any
    }

    /// The number of a corner. `positions` is how many there are so far.
    pub fn number(&mut self, corner: Corner, positions: usize) -> u32 {
        if !self.has_any {
            if corner.uv == NONE && corner.normal == NONE {
                return corner.position;
            }
            self.has_any = true;
        }
        if self.first.len() < positions {
            self.first.resize(positions, NONE);
        }
        let Some(first) = self.first.get_mut(corner.position as usize) else {
            return corner.position;
        };
        let head = *first;
        let mut at = head;
        for _ in 0..CHAIN {
            match self.list.get(at as usize) {
                Some(found) if *found == corner => return at,
                Some(_) => at = self.next.get(at as usize).copied().unwrap_or(NONE),
                None => {
                    let number = self.list.len() as u32;
                    *first = number;
                    self.list.push(corner);
                    self.next.push(head);
                    return number;
                }
            }
        }
        let list = &mut self.list;
        let next = &mut self.next;
        *self.table.entry(corner).or_insert_with(|| {
            let number = list.len() as u32;
            list.push(corner);
            next.push(NONE);
            number
        })
    }

    /// Numbers every position's plain corner as the position itself, for triangles that were made of positions
    /// alone before the first corner that has more.
    pub fn keep_plain(&mut self, positions: u32) {
        self.list =
            (0..positions).map(|position| Corner { position, uv: NONE, normal: NONE }).collect();
        self.next = vec![NONE; positions as usize];
        self.first = (0..positions).collect();
    }
}
