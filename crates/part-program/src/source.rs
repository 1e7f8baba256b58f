//! A text with a name, and the place of a byte in it.

use std::ops::Range;
use std::sync::Arc;

/// Bytes `start..end` of a source.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Span {
    pub(crate) start: usize,
    pub(crate) end: usize,
}

impl Span {
    pub(crate) fn new(start: usize, end: usize) -> Self {
        Self { start, end }
    }

    /// From the start of this to the end of `other`.
    pub(crate) fn to(self, other: Self) -> Self {
        Self { start: self.start, end: other.end }
    }
}

impl From<Range<usize>> for Span {
    fn from(range: Range<usize>) -> Self {
        Self { start: range.start, end: range.end }
    }
}

/// A text with a name.
pub(crate) struct Source<'t> {
    pub(crate) name: Arc<str>,
    pub(crate) text: &'t str,
    /// A text has at most 512 MiB, and may have as many lines.
    line_starts: Vec<u32>,
}

/// A span as a reader of the text counts; line and column begin at 1, columns count characters.
pub(crate) struct TextPlace<'t> {
    pub(crate) line: usize,
    pub(crate) column: usize,
    /// Characters from `column` that belong to the span; at least 1, at most to the end of the line.
    pub(crate) length: usize,
    pub(crate) line_text: &'t str,
    /// Byte of `line_text` at which the span begins.
    pub(crate) offset: usize,
}

impl<'t> Source<'t> {
    pub(crate) fn new(name: &str, text: &'t str) -> Self {
        let behind = |(at, _): (usize, &str)| u32::try_from(at + 1).unwrap_or(u32::MAX);
        let line_starts = std::iter::once(0).chain(text.match_indices('\n').map(behind)).collect();
        Self { name: name.into(), text, line_starts }
    }

    /// Number of the line that holds byte `at`, from 1.
    pub(crate) fn line_number(&self, at: usize) -> usize {
        self.line_starts.partition_point(|start| *start as usize <= at).max(1)
    }

    /// Number of lines; of a text that ends with a line end, the empty one behind it is one.
    pub(crate) fn lines(&self) -> usize {
        self.line_starts.len()
    }

    /// The byte at which a line begins, and its text with its line end; lines count from 0, and there is nothing behind the last.
    pub(crate) fn line(&self, index: usize) -> (usize, &'t str) {
        let start_of = |index: usize| self.start_of(index).unwrap_or(self.text.len());
        let start = start_of(index);
        (start, self.text.get(start..start_of(index.saturating_add(1))).unwrap_or(""))
    }

    /// The byte at which a line begins; lines count from 0.
    fn start_of(&self, index: usize) -> Option<usize> {
        self.line_starts.get(index).map(|start| *start as usize)
    }

    /// The text of a span; empty if the span does not fall on characters.
    pub(crate) fn slice(&self, span: Span) -> &'t str {
        self.text.get(span.start..span.end).unwrap_or("")
    }

    /// One character at a line and a column that count from 1, in bytes.
    pub(crate) fn span_at(&self, line: usize, column: usize) -> Span {
        let start = self.start_of(line.saturating_sub(1)).map_or(0, |start| start + column.saturating_sub(1));
        Span::new(start, start + 1)
    }

    pub(crate) fn place(&self, span: Span) -> TextPlace<'t> {
        let at = span.start.min(self.text.len());
        let line = self.line_number(at);
        let start = self.start_of(line - 1).unwrap_or(0);
        let end = self.start_of(line).map_or(self.text.len(), |next| next - 1);
        let line_text = self.text.get(start..end).unwrap_or("").trim_end_matches('\r');
        let offset = floor_char_boundary(line_text, at - start);
        let stop = floor_char_boundary(line_text, span.end.saturating_sub(start)).max(offset);
        let count = |range: Range<usize>| line_text.get(range).unwrap_or("").chars().count();
        TextPlace {
            line,
            column: count(0..offset) + 1,
            length: count(offset..stop).max(1),
            line_text,
            offset,
        }
    }
}

/// The largest character boundary of `text` at or before `at`.
fn floor_char_boundary(text: &str, at: usize) -> usize {
    let mut at = at.min(text.len());
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    at
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_count_characters_and_lines_count_from_one() {
        let source = Source::new("p.nc", "(Fräsen) G1\r\nX1\n");
        let place = source.place(Span::new(10, 12));
        assert_eq!((place.line, place.column, place.length), (1, 10, 2));
        let place = source.place(Span::new(14, 16));
        assert_eq!((place.line, place.column, place.length, place.line_text), (2, 1, 2, "X1"));
    }

    #[test]
    fn a_span_past_the_end_is_the_last_line() {
        let source = Source::new("p.nc", "G1\n");
        let place = source.place(Span::new(900, 901));
        assert_eq!((place.line, place.column, place.length, place.line_text), (2, 1, 1, ""));
    }

    #[test]
    fn a_span_over_several_lines_is_clipped_to_its_first() {
        let source = Source::new("p.nc", "G1 X1\nX2");
        assert_eq!(source.place(Span::new(3, 8)).length, 2);
    }
}
