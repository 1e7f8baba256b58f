//! Why a log cannot be judged.

use std::fmt;

/// What is wrong with a log, where, and what was expected instead.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LogError {
    /// The line of the log, from 1, and the column of its first wrong character, from 1, where one place is wrong.
    pub place: Option<(u64, usize)>,
    /// What is wrong.
    pub message: String,
    /// What was expected.
    pub expected: String,
}

impl LogError {
    /// A fault of the whole log.
    pub(crate) fn whole(message: impl Into<String>, expected: impl Into<String>) -> Self {
        Self { place: None, message: message.into(), expected: expected.into() }
    }

    /// A fault at a line and a column.
    pub(crate) fn at(
        line: u64,
        column: usize,
        message: impl Into<String>,
        expected: impl Into<String>,
    ) -> Self {
        Self { place: Some((line, column)), ..Self::whole(message, expected) }
    }
}

impl fmt::Display for LogError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some((line, column)) = self.place {
            write!(f, "line {line}, column {column}: ")?;
        }
        write!(f, "{}: expected {}", self.message, self.expected)
    }
}

impl std::error::Error for LogError {}

/// What a log says, as a message quotes it: the begin of a long text.
pub(crate) fn quoted(bytes: &[u8]) -> String {
    const MOST: usize = 40;
    let text = String::from_utf8_lossy(bytes);
    let begin: String = text.chars().take(MOST).collect();
    format!("{begin}{}", if text.chars().nth(MOST).is_some() { "…" } else { "" })
}
