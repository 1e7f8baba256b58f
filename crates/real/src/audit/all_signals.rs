//! The range of all signals of a run together.

use crate::Extremes;
use crate::audit::value::{Value, cut, of_word};

/// The range of all signals together. Values in fixed point wait as words, of which only the extremes are converted.
#[derive(Clone, Copy, Debug)]
pub(super) struct All {
    range: Extremes,
    fraction_bits: u32,
    least: i64,
    greatest: i64,
}

impl Default for All {
    fn default() -> Self {
        Self { range: Extremes::default(), fraction_bits: 0, least: i64::MAX, greatest: i64::MIN }
    }
}

impl All {
    #[inline]
    pub(super) fn add(&mut self, value: Value) {
        match value {
            Value::Word(word, fraction_bits) => {
                if self.fraction_bits != fraction_bits {
                    *self = Self { range: self.finished(), fraction_bits, ..Self::default() };
                }
                self.least = self.least.min(word);
                self.greatest = self.greatest.max(word);
            }
            Value::Floats(high, low) => {
                let value = cut((high, low));
                self.range.include(value, value);
            }
        }
    }

    /// The range with the words in it.
    pub(super) fn finished(self) -> Extremes {
        let mut range = self.range;
        if self.least <= self.greatest {
            let [min, max] = [self.least, self.greatest].map(|word| of_word(word, self.fraction_bits));
            range.include(min, max);
        }
        range
    }
}
