//! Diagnostics of a text, printed in the form of a compiler.
//!
//! ```text
//! error: unknown key `weigths`
//!   --> part.toml:4:1
//!    |
//!  4 | weigths = [1, 1]
//!    | ^^^^^^^
//!    = expected: degree, control_points_mm, weights or knots
//!    = help: did you mean `weights`?
//! ```

use std::collections::HashMap;
use std::fmt;
use std::sync::Arc;

use serde::Serialize;
use unicode_width::UnicodeWidthStr;

use crate::source::{Source, Span, TextPlace};

/// Diagnostics kept for one text; further ones are only counted. This limits memory when a large file of another kind
/// is read.
pub const MAX_DIAGNOSTICS: usize = 1000;

/// Characters of a source line that are kept around the offending word.
const EXCERPT: usize = 60;
/// Bytes of a message, of what was expected, of a hint and of a file's name. What they quote may be as long as the text.
const LONGEST: usize = 280;

/// The severity of a diagnostic.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Severity {
    /// The text cannot be used.
    Error,
    /// The text can be used, but not all of it was.
    Warning,
    /// The text is used as far as it says the path; what is noted is no part of it, or not said.
    Note,
}

/// One fault or remark about one place of a text.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Diagnostic {
    /// Its severity.
    pub severity: Severity,
    /// Name of the text, as the caller gave it.
    #[serde(serialize_with = "as_text")]
    pub file: Arc<str>,
    /// Line, from 1.
    pub line: usize,
    /// Column of the first offending character, from 1, in characters.
    pub column: usize,
    /// Number of offending characters on that line, at least 1.
    pub length: usize,
    /// The fault, with the value and the violated relation.
    pub message: String,
    /// The correct form.
    pub expected: Option<String>,
    /// A hint how to correct it.
    pub hint: Option<String>,
    #[serde(skip)]
    excerpt: Excerpt,
}

/// Serde has shared text only behind a feature.
fn as_text<S: serde::Serializer>(name: &Arc<str>, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(name)
}

/// The part of a source line that is shown.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct Excerpt {
    before: String,
    word: String,
    after: String,
}

impl Diagnostic {
    pub(crate) fn new(severity: Severity, source: &Source<'_>, span: Span, message: String) -> Self {
        let place = source.place(span);
        Self {
            severity,
            file: Arc::clone(&source.name),
            line: place.line,
            column: place.column,
            length: place.length,
            message: shortened(message),
            expected: None,
            hint: None,
            excerpt: Excerpt::new(&place),
        }
    }

    /// Adds the correct form.
    pub(crate) fn expected(&mut self, expected: impl Into<String>) -> &mut Self {
        self.expected = Some(shortened(expected.into()));
        self
    }

    /// Makes it a note.
    pub(crate) fn note(&mut self) -> &mut Self {
        self.severity = Severity::Note;
        self
    }

    /// Adds a hint how to correct it.
    pub(crate) fn hint(&mut self, hint: impl Into<String>) -> &mut Self {
        self.hint = Some(shortened(hint.into()));
        self
    }
}

impl Excerpt {
    fn new(place: &TextPlace<'_>) -> Self {
        let (before, rest) = place.line_text.split_at(place.offset);
        let skipped = before.chars().count().saturating_sub(EXCERPT / 2);
        let (skip_mark, before) = if skipped > 0 {
            ("…", before.char_indices().nth(skipped).map_or("", |(at, _)| &before[at..]))
        } else {
            ("", before)
        };
        let word: String = rest.chars().take(place.length.min(EXCERPT)).map(printable).collect();
        let mut tail = rest.chars().skip(place.length).map(printable);
        let mut after: String = tail.by_ref().take(EXCERPT / 2).collect();
        if place.length > EXCERPT || tail.next().is_some() {
            after.push('…');
        }
        Self { before: skip_mark.chars().chain(before.chars().map(printable)).collect(), word, after }
    }
}

/// The text, without its middle if it is longer than [`LONGEST`].
fn shortened(text: String) -> String {
    if text.len() <= LONGEST {
        return text;
    }
    let begin = text.floor_char_boundary(LONGEST * 3 / 5);
    let end = text.ceil_char_boundary(text.len() - LONGEST * 2 / 5 + '…'.len_utf8());
    format!("{}…{}", &text[..begin], &text[end..])
}

