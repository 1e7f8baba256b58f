//! The range of a named signal.

/// The values that a named signal took.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SignalRange {
    /// Least value; cut toward zero if it has more bits than an f64.
    pub min: f64,
    /// Greatest value; cut toward zero if it has more bits than an f64.
    pub max: f64,
    /// Smallest magnitude that is not zero; infinite if every value was zero.
    pub min_magnitude: f64,
    /// How many values.
    pub count: u64,
    /// How many of them were zero.
    pub zeros: u64,
    /// Overflows between this signal and the signal that was named before it, whichever that was.
    pub overflows: u64,
    /// Underflows to zero between the same two signals.
    pub underflows: u64,
}

impl SignalRange {
    /// Includes a value that the signal took so many times.
    pub(super) fn include(&mut self, value: f64, times: u64) {
        self.min = self.min.min(value);
        self.max = self.max.max(value);
        if value == 0.0 {
            self.zeros += times;
        } else {
            self.min_magnitude = self.min_magnitude.min(value.abs());
        }
        self.count += times;
    }

    /// Adds the values of another part of the same run.
    pub(super) fn join(&mut self, other: &Self) {
        self.min = self.min.min(other.min);
        self.max = self.max.max(other.max);
        self.min_magnitude = self.min_magnitude.min(other.min_magnitude);
        self.count += other.count;
        self.zeros += other.zeros;
        self.overflows += other.overflows;
        self.underflows += other.underflows;
    }
}

impl Default for SignalRange {
    fn default() -> Self {
        Self {
            min: f64::INFINITY,
            max: f64::NEG_INFINITY,
            min_magnitude: f64::INFINITY,
            count: 0,
            zeros: 0,
            overflows: 0,
            underflows: 0,
        }
    }
}
