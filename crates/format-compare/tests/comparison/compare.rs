//! Comparisons as a whole.

use std::sync::atomic::{AtomicBool, Ordering};

use format_compare::{Engine, Options, Watch, compare, compare_with, select};

use crate::examples::{EXAMPLE, on_example_machine};

/// Runs that were finished before an interruption stay, and are those of a comparison without one.
#[test]
fn an_interruption_leaves_out_what_is_not_finished() {
    static INTERRUPT: AtomicBool = AtomicBool::new(false);
    let problem = on_example_machine::<2>(EXAMPLE, "");
    let formats = select::<2>(&["I8F24", "I4F28", "f32", "f64"]).unwrap();
    let whole = compare(&problem, &formats, &[Engine::Pieces], &Options::default()).unwrap();
    let progress = |done: u64, all: u64| INTERRUPT.store(done > all / 2, Ordering::Relaxed);
    let options = Options { interrupt: Some(&INTERRUPT), ..Options::default() };
    let watch = Watch { traces: true, progress: &progress };
    let cut = compare_with(&problem, &formats, &[Engine::Pieces], &options, &watch).unwrap();
    let (left, out) = (&cut.comparison.formats, cut.comparison.interrupted_runs);
    assert_eq!(cut.comparison.recommended, None);
    assert!(left.len() + out == 4 && out > 0 && cut.traces.len() == left.len(), "{out} of 4 left out");
    for run in left {
        let same = whole.formats.iter().find(|one| one.format == run.format).unwrap();
        assert_eq!((run.fluctuation, run.periods), (same.fluctuation, same.periods));
    }
}
