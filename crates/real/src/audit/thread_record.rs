//! The record that a thread keeps while its audit is made.
//!
//! The records live in thread-local storage, so that a value stays as small as the backend's own and a kernel needs no
//! extra argument.

use std::cell::RefCell;
use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

use crate::audit::all_signals::All;
use crate::audit::signal::Signal;
use crate::audit::value::Value;
use crate::fate::Fate;

thread_local! {
    static RECORD: RefCell<Record> = RefCell::default();
}

/// The audit of this thread while it is made.
#[derive(Debug, Default)]
pub(super) struct Record {
    pub(super) overflows: u64,
    pub(super) underflows: u64,
    pub(super) divisions_by_zero: u64,
    /// In the order in which they were first named.
    pub(super) signals: Vec<Signal>,
    /// Where the signal is that was named last.
    last: usize,
    /// Where the signal of a name is, by the place and the length of the name's text.
    places: HashMap<(usize, usize), usize, BuildHasherDefault<PlaceHasher>>,
    /// Overflows and underflows that have already been counted for a signal.
    charged: (u64, u64),
    /// The signal that was the first to be charged with an overflow.
    pub(super) first_overflow: Option<&'static str>,
    /// The range of all signals, where it alone is wanted: then no signal is kept by its name.
    pub(super) all: Option<All>,
}

impl Record {
    /// A record of the range of all signals together.
    pub(super) fn of_all_together() -> Self {
        Self { all: Some(All::default()), ..Self::default() }
    }

    /// Runs `work` while this is the record of the thread. Returns the result, and the record with what was noted.
    pub(super) fn kept_while<T>(self, work: impl FnOnce() -> T) -> (T, Self) {
        let outer = RECORD.with(|record| record.replace(self));
        let result = work();
        (result, RECORD.with(|record| record.replace(outer)))
    }

    #[inline]
    fn include(&mut self, name: &'static str, value: Value) {
        if let Some(all) = &mut self.all {
            all.add(value);
            return;
        }
        let lost = (self.overflows, self.underflows);
        let signal = self.signal(name);
        signal.add(value);
        if lost != self.charged {
            self.charge(lost);
        }
    }

    /// Counts for the signal that was named last what was lost before it.
    #[cold]
    fn charge(&mut self, lost: (u64, u64)) {
        if lost.0 != self.charged.0 && self.first_overflow.is_none() {
            self.first_overflow = Some(self.signals[self.last].name);
        }
        let range = &mut self.signals[self.last].range;
        range.overflows += lost.0 - self.charged.0;
        range.underflows += lost.1 - self.charged.1;
        self.charged = lost;
    }

    /// The signal of this name.
    #[inline]
    pub(super) fn signal(&mut self, name: &'static str) -> &mut Signal {
        let has_name = |at: usize| self.signals.get(at).is_some_and(|signal| std::ptr::eq(signal.name, name));
        if !has_name(self.last) {
            let expected = self.signals.get(self.last).map_or([0; 2], |last| last.next);
            let known = expected.into_iter().find(|at| has_name(*at));
            self.last = known.unwrap_or_else(|| self.find(name));
        }
        &mut self.signals[self.last]
    }

    /// Where the signal of this name is, which the one before it did not expect.
    #[inline(never)]
    fn find(&mut self, name: &'static str) -> usize {
        let place = (name.as_ptr() as usize, name.len());
        let index = match self.places.get(&place) {
            Some(index) => *index,
            None => self.find_text(name, place),
        };
        let next = &mut self.signals[self.last].next;
        *next = [index, next[0]];
        index
    }

    /// Where the signal is of a name whose text was not seen at this place before.
    #[cold]
    fn find_text(&mut self, name: &'static str, place: (usize, usize)) -> usize {
        let known = self.signals.iter().position(|signal| signal.name == name);
        let index = known.unwrap_or_else(|| {
            self.signals.push(Signal::new(name));
            self.signals.len() - 1
        });
        self.places.insert(place, index);
        index
    }
}

