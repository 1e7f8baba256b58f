//! The progress of a long command: a bar on a terminal, and a line now and then elsewhere.

use std::thread;
use std::time::Duration;

use indicatif::{HumanCount, HumanDuration, ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::output;

/// Work of this length is reported by a line where no bar can be drawn. The next lines come after four times this length, after
/// sixteen times, and so on, so that a day's work has few of them.
const FIRST_LINE: Duration = Duration::from_secs(10);
const NEXT_LINE: u32 = 4;

/// A bar on the terminal's error stream. If that is no terminal, as in a log, long work is reported there by a few lines. With
/// the first one the work begins: notes and warnings so far are printed.
pub(crate) struct Progress(ProgressBar);

impl Progress {
    /// A bar of so many steps.
    pub(crate) fn of(what: &'static str, steps: usize) -> Self {
        Self::shown(ProgressBar::new(steps as u64).with_style(bar_style()).with_message(what))
    }

    /// A sign that the program works, if the number of steps is unknown.
    pub(crate) fn spinning(what: &'static str) -> Self {
        Self::shown(ProgressBar::new_spinner().with_message(what))
    }

    fn shown(bar: ProgressBar) -> Self {
        output::begin_work();
        // The work of a part of a set counts as one step of the set's own bar.
        if output::is_quiet() || output::is_kept() {
            bar.set_draw_target(ProgressDrawTarget::hidden());
        } else if bar.is_hidden() {
            let bar = bar.clone();
            thread::spawn(move || report(&bar, FIRST_LINE, output::note));
        } else {
            bar.enable_steady_tick(Duration::from_millis(200));
        }
        Self(bar)
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

impl Drop for Progress {
    fn drop(&mut self) {
        self.finish();
    }
}

/// Says at once what is begun, where no bar will say it.
pub(crate) fn announce(text: &str) {
    if ProgressDrawTarget::stderr().is_hidden() {
        output::note(text);
    }
}

fn bar_style() -> ProgressStyle {
    let style = ProgressStyle::with_template("{bar:30} {human_pos}/{human_len} {msg}, {elapsed} (eta {eta})");
    style.unwrap_or_else(|_| ProgressStyle::default_bar())
}

/// Says how far the work of a bar is that is not drawn, first after `first`, until the work is done.
fn report(bar: &ProgressBar, first: Duration, say: impl Fn(&str)) {
    let mut due = first;
    loop {
        thread::sleep(due.saturating_sub(bar.elapsed()));
        if bar.is_finished() {
            return;
        }
        say(&line(bar));
        due *= NEXT_LINE;
    }
}

/// How far the work is, and how long about the rest takes, if that is known.
fn line(bar: &ProgressBar) -> String {
    let (done, what) = (bar.position(), bar.message());
    let work = match bar.length() {
        Some(all) if done > 0 => {
            let (done, all, left) = (HumanCount(done), HumanCount(all), HumanDuration(bar.eta()));
            format!("{done} of {all} {what}, about {left} left")
        }
        _ => what,
    };
    format!("after {}: {work}", HumanDuration(bar.elapsed()))
}

#[cfg(test)]
mod tests {
    use std::cell::RefCell;
    use std::time::Instant;

    use super::*;

    #[test]
    fn where_no_bar_is_drawn_few_lines_say_how_far_the_work_is() {
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden()).with_message("planning");
        let (first, begun) = (Duration::from_millis(20), Instant::now());
        let said = RefCell::new(Vec::new());
        report(&bar, first, |line| {
            said.borrow_mut().push((line.to_string(), begun.elapsed()));
            match said.borrow().len() {
                1 => {
                    bar.set_length(1000);
                    bar.set_message("periods");
                    bar.set_position(250);
                }
                2 => bar.finish_and_clear(),
                _ => {}
            }
        });
        let said = said.into_inner();
        assert_eq!(said.len(), 2, "{said:?}");
        assert_eq!(said[0].0, "after 0 seconds: planning");
        assert!(said[1].0.starts_with("after 0 seconds: 250 of 1,000 periods, about "), "{said:?}");
        assert!(said[0].1 >= first && said[1].1 >= first * NEXT_LINE, "{said:?}");
    }
}
