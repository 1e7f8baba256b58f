//! The operations of every period of a run.

use real::Graph;
use target_cost::RecordedRun;

/// Records the first `most` periods of these runs, one after the other, each from its state. `step` returns whether there was
/// another period. The first period of a run also holds the operations with which the run before found its end.
pub(crate) fn recorded<S, L>(
    most: u64,
    runs: impl IntoIterator<Item = (S, L)>,
    step: impl Fn(&L, &mut S) -> bool,
) -> RecordedRun {
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
    let mut recorded = RecordedRun::default();
    for _ in 0..most {
        let (goes_on, graph) = Graph::of(&mut period);
        if !goes_on {
            break;
        }
        recorded.add(&graph);
    }
    recorded
}
