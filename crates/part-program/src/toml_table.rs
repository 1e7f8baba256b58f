//! A TOML table read key by key, so that each fault is reported at its own place and none hides another.

use domains::{Key, Value, shown};
use toml::Spanned;
use toml::de::{DeTable, DeValue};
use toml_parser::lexer::{Token, TokenKind};

use crate::diagnostic::Report;
use crate::source::Span;

/// A table, with the keys that have been read.
pub(crate) struct TableReader<'r, 'd, 't> {
    pub(crate) report: &'r mut Report<'t>,
    table: &'d DeTable<'d>,
    /// Name with brackets, as the user wrote it.
    name: String,
    header: Span,
    known: Vec<&'static str>,
}

impl<'r, 'd, 't> TableReader<'r, 'd, 't> {
    pub(crate) fn new(
        report: &'r mut Report<'t>,
        name: impl Into<String>,
        header: Span,
        table: &'d DeTable<'d>,
    ) -> Self {
        Self { report, table, name: name.into(), header, known: Vec::new() }
    }

    /// The value of a key, if it is there.
    pub(crate) fn optional(&mut self, key: &'static str) -> Option<&'d Spanned<DeValue<'d>>> {
        if !self.known.contains(&key) {
            self.known.push(key);
        }
        self.table.get(key)
    }

    /// The value of a key; its absence is an error.
    pub(crate) fn required(&mut self, key: &'static str) -> Option<&'d Spanned<DeValue<'d>>> {
        let value = self.optional(key);
        if value.is_none() {
            let message = format!("`{key}` is missing in {}", self.name);
            self.report.error(self.header, message).expected(format!("a line `{key} = …`"));
        }
        value
    }

    /// The number of a key, within its domain. Where the key is left out, that is its default, or an error.
    pub(crate) fn number(&mut self, key: &Key) -> Option<f64> {
        match (self.optional(key.name), key.default_number()) {
            (None, Some(default)) => Some(default),
            _ => {
                let value = self.required(key.name)?;
                self.number_of(key, value)
            }
        }
    }

    /// The number of a key, within its domain, if the key is there.
    pub(crate) fn optional_number(&mut self, key: &Key) -> Option<f64> {
        let value = self.optional(key.name)?;
        self.number_of(key, value)
    }

    fn number_of(&mut self, key: &Key, value: &Spanned<DeValue<'_>>) -> Option<f64> {
        let number = number(self.report, key.name, value)?;
        if !key.holds(number) {
            let message = format!("`{}` is {}", key.name, shown(number));
            self.report.error(value.span(), message).expected(key.expected());
            return None;
        }
        Some(number)
    }

    /// `true` or `false`, or `default` if the key is not there.
    pub(crate) fn truth_or(&mut self, key: &'static str, default: bool) -> bool {
        let Some(value) = self.optional(key) else { return default };
        match value.get_ref() {
            DeValue::Boolean(truth) => *truth,
            _ => {
                self.report
                    .error(value.span(), format!("`{key}` is neither true nor false"))
                    .expected("true or false");
                default
            }
        }
    }