/// The character, or a substitute if a terminal would act on it.
fn printable(c: char) -> char {
    match c {
        '\t' => ' ',
        c if foreign_text::is_printable(c) => c,
        _ => '\u{fffd}',
    }
}

impl fmt::Display for Severity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Error => "error",
            Self::Warning => "warning",
            Self::Note => "note",
        })
    }
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Excerpt { before, word, after } = &self.excerpt;
        let gutter = self.line.to_string().len().max(2);
        let indent = before.width();
        let underline = "^".repeat(word.width().max(1));
        writeln!(f, "{}: {}", self.severity, self.message)?;
        writeln!(f, "{:gutter$}--> {}:{}:{}", "", shortened(self.file.to_string()), self.line, self.column)?;
        writeln!(f, "{:gutter$} |", "")?;
        writeln!(f, "{:gutter$} | {before}{word}{after}", self.line)?;
        write!(f, "{:gutter$} | {:indent$}{underline}", "", "")?;
        for (label, text) in [("expected", &self.expected), ("help", &self.hint)] {
            if let Some(text) = text {
                write!(f, "\n{:gutter$} = {label}: {text}", "")?;
            }
        }
        Ok(())
    }
}

/// All errors of one text, with warnings that help to understand them. It is never empty when it is returned as an
/// error.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Diagnostics {
    list: Vec<Diagnostic>,
    omitted: usize,
}

impl Diagnostics {
    /// The diagnostics that were kept, in the order of the text where the format allows.
    pub fn iter(&self) -> std::slice::Iter<'_, Diagnostic> {
        self.list.iter()
    }

    /// The number of diagnostics, including those beyond [`MAX_DIAGNOSTICS`].
    #[must_use]
    pub fn count(&self) -> usize {
        self.list.len() + self.omitted
    }
}

impl<'d> IntoIterator for &'d Diagnostics {
    type Item = &'d Diagnostic;
    type IntoIter = std::slice::Iter<'d, Diagnostic>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

impl fmt::Display for Diagnostics {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, diagnostic) in self.list.iter().enumerate() {
            if index > 0 {
                f.write_str("\n\n")?;
            }
            diagnostic.fmt(f)?;
        }
        if self.omitted > 0 {
            write!(f, "\n\nand {} more", self.omitted)?;
        }
        Ok(())
    }
}

impl std::error::Error for Diagnostics {}

/// Collects diagnostics while a text is read.
pub(crate) struct Report<'t> {
    pub(crate) source: Source<'t>,
    errors: Diagnostics,
    warnings: Diagnostics,
    /// A place for additions to a diagnostic that was not kept.
    scratch: Diagnostic,
    /// For each kind of diagnostic, given by severity and name: its index among those kept, and how often it occurred.
    kinds: HashMap<(bool, String), (usize, usize)>,
    /// Where the part of the text begins that is being read: the bytes of spans count from there.
    pub(crate) offset: usize,
    /// The loop whose lines are being read, as its line and its turn, or the line of the call.
    pub(crate) within: Option<(usize, Option<u32>)>,
}

impl<'t> Report<'t> {
    pub(crate) fn new(source: Source<'t>) -> Self {
        let scratch = Diagnostic::new(Severity::Error, &source, Span::default(), String::new());
        Self {
            source,
            errors: Diagnostics::default(),
            warnings: Diagnostics::default(),
            scratch,
            kinds: HashMap::new(),
            offset: 0,
            within: None,
        }
    }

    /// A span of the part that is being read, in the whole text.
    fn in_text(&self, span: Span) -> Span {
        Span::new(span.start + self.offset, span.end + self.offset)
    }

