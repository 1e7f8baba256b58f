//! Largest magnitude and root mean square of an error.

use serde::Serialize;

/// How large an error is over a path, in mm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct ErrorSize {
    /// Largest magnitude.
    pub max: f64,
    /// Root mean square.
    pub rms: f64,
}

impl ErrorSize {
    /// The size of these values; 0 for none.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Self {
        Self::of_motion(values, usize::MAX)
    }

    /// The size of an error over a motion of `count` values, after which the machine settles: the largest magnitude of
    /// all values, and the root mean square of the first `count`.
    ///
    /// A mean that includes the standstill would depend on the length of the standstill, and so on the loop that
    /// settles.
    pub fn of_motion(values: impl IntoIterator<Item = f64>, count: usize) -> Self {
        let mut tally = ErrorTally::default();
        values.into_iter().enumerate().for_each(|(index, value)| tally.add(value, index < count));
        tally.size()
    }

    /// The size over several motions, from the size and the number of values of each.
    pub fn joined(motions: impl IntoIterator<Item = (Self, usize)>) -> Self {
        let (mut max, mut sum, mut counted) = (0.0_f64, 0.0, 0.0);
        for (size, count) in motions {
            max = max.max(size.max);
            sum += size.rms * size.rms * count as f64;
            counted += count as f64;
        }
        Self { max, rms: if counted > 0.0 { f64::sqrt(sum / counted) } else { 0.0 } }
    }
}

/// The size of errors that come one after the other.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ErrorTally {
    max: f64,
    sum: f64,
    counted: f64,
}

impl ErrorTally {
    /// Adds an error; in the mean it counts only if it is one of the motion.
    pub(crate) fn add(&mut self, error: f64, is_of_motion: bool) {
        self.max = self.max.max(error.abs());
        if is_of_motion {
            self.sum += error * error;
            self.counted += 1.0;
        }
    }

    /// The size of all of them.
    pub(crate) fn size(&self) -> ErrorSize {
        let rms = if self.counted > 0.0 { f64::sqrt(self.sum / self.counted) } else { 0.0 };
        ErrorSize { max: self.max, rms }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn max_and_root_mean_square() {
        let size = ErrorSize::of([1.0, -7.0]);
        assert_eq!(size, ErrorSize { max: 7.0, rms: 5.0 });
        assert_eq!(ErrorSize::of([]), ErrorSize::default());
    }

    #[test]
    fn motions_are_joined_as_if_they_were_one() {
        let (first, second) = ([1.0, -7.0, 2.5], [0.5]);
        let joined = ErrorSize::joined([(ErrorSize::of(first), 3), (ErrorSize::of(second), 1)]);
        let whole = ErrorSize::of(first.into_iter().chain(second));
        assert!(joined.max == whole.max && (joined.rms - whole.rms).abs() < 1e-15, "{joined:?} {whole:?}");
        assert_eq!(ErrorSize::joined([]), ErrorSize::default());
    }

    #[test]
    fn a_standstill_counts_for_the_largest_alone() {
        let size = ErrorSize::of_motion([1.0, -7.0, 9.0, 0.0, 0.0], 2);
        assert_eq!(size, ErrorSize { max: 9.0, rms: 5.0 });
        assert_eq!(ErrorSize::of_motion([2.0], 0), ErrorSize { max: 2.0, rms: 0.0 });
    }
}
