// SPDX-License-Identifier: MIT OR Apache-2.0
//! `manual`: writes the reference chapters of the manual from the code: a page a category from the
//! schemas, with each example rendered, and the page of the command line from its options.

use std::fs;
use std::path::PathBuf;

use clap::CommandFactory;
use dioptric::image::{EncodeOptions, FileFormat, Layers, encode};
use dioptric::render::job::Control;
use dioptric::render::region::Region;
use dioptric::render::{compile, picture, vocabulary};
use dioptric::scene::{Category, FolderLoader, Schema, Sources, Vocabulary};

use super::failure::Failure;
use super::{page, stage, terminal};

/// Writes the reference chapters of the manual.
#[derive(Debug, clap::Args)]
#[command(hide = true)]
pub struct ManualArgs {
    /// The folder of the manual's sources.
    folder: PathBuf,
    /// Writes nothing; fails where a file is not what it would write.
    #[arg(long)]
    check: bool,
    /// The folder below which the examples find their pictures.
    #[arg(long, default_value = "scenes")]
    scenes: PathBuf,
    /// Renders the pictures of these kinds only.
    #[arg(long)]
    only: Vec<String>,
}

/// Writes or checks everything.
pub fn run(args: &ManualArgs) -> Result<(), Failure> {
    let all = vocabulary();
    let mut files = vec![("reference/command-line.md".to_string(), command_line().into_bytes())];
    for category in Category::ALL {
        let text = category_page(&all, category);
        files.push((format!("reference/{}s.md", category.name()), text.into_bytes()));
    }
    let loader = FolderLoader::new(&args.scenes);
    let pool = rayon::ThreadPoolBuilder::new().build().map_err(|e| Failure::File {
        message: format!("cannot start threads: {e}"),
        help: "try again".into(),
    })?;
    for schema in all.iter().filter(|s| !s.example.is_empty()) {
        if args.only.is_empty() || args.only.iter().any(|kind| kind == schema.kind) {
            files.push((picture_name(schema), example_picture(schema, &loader, &pool)?));
        }
    }
    let mut stale = Vec::new();
    for (name, bytes) in files {
        let path = args.folder.join(&name);
        if fs::read(&path).is_ok_and(|old| old == bytes) {
            continue;
        }
        if args.check {
            stale.push(name);
            continue;
        }
        let written =
            path.parent().map_or(Ok(()), fs::create_dir_all).and_then(|()| fs::write(&path, bytes));
        written.map_err(|e| Failure::output(&path.display().to_string(), &e))?;
        terminal::note(&format!("wrote {}\n", path.display()));
    }
    if stale.is_empty() {
        return Ok(());
    }
    Err(Failure::File {
        message: format!("the manual is not what the code says: {}", stale.join(", ")),
        help: format!("run dioptric manual {}", args.folder.display()),
    })
}

fn picture_name(schema: &Schema) -> String {
    format!("pictures/{}.png", schema.kind)
}

/// The bytes of an example's picture.
fn example_picture(
    schema: &Schema,
    loader: &FolderLoader,
    pool: &rayon::ThreadPool,
) -> Result<Vec<u8>, Failure> {
    let description =
        stage::staged(schema, loader).map_err(|e| Failure::Scene(e.diagnostics, e.sources))?;
    let description = std::sync::Arc::new(description);
    let (scene, _) = compile::compile(&description, loader, &compile::Options::default())
        .map_err(|errors| Failure::Scene(errors, description.sources.clone()))?;
    let region = Region::full(scene.settings.size);
    let film = picture::render(&scene, region, pool, &Control::default())
        .map_err(|e| Failure::Scene(vec![e], Sources::default()))?;
    let wrong = |e| Failure::image(&picture_name(schema), &e);
    let layers = Layers::from(film.to_layers(false).map_err(wrong)?.picture);
    let options = EncodeOptions { develop: scene.develop, ..EncodeOptions::default() };
    encode(&layers, FileFormat::Png, &options).map_err(wrong)
}

const NOTICE: &str =
    "<!-- Written by `dioptric manual` from the code: change that, not this file. -->";

fn category_page(all: &Vocabulary, category: Category) -> String {
    let name = category.name();
    let title: String = name[..1].to_uppercase() + &name[1..];
    let mut text = format!("{NOTICE}\n\n# {title}s\n\n| | |\n|---|---|\n");
    for schema in all.of(category) {
        text.push_str(&format!("| [`{0}`](#{0}) | {1} |\n", schema.kind, cell(schema.summary)));
    }
    for schema in all.of(category) {
        text.push_str(&kind_section(schema));
    }
    text
}

fn kind_section(schema: &Schema) -> String {
    let mut text = format!("\n## {}\n\n", schema.kind);
    if !schema.example.is_empty() {
        text.push_str(&format!("![{}](../{})\n\n", schema.summary, picture_name(schema)));
        text.push_str(&format!("```python\n{}\n```\n\n", schema.example));
    }
    text.push_str(&format!(
        "`{}`\n\n{}\n\n",
        page::signature(schema),
        links_from_below(schema.doc)
    ));
    text.push_str("| parameter | takes | meaning |\n|---|---|---|\n");
    for param in schema.all_params() {
        text.push_str(&format!(
            "| `{}` | {} | {} |\n",
            param.name,
            cell(&page::takes(param)),
            cell(&links_from_below(param.doc))
        ));
    }
    text
}

/// A text inside a table.
fn cell(text: &str) -> String {
    text.replace('|', "\\|").replace('\n', " ")
}

/// Schemas link to other chapters as their neighbours; the reference is one folder further down.
fn links_from_below(doc: &str) -> String {
    let mut text = String::new();
    let mut rest = doc;
    while let Some(at) = rest.find("](") {
        let (before, link) = rest.split_at(at + 2);
        text.push_str(before);
        let end = link.find(')').unwrap_or(link.len());
        if link[..end].ends_with(".md") && !link.starts_with("..") && !link[..end].contains("://") {
            text.push_str("../");
        }
        rest = link;
    }
    text.push_str(rest);
    text
}

/// The page of every command's options.
fn command_line() -> String {
    let mut command = super::Cli::command().term_width(100);
    command.build();
    let mut text = format!("{NOTICE}\n\n# Command line\n\n```text\n{}```\n", help(&mut command));
    for sub in command.get_subcommands_mut().filter(|c| !c.is_hide_set() && c.get_name() != "help")
    {
        let name = sub.get_name().to_string();
        text.push_str(&format!("\n## {name}\n\n```text\n{}```\n", help(sub)));
    }
    text
}

fn help(command: &mut clap::Command) -> String {
    let text = command.render_long_help().to_string();
    let lines: Vec<&str> = text.lines().map(str::trim_end).collect();
    format!("{}\n", lines.join("\n").trim_end())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_to_chapters_go_up_one_folder() {
        let doc = "see [a](antialiasing.md), [b](https://x.org/y.md) and [c](../d.md)";
        assert_eq!(
            links_from_below(doc),
            "see [a](../antialiasing.md), [b](https://x.org/y.md) and [c](../d.md)"
        );
    }

    #[test]
    fn every_kind_has_a_section_with_all_its_parameters() {
        let all = vocabulary();
        for schema in all.iter() {
            let page = category_page(&all, schema.category);
            assert!(page.contains(&format!("\n## {}\n", schema.kind)), "{}", schema.kind);
            for param in schema.all_params() {
                assert!(page.contains(&format!("\n| `{}` | ", param.name)), "{}", schema.kind);
            }
        }
    }
}
