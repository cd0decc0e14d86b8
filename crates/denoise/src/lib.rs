// SPDX-License-Identifier: MIT OR Apache-2.0
//! Takes the noise out of pictures, guided by what the camera's rays hit first.
//!
//! [`oidn`] asks Intel Open Image Denoise, which is looked for when it is wanted and is no part of this program;
//! [`plain`] is a filter of our own, with the same bits on every machine. Both invent: where a picture had noise they
//! show what is likely, and a denoised picture is no longer an unbiased one.

pub mod oidn;
pub mod plain;

/// A picture in linear light, and what was hit first; all row by row, `width * height` each.
#[derive(Clone, Copy, Debug)]
pub struct Picture<'a> {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Linear light.
    pub color: &'a [[f32; 3]],
    /// The surfaces' own colour, zero where nothing was hit.
    pub albedo: &'a [[f32; 3]],
    /// Normals, zero where nothing was hit.
    pub normal: &'a [[f32; 3]],
    /// Distances, infinite where nothing was hit.
    pub depth: &'a [f32],
}

impl Picture<'_> {
    /// Whether all lists have as many entries as there are pixels.
    #[must_use]
    pub fn is_whole(&self) -> bool {
        let count = self.width.checked_mul(self.height);
        count.is_some_and(|count| {
            count > 0
                && self.color.len() == count
                && self.albedo.len() == count
                && self.normal.len() == count
                && self.depth.len() == count
        })
    }
}
