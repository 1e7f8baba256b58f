//! Work on all cores whose results are taken in order, as soon as all before them have been: so only a few wait.

use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;

use real::RuntimeFormats;

/// Results that may wait for an earlier one, for each thread.
const AHEAD: usize = 4;

/// The threads that a run is made on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Threads {
    /// One for each core.
    All,
    /// The calling one.
    This,
}

/// Maps `work` over the items. `take` is given the results in the order of the items, one at a time, until it breaks
/// off. In other threads the run-time formats are those of the calling one.
pub(crate) fn in_order<T: Sync, U: Send>(
    threads: Threads,
    items: &[T],
    work: impl Fn(usize, &T) -> U + Sync,
    mut take: impl FnMut(usize, U) -> ControlFlow<()> + Send,
) {
    let cores = thread::available_parallelism().map_or(1, usize::from);
    let workers = if threads == Threads::This { 1 } else { cores.min(items.len()) };
    if workers <= 1 {
        let _ = items.iter().enumerate().try_for_each(|(index, item)| take(index, work(index, item)));
        return;
    }
    let state = State { next: 0, taken: 0, is_over: false, results: BTreeMap::new(), take };
    let queue = Queue { state: Mutex::new(state), changed: Condvar::new(), most_ahead: AHEAD * workers };
    let formats = RuntimeFormats::of_this_thread();
    thread::scope(|scope| {
        for _ in 0..workers {
            scope.spawn(|| {
                formats.set();
                while let Some(index) = queue.next(items.len()) {
                    let mut given = Given { queue: &queue, result: None };
                    given.result = Some((index, work(index, &items[index])));
                }
            });
        }
    });
}

struct Queue<U, F> {
    state: Mutex<State<U, F>>,
    changed: Condvar,
    most_ahead: usize,
}

struct State<U, F> {
    /// The next item to be given out.
    next: usize,
    /// How many results have been taken.
    taken: usize,
    is_over: bool,
    /// The results that wait for earlier ones.
    results: BTreeMap<usize, U>,
    take: F,
}

impl<U, F: FnMut(usize, U) -> ControlFlow<()>> Queue<U, F> {
    fn lock(&self) -> MutexGuard<'_, State<U, F>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The next item to work on, once few results wait; `None` if there is none.
    fn next(&self, count: usize) -> Option<usize> {
        let waits = |state: &mut State<U, F>| !state.is_over && state.next >= state.taken + self.most_ahead;
        let mut state = self.changed.wait_while(self.lock(), waits).unwrap_or_else(PoisonError::into_inner);
        let index = state.next;
        state.next += 1;
        (!state.is_over && index < count).then_some(index)
    }

    /// Takes a result, and those that waited for it.
    fn put(&self, index: usize, result: U) {
        let mut state = self.lock();
        state.results.insert(index, result);
        while !state.is_over {
            let taken = state.taken;
            let Some(result) = state.results.remove(&taken) else { break };
            state.taken += 1;
            state.is_over = (state.take)(taken, result).is_break();
        }
        self.changed.notify_all();
    }
}

/// An item that a thread works on. Dropped, it hands its result over; if the work panicked, all threads end.
struct Given<'a, U, F: FnMut(usize, U) -> ControlFlow<()>> {
    queue: &'a Queue<U, F>,
    result: Option<(usize, U)>,
}

impl<U, F: FnMut(usize, U) -> ControlFlow<()>> Drop for Given<'_, U, F> {
    fn drop(&mut self) {
        match self.result.take() {
            Some((index, result)) => self.queue.put(index, result),
            None => {
                self.queue.lock().is_over = true;
                self.queue.changed.notify_all();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};
    use std::time::Duration;

    use super::*;

    #[test]
    fn results_come_in_order_and_few_wait() {
        for threads in [Threads::All, Threads::This] {
            let items: Vec<usize> = (0..500).collect();
            let (begun, mut taken) = (AtomicUsize::new(0), Vec::new());
            let work = |index: usize, item: &usize| {
                begun.fetch_max(index, Ordering::Relaxed);
                if index.is_multiple_of(50) {
                    thread::sleep(Duration::from_millis(2));
                }
                item * 2
            };
            in_order(threads, &items, work, |index, result| {
                let cores = thread::available_parallelism().map_or(1, usize::from);
                assert!(begun.load(Ordering::Relaxed) <= index + AHEAD * cores);
                taken.push(result);
                if index == 400 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            });
            assert_eq!(taken, (0..=400).map(|i| 2 * i).collect::<Vec<_>>());
        }
    }

    #[test]
    #[should_panic(expected = "a scoped thread panicked")]
    fn a_panic_ends_all() {
        if thread::available_parallelism().map_or(1, usize::from) == 1 {
            panic!("a scoped thread panicked");
        }
        let work = |index: usize, _: &()| assert_ne!(index, 3, "this is the panic");
        in_order(Threads::All, &[(); 100], work, |_, ()| ControlFlow::Continue(()));
    }
}
