// SPDX-License-Identifier: MIT OR Apache-2.0
//! Every way of looking for light finds each part of it as often as it says, and says how often for each part that it
//! finds.

mod irradiance;
mod lamps;
mod maker;
mod many;
mod patches;
mod rays;
mod sky;
