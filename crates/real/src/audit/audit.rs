//! What an audit found: overflows and underflows, and the range of every named signal.

use std::collections::BTreeMap;

use crate::audit::signal::Signal;
use crate::audit::signal_range::SignalRange;
use crate::audit::thread_record::{Record, lost_so_far};
use crate::{Extremes, Histogram};

/// The record that [`Audit::of`] makes of a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Audit {
    /// Number of results too large for the format: they wrapped, saturated, or became infinite or NaN. In fixed point a
    /// result counts if it differs from the exact one by a unit of the last place or more: rounding alone never differs
    /// by so much.
    pub overflows: u64,
    /// Number of results too small for the format: they are zero, and the exact ones are not.
    pub underflows: u64,
    /// Divisions by zero.
    pub divisions_by_zero: u64,
    /// The first signal that was named after the first overflow; `None` without an overflow, or a signal after it.
    pub first_overflow: Option<&'static str>,
    /// The range of each named signal.
    pub signals: BTreeMap<&'static str, SignalRange>,
    /// How large the values of each named signal were, by powers of two.
    pub histograms: BTreeMap<&'static str, Histogram>,
}

impl Audit {
    /// Runs `work`. Returns its result, and what the [`Audited`](crate::Audited) numbers of this thread met meanwhile.
    ///
    /// An inner call keeps a record of its own, which the outer call does not see.
    pub fn of<T>(work: impl FnOnce() -> T) -> (T, Audit) {
        let (result, record) = Record::default().kept_while(work);
        (result, Self::of_record(record))
    }

    /// Overflows and divisions by zero that the [`Audited`](crate::Audited) numbers of this thread have met in the
    /// present call of [`Audit::of`] or [`Extremes::of`].
    #[must_use]
    pub fn lost_so_far() -> u64 {
        lost_so_far()
    }

    /// Adds what another part of the same run met.
    pub fn join(&mut self, other: Self) {
        self.overflows += other.overflows;
        self.underflows += other.underflows;
        self.divisions_by_zero += other.divisions_by_zero;
        self.first_overflow = self.first_overflow.or(other.first_overflow);
        for (name, range) in other.signals {
            self.signals.entry(name).or_default().join(&range);
        }
        for (name, histogram) in other.histograms {
            self.histograms.entry(name).or_default().join(&histogram);
        }
    }

    /// Integer bits, the sign included, that the signal with the largest values needs; 1 if no signal was recorded.
    #[must_use]
    pub fn integer_bits_needed(&self) -> u32 {
        Extremes::from(self).integer_bits_needed()
    }

    /// The audit that a record ends with.
    fn of_record(record: Record) -> Self {
        let Record { overflows, underflows, divisions_by_zero, first_overflow, signals, .. } = record;
        let mut audit = Audit { overflows, underflows, divisions_by_zero, first_overflow, ..Self::default() };
        for mut signal in signals {
            signal.include_newest();
            signal.include_words();
            let Signal { name, range, histogram, .. } = signal;
            audit.signals.insert(name, range);
            audit.histograms.insert(name, histogram);
        }
        audit
    }
}

impl Extremes {
    /// Runs `work`. Returns its result, and what the [`Audited`](crate::Audited) numbers of this thread met meanwhile.
    ///
    /// An inner call keeps a record of its own, as that of [`Audit::of`] does.
    pub fn of<T>(work: impl FnOnce() -> T) -> (T, Extremes) {
        let (result, record) = Record::of_all_together().kept_while(work);
        let Record { overflows, divisions_by_zero, all, .. } = record;
        let range = all.unwrap_or_default().finished();
        (result, Extremes { overflows, divisions_by_zero, ..range })
    }
}

impl From<&Audit> for Extremes {
    fn from(audit: &Audit) -> Self {
        let lost = Self {
            overflows: audit.overflows,
            divisions_by_zero: audit.divisions_by_zero,
            ..Self::default()
        };
        audit.signals.values().fold(lost, |mut all, signal| {
            all.include(signal.min, signal.max);
            all
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Real;
    use crate::audit::audited::examples::audited;

    #[test]
    fn signals_have_ranges_and_integer_bits() {
        let ((), audit) = Audit::of(|| {
            for value in [-8.0, 0.0, 0.25, 7.5] {
                let _ = audited(value).signal("x");
            }
        });
        let x = audit.signals["x"];
        assert_eq!((x.min, x.max, x.min_magnitude, x.count), (-8.0, 7.5, 0.25, 4));
        assert_eq!(audit.integer_bits_needed(), 4); // -8 fits 4 bits with the sign, +8 would not
    }

    #[test]
    fn audits_nest() {
        let (inner, outer) = Audit::of(|| Audit::of(|| audited(300.0) * audited(300.0)).1);
        assert_eq!((inner.overflows, outer.overflows), (1, 0));
    }
}
