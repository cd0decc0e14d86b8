// SPDX-License-Identifier: MIT OR Apache-2.0
//! The expanded form of a scene: every node written out, with the vocabulary's own words as keys.
//!
//! ```json
//! {
//!   "dioptric": 1,
//!   "scene": [
//!     {"kind": "camera", "eye": [0, 2, 10], "fov": 35},
//!     {"kind": "sphere", "center": [0, 1, 0], "material": {"kind": "matte", "id": 1, "color": "gold"}},
//!     {"kind": "sphere", "center": [2, 1, 0], "material": {"ref": 1}}
//!   ]
//! }
//! ```
//!
//! `scene` holds the nodes that are in the scene by themselves, in order. A node that several others
//! hold is written where it is met first, with an `id`, and as `{"ref": id}` after that.

mod read;
mod scan;
mod write;

pub(crate) use read::read;
pub use write::write;

/// The version that is written and read.
const VERSION: f64 = 1.0;
