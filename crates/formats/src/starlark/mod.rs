// SPDX-License-Identifier: MIT OR Apache-2.0
//! The scene language: Starlark with one constructor for every kind of the vocabulary.
//!
//! The evaluator runs on a thread of its own, whose stack is as large as the limit on depth needs.
//! A constructor's call adds a node to the description that is being built (`state`) and returns a
//! handle to it. Garbage is not collected: a scene is short-lived, its memory is limited, and the
//! collector would call itself for every level of a nested list.

#[expect(
    unsafe_code,
    reason = "derive(ProvidesStaticType) writes an unsafe impl; there is no other"
)]
mod constructor;
mod convert;
mod errors;
#[expect(
    unsafe_code,
    reason = "derive(ProvidesStaticType) writes an unsafe impl; there is no other"
)]
mod guards;
mod load;
mod math;
mod params;
#[expect(
    unsafe_code,
    reason = "derive(ProvidesStaticType) writes an unsafe impl; there is no other"
)]
mod random;
mod rephrase;
#[expect(
    unsafe_code,
    reason = "derive(ProvidesStaticType) writes an unsafe impl; there is no other"
)]
mod state;

use dioptric_scene::{Diagnostic, Loader, Sources, Vocabulary};
use starlark::environment::{Globals, GlobalsBuilder, LibraryExtension};
use starlark::syntax::{Dialect, DialectTypes};

use crate::options::ReadOptions;
use crate::{ReadError, Reading};

/// Python's syntax as people know it: `for` and `if` at top level, f-strings, lambdas.
const DIALECT: Dialect = Dialect {
    enable_def: true,
    enable_lambda: true,
    enable_load: true,
    enable_keyword_only_arguments: true,
    enable_positional_only_arguments: true,
    enable_types: DialectTypes::ParseOnly,
    enable_load_reexport: false,
    enable_top_level_stmt: true,
    enable_f_strings: true,
    _non_exhaustive: (),
};

/// Stack for the parser and the evaluator, without the scene's own calls.
const BASE_STACK: usize = 64 << 20;
/// Stack for each level of the scene's own calls.
const STACK_PER_CALL: usize = 8 << 10;
/// Deepest calls that can be asked for.
const MAX_DEPTH: usize = 50_000;

/// Reads a scene in the scene language.
pub(crate) fn read(
    path: &str,
    text: String,
    loader: &dyn Loader,
    vocabulary: &Vocabulary,
    options: &ReadOptions,
) -> Result<Reading, ReadError> {
    let fail = |message: &str| {
        Err(ReadError::new(Sources::default(), Diagnostic::error("internal", message)))
    };
    let stack = BASE_STACK + options.limits.depth.min(MAX_DEPTH) * STACK_PER_CALL;
    std::thread::scope(|scope| {
        let thread = std::thread::Builder::new().name("scene".into()).stack_size(stack);
        let work = || load::read_scene(path, text, loader, vocabulary, options);
        match thread.spawn_scoped(scope, work).map(|handle| handle.join()) {
            Ok(Ok(result)) => result,
            Ok(Err(_)) => fail("the reader of scenes failed on this one; please report it"),
            Err(_) => fail("there is no memory for the stack of the scene's reader"),
        }
    })
}

/// All names that a scene can use without making them.
fn globals(vocabulary: &Vocabulary) -> Globals {
    let mut builder = GlobalsBuilder::extended_by(&[
        LibraryExtension::StructType,
        LibraryExtension::Map,
        LibraryExtension::Filter,
        LibraryExtension::Print,
    ]);
    math::register(&mut builder);
    guards::register(&mut builder);
    params::register(&mut builder);
    random::register(&mut builder);
    for schema in vocabulary.iter() {
        builder.set(schema.kind, constructor::Constructor::new(schema));
    }
    builder.build()
}

/// The names of the scene language besides the vocabulary's, sorted: `abs`, `acos`, ... No kind may
/// have one of them.
#[must_use]
pub fn functions() -> Vec<String> {
    let globals = globals(&Vocabulary::default());
    let names = globals.names().map(|name| name.as_str().to_string());
    names.filter(|name| name.starts_with(char::is_alphabetic)).collect()
}
