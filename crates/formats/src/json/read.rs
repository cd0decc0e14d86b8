// SPDX-License-Identifier: MIT OR Apache-2.0
//! Reads the expanded form.

use std::collections::HashMap;

use dioptric_scene::{Diagnostic, Loader, NodeId, Span, StackId, Value, Vocabulary, suggest};

use super::VERSION;
use super::scan::{Json, JsonValue, Member, Scanner};
use crate::build::Build;
use crate::call::{Call, Kind};
use crate::options::ReadOptions;
use crate::{ReadError, Reading, conclude};

/// Why reading stops: an error to record, or nothing where enough were recorded.
type Stop = Option<Box<Diagnostic>>;

fn stop(diagnostic: Diagnostic) -> Stop {
    Some(Box::new(diagnostic))
}

/// Reads a scene in the expanded form.
pub(crate) fn read(
    path: &str,
    text: String,
    _loader: &dyn Loader,
    vocabulary: &Vocabulary,
    options: &ReadOptions,
) -> Result<Reading, ReadError> {
    let mut build = Build::default();
    let file = build.description.sources.add(path, text.as_str());
    let mut reader = Reader {
        build,
        kinds: vocabulary.iter().map(|schema| (schema.kind, Kind::new(schema))).collect(),
        ids: HashMap::new(),
        options,
    };
    if let Err(Some(error)) = reader.document(&mut Scanner::new(&text, file)) {
        reader.build.record(*error);
    }
    let mut build = reader.build;
    if let Some((name, _)) = options.set.first() {
        let message = format!("--set {name}: a JSON scene has no parameters");
        build.diagnostics.push(Diagnostic::error("unknown-parameter", message));
    }
    build.finish(options);
    conclude(build, Vec::new(), Vec::new())
}

struct Reader<'a> {
    build: Build,
    kinds: HashMap<&'static str, Kind>,
    ids: HashMap<String, NodeId>,
    options: &'a ReadOptions,
}

