//! The watching wrapper: which way a kernel went at each comparison, and how many bits its results need.
//!
//! Two runs of one kernel, in a format and in its reference, do the same operations until a comparison turns out
//! differently. From there on their values have nothing to do with each other, however small the rounding was that led
//! to it. So the first such comparison is what explains the difference.

use std::cell::{Cell, RefCell};
use std::sync::Arc;

use crate::wrapper::{Wrapper, wrapper};
use crate::{Backend, Operation};

/// Most decisions of a run that are kept: 64 MiB.
const MOST_KEPT: usize = 1 << 26;

/// A backend under watch: computes exactly as `R` does, and notes in the [`Watch`] of its thread.
///
/// Only comparisons by which a kernel can go one way or the other are decisions: `<`, `<=`, `>`, `>=`, `==` and
/// [`is_part`](crate::Real::is_part). `max`, `min` and `abs` select a value. What a kernel decides by integers that it
/// made of phases is not seen.
#[derive(Clone, Copy, Debug, Default)]
pub struct Watched<R> {
    value: R,
    /// The name that the kernel gave this very value.
    name: Option<&'static str>,
}

/// What is to be noted of decisions.
#[derive(Clone, Debug)]
pub enum Watching {
    /// Nothing.
    Nothing,
    /// All of them.
    All,
    /// The first that turns out otherwise than in these, which another run kept.
    Against(Arc<[bool]>),
    /// The decision of this number, from 0.
    Only(usize),
}

/// A comparison.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Decision {
    /// Its number in the run, from 0.
    pub number: usize,
    /// The value to the left.
    pub left: f64,
    /// The value to the right.
    pub right: f64,
    /// Whether it holds.
    pub holds: bool,
    /// The name of one of the two values; without one, that of the value that was named last before.
    pub signal: Option<&'static str>,
}

/// What a run showed.
#[derive(Clone, Debug, PartialEq)]
pub struct Watch {
    /// Each decision, if all were to be noted, up to 2²⁶ of them.
    pub decisions: Vec<bool>,
    /// The decision that was to be noted.
    pub found: Option<Decision>,
    /// Number of decisions.
    pub count: usize,
    /// The least and the greatest word of any result in fixed point: `least > greatest` if there was none.
    pub words: (i64, i64),
    /// Whether the kernel asked for a number that depends on the format's width.
    pub asked_for_bounds: bool,
}

/// Decisions while a run is made.
struct Decisions {
    watching: Watching,
    watch: Watch,
    last_named: Option<&'static str>,
}

impl Default for Watch {
    fn default() -> Self {
        Self { decisions: Vec::new(), found: None, count: 0, words: NO_WORDS, asked_for_bounds: false }
    }
}

/// The range of no word.
const NO_WORDS: (i64, i64) = (i64::MAX, i64::MIN);

thread_local! {
    static DECISIONS: RefCell<Option<Decisions>> = const { RefCell::new(None) };
    static WORDS: Cell<(i64, i64)> = const { Cell::new(NO_WORDS) };
    static SELECTING: Cell<bool> = const { Cell::new(false) };
}

impl Watch {
    /// Runs `work`. Returns its result, and what the [`Watched`] numbers of this thread showed meanwhile.
    ///
    /// An inner call keeps a watch of its own, which the outer call does not see.
    pub fn of<T>(watching: Watching, work: impl FnOnce() -> T) -> (T, Watch) {
        let now = Decisions { watching, watch: Watch::default(), last_named: None };
        let outer = (DECISIONS.replace(Some(now)), WORDS.replace(NO_WORDS), SELECTING.replace(false));
        let result = work();
        let mut watch = DECISIONS.replace(outer.0).map(|now| now.watch).unwrap_or_default();
        watch.words = WORDS.replace(outer.1);
        SELECTING.set(outer.2);
        (result, watch)
    }

    /// Number of decisions so far in the present call of [`Watch::of`].
    #[must_use]
    pub fn count_so_far() -> usize {
        DECISIONS.with_borrow(|now| now.as_ref().map_or(0, |now| now.watch.count))
    }

    /// [`integer_bits`](Self::integer_bits) so far in the present call of [`Watch::of`].
    #[must_use]
    pub fn integer_bits_so_far(fraction_bits: u32) -> u32 {
        integer_bits(WORDS.get(), fraction_bits)
    }

    /// Integer bits, the sign included, in which every result fits that has this many fraction bits: constants, inputs and
    /// what was computed, named or not. 0 if there was none.
    #[must_use]
    pub fn integer_bits(&self, fraction_bits: u32) -> u32 {
        integer_bits(self.words, fraction_bits)
    }
}

fn integer_bits((least, greatest): (i64, i64), fraction_bits: u32) -> u32 {
    if least > greatest {
        return 0;
    }
    // A word w fits n bits when -2^(n-1) ≤ w < 2^(n-1).
    let bits = |word: i64| 65 - (if word < 0 { !word } else { word }).leading_zeros();
    bits(least).max(bits(greatest)).saturating_sub(fraction_bits)
}

impl Decisions {
    fn note<R: Backend>(&mut self, left: Watched<R>, right: Watched<R>, holds: bool) {
        let number = self.watch.count;
        self.watch.count += 1;
        let is_wanted = match &self.watching {
            Watching::Nothing => false,
            Watching::All => {
                if number < MOST_KEPT {
                    self.watch.decisions.push(holds);
                }
                false
            }
            Watching::Against(others) => {
                self.watch.found.is_none() && others.get(number).is_some_and(|other| *other != holds)
            }
            Watching::Only(wanted) => number == *wanted,
        };
        if is_wanted {
            let signal = left.name.or(right.name).or(self.last_named);
            let [left, right] = [left, right].map(|number| number.value.to_f64());
            self.watch.found = Some(Decision { number, left, right, holds, signal });
        }
    }
}

