// SPDX-License-Identifier: MIT OR Apache-2.0
//! Tests of the readers through their public face, with a vocabulary of their own.

mod common;
mod json;
mod language;
mod mutations;
