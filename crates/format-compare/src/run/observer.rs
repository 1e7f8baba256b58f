//! Looking at the steps of a run while it is made.
//!
//! A run is made in *stretches* of sections, on all cores. Each section begins at rest at a known place, so a stretch
//! needs nothing of those before it. An observer looks at each stretch on the thread that makes it, keeps what it needs
//! of it, and is then told the stretches in order.

use std::collections::BTreeMap;
use std::ops::{ControlFlow, Range};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::refusal::Refusal;
use crate::run::in_order::{Threads, in_order};
use crate::run::run::{AboutRun, Run, RunStep};

/// Something that looks at the steps of a run.
pub trait Observer: Sync {
    /// Whether the stretches must be made one after the other, on one thread.
    fn goes_in_order(&self) -> bool {
        false
    }

    /// Whether each signal of the run is wanted by its name, which takes longer than the range of all.
    fn wants_signals(&self) -> bool {
        false
    }

    /// Whether enough was seen: then the run ends, and its other steps are not made.
    fn is_over(&self) -> bool {
        false
    }

    /// Looks at the steps of a stretch. Stretches are numbered from 0; several threads may be here at a time.
    fn look(&self, stretch: usize, steps: &mut dyn Iterator<Item = RunStep>);

    /// Takes what was seen of a stretch. It is called for each in order, by one thread at a time. Stretches
    /// behind the one in which a run was given up are not taken.
    fn take(&self, stretch: usize);
}

/// The threads on which a run may be made in front of an observer.
pub(crate) fn threads_for(observer: &dyn Observer) -> Threads {
    if observer.goes_in_order() { Threads::This } else { Threads::All }
}

/// An observer that makes a value of each stretch and adds the values up in order.
pub(crate) struct Collected<'a, T, S, L, A> {
    sum: Mutex<S>,
    waiting: Mutex<BTreeMap<usize, T>>,
    look: L,
    add: A,
    wants_signals: bool,
    is_over: Option<&'a AtomicBool>,
}

impl<'a, T, S, L, A> Collected<'a, T, S, L, A>
where
    L: Fn(usize, &mut dyn Iterator<Item = RunStep>) -> T,
    A: Fn(&mut S, T),
{
    /// Begins with `sum`. `look` is given the number of a stretch and its steps.
    pub(crate) fn new(sum: S, look: L, add: A) -> Self {
        let waiting = Mutex::default();
        Self { sum: Mutex::new(sum), waiting, look, add, wants_signals: false, is_over: None }
    }

    /// The same, which ends the run once the flag is set.
    pub(crate) fn until(self, is_over: &'a AtomicBool) -> Self {
        Self { is_over: Some(is_over), ..self }
    }

    /// The same, which wants the run's signals by name, or not.
    pub(crate) fn with_signals(self, wants_signals: bool) -> Self {
        Self { wants_signals, ..self }
    }

    pub(crate) fn sum(self) -> S {
        self.sum.into_inner().unwrap_or_else(PoisonError::into_inner)
    }

    fn waiting(&self) -> MutexGuard<'_, BTreeMap<usize, T>> {
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl<T, S, L, A> Observer for Collected<'_, T, S, L, A>
where
    T: Send,
    S: Send,
    L: Fn(usize, &mut dyn Iterator<Item = RunStep>) -> T + Sync,
    A: Fn(&mut S, T) + Sync,
{
    fn wants_signals(&self) -> bool {
        self.wants_signals
    }

    fn is_over(&self) -> bool {
        self.is_over.is_some_and(|is_over| is_over.load(Ordering::Relaxed))
    }

    fn look(&self, stretch: usize, steps: &mut dyn Iterator<Item = RunStep>) {
        let seen = (self.look)(stretch, steps);
        self.waiting().insert(stretch, seen);
    }

    fn take(&self, stretch: usize) {
        let Some(seen) = self.waiting().remove(&stretch) else { return };
        (self.add)(&mut self.sum.lock().unwrap_or_else(PoisonError::into_inner), seen);
    }
}

/// The run that `run` makes in front of the observer, with all its steps.
pub(crate) fn with_steps(
    run: impl FnOnce(&dyn Observer) -> Result<AboutRun, Refusal>,
) -> Result<Run, Refusal> {
    let add = |all: &mut Vec<RunStep>, own: Vec<RunStep>| all.extend(own);
    let kept = Collected::new(Vec::new(), |_, steps| steps.collect(), add);
    let about = run(&kept)?;
    Ok(Run { steps: kept.sum(), about })
}

/// Makes the run of sections of so many periods in front of an observer. `steps` begins a stretch; `add` is given each,
/// made to its end, in order, until it breaks off.
pub(crate) fn in_stretches<I: Iterator<Item = RunStep> + Send>(
    threads: Threads,
    periods: impl Iterator<Item = u64>,
    observer: &dyn Observer,
    steps: impl Fn(&Stretch) -> I + Sync,
    mut add: impl FnMut(I) -> ControlFlow<()> + Send,
) {
    let work = |number: usize, stretch: &Stretch| {
        let mut steps = steps(stretch);
        observer.look(number, &mut steps);
        // An observer may have looked at the first steps only.
        steps.by_ref().take_while(|_| !observer.is_over()).for_each(drop);
        steps
    };
    in_order(threads, &stretches(periods), work, |number, steps| {
        observer.take(number);
        if observer.is_over() { ControlFlow::Break(()) } else { add(steps) }
    });
}

/// Sections that are run one after the other.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Stretch {
    /// Their numbers.
    pub(crate) sections: Range<usize>,
    /// The period of the plan with which the first begins.
    pub(crate) first_period: u64,
}

/// Periods of a stretch, at least, unless it is the last.
const STRETCH: u64 = 1 << 16;

/// Sections of so many periods in stretches.
pub(crate) fn stretches(periods: impl Iterator<Item = u64>) -> Vec<Stretch> {
    let (mut found, mut next, mut time): (Vec<Stretch>, _, u64) = (Vec::new(), 0..0, 0);
    let mut first_period = 0;
    for periods in periods {
        next.end += 1;
        time += periods;
        if time - first_period >= STRETCH {
            found.push(Stretch { sections: next.clone(), first_period });
            (next, first_period) = (next.end..next.end, time);
        }
    }
    if !next.is_empty() {
        found.push(Stretch { sections: next, first_period });
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stretches_are_long_and_leave_nothing_out() {
        let of = |periods: &[u64]| {
            let found = stretches(periods.iter().copied());
            found.into_iter().map(|one| (one.sections, one.first_period)).collect::<Vec<_>>()
        };
        let cut = [(0..2, 0), (2..4, STRETCH + 1), (4..5, 2 * STRETCH + 1)];
        assert_eq!(of(&[1, STRETCH, 3, STRETCH - 3, 1]), cut);
        assert_eq!(of(&[5, 6, STRETCH, 1]), [(0..3, 0), (3..4, STRETCH + 11)]);
        assert_eq!((of(&[5, 6]), of(&[])), (vec![(0..2, 0)], vec![]));
    }
}
