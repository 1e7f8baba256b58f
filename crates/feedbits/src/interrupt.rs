//! Ctrl-C: the first ends a comparison with what is finished, the second ends the program.

use std::process;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::output;

/// The exit status of a program that Ctrl-C has ended.
pub(crate) const STATUS: u8 = 130;

static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// From now on, the flag says whether Ctrl-C was pressed. Where no handler can be set, Ctrl-C ends the program.
pub(crate) fn flag() -> &'static AtomicBool {
    let _ = ctrlc::set_handler(|| {
        if INTERRUPTED.swap(true, Ordering::Relaxed) {
            process::exit(STATUS.into());
        }
        output::say("feedbits: interrupted; what is finished follows, once more Ctrl-C ends at once");
    });
    &INTERRUPTED
}

/// Whether Ctrl-C was pressed.
pub(crate) fn is_set() -> bool {
    INTERRUPTED.load(Ordering::Relaxed)
}
