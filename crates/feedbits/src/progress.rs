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
        Self(bar.with_style(bar_style()).with_message(what))
    }

    /// A sign that the program works, if the number of steps is unknown.
    pub(crate) fn spinning(what: &'static str) -> Self {
        let bar = if output::is_quiet() { ProgressBar::hidden() } else { ProgressBar::new_spinner() };
        bar.enable_steady_tick(Duration::from_millis(200));
        Self(bar.with_message(what))
    }

    /// A sign that a part is planned. Once its periods are made, a bar of them with the time that is left.
    pub(crate) fn planning() -> Self {
        Self::spinning("planning")
    }

    /// Sets how many periods are done, of how many in all; 0 if that is unknown.
    pub(crate) fn periods(&self, done: u64, all: u64) {
        if all > 0 && self.0.length() != Some(all) {
            self.0.set_length(all);
            self.0.set_style(bar_style());
            self.0.set_message("periods");
        }
        self.0.set_position(done);
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

fn bar_style() -> ProgressStyle {
    let style = ProgressStyle::with_template("{bar:30} {human_pos}/{human_len} {msg}, {elapsed} (eta {eta})");
    style.unwrap_or_else(|_| ProgressStyle::default_bar())
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.finish();
    }
}
