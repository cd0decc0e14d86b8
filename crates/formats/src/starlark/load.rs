// SPDX-License-Identifier: MIT OR Apache-2.0
//! Evaluates a scene's file and the files that it loads.

use std::cell::RefCell;
use std::collections::BTreeMap;

use dioptric_scene::{Diagnostic, Loader, Vocabulary, suggest};
use starlark::environment::{FrozenModule, Globals, Module};
use starlark::eval::{Evaluator, FileLoader};
use starlark::syntax::AstModule;
use starlark::{ErrorKind, PrintHandler};

use super::errors::{self, Raised};
use super::state::State;
use super::{DIALECT, MAX_DEPTH, guards};
use crate::options::ReadOptions;
use crate::{ReadError, Reading, conclude, decode, depth};

/// What all files of one scene share.
struct Session<'a> {
    state: &'a State,
    loader: &'a dyn Loader,
    globals: Globals,
    vocabulary: &'a Vocabulary,
    /// Files that are loaded, by path.
    modules: RefCell<BTreeMap<String, FrozenModule>>,
    /// Files that are being loaded, outermost first: the scene itself is the first.
    open: RefCell<Vec<String>>,
}

/// Reads a scene; runs on the reader's thread.
pub(super) fn read_scene(
    path: &str,
    text: String,
    loader: &dyn Loader,
    vocabulary: &Vocabulary,
    options: &ReadOptions,
) -> Result<Reading, ReadError> {
    let state = State::new(options);
    let session = Session {
        state: &state,
        loader,
        globals: super::globals(vocabulary),
        vocabulary,
        modules: RefCell::default(),
        open: RefCell::new(vec![path.to_string()]),
    };
    let result = Module::with_temp_heap(|module| session.evaluate(path, text, &module));
    drop(session);
    if let Err(error) = result
        && let Some(diagnostic) = errors::diagnose(&error, &state)
    {
        state.build().record(diagnostic);
    }
    let (mut build, params, printed) = state.into_parts();
    if build.diagnostics.is_empty() {
        build.diagnostics.extend(unknown_settings(options, &params));
    }
    build.finish(options);
    conclude(build, params, printed)
}

/// `--set` for names that the scene never asked for.
fn unknown_settings(options: &ReadOptions, params: &[crate::ParamInfo]) -> Vec<Diagnostic> {
    let names = || params.iter().map(|param| param.name.as_str());
    let unknown = options.set.iter().filter(|(name, _)| !names().any(|known| known == name));
    unknown
        .map(|(name, _)| {
            let message = format!("the scene has no parameter \"{name}\" to set");
            let help = match suggest::nearest(name, names()) {
                Some(near) => format!("did you mean \"{near}\"?"),
                None if params.is_empty() => "it has no parameters at all".into(),
                None => format!("it has {}", names().collect::<Vec<_>>().join(", ")),
            };
            Diagnostic::error("unknown-parameter", message).help(help)
        })
        .collect()
}

