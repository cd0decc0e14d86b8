// SPDX-License-Identifier: MIT OR Apache-2.0
//! Wavefront OBJ ("Object Files", Advanced Visualizer manual, appendix B1, 1992): the polygons in it.
//!
//! `v`, `vt`, `vn` and `f` are read, with every form of index: `1`, `1/2`, `1//3`, `1/2/3`, and negative ones that
//! count back from the last. Lines that end in `\` go on in the next. Normals and
//! surface coordinates that a face names where the file has none are taken as not given. Groups, materials, smoothing groups,
//! curves, lines and points are passed over, as are words that are not known: many programs add their own.

mod corners;

use std::borrow::Cow;

use crate::error::MeshError;
use crate::feed::Feed;
use crate::number::{Words, integer, is_space, shown};
use crate::{Limits, Model, bytes_of, cut, too_large};
use corners::{Corner, Corners, NONE};

/// Lines that one line may go on over.
const MAX_CONTINUED: usize = 1 << 24;

#[derive(Default)]
struct Reader {
    positions: Vec<[f32; 3]>,
    uvs: Vec<[f32; 2]>,
    normals: Vec<[f32; 3]>,
    corners: Corners,
    triangles: Vec<[u32; 3]>,
    /// The corners of one face, their numbers and places.
    face: Vec<u32>,
    polygon: Vec<[f32; 3]>,
}

/// Reads an OBJ file.
pub fn read(feed: &mut Feed, limits: &Limits) -> Result<Model, MeshError> {
    let mut reader = Reader::default();
    let mut joined: Vec<u8> = Vec::new();
    while let Some(line) = feed.line()? {
        let mut line = Cow::Borrowed(line);
        if line.last() == Some(&b'\\') {
            joined.clear();
            joined.extend_from_slice(&line);
            while joined.last() == Some(&b'\\') && joined.len() < MAX_CONTINUED {
                joined.pop();
                joined.push(b' ');
                joined.extend_from_slice(feed.line()?.unwrap_or_default());
            }
            line = Cow::Borrowed(joined.as_slice());
        }
        if let Err(why) = reader.line(&line) {
            return Err(MeshError::new(feed.line_place(), why));
        }
        if reader.bytes() > limits.bytes {
            return Err(too_large(feed.line_place(), limits));
        }
    }
    if reader.positions.is_empty() {
        let message = "the file has no line that starts with v, so it is no mesh";
        return Err(MeshError::new(feed.line_place(), message)
            .help("see whether the file is an OBJ file, or export it again"));
    }
    Ok(Model { mesh: reader.finish(), radii: Vec::new() })
}

impl Reader {
    fn line(&mut self, line: &[u8]) -> Result<(), String> {
        let mut words = Words(line);
        if !words.more() {
            return Ok(());
        }
        match words.0 {
            [b'v', next, ..] if is_space(*next) => {
                words.word();
                let [x, y, z] = numbers(words, "v", 3)?;
                self.positions.push([x, y, z]);
            }
            [b'f', next, ..] if is_space(*next) => {
                words.word();
                self.face(words)?;
            }
            [b'v', b'n', next, ..] if is_space(*next) => {
                words.word();
                let [x, y, z] = numbers(words, "vn", 3)?;
                self.normals.push([x, y, z]);
            }
            [b'v', b't', next, ..] if is_space(*next) => {
                words.word();
                // One number suffices for a curve's texture; v is 0 then.
                let [u, v, _] = numbers(words, "vt", 1)?;
                self.uvs.push([u, v]);
            }
            [b'v'] => return Err("expected three numbers after v, got 0".into()),
            _ => {}
        }
        Ok(())
    }

    fn face(&mut self, mut words: Words) -> Result<(), String> {
        self.face.clear();
        while words.more() {
            if words.0.first() == Some(&b'#') {
                break;
            }
            let corner = self.corner(&mut words)?;
            let is_plain = corner.uv == NONE && corner.normal == NONE;
            if !is_plain && !self.corners.are_needed() {
                let used = !self.triangles.is_empty() || !self.face.is_empty();
                if used {
                    self.corners.keep_plain(self.positions.len() as u32);
                }
            }
            self.face.push(self.corners.number(corner, self.positions.len()));
        }
        if let [a, b, c] = self.face.as_slice() {
            self.triangles.push([*a, *b, *c]);
            return Ok(());
        }
        let (corners, positions) = (&self.corners, &self.positions);
        self.polygon.clear();
        self.polygon.extend(self.face.iter().map(|&number| {
            let position = match corners.list.get(number as usize) {
                Some(corner) if corners.are_needed() => corner.position,
                _ => number,
            };
            positions.get(position as usize).copied().unwrap_or_default()
        }));
        let (face, triangles) = (&self.face, &mut self.triangles);
        cut::cut(&self.polygon, |t| triangles.push(t.map(|i| face[i])));
        Ok(())
    }

