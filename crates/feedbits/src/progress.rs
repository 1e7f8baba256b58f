//! The progress of a long command: a bar on a terminal, nothing elsewhere.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

use crate::output;

/// A bar on the terminal's error stream. It is not drawn for work that ends within half a second.
pub(crate) struct Progress(ProgressBar);

impl Progress {
    /// A bar of so many steps.
    pub(crate) fn of(what: &'static str, steps: usize) -> Self {
        let bar = if output::is_quiet() { ProgressBar::hidden() } else { ProgressBar::new(steps as u64) };
        if let Ok(style) = ProgressStyle::with_template("{bar:30} {pos}/{len} {msg}, {elapsed} (eta {eta})") {
            bar.set_style(style);
        }
        Self(bar.with_message(what))
    }

    /// A sign that the program works, if the number of steps is unknown.
    pub(crate) fn spinning(what: &'static str) -> Self {
        let bar = if output::is_quiet() { ProgressBar::hidden() } else { ProgressBar::new_spinner() };
        bar.enable_steady_tick(Duration::from_millis(200));
        Self(bar.with_message(what))
    }

    /// Counts a step that is done.
    pub(crate) fn step(&self) {
        self.0.inc(1);
    }

    /// Sets the number of steps that were done before.
    pub(crate) fn start_at(&self, steps: usize) {
        self.0.set_position(steps as u64);
    }

    /// Takes the bar away.
    pub(crate) fn finish(&self) {
        self.0.finish_and_clear();
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.finish();
    }
}
