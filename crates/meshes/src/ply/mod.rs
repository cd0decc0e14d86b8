// SPDX-License-Identifier: MIT OR Apache-2.0
//! PLY, the Stanford polygon format (Greg Turk, 1994): a header that says what follows, then the records,
//! as text or as binary data of either byte order.
//!
//! Of the element `vertex` these properties are read, of any type: `x y z`; `nx ny nz`; surface coordinates
//! `u v`, `s t`, `texture_u texture_v` or `texture_s texture_t` (whole numbers of 8 and 16 bits stand for 0 to
//! 1); `radius`. Of `face` the list `vertex_indices` or `vertex_index`, of `tristrips` the same, where -1 starts a
//! new strip. All else is skipped. Elements may come in any order.

mod ascii;
mod binary;
mod collect;
mod header;

use crate::error::{MeshError, Place};
use crate::feed::Feed;
use crate::number::shown;
use crate::{Limits, Model};
use collect::Collector;
use header::{Element, Encoding};

/// What a property of a vertex is for: an index into the numbers of one vertex.
type Role = usize;

/// Numbers of a vertex: place, normal, surface coordinates, radius.
const NUMBERS: usize = 9;

/// The spellings of each number.
const NAMES: [&[&str]; NUMBERS] = [
    &["x"],
    &["y"],
    &["z"],
    &["nx", "normal_x"],
    &["ny", "normal_y"],
    &["nz", "normal_z"],
    &["u", "s", "texture_u", "texture_s"],
    &["v", "t", "texture_v", "texture_t"],
    &["radius"],
];

/// Where a record of the element `vertex` has what.
struct Layout {
    /// A property's index, its role and what its numbers are divided by.
    roles: Vec<(usize, Role, f32)>,
    has_normals: bool,
    has_uvs: bool,
    has_radius: bool,
}

impl Layout {
    fn new(element: &Element) -> Result<Self, String> {
        let find = |role: Role| {
            let names = NAMES.get(role).copied().unwrap_or_default();
            let found = names.iter().find_map(|name| element.property(name));
            let (index, property) = found.filter(|(_, p)| p.count.is_none())?;
            let one = if role == 6 || role == 7 { property.item.one() } else { 1.0 };
            Some((index, role, one))
        };
        let mut roles = Vec::new();
        for (role, name) in ["x", "y", "z"].into_iter().enumerate() {
            let missing = || format!("the element vertex has no property {name}");
            roles.push(find(role).ok_or_else(missing)?);
        }
        let mut optional = |range: std::ops::Range<Role>| {
            let all: Option<Vec<_>> = range.map(find).collect();
            let is_there = all.is_some();
            roles.extend(all.unwrap_or_default());
            is_there
        };
        let has_normals = optional(3..6);
        let has_uvs = optional(6..8);
        let has_radius = optional(8..9);
        Ok(Self { roles, has_normals, has_uvs, has_radius })
    }
}

/// What a reader does with the records of an element.
enum Use {
    Vertices(Layout),
    /// Faces or strips: the index of the property that lists their corners.
    Corners {
        list: usize,
        is_strip: bool,
    },
    Nothing,
}

impl Use {
    fn of(element: &Element) -> Result<Self, String> {
        match element.name.as_str() {
            "vertex" => Layout::new(element).map(Self::Vertices),
            "face" | "tristrips" => {
                let found = ["vertex_indices", "vertex_index"]
                    .iter()
                    .find_map(|name| element.property(name))
                    .filter(|(_, p)| p.count.is_some() && p.item.is_whole());
                match found {
                    Some((list, _)) => {
                        Ok(Self::Corners { list, is_strip: element.name == "tristrips" })
                    }
                    None if element.count == 0 => Ok(Self::Nothing),
                    None => Err(format!(
                        "the element {} has no list vertex_indices of whole numbers",
                        element.name
                    )),
                }
            }
            _ => Ok(Self::Nothing),
        }
    }
}

/// Reads a PLY file.
pub fn read(feed: &mut Feed, limits: &Limits) -> Result<Model, MeshError> {
    let (encoding, elements) = header::read(feed)?;
    let in_header = |message: String| {
        MeshError::new(Place::File, message).help("export the mesh with these in its header")
    };
    let Some(vertices) = elements.iter().find(|e| e.name == "vertex") else {
        return Err(in_header("the header has no element vertex".into()));
    };
    let mut collector = Collector::new(vertices.count, limits)?;
    let purposes: Vec<Use> =
        elements.iter().map(Use::of).collect::<Result<_, _>>().map_err(in_header)?;
    let mut are_vertices_read = false;
    for (element, purpose) in elements.iter().zip(purposes) {
        let purpose = match purpose {
            // Of several only the first counts.
            Use::Vertices(_) if are_vertices_read => Use::Nothing,
            purpose => purpose,
        };
        are_vertices_read |= matches!(purpose, Use::Vertices(_));
        // Records of nothing take no lines and no bytes, however many there are.
        if element.properties.is_empty() {
            continue;
        }
        match encoding {
            Encoding::Ascii => ascii::read(feed, element, &purpose, &mut collector)?,
            Encoding::Little => binary::read(feed, element, false, &purpose, &mut collector)?,
            Encoding::Big => binary::read(feed, element, true, &purpose, &mut collector)?,
        }
    }
    collector.finish()
}

/// The record of an element that is being read, for messages: `face 3 of 12`.
fn record_name(element: &Element, index: u64) -> String {
    format!("{} {} of {}", shown(element.name.as_bytes()), index + 1, element.count)
}
