// SPDX-License-Identifier: MIT OR Apache-2.0
//! `list`: the vocabulary as tables, and the manual page of one kind.

use dioptric::render::vocabulary;
use dioptric::scene::{Category, Vocabulary};

use super::failure::Failure;
use super::{page, terminal};

/// Lists shapes, materials, patterns, lights, cameras and settings, or shows one kind's page.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  dioptric list\n  dioptric list shapes\n  dioptric list sphere"
)]
pub struct ListArgs {
    /// A category (shape, material, ...) or a kind (sphere, glass, ...).
    what: Option<String>,
    /// A kind of the category.
    kind: Option<String>,
}

/// Prints the table or page that was asked for.
pub fn run(args: &ListArgs) -> Result<(), Failure> {
    let all = vocabulary();
    let text = match (&args.what, &args.kind) {
        (None, _) => Category::ALL.iter().map(|&c| table(&all, c)).collect::<Vec<_>>().join("\n"),
        (Some(what), None) => match (category(what), all.get(what)) {
            // `camera` and `light` are both.
            (Some(category), Some(schema)) => {
                format!("{}\n{}", table(&all, category), page::text(schema))
            }
            (Some(category), None) => table(&all, category),
            (None, Some(schema)) => page::text(schema),
            (None, None) => return Err(unknown(&all, what)),
        },
        (Some(what), Some(kind)) => {
            let category = category(what).ok_or_else(|| {
                Failure::unknown("category", what, Category::ALL.iter().map(|c| c.name()))
            })?;
            let schema = all.of(category).find(|s| s.kind == kind).ok_or_else(|| {
                Failure::unknown(category.name(), kind, all.of(category).map(|s| s.kind))
            })?;
            page::text(schema)
        }
    };
    terminal::print(text.as_bytes())
}

/// The category with this name, singular or plural.
fn category(word: &str) -> Option<Category> {
    Category::ALL.into_iter().find(|c| c.name() == word.strip_suffix('s').unwrap_or(word))
}

fn table(all: &Vocabulary, category: Category) -> String {
    let mut text = format!("{}s\n", category.name());
    let width = all.of(category).map(|s| s.kind.len()).max().unwrap_or(0);
    for schema in all.of(category) {
        text.push_str(&format!("  {:width$}  {}\n", schema.kind, schema.summary));
    }
    text
}

fn unknown(all: &Vocabulary, word: &str) -> Failure {
    let kinds = all.iter().map(|s| s.kind);
    Failure::unknown("kind", word, kinds.chain(Category::ALL.iter().map(|c| c.name())))
}
