//! The auditing wrapper: the same values, with overflows and underflows counted and the range of every named signal recorded.
//!
//! The wrapper hands on the backend's result unchanged. Beside it, it forms the exact result, in integers for fixed
//! point, and checks whether the two differ by more than rounding. The records live in thread-local storage, so that a
//! value stays as small as the backend's own and a kernel needs no extra argument.

use std::cell::RefCell;
use std::collections::{BTreeMap, HashMap};
use std::hash::{BuildHasherDefault, Hasher};

use crate::fate::Fate;
use crate::word::Word;
use crate::wrapper::{Wrapper, wrapper};
use crate::{Backend, Extremes, Histogram, Operation, Real};

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
    /// The range of each named signal.
    pub signals: BTreeMap<&'static str, SignalRange>,
    /// How large the values of each named signal were, by powers of two.
    pub histograms: BTreeMap<&'static str, Histogram>,
}

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
    /// Largest distance between value and shadow; `None` if the signal was not [`Shadowed`](crate::Shadowed).
    pub max_error: Option<f64>,
}

impl SignalRange {
    /// Includes a value that the signal took so many times.
    fn include(&mut self, value: f64, times: u64) {
        self.min = self.min.min(value);
        self.max = self.max.max(value);
        if value == 0.0 {
            self.zeros += times;
        } else {
            self.min_magnitude = self.min_magnitude.min(value.abs());
        }
        self.count += times;
    }
}

impl SignalRange {
    /// Adds the values of another part of the same run.
    fn join(&mut self, other: &Self) {
        self.min = self.min.min(other.min);
        self.max = self.max.max(other.max);
        self.min_magnitude = self.min_magnitude.min(other.min_magnitude);
        self.count += other.count;
        self.zeros += other.zeros;
        self.overflows += other.overflows;
        self.underflows += other.underflows;
        self.max_error = match (self.max_error, other.max_error) {
            (Some(one), Some(other)) => Some(one.max(other)),
            (one, other) => one.or(other),
        };
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
            max_error: None,
        }
    }
}

thread_local! {
    static RECORD: RefCell<Record> = RefCell::default();
}

/// The audit of this thread while it is made.
#[derive(Debug, Default)]
struct Record {
    overflows: u64,
    underflows: u64,
    divisions_by_zero: u64,
    /// In the order in which they were first named.
    signals: Vec<Signal>,
    /// Where the signal is that was named last.
    last: usize,
    /// Where the signal of a name is, by the place and the length of the name's text.
    places: HashMap<(usize, usize), usize, BuildHasherDefault<PlaceHasher>>,
    /// Overflows and underflows that have already been counted for a signal.
    charged: (u64, u64),
    /// The range of all signals, where it alone is wanted: then no signal is kept by its name.
    all: Option<All>,
}

