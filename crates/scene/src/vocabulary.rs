// SPDX-License-Identifier: MIT OR Apache-2.0
//! All kinds that scenes can use: the registries of the other crates hand their schemas in here.

use crate::schema::{Category, Schema};
use crate::suggest;

/// The kinds that a reader accepts.
#[derive(Clone, Debug, Default)]
pub struct Vocabulary {
    schemas: Vec<&'static Schema>,
}

impl Vocabulary {
    /// A vocabulary of these kinds, sorted by category and name.
    #[must_use]
    pub fn new(schemas: impl IntoIterator<Item = &'static Schema>) -> Self {
        let mut schemas: Vec<_> = schemas.into_iter().collect();
        schemas.sort_by_key(|s| (s.category, s.kind));
        Self { schemas }
    }

    /// The schema of a kind.
    #[must_use]
    pub fn get(&self, kind: &str) -> Option<&'static Schema> {
        self.schemas.iter().copied().find(|s| s.kind == kind)
    }

    /// All schemas, sorted by category and name.
    pub fn iter(&self) -> impl Iterator<Item = &'static Schema> + '_ {
        self.schemas.iter().copied()
    }

    /// The schemas of one category, sorted by name.
    pub fn of(&self, category: Category) -> impl Iterator<Item = &'static Schema> + '_ {
        self.iter().filter(move |s| s.category == category)
    }

    /// The kind nearest to a misspelt one.
    #[must_use]
    pub fn nearest(&self, kind: &str) -> Option<&'static str> {
        suggest::nearest(kind, self.iter().map(|s| s.kind))
    }
}