    /// The text of a span of the part that is being read.
    pub(crate) fn slice(&self, span: Span) -> &'t str {
        self.source.slice(self.in_text(span))
    }

    /// Number of the line that holds a byte of the part that is being read, from 1.
    pub(crate) fn line_number(&self, at: usize) -> usize {
        self.source.line_number(at + self.offset)
    }

    pub(crate) fn error(&mut self, span: impl Into<Span>, message: impl Into<String>) -> &mut Diagnostic {
        self.say(Severity::Error, span.into(), message.into())
    }

    pub(crate) fn warning(&mut self, span: impl Into<Span>, message: impl Into<String>) -> &mut Diagnostic {
        self.say(Severity::Warning, span.into(), message.into())
    }

    /// Reports a frequent fault once: the first of its kind at its place, with the number of further ones.
    pub(crate) fn of_kind(
        &mut self,
        is_error: bool,
        span: Span,
        kind: impl fmt::Display,
        message: impl Into<String>,
    ) -> &mut Diagnostic {
        let kind = (is_error, kind.to_string());
        if let Some((_, count)) = self.kinds.get_mut(&kind) {
            *count += 1;
            return &mut self.scratch;
        }
        let (severity, kept) = if is_error {
            (Severity::Error, &self.errors.list)
        } else {
            (Severity::Warning, &self.warnings.list)
        };
        self.kinds.insert(kind, (kept.len(), 0));
        self.say(severity, span, message.into())
    }

    /// A warning that is also shown if there are errors.
    pub(crate) fn warning_beside_errors(&mut self, span: Span, message: String) {
        if self.has_errors() && self.errors.list.len() < MAX_DIAGNOSTICS {
            let span = self.in_text(span);
            let diagnostic = Diagnostic::new(Severity::Warning, &self.source, span, message);
            self.errors.list.push(diagnostic);
        } else {
            self.warning(span, message);
        }
    }

    fn say(&mut self, severity: Severity, span: Span, message: String) -> &mut Diagnostic {
        let span = self.in_text(span);
        let kept = match severity {
            Severity::Error => &mut self.errors,
            Severity::Warning | Severity::Note => &mut self.warnings,
        };
        if kept.list.len() == MAX_DIAGNOSTICS {
            kept.omitted += 1;
            return &mut self.scratch;
        }
        let message = match self.within {
            Some((line, Some(turn))) => format!("{message} (turn {turn} of the loop of line {line})"),
            Some((line, None)) => format!("{message} (called from line {line})"),
            None => message,
        };
        let diagnostic = Diagnostic::new(severity, &self.source, span, message);
        let index = kept.list.len();
        kept.list.push(diagnostic);
        &mut kept.list[index]
    }

    /// Drops the errors: one that explains them all follows.
    pub(crate) fn forget_errors(&mut self) {
        self.errors = Diagnostics::default();
        self.kinds.retain(|(is_error, _), _| !is_error);
    }

    /// Said first of what is no error.
    pub(crate) fn first_warning(&self) -> Option<&Diagnostic> {
        self.warnings.list.first()
    }

    /// Whether an error has been reported.
    pub(crate) fn has_errors(&self) -> bool {
        !self.errors.list.is_empty()
    }

    /// The warnings, or the errors if there are any, sorted by place.
    pub(crate) fn finish(mut self) -> Result<Vec<Diagnostic>, Diagnostics> {
        for ((is_error, _), (index, more)) in self.kinds.drain().filter(|(_, (_, more))| *more > 0) {
            let kept = if is_error { &mut self.errors } else { &mut self.warnings };
            if let Some(diagnostic) = kept.list.get_mut(index) {
                diagnostic.message.push_str(&format!(", and {} more like it", thousands(more)));
            }
        }
        let place = |diagnostic: &Diagnostic| (diagnostic.line, diagnostic.column);
        if self.has_errors() {
            self.errors.list.sort_by_key(place);
            return Err(self.errors);
        }
        self.warnings.list.sort_by_key(place);
        Ok(self.warnings.list)
    }
}

/// A number with commas between its thousands.
fn thousands(number: usize) -> String {
    let digits = number.to_string();
    let first = digits.len() % 3;
    let mut grouped = digits[..first].to_owned();
    for group in digits.as_bytes()[first..].chunks(3) {
        if !grouped.is_empty() {
            grouped.push(',');
        }
        grouped.extend(group.iter().map(|digit| char::from(*digit)));
    }
    grouped
}

#[cfg(test)]
mod tests {
    use super::*;

    fn say(text: &str, span: Span) -> Diagnostic {
        Diagnostic::new(Severity::Error, &Source::new("part.nc", text), span, "wrong word".into())
    }

