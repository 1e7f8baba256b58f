//! The operations of every step of a run, from which the run is priced on targets.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use real::Graph;
use target_cost::Step;

/// The steps of a run: each sequence of operations, and how often it occurs. Most steps make the same sequence.
#[derive(Clone, Debug, Default)]
pub struct RecordedRun {
    /// Each sequence, with the number of steps that made it.
    pub steps: Vec<(Step, u32)>,
}

impl RecordedRun {
    /// Records the first `most` periods of these runs, one after the other, each from its state. `step` returns whether
    /// there was another period. The first period of a run also holds the operations with which the run before found
    /// its end.
    pub(crate) fn of<S, L>(
        most: u64,
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