impl<R: Backend> Watched<R> {
    #[inline]
    fn unnamed(value: R) -> Self {
        if let Some(word) = value.word() {
            note_word(word);
        }
        Self { value, name: None }
    }
}

/// Compiled once and not for each format: thread-local storage is quick to reach only within the crate that has it.
#[inline(never)]
fn note_word(word: i64) {
    let (least, greatest) = WORDS.get();
    if word < least || word > greatest {
        WORDS.set((least.min(word), greatest.max(word)));
    }
}

impl<R: Backend> Wrapper for Watched<R> {
    type Inner = R;

    fn inner(self) -> R {
        self.value
    }

    #[inline]
    fn constant(value: R) -> Self {
        Self::unnamed(value)
    }

    #[inline]
    fn observe(_: Operation, _: &[Self], result: R) -> Self {
        Self::unnamed(result)
    }

    fn bound(value: R) -> Self {
        DECISIONS.with_borrow_mut(|now| {
            if let Some(now) = now {
                now.watch.asked_for_bounds = true;
            }
        });
        Self { value, name: None }
    }

    fn decided(left: Self, right: Self, holds: bool) {
        if SELECTING.get() {
            return;
        }
        DECISIONS.with_borrow_mut(|now| {
            if let Some(now) = now {
                now.note(left, right, holds);
            }
        });
    }

    fn selecting(work: impl FnOnce() -> Self) -> Self {
        let outer = SELECTING.replace(true);
        let selected = work();
        SELECTING.set(outer);
        selected
    }

    fn named(self, name: &'static str) -> Self {
        DECISIONS.with_borrow_mut(|now| {
            if let Some(now) = now {
                now.last_named = Some(name);
            }
        });
        Self { value: self.value.signal(name), name: Some(name) }
    }
}

wrapper!(impl[R: Backend] Watched<R>);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{DoubleDouble, I16F16, Real, RuntimeFixed, RuntimeFormat};
    use num_traits::{Bounded, One, Zero};
    use proptest::prelude::*;

    /// Counts how often a sum of tenths is below 1: in exact numbers ten times.
    fn tenths<R: Real>() -> i32 {
        let (mut sum, mut count) = (R::zero(), 0);
        while sum < R::one() && count < 20 {
            sum = (sum + R::from_ratio(1, 10)).signal("sum");
            let _ = sum.max(R::zero()).abs();
            count += 1;
        }
        count
    }

    #[test]
    fn the_first_decision_that_differs_is_found_with_its_signal() {
        let (count, reference) = Watch::of(Watching::All, tenths::<Watched<DoubleDouble>>);
        assert_eq!((count, reference.decisions.len()), (11, 12)); // ten tenths of a double-double are less than 1, too
        let against = Watching::Against(reference.decisions.into());
        let (count, found) = Watch::of(against.clone(), tenths::<Watched<f64>>);
        assert_eq!((count, found.found), (11, None));
        let (count, found) = Watch::of(against, tenths::<Watched<f32>>);
        let decision = found.found.expect("ten tenths of an f32 are more than 1");
        assert_eq!((count, decision.number, decision.signal, decision.holds), (10, 10, Some("sum"), false));
        assert!(decision.left > 1.0 && decision.right == 1.0, "{decision:?}");
        let (_, same) = Watch::of(Watching::Only(10), tenths::<Watched<DoubleDouble>>);
        assert!(same.found.is_some_and(|other| other.holds && other.signal == Some("sum")));
    }

    #[test]
    fn bounds_are_told_from_results() {
        let (_, watch) = Watch::of(Watching::Nothing, || {
            let most = Watched::<I16F16>::max_value();
            most.min(Watched::one()) + Watched::zero()
        });
        assert!(watch.asked_for_bounds);
        assert_eq!((watch.integer_bits(16), watch.count), (2, 0));
    }

    proptest! {
        /// A run at 64 bits says in how many bits the same values come out.
        #[test]
        fn a_wide_run_says_how_many_integer_bits_are_enough(
            values in proptest::collection::vec(-100.0..100.0, 2..10), fraction_bits in 3..20_u32
        ) {
            use crate::{Audit, Audited, Overflow, Rounding};
            fn sums<R: Backend>(values: &[f64]) -> Vec<f64> {
                let (mut sum, mut sums) = (R::zero(), Vec::new());
                for value in values {
                    let x = R::from_f64(*value).unwrap_or_else(R::max_value);
                    sum = x.mul_add(R::from_ratio(3, 7), sum) - x;
                    sums.push(sum.to_f64());
                }
                sums
            }
            let format = |bits| RuntimeFormat::new(bits, fraction_bits, Rounding::Nearest, Overflow::Wrap).unwrap();
            let (wide, watch) = format(64).run::<0, _>(|| {
                Watch::of(Watching::Nothing, || sums::<Watched<RuntimeFixed<0>>>(&values))
            });
            let needed = watch.integer_bits(fraction_bits).max(2);
            let (narrow, audit) = format(needed + fraction_bits)
                .run::<0, _>(|| Audit::of(|| sums::<Audited<RuntimeFixed<0>>>(&values)));
            prop_assert_eq!((wide, audit.overflows), (narrow, 0));
        }
    }
}
