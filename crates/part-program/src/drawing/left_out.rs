//! The entities of a drawing that do not become a path.

use crate::source::Span;

/// Most kinds that are named; the others are only counted.
const MAX_KINDS: usize = 30;
/// Most characters of a name that are shown.
const MAX_NAME: usize = 40;

/// Kinds of entities, in the order in which they are found, each with its number.
#[derive(Default)]
pub(crate) struct LeftOut {
    kinds: Vec<(String, usize)>,
    /// Entities of kinds beyond [`MAX_KINDS`].
    others: usize,
    first: Option<Span>,
}

impl LeftOut {
    /// Counts an entity.
    pub(crate) fn add(&mut self, kind: &str, span: Span) {
        if self.first.is_none_or(|first| span.start < first.start) {
            self.first = Some(span);
        }
        let kind: String = kind.chars().take(MAX_NAME).collect();
        if let Some((_, count)) = self.kinds.iter_mut().find(|(name, _)| *name == kind) {
            *count += 1;
        } else if self.kinds.len() < MAX_KINDS {
            self.kinds.push((kind, 1));
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