/// Overflows and divisions by zero that the record of this thread has so far.
pub(super) fn lost_so_far() -> u64 {
    RECORD.with(|record| {
        let record = record.borrow();
        record.overflows + record.divisions_by_zero
    })
}

#[inline]
fn note(change: impl FnOnce(&mut Record)) {
    RECORD.with(|record| change(&mut record.borrow_mut()));
}

/// Notes a value of a signal. It is compiled once and not for each format: thread-local storage is quick to reach only
/// within the crate that has it.
#[inline(never)]
pub(super) fn note_signal(name: &'static str, value: Value) {
    note(|record| record.include(name, value));
}

#[cold]
#[inline(never)]
pub(super) fn note_division_by_zero() {
    note(|record| record.divisions_by_zero += 1);
}

#[inline]
pub(super) fn note_fate(fate: Fate) {
    if fate != Fate::Rounded {
        note_lost(fate == Fate::Overflowed);
    }
}

#[cold]
#[inline(never)]
fn note_lost(overflowed: bool) {
    note(|record| if overflowed { record.overflows += 1 } else { record.underflows += 1 });
}

/// Makes a hash of the place and the length of a text. The greatest factor is odd, so that no two places of one length
/// have the same hash.
#[derive(Debug, Default)]
struct PlaceHasher(u64);

impl Hasher for PlaceHasher {
    fn finish(&self) -> u64 {
        self.0
    }

    fn write(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|byte| self.write_usize((*byte).into()));
    }

    #[inline]
    fn write_usize(&mut self, number: usize) {
        self.0 = (self.0.rotate_left(32) ^ number as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    }
}

#[cfg(test)]
mod tests {
    use crate::audit::audited::examples::audited;
    use crate::{Audit, Audited, Real};
    use proptest::prelude::*;

    proptest! {
        /// Values that come in succession are included together, and signals are found in whatever order they are named: the
        /// record is that of one value after the other.
        #[test]
        fn values_in_succession_are_counted_one_by_one(
            values in proptest::collection::vec((0..5_usize, prop::sample::select(vec![0.0, -0.0, 0.25, 3.0, -8.0]), 1..4_usize), 0..60),
        ) {
            const NAMES: [&str; 5] = ["a", "b", "c", "d", "e"];
            let ((), found) = Audit::of(|| {
                for (name, value, times) in &values {
                    for _ in 0..*times {
                        let _ = Audited(*value).signal(NAMES[*name]);
                    }
                }
            });
            let ((), words) = Audit::of(|| {
                for (name, value, times) in &values {
                    for _ in 0..*times {
                        let _ = audited(*value).signal(NAMES[*name]);
                    }
                }
            });
            let mut expected = Audit::default();
            for (name, value, times) in values {
                for _ in 0..times {
                    expected.signals.entry(NAMES[name]).or_default().include(value, 1);
                    expected.histograms.entry(NAMES[name]).or_default().include((value, 0.0));
                }
            }
            prop_assert_eq!(&found, &expected);
            prop_assert_eq!(words, expected);
        }
    }

    #[test]
    fn a_signal_is_charged_with_what_led_to_it() {
        let (_, audit) = Audit::of(|| {
            let x = audited(0.001).signal("x");
            let squared = (x * x).signal("x²"); // 1e-6 vanishes in steps of 1.5e-5
            let big = (audited(300.0) * audited(300.0)).signal("big");
            (squared + big).signal("sum")
        });
        let events = |name: &str| (audit.signals[name].overflows, audit.signals[name].underflows);
        assert_eq!(
            [events("x"), events("x²"), events("big"), events("sum")],
            [(0, 0), (0, 1), (1, 0), (0, 0)]
        );
        assert_eq!((audit.overflows, audit.underflows), (1, 1));
        assert_eq!((audit.signals["x²"].zeros, audit.signals["x"].zeros), (1, 0));
    }
}