    /// The whole number of a key, within its domain; an error where it is left out and has no default.
    pub(crate) fn whole_number(&mut self, key: &Key) -> Option<u32> {
        let value = match (self.optional(key.name), key.default_number()) {
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "defaults are small")]
            (None, Some(default)) => return Some(default as u32),
            _ => self.required(key.name)?,
        };
        self.whole_of(key, value, |whole| key.holds(f64::from(whole)))
    }

    /// The whole number of a key that must be there, where others say whether it is within the key's domain.
    pub(crate) fn any_whole_number(&mut self, key: &Key) -> Option<u32> {
        let value = self.required(key.name)?;
        self.whole_of(key, value, |_| true)
    }

    fn whole_of(
        &mut self,
        key: &Key,
        value: &Spanned<DeValue<'_>>,
        holds: impl Fn(u32) -> bool,
    ) -> Option<u32> {
        let whole = match value.get_ref() {
            DeValue::Integer(integer) => u32::from_str_radix(integer.as_str(), integer.radix()).ok(),
            _ => None,
        };
        let within = whole.filter(|whole| holds(*whole));
        if within.is_none() {
            let text = self.report.slice(value.span().into());
            self.report.error(value.span(), format!("`{}` is {text}", key.name)).expected(key.expected());
        }
        within
    }

    /// One of the words of a key; the first of them if the key is missing.
    pub(crate) fn word(&mut self, key: &Key) -> Option<&'static str> {
        let Value::Word(words) = key.value else { return None };
        let Some(value) = self.optional(key.name) else { return words.first().copied() };
        let found = value.get_ref().as_str().and_then(|text| words.iter().find(|word| **word == text));
        if found.is_none() {
            let text = self.report.slice(value.span().into());
            self.report.error(value.span(), format!("`{}` is {text}", key.name)).expected(key.expected());
        }
        found.copied()
    }

    /// The keys of this table that a list names, with their numbers. Each is one of `known`, and has a value here.
    pub(crate) fn named_numbers(&mut self, key: &Key, known: &[Key]) -> Vec<(&'static str, f64)> {
        let Some(value) = self.optional(key.name) else { return Vec::new() };
        let DeValue::Array(items) = value.get_ref() else {
            wrong_kind(self.report, key.name, value, "an array");
            return Vec::new();
        };
        let numbers: Vec<&'static str> = known
            .iter()
            .filter(|one| matches!(one.value, Value::Number(_) | Value::Whole(..)))
            .map(|one| one.name)
            .collect();
        let mut named = Vec::new();
        for item in items {
            let text = item.get_ref().as_str();
            let found = numbers.iter().find(|name| Some(**name) == text);
            let Some(found) = found.filter(|name| self.table.get(**name).is_some()) else {
                let written = self.report.slice(item.span().into()).to_string();
                let said = format!("`{}` names {written}, which has no value in {}", key.name, self.name);
                let there: Vec<&str> =
                    numbers.iter().copied().filter(|name| self.table.get(*name).is_some()).collect();
                let diagnostic = self.report.error(item.span(), said);
                diagnostic.expected(listed(&there));
                if let Some(near) = text.and_then(|text| nearest(text, &there)) {
                    diagnostic.hint(format!("did you mean `{near}`?"));
                }
                continue;
            };
            let number = self.table.get(*found).and_then(|value| number_of(value.get_ref()));
            named.extend(number.map(|number| (*found, number)));
        }
        named
    }

    /// The place of a required array, whose items are read where they stand.
    pub(crate) fn array(&mut self, key: &'static str) -> Option<Span> {
        let value = self.required(key)?;
        array(self.report, key, value)
    }

    /// A table within this one, if it is there, with its header's place.
    pub(crate) fn table(&mut self, key: &'static str) -> Option<(Span, &'d DeTable<'d>)> {
        let value = self.optional(key)?;
        let DeValue::Table(table) = value.get_ref() else {
            wrong_kind(self.report, key, value, "a table");
            return None;
        };
        Some((value.span().into(), table))
    }

    /// One table within this one, or an array of them, each with its header's place; none if the key is not there.
    pub(crate) fn tables(&mut self, key: &'static str) -> Vec<(Span, &'d DeTable<'d>)> {
        let Some(value) = self.optional(key) else { return Vec::new() };
        let items = match value.get_ref() {
            DeValue::Array(items) => items.iter().collect(),
            _ => vec![value],
        };
        let mut tables = Vec::with_capacity(items.len());
        for item in items {
            match item.get_ref() {
                DeValue::Table(table) => tables.push((item.span().into(), table)),
                _ => wrong_kind(self.report, key, item, "a table"),
            }
        }
        tables
    }

    /// Reports every key that was not read, and returns the report.
    pub(crate) fn finish(self) -> &'r mut Report<'t> {
        for key in self.table.keys().filter(|key| !self.known.contains(&key.get_ref().as_ref())) {
            let diagnostic = self.report.error(key.span(), format!("unknown key `{key}` in {}", self.name));
            diagnostic.expected(listed(&self.known));
            if let Some(near) = nearest(key.get_ref(), &self.known) {
                diagnostic.hint(format!("did you mean `{near}`?"));
            }
        }
        self.report
    }
}

/// Most tokens that are parsed at once: each value takes some hundred bytes. The numbers of curves are not among them.
const MOST_TOKENS: usize = 200_000;

/// Parses a text and reports every syntax error at its place.
pub(crate) fn parse<'d>(report: &mut Report<'_>, text: &'d str) -> Option<Spanned<DeTable<'d>>> {
    let counts = |token: &Token| {
        !matches!(token.kind(), TokenKind::Whitespace | TokenKind::Newline | TokenKind::Comment)
    };
    if let Some(token) = toml_parser::Source::new(text).lex().filter(counts).nth(MOST_TOKENS) {
        let span = Span::new(token.span().start(), token.span().end());
        let message =
            format!("more than {MOST_TOKENS} words, numbers and signs beside the numbers of curves");
        report.error(span, message).expected("curves, and limits of a machine");
        return None;
    }
    let (document, errors) = DeTable::parse_recoverable(text);
    if errors.is_empty() {
        return Some(document);
    }
    for error in errors {
        report.error(error.span().unwrap_or_default(), error.message());
    }
    None
}

/// A finite or infinite number, whole or with a fraction.
pub(crate) fn number(report: &mut Report<'_>, key: &str, value: &Spanned<DeValue<'_>>) -> Option<f64> {
    let number = number_of(value.get_ref());
    if number.is_none() {
        wrong_kind(report, key, value, "a number");
    }
    number
}

