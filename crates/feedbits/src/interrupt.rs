//! Signals that end the program: Ctrl-C, a terminal that is closed, `kill`. What is unfinished is removed first. Where some
//! runs of a comparison may be finished, the first Ctrl-C ends it with these.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::Duration;
use std::{panic, process, thread};

use crate::unfinished;

/// The exit status of a comparison that Ctrl-C has ended with what is finished.
pub(crate) const STATUS: u8 = 130;

static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Whether runs have begun, of which some may be finished.
static HAS_RUNS: AtomicBool = AtomicBool::new(false);

/// The flag that says whether Ctrl-C was pressed since runs have begun.
pub(crate) fn flag() -> &'static AtomicBool {
    &INTERRUPTED
}

/// From now on, what is finished is worth to be printed: the path is planned, which looks at no flag, and runs begin, which do.
pub(crate) fn runs_begin() {
    HAS_RUNS.store(true, Ordering::Relaxed);
}

/// Whether Ctrl-C was pressed since runs have begun.
pub(crate) fn is_set() -> bool {
    INTERRUPTED.load(Ordering::Relaxed)
}

/// The result of `work`, which may plan, and a plan looks at no flag. If Ctrl-C is pressed meanwhile and `work` does not end soon, has
/// `end` print what is finished, and ends the program.
pub(crate) fn unless_interrupted<T: Send>(work: impl FnOnce() -> T + Send, end: impl FnOnce()) -> T {
    const BETWEEN_LOOKS: Duration = Duration::from_millis(50);
    const LOOKS: usize = 8;
    let (done, wait) = mpsc::channel();
    let work = || {
        let result = work();
        let _ = done.send(());
        result
    };
    thread::scope(|scope| {
        let working = scope.spawn(work);
        let mut looks = 0;
        while wait.recv_timeout(BETWEEN_LOOKS) == Err(RecvTimeoutError::Timeout) {
            looks += usize::from(is_set());
            if looks > LOOKS {
                end();
                let _nothing_is_made = unfinished::remove_all();
                process::exit(STATUS.into());
            }
        }
        working.join().unwrap_or_else(|panicked| panic::resume_unwind(panicked))
    })
}

/// From now on, signals end the program as this file says. Where none can be watched, they end it at once.
#[cfg(not(unix))]
pub(crate) fn watch() {}

#[cfg(unix)]
pub(crate) use of_unix::watch;

#[cfg(unix)]
mod of_unix {
    use std::fs;
    use std::sync::atomic::Ordering;
    use std::thread;

    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    use signal_hook::iterator::Signals;
    use signal_hook::low_level::emulate_default_handler;

    use super::{HAS_RUNS, INTERRUPTED};
    use crate::{output, unfinished};

    /// From now on, signals end the program as this file says. Where none can be watched, they end it at once.
    pub(crate) fn watch() {
        let watched = [SIGINT, SIGTERM, SIGHUP].into_iter().filter(|signal| !is_ignored(*signal));
        let Ok(mut signals) = Signals::new(watched) else { return };
        thread::spawn(move || {
            for signal in signals.forever() {
                take(signal);
            }
        });
    }

    fn take(signal: i32) {
        let has_finished = signal == SIGINT && HAS_RUNS.load(Ordering::Relaxed);
        if has_finished && !INTERRUPTED.swap(true, Ordering::Relaxed) {
            return output::say(
                "feedbits: interrupted; what is finished follows, once more Ctrl-C ends at once",
            );
        }
        let _nothing_is_made = unfinished::remove_all();
        let _ = emulate_default_handler(signal);
    }

    /// Whether who started the program wants it to ignore a signal, as `nohup` does.
    fn is_ignored(signal: i32) -> bool {
        let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
        let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
        let ignored = ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
        ignored.is_some_and(|mask| mask >> (signal - 1) & 1 == 1)
    }
}
