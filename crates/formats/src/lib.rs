// SPDX-License-Identifier: MIT OR Apache-2.0
//! Readers and writers of scenes.

#![forbid(unsafe_code)]

pub mod report;
