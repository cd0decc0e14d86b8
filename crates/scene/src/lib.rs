// SPDX-License-Identifier: MIT OR Apache-2.0
//! What a scene is, as plain data, before anything is rendered.
//!
//! A reader of some format (Starlark, JSON, NFF) fills a [`Description`]: a tree of [`Node`]s, each
//! made from a [`Schema`] and remembering the [`Span`] of the text that made it. This crate checks
//! a node against its schema and hands typed arguments to the code that builds the real thing
//! ([`Args`]). It knows no single shape or material and renders nothing; its only I/O is the
//! [`loader`], through which all crates read files. Everything that is wrong becomes a
//! [`Diagnostic`].

#![forbid(unsafe_code)]

pub mod args;
pub mod check;
pub mod color;
pub mod description;
pub mod diagnostic;
pub mod loader;
mod locate;
pub mod schema;
pub mod source;
pub mod suggest;
pub mod validate;
pub mod value;
pub mod vocabulary;

pub use args::Args;
pub use description::{Description, Node, NodeId, StackFrame, StackId};
pub use diagnostic::{Diagnostic, Label, Severity};
pub use loader::{FolderLoader, LoadError, Loader, MemoryLoader};
pub use schema::{Category, Default, Param, Schema, Type};
pub use source::{FileId, Source, Sources, Span};
pub use value::Value;
pub use vocabulary::Vocabulary;