    #[test]
    fn prints_like_a_compiler() {
        let mut diagnostic = say("G90\nG1 XX10\n", Span::new(7, 8));
        diagnostic.expected("a number").hint("write X10");
        let printed = "error: wrong word
  --> part.nc:2:4
   |
 2 | G1 XX10
   |    ^
   = expected: a number
   = help: write X10";
        assert_eq!(diagnostic.to_string(), printed);
    }

    #[test]
    fn underline_stands_below_wide_characters_and_tabs() {
        let printed = say("(切削)\tQ1", Span::new(9, 11)).to_string();
        let lines: Vec<_> = printed.lines().collect();
        assert_eq!(lines[3], " 1 | (切削) Q1");
        assert_eq!(lines[4], "   |        ^^");
    }

    #[test]
    fn a_long_line_is_cut_around_the_word() {
        let text = format!("{}Q{}", "X1".repeat(5000), "Y".repeat(5000));
        let diagnostic = say(&text, Span::new(10_000, 10_001));
        assert_eq!(diagnostic.column, 10_001);
        let printed = diagnostic.to_string();
        assert!(printed.len() < 1000, "{} bytes", printed.len());
        let lines: Vec<_> = printed.lines().collect();
        let underlined = lines[4].find('^').map(|at| lines[3].chars().nth(at));
        assert_eq!(underlined, Some(Some('Q')), "{printed}");
    }

    /// A key of a megabyte, a number of a million digits, a name of any length: all of them, and characters of four bytes.
    #[test]
    fn no_diagnostic_is_above_2000_bytes() {
        for long in ["1".repeat(1_000_000), "🦀".repeat(1_000_000), "é`".repeat(500_000)] {
            let name = long[..long.ceil_char_boundary(4000)].to_owned();
            let text = format!("{long}{long}");
            let source = Source::new(&name, &text);
            for span in [Span::new(0, long.len()), Span::new(long.len(), 2 * long.len())] {
                let mut said =
                    Diagnostic::new(Severity::Error, &source, span, format!("`{long}` is no number"));
                said.expected(format!("a number, as `{long}`")).hint(format!("did you mean `{long}`?"));
                let printed = said.to_string();
                assert!(printed.len() <= 2000, "{} bytes", printed.len());
                assert!(said.message.ends_with("` is no number"), "{}", said.message);
                assert!(said.expected.is_some_and(|expected| expected.starts_with("a number, as `")));
            }
        }
        assert_eq!(shortened("x".repeat(LONGEST)), "x".repeat(LONGEST));
        assert_eq!(shortened("x".repeat(LONGEST + 1)).len(), LONGEST);
    }

    #[test]
    fn control_characters_do_not_reach_the_terminal() {
        let printed = say("G1 \u{1b}[2J X1", Span::new(3, 4)).to_string();
        assert!(!printed.contains('\u{1b}'), "{printed:?}");
    }

    #[test]
    fn what_is_met_again_is_counted() {
        let mut report = Report::new(Source::new("p", "A1 A2\nB3"));
        for at in 0..1167 {
            report.of_kind(true, Span::new(at.min(5), 6), 'A', "no `A`").hint("leave it out");
        }
        report.of_kind(true, Span::new(6, 8), 'B', "no `B`");
        let errors = report.finish().unwrap_err();
        let said: Vec<_> =
            errors.iter().map(|error| (error.line, error.column, error.message.as_str())).collect();
        assert_eq!(said, [(1, 1, "no `A`, and 1,166 more like it"), (2, 1, "no `B`")]);
        assert_eq!(errors.iter().next().unwrap().hint.as_deref(), Some("leave it out"));
        assert_eq!([7, 123, 1000, 1_234_567].map(thousands), ["7", "123", "1,000", "1,234,567"]);
    }

    #[test]
    fn diagnostics_beyond_the_limit_are_counted() {
        let mut report = Report::new(Source::new("p", "x"));
        for _ in 0..MAX_DIAGNOSTICS + 7 {
            report.error(Span::new(0, 1), "no").hint("none");
        }
        let errors = report.finish().unwrap_err();
        assert_eq!(errors.count(), MAX_DIAGNOSTICS + 7);
        assert_eq!(errors.iter().count(), MAX_DIAGNOSTICS);
        assert!(errors.to_string().ends_with("and 7 more"));
    }
}