impl Session<'_> {
    fn evaluate(&self, path: &str, text: String, module: &Module) -> starlark::Result<()> {
        let ast = self.parse(path, text)?;
        // Only a file with unknown names is needed again; a scene's text is small.
        let again = ast.file_span(starlark::codemap::Span::default()).file.source().to_string();
        let print = Printer(self.state);
        let heap = module.heap();
        let mut eval = Evaluator::new(module);
        eval.extra = Some(self.state);
        eval.disable_gc();
        eval.set_loader(self);
        eval.set_print_handler(&print);
        guards::watch(&mut eval, &again);
        eval.set_check_cancelled(Box::new(move || self.state.count_steps(heap.allocated_bytes())));
        let depth = self.state.limits().depth.clamp(1, MAX_DEPTH);
        eval.set_max_callstack_size(depth.saturating_add(2))
            .map_err(|error| Raised::error("internal", error.to_string()))?;
        let result = eval.eval_module(ast, &self.globals).map(|_| ());
        drop(eval);
        match result {
            Err(error) if matches!(error.kind(), ErrorKind::Scope(_)) => {
                Err(self.unknown_names(path, again, module, error))
            }
            other => other,
        }
    }

    fn parse(&self, path: &str, text: String) -> starlark::Result<AstModule> {
        if let Err(deep) = depth::check(&text) {
            let mut build = self.state.build();
            let file = build.description.sources.add(path, text);
            let (start, end) = (deep.at as u32, deep.at as u32 + 1);
            let message = format!("too many {} within one another", deep.what);
            return Err(Raised::with(
                Diagnostic::error("too-nested", message)
                    .at(dioptric_scene::Span { file, start, end }, "")
                    .help("give the parts names and put them together in a further line"),
            ));
        }
        match AstModule::parse(path, text.clone(), &DIALECT) {
            Ok(mut ast) => {
                guards::rewrite(&mut ast);
                let code = ast.file_span(starlark::codemap::Span::default()).file;
                self.state.add_file(path, &code);
                Ok(ast)
            }
            Err(error) => {
                match error.span() {
                    Some(place) => self.state.add_file(path, &place.file),
                    None => self.state.build().description.sources.add(path, text),
                };
                Err(error)
            }
        }
    }

    /// All unknown names of a file at once, instead of the first.
    fn unknown_names(
        &self,
        path: &str,
        text: String,
        module: &Module,
        error: starlark::Error,
    ) -> starlark::Error {
        let Ok(ast) = AstModule::parse(path, text, &DIALECT) else { return error };
        let own: Vec<String> = module.names().map(|name| name.as_str().to_string()).collect();
        let Some(place) = error.span().map(|span| self.state.span(span)) else { return error };
        let found = errors::unknown_names(&ast, &self.globals, self.vocabulary, &own, place.file);
        if found.is_empty() {
            return error;
        }
        let mut build = self.state.build();
        for diagnostic in found {
            build.record(diagnostic);
        }
        Raised::enough()
    }

    fn load_file(&self, written: &str) -> starlark::Result<FrozenModule> {
        let path = self.open.borrow().last().map_or(written.into(), |from| beside(from, written));
        if let Some(module) = self.modules.borrow().get(&path) {
            return Ok(module.clone());
        }
        if self.open.borrow().contains(&path) {
            return Err(Raised::with(
                Diagnostic::error("load-cycle", format!("{path} loads itself"))
                    .help("move what both files need to a third"),
            ));
        }
        if self.open.borrow().len() > 50 {
            return Err(Raised::error("too-deep", "more than 50 files load one another"));
        }
        if !path.ends_with(".star") {
            return Err(Raised::with(
                Diagnostic::error("unknown-format", format!("{path} is no scene file to load"))
                    .help("load() takes files whose names end in .star"),
            ));
        }
        let bytes = self.loader.read(&path).map_err(|error| Raised::with(error.diagnostic()))?;
        let text = decode(&path, bytes, &self.state.options).map_err(|error| {
            error.diagnostics.into_iter().next().map_or_else(Raised::enough, Raised::with)
        })?;
        self.open.borrow_mut().push(path.clone());
        let defining = std::mem::replace(&mut self.state.build().only_define, true);
        let result = Module::with_temp_heap(|module| {
            self.evaluate(&path, text, &module)?;
            module.freeze().map_err(|error| Raised::error("internal", format!("{error:?}")))
        });
        self.state.build().only_define = defining;
        self.open.borrow_mut().pop();
        let module = result.map_err(|error| {
            // The error tells its own place, in the file that is loaded.
            errors::diagnose(&error, self.state).map_or_else(Raised::enough, Raised::with)
        })?;
        self.modules.borrow_mut().insert(path, module.clone());
        Ok(module)
    }
}

impl FileLoader for Session<'_> {
    fn load(&self, path: &str) -> starlark::Result<FrozenModule> {
        self.load_file(path)
    }
}

/// A path that the file `from` writes, relative to the scene's folder.
fn beside(from: &str, written: &str) -> String {
    let mut parts: Vec<&str> = match from.rsplit_once('/') {
        Some((folder, _)) if !written.starts_with('/') => folder.split('/').collect(),
        _ => Vec::new(),
    };
    for part in written.split('/') {
        match part {
            "." => {}
            ".." if parts.last().is_some_and(|last| *last != ".." && !last.is_empty()) => {
                parts.pop();
            }
            other => parts.push(other),
        }
    }
    parts.join("/")
}

/// Keeps what the scene prints.
struct Printer<'a>(&'a State);

impl PrintHandler for Printer<'_> {
    fn println(&self, text: &str) -> starlark::Result<()> {
        self.0.print(text);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::beside;

    #[test]
    fn loaded_paths_are_relative_to_the_file_that_names_them() {
        assert_eq!(beside("scene.star", "lib/a.star"), "lib/a.star");
        assert_eq!(beside("lib/a.star", "b.star"), "lib/b.star");
        assert_eq!(beside("lib/a.star", "./../b.star"), "b.star");
        assert_eq!(beside("a.star", "../b.star"), "../b.star");
        assert_eq!(beside("lib/a.star", "/b.star"), "/b.star");
    }
}