    /// The next corner of a face: `1`, `1/2`, `1//3` or `1/2/3`.
    fn corner(&self, words: &mut Words) -> Result<Corner, String> {
        let whole = *words;
        let wrong = || {
            let word = shown({ whole }.word().unwrap_or_default());
            format!("expected a corner such as 1, 1/2, 1//3 or 1/2/3, got {word}")
        };
        let mut rest = words.0;
        let mut indices = [NONE; 3];
        let names = ["v", "vt", "vn"];
        let counts = [self.positions.len(), self.uvs.len(), self.normals.len()];
        for (place, index) in indices.iter_mut().enumerate() {
            match integer(rest) {
                Some((number, length)) => {
                    rest = rest.get(length..).unwrap_or_default();
                    // Some programs name normals or surface coordinates and then write none.
                    if place == 0 || counts[place] > 0 {
                        *index = resolve(number, counts[place], names[place])?;
                    }
                }
                // Only the middle one may be left out, or the last ones with their strokes.
                None if place == 0 => return Err(wrong()),
                None => {}
            }
            match rest {
                [b'/', more @ ..] if place < 2 => rest = more,
                [] => break,
                [next, ..] if is_space(*next) => break,
                _ => return Err(wrong()),
            }
        }
        words.0 = rest;
        let [position, uv, normal] = indices;
        Ok(Corner { position, uv, normal })
    }

    /// How much memory the mesh takes.
    fn bytes(&self) -> u64 {
        let sources = bytes_of(self.positions.len() + self.normals.len() + self.uvs.len(), 12, 0);
        // A corner of its own becomes a position, a normal and surface coordinates.
        sources + bytes_of(self.corners.list.len(), 16 + 32, self.triangles.len())
    }

    fn finish(self) -> dioptric_geometry::MeshData {
        let Self { mut positions, uvs, normals, corners, mut triangles, .. } = self;
        triangles.shrink_to_fit();
        if !corners.are_needed() {
            positions.shrink_to_fit();
            return dioptric_geometry::MeshData { positions, triangles, ..Default::default() };
        }
        let list = &corners.list;
        let has_uvs = list.iter().any(|c| c.uv != NONE);
        let has_normals = list.iter().any(|c| c.normal != NONE);
        fn gather<T: Copy + Default>(
            list: &[Corner],
            is_there: bool,
            of: &[T],
            index: impl Fn(&Corner) -> u32,
        ) -> Vec<T> {
            let value = |c| of.get(index(c) as usize).copied().unwrap_or_default();
            if is_there { list.iter().map(value).collect() } else { Vec::new() }
        }
        dioptric_geometry::MeshData {
            positions: gather(list, true, &positions, |c| c.position),
            triangles,
            normals: gather(list, has_normals, &normals, |c| c.normal),
            uvs: gather(list, has_uvs, &uvs, |c| c.uv),
        }
    }
}

/// Up to three numbers, at least `least`; what comes after (weights, colours) is passed over.
fn numbers(mut words: Words, keyword: &str, least: usize) -> Result<[f32; 3], String> {
    let mut values = [0.0; 3];
    for (i, value) in values.iter_mut().enumerate() {
        match words.f32() {
            Some(Ok(x)) => *value = x,
            Some(Err(word)) if word.starts_with(b"#") && i >= least => break,
            Some(Err(word)) => {
                return Err(format!("expected a number after {keyword}, got {}", shown(word)));
            }
            None if i >= least => break,
            None => {
                let many = if least == 1 { "a number" } else { "three numbers" };
                return Err(format!("expected {many} after {keyword}, got {i}"));
            }
        }
    }
    Ok(values)
}

/// The index, from 0, that a number in a file stands for.
fn resolve(number: i64, count: usize, keyword: &str) -> Result<u32, String> {
    let index = if number > 0 { number - 1 } else { number + count as i64 };
    if number != 0 && (0..count as i64).contains(&index) && index < i64::from(NONE) {
        return Ok(index as u32);
    }
    if number == 0 {
        return Err(format!("the face names {keyword} 0, but they count from 1"));
    }
    Err(match count {
        0 => format!(
            "the face names {keyword} {number}, but no line before it starts with {keyword}"
        ),
        n => format!("the face names {keyword} {number}, but only {n} come before it"),
    })
}