/// The range of all signals together. Values in fixed point wait as words, of which only the extremes are converted.
#[derive(Clone, Copy, Debug)]
struct All {
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
    fn add(&mut self, value: Value) {
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
    fn finished(self) -> Extremes {
        let mut range = self.range;
        if self.least <= self.greatest {
            let [min, max] = [self.least, self.greatest].map(|word| of_word(word, self.fraction_bits));
            range.include(min, max);
        }
        range
    }
}

/// A named signal.
#[derive(Debug)]
struct Signal {
    name: &'static str,
    range: SignalRange,
    histogram: Histogram,
    /// Its values in fixed point, which are still to be included.
    words: Words,
    /// Its newest value in floats, and how often it came in succession: so often it is still to be included. On a straight
    /// move at constant feed most signals keep their values.
    newest: (f64, f64),
    times: u64,
    /// Where the last two other signals are that were named after it. A step names the same signals in the same order
    /// again and again, and some of them in turn with two others.
    next: [usize; 2],
}

impl Signal {
    fn new(name: &'static str) -> Self {
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
    fn add(&mut self, value: Value) {
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
    fn include_newest(&mut self) {
        let times = std::mem::take(&mut self.times);
        if times > 0 {
            self.range.include(cut(self.newest), times);
            self.histogram.include_times(self.newest, times);
        }
    }

    /// Includes the values in fixed point.
    #[cold]
    fn include_words(&mut self) {
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

/// The float of a word with so many bits after its point, cut toward zero.
fn of_word(word: i64, fraction_bits: u32) -> f64 {
    let ((high, low), exponent) = (word.split(), -fraction_bits.cast_signed());
    cut((high.ldexp(exponent), low.ldexp(exponent)))
}

/// The float of a pair, cut toward zero: rounding to the high float went away from zero if the low one points back.
fn cut((high, low): (f64, f64)) -> f64 {
    if low != 0.0 && (low < 0.0) != (high < 0.0) { toward_zero(high) } else { high }
}

/// Values in fixed point as integers: what is asked of them is monotone, so that only the results are converted.
#[derive(Clone, Copy, Debug)]
struct Words {
    fraction_bits: u32,
    least: i64,
    greatest: i64,
    /// The least magnitude that is not 0.
    nearest: u64,
    zeros: u64,
    /// How many magnitudes have their leading bit at each place.
    by_length: [u64; 64],
}

impl Words {
    fn of(fraction_bits: u32) -> Self {
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
    fn add(&mut self, word: i64) {
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

/// A value as its format has it: a word and the bits after its point, or a sum of two floats.
#[derive(Clone, Copy, Debug)]
enum Value {
    Word(i64, u32),
    Floats(f64, f64),
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

impl Audit {
    /// Runs `work`. Returns its result, and what the [`Audited`] numbers of this thread met meanwhile.
    ///
    /// An inner call keeps a record of its own, which the outer call does not see.
    pub fn of<T>(work: impl FnOnce() -> T) -> (T, Audit) {
        let outer = RECORD.with(RefCell::take);
        let result = work();
        (result, RECORD.with(|record| record.replace(outer)).finished())
    }

    /// Overflows and divisions by zero that the [`Audited`] numbers of this thread have met in the present call of
    /// [`Audit::of`] or [`Extremes::of`].
    #[must_use]
    pub fn lost_so_far() -> u64 {
        RECORD.with(|record| {
            let record = record.borrow();
            record.overflows + record.divisions_by_zero
        })
    }

    /// Adds what another part of the same run met.
    pub fn join(&mut self, other: Self) {
        self.overflows += other.overflows;
        self.underflows += other.underflows;
        self.divisions_by_zero += other.divisions_by_zero;
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

    /// Notes the distance of a signal from its shadow.
    pub(crate) fn note_error(name: &'static str, error: f64) {
        note(|record| {
            let largest = &mut record.signal(name).range.max_error;
            *largest = Some(largest.map_or(error, |largest| largest.max(error)));
        });
    }
}

impl Extremes {
    /// Runs `work`. Returns its result, and what the [`Audited`] numbers of this thread met meanwhile.
    ///
    /// An inner call keeps a record of its own, as that of [`Audit::of`] does.
    pub fn of<T>(work: impl FnOnce() -> T) -> (T, Extremes) {
        let own = Record { all: Some(All::default()), ..Record::default() };
        let outer = RECORD.with(|record| record.replace(own));
        let result = work();
        let Record { overflows, divisions_by_zero, all, .. } = RECORD.with(|record| record.replace(outer));
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

#[inline]
fn note(change: impl FnOnce(&mut Record)) {
    RECORD.with(|record| change(&mut record.borrow_mut()));
}

/// Notes a value of a signal. It is compiled once and not for each format: thread-local storage is quick to reach only
/// within the crate that has it.
#[inline(never)]
fn note_signal(name: &'static str, value: Value) {
    note(|record| record.include(name, value));
}

#[cold]
#[inline(never)]
fn note_division_by_zero() {
    note(|record| record.divisions_by_zero += 1);
}

impl Record {
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
        let range = &mut self.signals[self.last].range;
        range.overflows += lost.0 - self.charged.0;
        range.underflows += lost.1 - self.charged.1;
        self.charged = lost;
    }

    /// The signal of this name.
    #[inline]
    fn signal(&mut self, name: &'static str) -> &mut Signal {
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

    fn finished(self) -> Audit {
        let Self { overflows, underflows, divisions_by_zero, signals, .. } = self;
        let mut audit = Audit { overflows, underflows, divisions_by_zero, ..Audit::default() };
        for mut signal in signals {
            signal.include_newest();
            signal.include_words();
            let Signal { name, range, histogram, .. } = signal;
            audit.signals.insert(name, range);
            // A signal of which only errors were noted has no values.
            if range.count > 0 {
                audit.histograms.insert(name, histogram);
            }
        }
        audit
    }
}

/// The neighbour of a number that is not zero.
fn toward_zero(x: f64) -> f64 {
    f64::from_bits(x.to_bits() - 1)
}

#[inline]
fn note_fate(fate: Fate) {
    if fate != Fate::Rounded {
        note_lost(fate == Fate::Overflowed);
    }
}

#[cold]
#[inline(never)]
fn note_lost(overflowed: bool) {
    note(|record| if overflowed { record.overflows += 1 } else { record.underflows += 1 });
}

/// A number of a backend in fixed point, in units of its resolution.
#[inline]
fn units<R: Backend>(number: R) -> i128 {
    number.word().unwrap_or(0).into()
}

/// A backend under audit: computes exactly as `R` does, and counts in the [`Audit`] of its thread.
#[derive(Clone, Copy, Debug, Default)]
pub struct Audited<R>(pub R);

impl<R: Backend> Wrapper for Audited<R> {
    type Inner = R;

    fn inner(self) -> R {
        self.0
    }

    fn constant(value: R) -> Self {
        Self(value)
    }

    #[inline(always)] // Into each operation, which is then known.
    fn observe(operation: Operation, operands: &[Self], result: R) -> Self {
        if operation == Operation::Div && operands[1].0.is_zero() {
            note_division_by_zero();
        } else if !R::IS_FLOATING {
            let (x, fraction_bits) = (|i: usize| units(operands[i].0), || R::fraction_bits().unwrap_or(0));
            note_fate(Fate::in_fixed_point(operation, (x, operands.len()), units(result), fraction_bits));
        } else {
            note_fate(Fate::in_float(operation, (|i: usize| operands[i].0, operands.len()), result));
        }
        Self(result)
    }

    fn ratio(numerator: i32, denominator: i32, result: R) -> Self {
        if denominator == 0 {
            note_division_by_zero();
        } else if let Some(fraction_bits) = R::fraction_bits() {
            let x = |i: usize| if i == 0 { numerator.into() } else { denominator.into() };
            note_fate(Fate::in_fixed_point(Operation::Div, (x, 2), units(result), || fraction_bits));
        }
        Self(result)
    }

    fn phase(phase: u64, exponent: i32, result: R) -> Self {
        if let Some(fraction_bits) = R::fraction_bits() {
            // In units: phase · 2^(exponent - 64 + f), of which the integer part has 126 bits at most.
            let shift = exponent.clamp(-64, 64) - 64 + fraction_bits.cast_signed();
            let (phase, result) = (i128::from(phase), units(result));
            if shift < 0 {
                note_fate(Fate::of(result, phase, 1 << shift.unsigned_abs().min(100)));
            } else {
                note_fate(Fate::of(result, phase << shift, 1));
            }
        }
        Self(result)
    }

    #[inline]
    fn named(self, name: &'static str) -> Self {
        let value = match (self.0.word(), R::fraction_bits()) {
            (Some(word), Some(fraction_bits)) => Value::Word(word, fraction_bits),
            _ => {
                let (high, low) = self.0.to_f64_pair();
                Value::Floats(high, low)
            }
        };
        note_signal(name, value);
        Self(self.0.signal(name))
    }
}

wrapper!(impl[R: Backend] Audited<R>);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{I4F4, I4F60, I16F16};
    use num_traits::{Bounded, Zero};
    use proptest::prelude::*;

    fn audited(value: f64) -> Audited<I16F16> {
        Audited::from_f64(value).expect("the value fits")
    }

    #[test]
    fn an_overflow_is_counted_and_the_value_is_the_backends_own() {
        let (product, audit) = Audit::of(|| audited(300.0) * audited(300.0));
        assert_eq!(product.0, audited(300.0).0 * audited(300.0).0);
        assert_eq!((audit.overflows, audit.divisions_by_zero), (1, 0));
        let ((), quiet) = Audit::of(|| {
            let _ = audited(100.0) * audited(300.0);
        });
        assert_eq!(quiet.overflows, 0);
    }

    #[test]
    fn a_division_by_zero_is_counted() {
        let (_, audit) = Audit::of(|| audited(1.0) / audited(0.0));
        assert_eq!(audit.divisions_by_zero, 1);
    }

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

    #[test]
    fn a_float_overflow_is_an_infinity() {
        let (_, audit) = Audit::of(|| Audited(1e30_f32) * Audited(1e30_f32));
        assert_eq!(audit.overflows, 1);
    }

    /// Signals, products that overflow or do not, and quotients, of numbers one after the other. What is not finite comes too.
    fn met<R: Backend>(numbers: &[(usize, f64)]) {
        let numbers = numbers.iter().filter_map(|(name, x)| Some((*name, Audited::<R>::from_f64(*x)?)));
        let _ = numbers.fold(Audited::<R>::zero(), |last, (name, x)| {
            let _ = (x * last).signal(["a", "b", "c"][name]);
            (x / last).signal(["c", "d", "a"][name])
        });
    }

    fn extremes_are_those_of_the_audit<R: Backend>(numbers: &[(usize, f64)]) -> Extremes {
        let ((), audit) = Audit::of(|| met::<R>(numbers));
        let ((), extremes) = Extremes::of(|| met::<R>(numbers));
        assert_eq!(extremes, Extremes::from(&audit));
        let widest = audit.signals.values().map(|range| {
            let held = |n: &i32| range.min >= -(2.0_f64.powi(n - 1)) && range.max < 2.0_f64.powi(n - 1);
            (1..=128).find(held).unwrap_or(129)
        });
        let expected = (audit.overflows, audit.divisions_by_zero, widest.max().unwrap_or(1).unsigned_abs());
        assert_eq!(
            (extremes.overflows, extremes.divisions_by_zero, extremes.integer_bits_needed()),
            expected
        );
        let (first, second) = numbers.split_at(numbers.len() / 2);
        let ((_, mut joined), (_, other)) =
            (Extremes::of(|| met::<R>(first)), Extremes::of(|| met::<R>(second)));
        let ((_, mut parts), (_, rest)) = (Audit::of(|| met::<R>(first)), Audit::of(|| met::<R>(second)));
        joined.join(other);
        parts.join(rest);
        assert_eq!(joined, Extremes::from(&parts));
        extremes
    }

    #[test]
    fn extremes_of_nothing_are_those_of_an_empty_audit() {
        assert_eq!(extremes_are_those_of_the_audit::<I16F16>(&[]), Extremes::default());
        assert_eq!(Extremes::default().integer_bits_needed(), 1);
    }

    #[test]
    fn extremes_count_what_overflows_and_what_does_not() {
        let quiet = extremes_are_those_of_the_audit::<I16F16>(&[(0, 2.0), (1, -3.0)]);
        assert_eq!((quiet.overflows, quiet.divisions_by_zero), (1, 1)); // 2/0 is an overflow too
        let lost = extremes_are_those_of_the_audit::<I4F4>(&[(0, 7.0), (1, 0.25), (2, -6.0), (0, 7.5)]);
        assert!(lost.overflows > 0);
        assert!(extremes_are_those_of_the_audit::<f32>(&[(0, 1e30), (1, 1e-30), (2, 1e30)]).overflows > 0);
    }

    #[test]
    fn a_record_within_extremes_is_kept_apart() {
        let (inner, outer) = Extremes::of(|| Audit::of(|| audited(300.0) * audited(300.0)).1);
        assert_eq!((inner.overflows, outer.overflows), (1, 0));
    }

    proptest! {
        #[test]
        fn extremes_are_those_of_any_audit(
            numbers in proptest::collection::vec((0..3_usize, prop_oneof![Just(0.0), -8.0..8.0, -1e4..1e4, Just(1e30)]), 0..30),
        ) {
            extremes_are_those_of_the_audit::<I4F4>(&numbers);
            extremes_are_those_of_the_audit::<I16F16>(&numbers);
            extremes_are_those_of_the_audit::<I4F60>(&numbers);
            extremes_are_those_of_the_audit::<f32>(&numbers);
            extremes_are_those_of_the_audit::<f64>(&numbers);
        }
    }

    #[test]
    fn audits_nest() {
        let (inner, outer) = Audit::of(|| Audit::of(|| audited(300.0) * audited(300.0)).1);
        assert_eq!((inner.overflows, outer.overflows), (1, 0));
    }

    /// Every pair of I4F4: an overflow is counted where the rounded exact result is outside the range, an underflow where
    /// zero stands for something else. Quotients saturate: clipped by less than a unit they are as good as rounded.
    #[test]
    fn events_are_counted_exactly() {
        let check = |what: &str, operation: &dyn Fn() -> Audited<I4F4>, exact_16ths: f64, clip: f64| {
            let (result, audit) = Audit::of(operation);
            let overflow = exact_16ths < -128.0 - clip || exact_16ths >= 127.0 + clip;
            let underflow = !overflow && exact_16ths != 0.0 && result.0.to_bits() == 0;
            assert_eq!((audit.overflows, audit.underflows), (overflow.into(), underflow.into()), "{what}");
        };
        for (a, b) in (i8::MIN..=i8::MAX).flat_map(|a| (i8::MIN..=i8::MAX).map(move |b| (a, b))) {
            let [x, y] = [a, b].map(|bits| Audited(I4F4::from_bits(bits)));
            let [a, b] = [a, b].map(f64::from);
            check("+", &|| x + y, a + b, 0.5);
            check("-", &|| x - y, a - b, 0.5);
            check("*", &|| x * y, a * b / 16.0, 0.5);
            check("mul_add", &|| x.mul_add(y, y), a * b / 16.0 + b, 0.5);
            check("sum", &|| Real::sum_of_products([(x, y), (x, x)]), (a * b + a * a) / 16.0, 0.5);
            if b != 0.0 {
                // -129 is one unit off, +128 too.
                let exact = a / b * 16.0;
                check("/", &|| x / y, if exact <= -129.0 { -200.0 } else { exact.max(-128.0) }, 1.0);
            }
            check("norm", &|| Real::norm(&[x, y]), a.hypot(b), 1.0);
            if b == 0.0 {
                check("-", &|| -x, -a, 0.5);
                check("√", &|| x.sqrt(), (a.max(0.0) * 16.0).sqrt(), 0.5);
                for exponent in -126..=126 {
                    check("ldexp", &|| x.ldexp(exponent), a * 2.0_f64.powi(exponent), 0.5);
                }
            }
        }
        for (n, d) in (-200..200).flat_map(|n| (1..40).map(move |d| (n, d))) {
            let exact = f64::from(n) / f64::from(d) * 16.0;
            let exact = if exact <= -129.0 { -200.0 } else { exact.max(-128.0) };
            check("ratio", &|| Audited::from_ratio(n, d), exact, 1.0);
        }
        for (phase, exponent) in
            [0, 1, 3 << 58, 1 << 62, u64::MAX << 11].into_iter().flat_map(|p| (-64..=64).map(move |e| (p, e)))
        {
            let exact = phase as f64 * 2.0_f64.powi(exponent - 60);
            check("phase", &|| Audited::from_phase(phase, exponent), exact, 1.0);
        }
    }

    /// The widest words: products of 128 bits, sums of them beyond, values that f64 rounds.
    #[test]
    fn events_are_counted_exactly_in_64_bits() {
        let number = |bits: i64| Audited(I4F60::from_bits(bits));
        let events = |operation: &dyn Fn() -> Audited<I4F60>| {
            let (_, audit) = Audit::of(operation);
            (audit.overflows, audit.underflows)
        };
        let (least, greatest, one) = (number(i64::MIN), number(i64::MAX), number(1 << 60));
        assert_eq!(events(&|| greatest + number(1)), (1, 0));
        assert_eq!(events(&|| greatest - number(1)), (0, 0));
        assert_eq!(events(&|| greatest * one), (0, 0));
        assert_eq!(events(&|| greatest.mul_add(one, number(1))), (1, 0));
        assert_eq!(events(&|| greatest / one), (0, 0));
        assert_eq!(events(&|| least / -one), (1, 0));
        assert_eq!(events(&|| -least), (1, 0));
        assert_eq!(events(&|| Real::sum_of_products([(least, least); 5])), (1, 0));
        assert_eq!(
            events(&|| Real::sum_of_products([(greatest, one), (number(1), one), (number(-1), one)])),
            (0, 0)
        );
        assert_eq!(events(&|| number(1 << 30).mul_add(number(1 << 29), number(0))), (0, 0)); // half a unit goes up
        assert_eq!(events(&|| number(1 << 30).mul_add(number(1 << 28), number(0))), (0, 1));
        assert_eq!(events(&|| Real::norm(&[least; 20])), (1, 0));
        assert_eq!(number(-1).ldexp(63).0, least.0);
        assert_eq!(events(&|| number(-1).ldexp(63)), (0, 0));
        for (x, exponent) in [(number(1), 63), (least, 63), (number(-1), 64), (least, i32::MAX)] {
            assert_eq!(events(&|| x.ldexp(exponent)), (1, 0), "{x:?} by 2^{exponent}");
        }
    }

    #[test]
    fn a_saturating_format_overflows_like_a_wrapping_one() {
        use crate::{Overflow, Rounding, RuntimeFixed, RuntimeFormat};
        for overflow in [Overflow::Wrap, Overflow::Saturate] {
            let format = RuntimeFormat::with_any_point(8, 10, Rounding::Floor, overflow).unwrap();
            let (_, audit) = format.run::<0, _>(|| {
                let x = Audited(RuntimeFixed::<0>::max_value());
                Audit::of(|| (x + x, x * x)) // 127·127/1024 = 15.75 units
            });
            assert_eq!(audit.overflows, 1);
        }
    }

    #[test]
    fn floats_underflow_to_zero() {
        let tiny = Audited(1e-30_f32);
        let events = |operation: &dyn Fn() -> Audited<f32>| {
            let (_, audit) = Audit::of(operation);
            (audit.overflows, audit.underflows)
        };
        assert_eq!(events(&|| tiny * tiny), (0, 1));
        assert_eq!(events(&|| tiny / Audited(1e30)), (0, 1));
        assert_eq!(events(&|| tiny.ldexp(-126)), (0, 1));
        assert_eq!(events(&|| tiny.mul_add(tiny, Audited(0.0))), (0, 1));
        assert_eq!(events(&|| Real::sum_of_products([(tiny, tiny), (tiny, Audited(0.0))])), (0, 1));
        assert_eq!(events(&|| Real::sum_of_products([(tiny, Audited(1.0)), (tiny, Audited(-1.0))])), (0, 0));
        assert_eq!(events(&|| tiny - tiny), (0, 0));
        assert_eq!(events(&|| Audited(0.0) * tiny), (0, 0));
        assert_eq!(events(&|| tiny.mul_add(Audited(1.0), -tiny)), (0, 0));
        assert_eq!(events(&|| Audited(1.0) / (Audited(1e30) * Audited(1e30))), (1, 0)); // 1/∞ is exactly 0
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

    /// 8 - 2⁻⁶⁰ is 8 as a float, which would need one bit more.
    #[test]
    fn the_extremes_of_64_bits_are_cut_and_not_rounded() {
        let ((), audit) = Audit::of(|| {
            for bits in [i64::MAX, i64::MIN] {
                let _ = Audited(I4F60::from_bits(bits)).signal("x");
            }
        });
        assert_eq!((audit.signals["x"].min, audit.signals["x"].max), (-8.0, 8.0_f64.next_down()));
        assert_eq!(audit.integer_bits_needed(), 4);
    }

    #[test]
    fn no_value_is_changed() {
        let numbers = |x: i32, y: i32| [I16F16::from_bits(x), I16F16::from_bits(y)];
        let mut random = 1_i32;
        for _ in 0..10_000 {
            random = random.wrapping_mul(1_103_515_245).wrapping_add(12_345);
            let [x, y] = numbers(random, random.rotate_left(11) >> (random & 15));
            let [a, b] = [x, y].map(Audited);
            let audited = [a + b, a - b, -a, a * b, a / b, a.mul_add(b, a), a.sqrt(), a.ldexp(random % 20)];
            assert_eq!(
                audited.map(|r| r.0),
                [x + y, x - y, -x, x * y, x / y, x.mul_add(y, x), x.sqrt(), x.ldexp(random % 20)]
            );
            assert_eq!(Real::norm(&[a, b]).0, Real::norm(&[x, y]));
            let terms = 1 + (random & 31).unsigned_abs() as usize; // also more than the stack holds
            let sum = Audited::sum_of_products(std::iter::repeat_n((a, b), terms));
            assert_eq!(sum.0, I16F16::sum_of_products(std::iter::repeat_n((x, y), terms)));
            assert_eq!((a < b, a == b, a.to_phase(-9)), (x < y, x == y, x.to_phase(-9)));
        }
    }
}