impl Reader<'_> {
    fn document(&mut self, scanner: &mut Scanner) -> Result<(), Stop> {
        scanner.want(b'{').map_err(stop)?;
        let mut first = true;
        let (mut version, mut scene) = (None, false);
        while scanner.next_item(&mut first, b'}').map_err(stop)? {
            let (key, key_span) = scanner.key().map_err(stop)?;
            match key.as_str() {
                "dioptric" => {
                    let value = scanner.value().map_err(stop)?;
                    version = Some(value.span);
                    if value.value != JsonValue::Number(VERSION) {
                        return Err(stop(
                            Diagnostic::error(
                                "version",
                                "this program reads version 1 of the format",
                            )
                            .at(value.span, ""),
                        ));
                    }
                }
                "scene" => {
                    scene = true;
                    self.roots(scanner)?;
                }
                _ => {
                    let near = suggest::nearest(&key, ["dioptric", "scene"]);
                    let error = Diagnostic::error("unknown-key", format!("unknown key \"{key}\""))
                        .at(key_span, "");
                    self.build.record(match near {
                        Some(near) => error.help(format!("did you mean \"{near}\"?")),
                        None => error.help("the keys are \"dioptric\" and \"scene\""),
                    });
                    scanner.value().map_err(stop)?;
                }
            }
        }
        scanner.end().map_err(stop)?;
        for (there, key) in [(version.is_some(), "\"dioptric\": 1"), (scene, "\"scene\": [...]")] {
            if !there && self.build.diagnostics.is_empty() {
                let message = format!("the file lacks {key}");
                return Err(stop(
                    Diagnostic::error("missing-key", message).at(scanner.span(0, 1), ""),
                ));
            }
        }
        Ok(())
    }

    /// The list of roots, one at a time, so that a large scene is not held twice.
    fn roots(&mut self, scanner: &mut Scanner) -> Result<(), Stop> {
        scanner.want(b'[').map_err(stop)?;
        let mut first = true;
        while scanner.next_item(&mut first, b']').map_err(stop)? {
            let json = scanner.value().map_err(stop)?;
            let id = self.node(&json)?;
            let category = self.build.description.node(id).schema.category;
            if !category.enters_scene() {
                let kind = self.build.description.node(id).schema.kind;
                let message = format!("the {} {kind} is not in a scene by itself", category.name());
                let error = Diagnostic::error("wrong-place", message).at(json.span, "");
                self.record(error)?;
            }
        }
        Ok(())
    }

    fn record(&mut self, error: Diagnostic) -> Result<(), Stop> {
        if self.build.record(error) { Ok(()) } else { Err(None) }
    }

    /// An object with a kind, or a reference to one.
    fn node(&mut self, json: &Json) -> Result<NodeId, Stop> {
        let JsonValue::Object(members) = &json.value else {
            let message = format!("expected an object with a kind, got {}", json.value.describe());
            return Err(stop(Diagnostic::error("wrong-value", message).at(json.span, "")));
        };
        if let [Member { key, value, .. }] = members.as_slice()
            && key == "ref"
        {
            let id = id_text(value)?;
            return self.ids.get(&id).copied().ok_or_else(|| {
                let message = format!("there is no id {id} before this");
                stop(Diagnostic::error("unknown-id", message).at(value.span, ""))
            });
        }
        let schema_kind = self.kind_of(json.span, members)?;
        let (mut call, mut own_id) = (Call::default(), None);
        for Member { key, value, .. } in members {
            match key.as_str() {
                "kind" => {}
                "id" => own_id = Some((id_text(value)?, value.span)),
                _ => {
                    let value = self.value(value)?;
                    if let Some(kind) = self.kinds.get(schema_kind) {
                        kind.bind_named(&mut call, key, value);
                    }
                }
            }
        }
        let limit = self.options.limits.objects;
        if self.build.description.nodes.len() >= limit {
            let message = format!("the scene has more than {limit} objects");
            return Err(stop(
                Diagnostic::error("too-many-objects", message)
                    .help("--max-objects raises the limit"),
            ));
        }
        let Some(kind) = self.kinds.get(schema_kind) else { return Err(None) };
        let (node, go_on) = kind.finish(call, &mut self.build, json.span, StackId::TOP);
        if !go_on {
            return Err(None);
        }
        if let Some((id, span)) = own_id
            && self.ids.insert(id.clone(), node).is_some()
        {
            let message = format!("the id {id} is given twice");
            self.record(Diagnostic::error("repeated-id", message).at(span, ""))?;
        }
        Ok(node)
    }

    fn kind_of(&self, span: Span, members: &[Member]) -> Result<&'static str, Stop> {
        let Some(member) = members.iter().find(|member| member.key == "kind") else {
            return Err(stop(
                Diagnostic::error("missing-kind", "the object has no kind")
                    .at(span, "")
                    .help("write \"kind\": \"sphere\", or \"ref\": id alone"),
            ));
        };
        let place = member.value.span;
        let JsonValue::Text(word) = &member.value.value else {
            let message =
                format!("expected the name of a kind, got {}", member.value.value.describe());
            return Err(stop(Diagnostic::error("wrong-value", message).at(place, "")));
        };
        match self.kinds.get(word.as_str()) {
            Some(kind) => Ok(kind.schema.kind),
            None => {
                let error =
                    Diagnostic::error("unknown-kind", format!("there is no kind \"{word}\""));
                let mut names: Vec<&str> = self.kinds.keys().copied().collect();
                names.sort_unstable();
                Err(stop(match suggest::nearest(word, names) {
                    Some(near) => error.at(place, "").help(format!("did you mean \"{near}\"?")),
                    None => error.at(place, "").help("`dioptric list` shows all kinds"),
                }))
            }
        }
    }

    /// A value, or what was found instead.
    fn value(&mut self, json: &Json) -> Result<Result<Value, String>, Stop> {
        Ok(Ok(match &json.value {
            JsonValue::Null => return Ok(Err("null; leave the key out".into())),
            JsonValue::Bool(b) => Value::Bool(*b),
            JsonValue::Number(x) => Value::Number(*x),
            JsonValue::Text(text) => Value::Text(text.as_str().into()),
            JsonValue::Object(_) => Value::Node(self.node(json)?),
            JsonValue::List(items) => {
                let mut values = Vec::with_capacity(items.len());
                for item in items {
                    match self.value(item)? {
                        Ok(value) => values.push(value),
                        Err(got) => return Ok(Err(got)),
                    }
                }
                Value::from_items(values)
            }
        }))
    }
}

/// An id, a number or text.
fn id_text(json: &Json) -> Result<String, Stop> {
    match &json.value {
        JsonValue::Number(x) => Ok(x.to_string()),
        JsonValue::Text(text) => Ok(text.clone()),
        other => {
            let message = format!("expected an id, a number or text, got {}", other.describe());
            Err(stop(Diagnostic::error("wrong-value", message).at(json.span, "")))
        }
    }
}