/// The number that a value is, if it is one.
pub(crate) fn number_of(value: &DeValue<'_>) -> Option<f64> {
    match value {
        DeValue::Float(float) => float.as_str().parse().ok(),
        DeValue::Integer(integer) if integer.radix() == 10 => integer.as_str().parse().ok(),
        _ => None,
    }
}

/// The place of an array.
pub(crate) fn array(report: &mut Report<'_>, key: &str, value: &Spanned<DeValue<'_>>) -> Option<Span> {
    let is_array = matches!(value.get_ref(), DeValue::Array(_));
    if !is_array {
        wrong_kind(report, key, value, "an array");
    }
    is_array.then(|| value.span().into())
}

pub(crate) fn wrong_kind(report: &mut Report<'_>, key: &str, value: &Spanned<DeValue<'_>>, expected: &str) {
    holds(report, key, (value.span().into(), value.get_ref().type_str()), expected);
}

/// Reports that a key holds a value of this kind at this place.
pub(crate) fn holds(report: &mut Report<'_>, key: &str, (span, kind): (Span, &str), expected: &str) {
    let article = if kind.starts_with(['a', 'i']) { "an" } else { "a" };
    report.error(span, format!("`{key}` holds {article} {kind}")).expected(expected);
}

/// A list of words, as in "a, b or c".
pub(crate) fn listed(words: &[&str]) -> String {
    match words {
        [] => "nothing".into(),
        [word] => (*word).into(),
        [words @ .., last] => format!("{} or {last}", words.join(", ")),
    }
}

/// Reports every key of a file that is not one of the tables `[curve]`, `[machine]` and `[table_…]`, the figures of a
/// paper.
pub(crate) fn refuse_unknown_tables(report: &mut Report<'_>, root: &DeTable<'_>) {
    const TABLES: [&str; 2] = ["curve", "machine"];
    for key in root.keys() {
        let name = key.get_ref().as_ref();
        if TABLES.contains(&name) || is_published(name) {
            continue;
        }
        let diagnostic = report.error(key.span(), format!("unknown key `{name}` in the file"));
        diagnostic.expected("[curve], [machine] or [table_…] with published figures");
        if name == "axes" {
            diagnostic.hint("limits of an axis are in [machine.axes.x]");
        } else if let Some(near) = nearest(name, &TABLES) {
            diagnostic.hint(format!("did you mean `{near}`?"));
        }
    }
}

/// Whether a table holds figures that a paper published.
pub(crate) fn is_published(name: &str) -> bool {
    name.starts_with("table_")
}

/// The known word that `word` was probably meant to be: at most a third of its letters differ, or of those before its unit.
///
/// ```
/// let keys = ["jerk_mm_per_s3", "feedrate_mm_per_s"];
/// assert_eq!(part_program::nearest("feedrat_mm_per_s", &keys), Some("feedrate_mm_per_s"));
/// assert_eq!(part_program::nearest("jerk", &keys), Some("jerk_mm_per_s3"));
/// assert_eq!(part_program::nearest("colour", &keys), None);
/// ```
#[must_use]
pub fn nearest<'w>(word: &str, known: &[&'w str]) -> Option<&'w str> {
    let near = |word: &str, candidate: &str| {
        let distance = strsim::damerau_levenshtein(word, candidate);
        (distance * 3 <= candidate.len().max(3)).then_some(distance)
    };
    if word.len() > 64 {
        return None;
    }
    let whole = known.iter().filter_map(|candidate| Some((near(word, candidate)?, *candidate))).min();
    let before_unit = || {
        let stems = known.iter().filter(|candidate| without_unit(candidate) != **candidate);
        let near = |candidate: &'w str| near(without_unit(word), without_unit(candidate));
        stems.filter_map(|candidate| Some((near(candidate)?, *candidate))).min()
    };
    whole.or_else(before_unit).map(|(_, candidate)| candidate)
}

/// A key without its unit: `jerk` of `jerk_mm_per_s3`.
fn without_unit(key: &str) -> &str {
    let units = ["_mm", "_m_", "_ms", "_us", "_s", "_inch"];
    units.iter().filter_map(|unit| key.find(unit)).min().map_or(key, |end| &key[..end])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_near_word_is_suggested_and_a_far_one_is_not() {
        let known = ["degree", "control_points_mm", "weights", "knots"];
        assert_eq!(nearest("weigths", &known), Some("weights"));
        assert_eq!(nearest("control_points", &known), Some("control_points_mm"));
        assert_eq!(nearest("colour", &known), None);
        assert_eq!(nearest(&"weights".repeat(100), &known), None);
    }

    #[test]
    fn words_are_listed_in_english() {
        assert_eq!(listed(&["a", "b", "c"]), "a, b or c");
        assert_eq!(listed(&["a"]), "a");
        assert_eq!(listed(&[]), "nothing");
    }
}
