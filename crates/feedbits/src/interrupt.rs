//! Ctrl-C: before anything is finished it ends the program. Then the first ends a comparison with what is finished, the second ends
//! the program.

use std::process;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::output;

/// The exit status of a program that Ctrl-C has ended.
pub(crate) const STATUS: u8 = 130;

static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Whether runs have begun, of which some may be finished.
static HAS_RUNS: AtomicBool = AtomicBool::new(false);

/// From now on, the flag says whether Ctrl-C was pressed. Where no handler can be set, Ctrl-C ends the program.
pub(crate) fn flag() -> &'static AtomicBool {
    let _ = ctrlc::set_handler(|| {
        let is_first = !INTERRUPTED.swap(true, Ordering::Relaxed);
        if is_first && !HAS_RUNS.load(Ordering::Relaxed) {
            output::say("feedbits: interrupted: nothing is finished");
        } else if is_first {
            return output::say(
                "feedbits: interrupted; what is finished follows, once more Ctrl-C ends at once",
            );
        }
        process::exit(STATUS.into());
    });
    &INTERRUPTED
}

/// From now on, what is finished is worth to be printed: the path is planned, which looks at no flag, and runs begin, which do.
pub(crate) fn runs_begin() {
    HAS_RUNS.store(true, Ordering::Relaxed);
}

/// Whether Ctrl-C was pressed.
pub(crate) fn is_set() -> bool {
    INTERRUPTED.load(Ordering::Relaxed)
}
