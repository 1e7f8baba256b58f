//! The values of a signal in fixed point, gathered as integers.

/// Values in fixed point as integers: what is asked of them is monotone, so that only the results are converted.
#[derive(Clone, Copy, Debug)]
pub(super) struct Words {
    pub(super) fraction_bits: u32,
    pub(super) least: i64,
    pub(super) greatest: i64,
    /// The least magnitude that is not 0.
    pub(super) nearest: u64,
    pub(super) zeros: u64,
    /// How many magnitudes have their leading bit at each place.
    pub(super) by_length: [u64; 64],
}

impl Words {
    pub(super) fn of(fraction_bits: u32) -> Self {
        Self {
            fraction_bits,
            least: i64::MAX,
            greatest: i64::MIN,
            nearest: u64::MAX,
            zeros: 0,
            by_length: [0; 64],
        }
    }

    #[inline]
    pub(super) fn add(&mut self, word: i64) {
        self.least = self.least.min(word);
        self.greatest = self.greatest.max(word);
        let magnitude = word.unsigned_abs();
        match magnitude.checked_ilog2() {
            Some(length) => {
                self.nearest = self.nearest.min(magnitude);
                self.by_length[length as usize & 63] += 1;
            }
            None => self.zeros += 1,
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::{Audit, Audited, Backend, I4F60, Real};

    /// The figures of words of 64 bits, cut toward zero, are those of their exact values.
    #[test]
    fn the_longest_words_keep_their_figures() {
        let number = |word: i64| {
            Audited(
                I4F60::from_f64_pair(
                    (word >> 11) as f64 * 2.0_f64.powi(-49),
                    (word & 2047) as f64 * 2.0_f64.powi(-60),
                )
                .unwrap(),
            )
        };
        let words = [i64::MIN, i64::MAX, (1 << 62) - 1, -(1 << 62) + 1, 3, 0];
        let (_, found) = Audit::of(|| words.map(|word| number(word).signal("x").0));
        let (x, unit) = (found.signals["x"], 2.0_f64.powi(-60));
        let below = |power: i32| 2.0_f64.powi(power).next_down();
        assert_eq!((x.min, x.max, x.min_magnitude), (-8.0, below(3), 3.0 * unit));
        assert_eq!((x.count, x.zeros), (6, 1));
        assert_eq!(found.histograms["x"].bins().collect::<Vec<_>>(), [(-59, 1), (1, 2), (2, 1), (3, 1)]);
    }
}
