//! The place of a key in a target file.

use std::fmt;

use domains::Key;
use toml::de::{DeTable, DeValue};

/// A key, and the table of a list in which it stands.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    /// The key, with its list before a dot if it has one.
    pub(crate) key: Key,
    /// The table of that list, from 0.
    index: usize,
    /// Another key of the same table.
    field: Option<&'static str>,
}

impl Place {
    /// A key of the file itself.
    pub(crate) fn of(key: &Key) -> Self {
        Self::in_table(key, 0)
    }

    /// A key of the table with this index.
    pub(crate) fn in_table(key: &Key, index: usize) -> Self {
        Self { key: *key, index, field: None }
    }

    /// Another key of the same table.
    pub(crate) fn field(self, field: &'static str) -> Self {
        Self { field: Some(field), ..self }
    }

    /// The list, if there is one, and the key in its table.
    fn parts(&self) -> (Option<&'static str>, &'static str) {
        let (list, key) =
            self.key.name.split_once('.').map_or((None, self.key.name), |(list, key)| (Some(list), key));
        (list, self.field.unwrap_or(key))
    }

    /// The line of the key, from 1; `None` if the text does not have it.
    pub(crate) fn line_in(&self, text: &str) -> Option<usize> {
        let document = DeTable::parse(text).ok()?;
        let (list, key) = self.parts();
        let value = match list {
            None => document.get_ref().get(key)?,
            Some(list) => match document.get_ref().get(list)?.get_ref() {
                DeValue::Array(tables) => match tables.get(self.index)?.get_ref() {
                    DeValue::Table(table) => table.get(key)?,
                    _ => return None,
                },
                _ => return None,
            },
        };
        Some(text.get(..value.span().start)?.matches('\n').count() + 1)
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.parts() {
            (None, key) => f.write_str(key),
            (Some(list), key) => write!(f, "{list} {}: {key}", self.index + 1),
        }
    }
}
