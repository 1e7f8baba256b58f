//! How even the feed is at cruise.
//!
//! A log does not say which feed was planned, but at cruise that is the commanded feed F. A stretch at cruise is a run of
//! steps L that are within a hundredth of F T. The steps at its begin that only grow, or only shrink, are left out: they
//! are the end of a ramp. So are those at its end. The fluctuation is the largest |1 - L / (F T)| of the others. A step
//! that passes corners counts by the sum of its legs. Where a control slows down by less than a hundredth and speeds up
//! again, as for a corner, that counts too: a log does not tell its plan.

use serde::Serialize;

use crate::log_place::LogPlace;

/// How far a step at cruise may be from the commanded one, as a share.
const AT_CRUISE: f64 = 0.01;

/// The fluctuation of the feed at cruise.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Fluctuation {
    /// The largest share by which a step is longer or shorter than commanded.
    pub share: f64,
    /// The largest share that the resolution of the log alone may show.
    pub hidden: f64,
    /// Where the largest share is.
    pub at: LogPlace,
    /// The line of the part.
    pub line: usize,
    /// Steps at cruise.
    pub steps: u64,
}

/// A step at cruise.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CruiseStep {
    pub(crate) step_mm: f64,
    pub(crate) feed_mm: f64,
    /// What is hidden of the step, in mm.
    pub(crate) hidden_mm: f64,
    pub(crate) at: LogPlace,
    pub(crate) line: usize,
}

/// The stretch at cruise that is being followed, in runs of steps that all grow or all shrink.
#[derive(Clone, Copy, Debug)]
struct Stretch {
    feed_mm: f64,
    last_mm: f64,
    /// Whether the last steps grow (1), shrink (-1) or stay as they are (0).
    trend: i8,
    /// The worst step of the run that goes on.
    run: Option<Fluctuation>,
    /// Whether the run is the first of the stretch, and so may be the end of a ramp.
    is_first: bool,
}

/// The feed at cruise so far.
#[derive(Debug, Default)]
pub(crate) struct Cruise {
    stretch: Option<Stretch>,
    pub(crate) worst: Option<Fluctuation>,
}

impl Cruise {
    /// Takes the next step; `None` where its length or its feed is not known, as where rows are missing.
    pub(crate) fn take(&mut self, step: Option<CruiseStep>) {
        let at_cruise = step.filter(|one| ((one.step_mm - one.feed_mm) / one.feed_mm).abs() <= AT_CRUISE);
        let Some(step) = at_cruise else {
            // The last run of the stretch is dropped: it may be the begin of a ramp.
            self.stretch = None;
            return;
        };
        let found = Fluctuation {
            share: (1.0 - step.step_mm / step.feed_mm).abs(),
            hidden: step.hidden_mm / step.feed_mm,
            at: step.at,
            line: step.line,
            steps: 1,
        };
        let known = self.stretch.filter(|stretch| stretch.feed_mm.total_cmp(&step.feed_mm).is_eq());
        let Some(stretch) = known else {
            let (feed_mm, last_mm) = (step.feed_mm, step.step_mm);
            self.stretch = Some(Stretch { feed_mm, last_mm, trend: 0, run: Some(found), is_first: true });
            return;
        };
        let change_mm = step.step_mm - stretch.last_mm;
        let trend = match change_mm {
            change if change > step.hidden_mm => 1,
            change if change < -step.hidden_mm => -1,
            _ => 0,
        };
        let goes_on = trend != 0 && (trend == stretch.trend || stretch.trend == 0 && stretch.is_first);
        let mut next = Stretch { last_mm: step.step_mm, trend, ..stretch };
        if goes_on {
            next.run = joined(stretch.run, Some(found));
        } else {
            let ended = stretch.run.filter(|_| !stretch.is_first);
            self.worst = joined(self.worst, ended);
            (next.run, next.is_first) = (Some(found), false);
        }
        if trend == 0 {
            self.worst = joined(self.worst, next.run.take());
        }
        self.stretch = Some(next);
    }
}

/// The worse of two, with the steps of both.
fn joined(one: Option<Fluctuation>, other: Option<Fluctuation>) -> Option<Fluctuation> {
    let (Some(a), Some(b)) = (one, other) else { return one.or(other) };
    let worse = if b.share > a.share { b } else { a };
    Some(Fluctuation { steps: a.steps + b.steps, ..worse })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(steps: &[f64]) -> Option<(f64, u64)> {
        let mut cruise = Cruise::default();
        for (row, step_mm) in (1..).zip(steps) {
            let at = LogPlace { row, time_s: 0.0, line: None, point_mm: [0.0; 3] };
            cruise.take(Some(CruiseStep { step_mm: *step_mm, feed_mm: 0.1, hidden_mm: 1e-9, at, line: 1 }));
        }
        cruise.worst.map(|found| (found.share, found.steps))
    }

    /// A ramp of the speed up to F and down again, in steps of a thousandth of F, with `middle` between.
    fn with_ramps(middle: &[f64]) -> Vec<f64> {
        let up = || (0..1000).map(|k| 1e-4 * f64::from(k));
        up().chain(middle.iter().copied()).chain(up().rev()).collect()
    }

    #[test]
    fn a_ramp_is_no_fluctuation() {
        let (share, steps) = of(&with_ramps(&[0.1; 50])).unwrap();
        assert!(share < 1e-12 && steps >= 48, "{share} {steps}");
        assert_eq!(of(&with_ramps(&[0.1])), None);
        assert_eq!(of(&[0.05; 100]), None, "slower than commanded is no cruise");
    }

    #[test]
    fn the_largest_fluctuation_between_ramps_is_found() {
        for off in [1e-6, -3e-5, 5e-4, -8e-4] {
            let mut middle = [0.1; 60];
            middle[30] += off;
            middle[41] -= 0.5 * off;
            let (share, _) = of(&with_ramps(&middle)).unwrap();
            assert!((share / (off.abs() / 0.1) - 1.0).abs() < 1e-9, "{off}: {share}");
        }
    }

    #[test]
    fn another_feed_or_a_gap_ends_a_stretch() {
        let mut cruise = Cruise::default();
        let at = LogPlace { row: 1, time_s: 0.0, line: None, point_mm: [0.0; 3] };
        let step = |step_mm, feed_mm| CruiseStep { step_mm, feed_mm, hidden_mm: 1e-9, at, line: 1 };
        for one in [Some(step(0.1, 0.1)), None, Some(step(0.1001, 0.1)), Some(step(0.1001, 0.1002))] {
            cruise.take(one);
        }
        assert!(cruise.worst.is_none(), "{:?}", cruise.worst);
    }
}
