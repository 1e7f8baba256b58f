//! The greatest figure over the steps at cruise, found in one pass, although only the whole run tells which steps these
//! are.

use limit_judge::is_less;

/// A step of at least this share of a full step is at cruise.
const AT_CRUISE: f64 = 0.25;

/// The greatest of a figure over the steps at cruise: those of at least a quarter of F·T, or of the longest step wanted
/// if the plan never reaches F.
///
/// Of the steps so far, those are kept that may still be the answer: each that has a greater figure than every longer
/// step, down to a quarter of the longest. Once a full step was wanted, that is one. NaN counts as greater than any
/// number.
#[derive(Clone, Debug)]
pub(crate) struct GreatestAtCruise<P> {
    full_step_mm: f64,
    longest_mm: f64,
    /// By rising length and falling figure.
    kept: Vec<Kept<P>>,
}

#[derive(Clone, Copy, Debug)]
struct Kept<P> {
    wanted_mm: f64,
    figure: f64,
    place: P,
}

impl<P: Copy> GreatestAtCruise<P> {
    pub(crate) fn new(full_step_mm: f64) -> Self {
        Self { full_step_mm, longest_mm: 0.0, kept: Vec::new() }
    }

    /// Adds a step of a length with its figure.
    pub(crate) fn add(&mut self, wanted_mm: f64, figure: f64, place: P) {
        self.note_length(wanted_mm);
        self.keep(Kept { wanted_mm, figure, place });
    }

    /// Adds a figure that counts however long its step is.
    pub(crate) fn add_always(&mut self, figure: f64, place: P) {
        self.keep(Kept { wanted_mm: f64::INFINITY, figure, place });
    }

    /// Adds the steps of another part of the run, which comes later.
    pub(crate) fn join(&mut self, other: Self, place: impl Fn(P) -> P) {
        self.note_length(other.longest_mm);
        for kept in other.kept {
            self.keep(Kept { place: place(kept.place), ..kept });
        }
    }

    /// The greatest figure, and the place of the step that has it.
    pub(crate) fn greatest(&self) -> Option<(f64, P)> {
        self.kept.first().map(|kept| (kept.figure, kept.place))
    }

    /// The least length at cruise, for all that is known.
    fn least_mm(&self) -> f64 {
        AT_CRUISE * self.full_step_mm.min(self.longest_mm)
    }

    /// Takes account of a step of this length, wherever it is in the run.
    pub(crate) fn note_length(&mut self, wanted_mm: f64) {
        if wanted_mm > self.longest_mm {
            self.longest_mm = wanted_mm;
            let least = self.least_mm();
            let too_short = self.kept.partition_point(|kept| kept.wanted_mm < least);
            self.kept.drain(..too_short);
        }
    }

    fn keep(&mut self, new: Kept<P>) {
        let is_long = new.wanted_mm >= self.least_mm();
        if !is_long {
            return;
        }
        let longer = self.kept.partition_point(|kept| kept.wanted_mm < new.wanted_mm);
        if self.kept.get(longer).is_some_and(|kept| !is_less(kept.figure, new.figure)) {
            return;
        }
        let first = self.kept.partition_point(|kept| !is_less(kept.figure, new.figure));
        let last = self.kept.partition_point(|kept| kept.wanted_mm <= new.wanted_mm);
        self.kept.splice(first..last.max(first), [new]);
        if self.longest_mm >= self.full_step_mm {
            self.kept.truncate(1);
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// As the definition has it, once all steps are known.
    fn by_definition(steps: &[(f64, f64)], full: f64) -> f64 {
        let longest = steps.iter().fold(0.0, |most: f64, step| most.max(step.0));
        let cruise = 0.25 * full.min(longest);
        let figures = steps.iter().filter(|step| step.0 >= cruise).map(|step| step.1);
        figures.reduce(|one, other| if is_less(one, other) { other } else { one }).unwrap()
    }

    proptest! {
        #[test]
        fn it_is_that_of_the_definition_in_one_part_or_two(
            steps in proptest::collection::vec((0.0_f64..2.0, prop_oneof![9 => 0.0_f64..1.0, 1 => Just(f64::NAN)]), 1..60),
            cut in 0_usize..60,
            full in 0.1_f64..4.0,
        ) {
            let of = |part: &[(f64, f64)]| {
                let mut found = GreatestAtCruise::new(full);
                part.iter().enumerate().for_each(|(i, step)| found.add(step.0, step.1, i));
                found
            };
            let expected = by_definition(&steps, full);
            let cut = cut.min(steps.len());
            let (mut joined, rest) = (of(&steps[..cut]), of(&steps[cut..]));
            joined.join(rest, |place| place + cut);
            for found in [of(&steps), joined] {
                let (figure, place) = found.greatest().unwrap();
                prop_assert!(figure.to_bits() == expected.to_bits(), "{figure} {expected}");
                prop_assert!(steps[place].1.to_bits() == expected.to_bits());
            }
        }
    }

    /// From rest, each step is longer and its error smaller: what is kept stays short once the feed is reached.
    #[test]
    fn little_is_kept() {
        let mut found = GreatestAtCruise::new(1.0);
        for i in 1..=1000 {
            let length = f64::from(i) * 1e-3;
            found.add(length, 1.0 / length, i);
        }
        assert_eq!((found.kept.len(), found.greatest()), (1, Some((4.0, 250))));
    }
}
