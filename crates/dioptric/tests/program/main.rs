// SPDX-License-Identifier: MIT OR Apache-2.0
//! The program, run as a user runs it: exit statuses, messages, files, and the promises about them.

#![allow(clippy::disallowed_methods, missing_docs)] // tests may use the system's functions

mod animation;
mod commands;
mod corpus;
mod degenerate;
mod denoise;
mod determinism;
mod interruption;
mod long;
mod output;
mod run;
mod trace;
mod until;
mod why;
