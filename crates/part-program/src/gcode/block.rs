//! One block of a part program: its words, by their addresses.

use crate::diagnostic::Report;
use crate::gcode::word::{Key, Word};
use crate::source::{Source, Span};

/// The words of a line. Each is taken by the first function that asks for it.
pub(crate) struct Block<'w> {
    words: &'w mut Vec<Word>,
    /// From the first word to the last.
    pub(crate) span: Span,
}

impl<'w> Block<'w> {
    /// The block of `words`. It is an error if a letter other than G and M occurs twice.
    pub(crate) fn new(report: &mut Report<'_>, words: &'w mut Vec<Word>) -> Option<Self> {
        let span = words.first()?.span.to(words.last()?.span);
        for (index, word) in words.iter().enumerate() {
            let repeats = !matches!(word.key, Key::Letter(b'G' | b'M'));
            // The search is quadratic, which a line of a million words would show: no block needs more than a few.
            if index > MAX_WORDS {
                report.error(word.span, format!("the block has more than {MAX_WORDS} words"));
                return None;
            }
            if repeats && words[..index].iter().any(|earlier| earlier.key == word.key) {
                let text = report.source.slice(word.span).to_owned();
                report
                    .error(word.span, format!("`{text}`: this address is there twice"))
                    .expected("each once a block");
                return None;
            }
        }
        Some(Self { words, span })
    }

    /// Takes the next word of `key`.
    pub(crate) fn take(&mut self, key: Key) -> Option<Word> {
        let index = self.words.iter().position(|word| word.key == key)?;
        Some(self.words.remove(index))
    }

    pub(crate) fn take_letter(&mut self, letter: u8) -> Option<Word> {
        self.take(Key::Letter(letter))
    }

    pub(crate) fn has(&self, letter: u8) -> bool {
        self.words.iter().any(|word| word.key == Key::Letter(letter))
    }

    /// Whether a word names an axis, or a polar coordinate.
    pub(crate) fn has_axis(&self) -> bool {
        b"XYZ@^".iter().any(|axis| self.has(*axis))
    }

    /// Changes the words that have a count of their own; `false` drops one.
    pub(crate) fn change(&mut self, mut change: impl FnMut(&mut Word) -> bool) {
        self.words.retain_mut(|word| word.count.is_none() || change(word));
    }

    /// Drops the words for which this holds.
    pub(crate) fn drop_words(&mut self, drops: impl Fn(&Word) -> bool) {
        self.words.retain(|word| !drops(word));
    }

    /// Takes X, Y and Z as they are written.
    pub(crate) fn take_axes(&mut self) -> [Option<f64>; 3] {
        [b'X', b'Y', b'Z'].map(|axis| self.take_letter(axis).map(|word| word.value))
    }

    /// The words as they are written.
    pub(crate) fn texts<'t>(&self, source: &Source<'t>) -> Vec<&'t str> {
        self.words.iter().map(|word| source.slice(word.span)).collect()
    }

    /// The first word of these letters whose number is not 0 and has no decimal point.
    pub(crate) fn without_point(&self, source: &Source<'_>, letters: &[u8]) -> Option<Word> {
        let is_one_of = |word: &Word| letters.iter().any(|letter| word.key == Key::Letter(*letter));
        // An expression has the point that its numbers have.
        let is_plain = |text: &str| text.bytes().skip(1).all(|c| c.is_ascii_digit() || b"+- \t".contains(&c));
        let whole = |word: &&Word| word.value != 0.0 && is_plain(source.slice(word.span));
        self.words.iter().filter(|word| is_one_of(word)).find(whole).copied()
    }

    pub(crate) fn words(&self) -> &[Word] {
        self.words
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.words.is_empty()
    }

    /// Drops the words that are left: the fault of the block has been reported.
    pub(crate) fn clear(&mut self) {
        self.words.clear();
    }

    /// The words that were not taken.
    pub(crate) fn rest(self) -> &'w mut Vec<Word> {
        self.words
    }
}

/// Words of one block.
const MAX_WORDS: usize = 200;
