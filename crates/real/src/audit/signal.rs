//! A named signal while the audit is made: its range and its histogram, and the values that are still to be included.

use crate::Histogram;
use crate::audit::signal_range::SignalRange;
use crate::audit::value::{Value, cut, of_word};
use crate::audit::words::Words;

/// A named signal.
#[derive(Debug)]
pub(super) struct Signal {
    pub(super) name: &'static str,
    pub(super) range: SignalRange,
    pub(super) histogram: Histogram,
    /// Its values in fixed point, which are still to be included.
    words: Words,
    /// Its newest value in floats, and how often it came in succession: so often it is still to be included. On a straight
    /// move at constant feed most signals keep their values.
    newest: (f64, f64),
    times: u64,
    /// Where the last two other signals are that were named after it. A step names the same signals in the same order
    /// again and again, and some of them in turn with two others.
    pub(super) next: [usize; 2],
}

impl Signal {
    pub(super) fn new(name: &'static str) -> Self {
        Self {
            name,
            range: SignalRange::default(),
            histogram: Histogram::default(),
            words: Words::of(0),
            newest: (0.0, 0.0),
            times: 0,
            next: [0; 2],
        }
    }

    #[inline]
    pub(super) fn add(&mut self, value: Value) {
        match value {
            Value::Word(word, fraction_bits) => {
                if self.words.fraction_bits != fraction_bits {
                    self.include_words();
                    self.words = Words::of(fraction_bits);
                }
                self.words.add(word);
            }
            Value::Floats(high, low) => {
                let same =
                    high.to_bits() == self.newest.0.to_bits() && low.to_bits() == self.newest.1.to_bits();
                if !same {
                    self.include_newest();
                    self.newest = (high, low);
                }
                self.times += 1;
            }
        }
    }

    /// Includes the newest value in floats as often as it came.
    #[inline]
    pub(super) fn include_newest(&mut self) {
        let times = std::mem::take(&mut self.times);
        if times > 0 {
            self.range.include(cut(self.newest), times);
            self.histogram.include_times(self.newest, times);
        }
    }

    /// Includes the values in fixed point.
    #[cold]
    pub(super) fn include_words(&mut self) {
        let Words { fraction_bits, least, greatest, nearest, zeros, by_length } = self.words;
        let of = |word: i64| of_word(word, fraction_bits);
        let others: u64 = by_length.iter().sum();
        if zeros + others == 0 {
            return;
        }
        let (range, magnitude) = (&mut self.range, i64::try_from(nearest).map_or(of(i64::MIN).abs(), of));
        range.min = range.min.min(of(least));
        range.max = range.max.max(of(greatest));
        if others > 0 {
            range.min_magnitude = range.min_magnitude.min(magnitude);
        }
        range.zeros += zeros;
        range.count += zeros + others;
        for (count, length) in by_length.into_iter().zip(0..) {
            self.histogram.add(length - fraction_bits.cast_signed(), count);
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::audit::audited::examples::audited;
    use crate::{Audit, Real};

    #[test]
    fn a_signal_has_a_histogram() {
        let ((), audit) = Audit::of(|| {
            for value in [0.25, 0.3, -0.49, 0.0, 1.0, -8.0] {
                let _ = audited(value).signal("x");
            }
        });
        let histogram = &audit.histograms["x"];
        assert_eq!(histogram.bins().collect::<Vec<_>>(), [(-2, 3), (0, 1), (3, 1)]);
        assert_eq!((histogram.count(-2), histogram.count(5), audit.signals["x"].zeros), (3, 0, 1));
    }
}
