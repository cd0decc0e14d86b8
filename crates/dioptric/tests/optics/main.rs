// SPDX-License-Identifier: MIT OR Apache-2.0
//! Light against formulas: every test goes the whole way from a scene's text to the tree of rays that `why`
//! shows, and checks the sums of every tree.

#![allow(clippy::disallowed_methods)] // the standard library's functions are the other opinion

mod glass;
mod invariance;
mod mesh;
mod mirror;
mod overlap;
mod parts;
mod shadow;
#[path = "../support/mod.rs"]
mod support;
mod why;
