//! Words that a shell may complete an option with.

use std::ffi::OsStr;

use clap_complete::engine::{CompletionCandidate, PathCompleter, ValueCompleter};
use part_program::Dialect;

use crate::presets::PRESETS;

fn candidate(word: impl Into<String>, help: impl Into<String>) -> CompletionCandidate {
    CompletionCandidate::new(word.into()).help(Some(help.into().into()))
}

/// The built-in formats.
pub(crate) fn formats() -> Vec<CompletionCandidate> {
    let names = format_compare::formats::<3>().into_iter().map(|format| format.name());
    names.map(|name| candidate(name.to_string(), format!("{} bits", name.bits()))).collect()
}

/// Names for the format to plan in.
pub(crate) fn planners() -> Vec<CompletionCandidate> {
    let mut words = formats();
    words.push(candidate("same", "each format plans for itself"));
    words
}

/// The built-in targets.
pub(crate) fn targets() -> Vec<CompletionCandidate> {
    let targets = target_cost::built_in().unwrap_or_default();
    targets.into_iter().map(|target| candidate(target.name, target.title)).collect()
}

/// The dialects of part programs.
pub(crate) fn dialects() -> Vec<CompletionCandidate> {
    Dialect::ALL.map(|dialect| CompletionCandidate::new(dialect.name())).into()
}

/// The machines that have a name.
pub(crate) fn presets() -> Vec<CompletionCandidate> {
    PRESETS.iter().map(|preset| candidate(preset.name, preset.title())).collect()
}

/// The machines that have a name, and files.
pub(crate) fn machines(begun: &OsStr) -> Vec<CompletionCandidate> {
    let begins = |word: &CompletionCandidate| {
        word.get_value().as_encoded_bytes().starts_with(begun.as_encoded_bytes())
    };
    let mut words: Vec<CompletionCandidate> = presets().into_iter().filter(begins).collect();
    words.extend(PathCompleter::any().complete(begun));
    words
}
