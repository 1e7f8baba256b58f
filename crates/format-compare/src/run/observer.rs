//! Looking at the steps of a run while it is made.
//!
//! A run is made in *stretches* of sections, on all cores. Each section begins at rest at a known place, so a stretch
//! needs nothing of those before it. An observer looks at each stretch on the thread that makes it, keeps what it needs
//! of it, and is then told the stretches in order.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::refusal::Refusal;
use crate::run::in_order::Threads;
use crate::run::run::{AboutRun, Run, RunStep};

/// Something that looks at the steps of a run.
pub trait Observer: Sync {
    /// Whether the stretches must be made one after the other, on one thread.
    fn goes_in_order(&self) -> bool {
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
pub(crate) struct Collected<T, S, L, A> {
    sum: Mutex<S>,
    waiting: Mutex<BTreeMap<usize, T>>,
    look: L,
    add: A,
}

impl<T, S, L, A> Collected<T, S, L, A>
where
    L: Fn(&mut dyn Iterator<Item = RunStep>) -> T,
    A: Fn(&mut S, T),
{
    pub(crate) fn new(sum: S, look: L, add: A) -> Self {
        Self { sum: Mutex::new(sum), waiting: Mutex::default(), look, add }
    }

    pub(crate) fn sum(self) -> S {
        self.sum.into_inner().unwrap_or_else(PoisonError::into_inner)
    }

    fn waiting(&self) -> MutexGuard<'_, BTreeMap<usize, T>> {
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl<T, S, L, A> Observer for Collected<T, S, L, A>
where
    T: Send,
    S: Send,
    L: Fn(&mut dyn Iterator<Item = RunStep>) -> T + Sync,
    A: Fn(&mut S, T) + Sync,
{
    fn look(&self, stretch: usize, steps: &mut dyn Iterator<Item = RunStep>) {
        let seen = (self.look)(steps);
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
    let kept = Collected::new(Vec::new(), |steps| steps.collect(), add);
    let about = run(&kept)?;
    Ok(Run { steps: kept.sum(), about })
}

/// Periods of a stretch, at least, unless it is the last.
const STRETCH: u64 = 1 << 16;

/// Sections of so many periods in stretches, as ranges of their numbers.
pub(crate) fn stretches(periods: impl Iterator<Item = u64>) -> Vec<Range<usize>> {
    let (mut found, mut begin, mut sum, mut count) = (Vec::new(), 0, 0, 0);
    for periods in periods {
        count += 1;
        sum += periods;
        if sum >= STRETCH {
            found.push(begin..count);
            (begin, sum) = (count, 0);
        }
    }
    if begin < count {
        found.push(begin..count);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stretches_are_long_and_leave_nothing_out() {
        assert_eq!(stretches([1, STRETCH, 3, STRETCH - 3, 1].into_iter()), [0..2, 2..4, 4..5]);
        assert_eq!(stretches([5, 6, STRETCH, 1].into_iter()), [0..3, 3..4]);
        assert_eq!(stretches(std::iter::empty()), []);
    }
}
