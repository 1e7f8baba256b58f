//! The operations of every step of a run, by which targets price it.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use real::Graph;
use target_cost::Step;

/// The steps of a run: how often each sequence of operations occurs. Most steps make the same one.
#[derive(Clone, Debug, Default)]
pub struct RecordedRun {
    /// Each sequence, and how many steps made it.
    pub steps: Vec<(Step, u32)>,
}

impl RecordedRun {
    /// Records the first `most` periods of these runs, one after the other, each from its state; `step` says whether there was one
    /// more. A period at the begin of a run holds what the last run took to find its own end.
    pub(crate) fn of<S, L>(
        most: usize,
        runs: impl IntoIterator<Item = (S, L)>,
        step: impl Fn(&L, &mut S) -> bool,
    ) -> Self {
        let mut runs = runs.into_iter().collect::<Vec<_>>().into_iter().peekable();
        let mut period = || {
            while let Some((state, run)) = runs.peek_mut() {
                if step(run, state) {
                    return true;
                }
                runs.next();
            }
            false
        };
        let (mut places, mut recorded) = (HashMap::new(), Self::default());
        for _ in 0..most {
            let (goes_on, graph) = Graph::of(&mut period);
            if !goes_on {
                break;
            }
            match places.entry(Step::of(&graph)) {
                Entry::Occupied(known) => {
                    let place: usize = *known.get();
                    recorded.steps[place].1 += 1;
                }
                Entry::Vacant(new) => {
                    recorded.steps.push((new.key().clone(), 1));
                    new.insert(recorded.steps.len() - 1);
                }
            }
        }
        recorded
    }
}
