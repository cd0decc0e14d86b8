// SPDX-License-Identifier: MIT OR Apache-2.0
//! Where samples lie: in pixels, on lenses, on lights. Pure functions of (pixel, sample, seed).

pub mod warp;
