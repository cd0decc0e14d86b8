// SPDX-License-Identifier: MIT OR Apache-2.0
//! The mesh while it is read: vertices and faces in whichever order they come.

use super::{Layout, NUMBERS};
use crate::error::{MeshError, Place};
use crate::{Limits, Model, bytes_of, cut, too_large};

/// Most that is reserved for what a header merely promises.
const PROMISED: u64 = 1 << 16;

pub struct Collector<'l> {
    model: Model,
    limits: &'l Limits,
    /// How many vertices the header says there are.
    vertices: u32,
    /// Faces that came before the vertices, which polygons are cut by: lengths and corners.
    waiting: Vec<u32>,
    polygon: Vec<[f32; 3]>,
    bytes_per_vertex: usize,
    are_vertices_read: bool,
}

impl<'l> Collector<'l> {
    pub fn new(vertices: u64, limits: &'l Limits) -> Result<Self, MeshError> {
        let Ok(count) = u32::try_from(vertices) else {
            let message = format!("the file has {vertices} vertices, more than can be told apart");
            return Err(MeshError::new(Place::File, message)
                .help("cut the mesh into files of less than 4 billion vertices"));
        };
        Ok(Self {
            model: Model::default(),
            limits,
            vertices: count,
            waiting: Vec::new(),
            polygon: Vec::new(),
            bytes_per_vertex: 12,
            are_vertices_read: count == 0,
        })
    }

    pub fn begin_vertices(&mut self, layout: &Layout) {
        let count = u64::from(self.vertices).min(PROMISED) as usize;
        let mesh = &mut self.model.mesh;
        mesh.positions.reserve(count);
        for (is_there, bytes) in
            [(layout.has_normals, 12), (layout.has_uvs, 8), (layout.has_radius, 4)]
        {
            self.bytes_per_vertex += if is_there { bytes } else { 0 };
        }
    }

    pub fn vertex(&mut self, layout: &Layout, n: &[f32; NUMBERS]) -> Result<(), Problem> {
        let mesh = &mut self.model.mesh;
        mesh.positions.push([n[0], n[1], n[2]]);
        if layout.has_normals {
            mesh.normals.push([n[3], n[4], n[5]]);
        }
        if layout.has_uvs {
            mesh.uvs.push([n[6], n[7]]);
        }
        if layout.has_radius {
            self.model.radii.push(n[8]);
        }
        self.check_size()
    }

    pub fn end_vertices(&mut self) {
        self.are_vertices_read = true;
    }

    /// A vertex's index, if there is such a vertex.
    pub fn index(&self, index: i64) -> Result<u32, Problem> {
        match u32::try_from(index) {
            Ok(i) if i < self.vertices => Ok(i),
            _ => Err(Problem::NoVertex(index)),
        }
    }

    pub fn triangle(&mut self, corners: [u32; 3]) -> Result<(), Problem> {
        if self.are_vertices_read {
            self.model.mesh.triangles.push(corners);
            self.check_size()
        } else {
            self.face(&corners)
        }
    }

    pub fn face(&mut self, corners: &[u32]) -> Result<(), Problem> {
        if self.are_vertices_read {
            self.cut(corners);
        } else {
            self.waiting.push(corners.len() as u32);
            self.waiting.extend_from_slice(corners);
        }
        self.check_size()
    }

    /// A strip: each corner makes a triangle with the two before it, every other one turned over.
    pub fn strip(&mut self, corners: impl Iterator<Item = i64>) -> Result<(), Problem> {
        let mut last = [None; 2];
        let mut is_turned = false;
        for corner in corners {
            if corner == -1 {
                (last, is_turned) = ([None; 2], false);
                continue;
            }
            let c = self.index(corner)?;
            if let [Some(a), Some(b)] = last {
                self.triangle(if is_turned { [b, a, c] } else { [a, b, c] })?;
                is_turned = !is_turned;
            }
            last = [last[1], Some(c)];
        }
        Ok(())
    }

    pub fn finish(mut self) -> Result<Model, MeshError> {
        let waiting = std::mem::take(&mut self.waiting);
        let mut rest = waiting.as_slice();
        while let Some((&count, more)) = rest.split_first() {
            let Some((corners, next)) = more.split_at_checked(count as usize) else { break };
            self.cut(corners);
            self.check_size().map_err(|p| p.at(Place::File, "", self.vertices, self.limits))?;
            rest = next;
        }
        let mesh = &mut self.model.mesh;
        mesh.positions.shrink_to_fit();
        mesh.triangles.shrink_to_fit();
        mesh.normals.shrink_to_fit();
        mesh.uvs.shrink_to_fit();
        Ok(self.model)
    }

    fn cut(&mut self, corners: &[u32]) {
        let mesh = &mut self.model.mesh;
        if let &[a, b, c] = corners {
            mesh.triangles.push([a, b, c]);
            return;
        }
        self.polygon.clear();
        let place = |&i: &u32| mesh.positions.get(i as usize).copied().unwrap_or_default();
        self.polygon.extend(corners.iter().map(place));
        cut::cut(&self.polygon, |t| mesh.triangles.push(t.map(|i| corners[i])));
    }

    fn check_size(&self) -> Result<(), Problem> {
        let mesh = &self.model.mesh;
        let used = bytes_of(mesh.positions.len(), self.bytes_per_vertex, mesh.triangles.len());
        if used + self.waiting.len() as u64 * 4 > self.limits.bytes {
            return Err(Problem::TooLarge);
        }
        Ok(())
    }

    /// A problem as an error about a record.
    pub fn error(&self, problem: Problem, place: Place, record: &str) -> MeshError {
        problem.at(place, record, self.vertices, self.limits)
    }
}

/// Why a record does not fit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Problem {
    /// This.
    Text(String),
    /// It names a vertex that is not there.
    NoVertex(i64),
    /// The mesh gets larger than is allowed.
    TooLarge,
}

impl Problem {
    fn at(self, place: Place, record: &str, vertices: u32, limits: &Limits) -> MeshError {
        match self {
            Self::NoVertex(index) => {
                let there = match vertices {
                    0 => "the file has none".to_string(),
                    n => format!("they count from 0 to {}", n - 1),
                };
                MeshError::new(place, format!("{record} names vertex {index}, but {there}"))
            }
            Self::Text(why) => MeshError::new(place, format!("{record}: {why}")),
            Self::TooLarge => too_large(place, limits),
        }
    }
}
