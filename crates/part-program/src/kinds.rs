//! What does not become a path, counted by kind: entities of a drawing, words of a program.

use crate::source::Span;

/// Most kinds that are named; the others are only counted.
const MAX_KINDS: usize = 30;
/// Most characters of a name that are shown.
const MAX_NAME: usize = 40;

/// Kinds, in the order in which they are found, each with its number.
#[derive(Default)]
pub(crate) struct Kinds {
    kinds: Vec<(String, usize)>,
    /// The number of what is of kinds beyond [`MAX_KINDS`].
    others: usize,
    first: Option<Span>,
}

impl Kinds {
    /// Counts one of a kind.
    pub(crate) fn add(&mut self, kind: &str, span: Span) {
        if self.first.is_none_or(|first| span.start < first.start) {
            self.first = Some(span);
        }
        let kind = kind.char_indices().nth(MAX_NAME).map_or(kind, |(end, _)| &kind[..end]);
        if let Some((_, count)) = self.kinds.iter_mut().find(|(name, _)| name == kind) {
            *count += 1;
        } else if self.kinds.len() < MAX_KINDS {
            self.kinds.push((kind.to_owned(), 1));
        } else {
            self.others += 1;
        }
    }

    /// The place of the first, and a text such as `3 TEXT, 2 HATCH`; `None` if there is none.
    pub(crate) fn words(&self) -> Option<(Span, String)> {
        let mut kinds: Vec<_> = self.kinds.iter().map(|(kind, count)| format!("{count} {kind}")).collect();
        if self.others > 0 {
            kinds.push(format!("{} of other kinds", self.others));
        }
        Some((self.first?, kinds.join(", ")))
    }
}
