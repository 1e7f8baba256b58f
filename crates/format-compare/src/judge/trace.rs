//! The figures of a run over its time, from which charts are drawn.

use std::collections::BTreeMap;

use limit_judge::is_less;
use real::{Audit, Histogram, SignalRange};

use crate::judge::metrics::{JudgedStep, greater};
use crate::run::run::RunStep;

/// A run with an entry for each period, or for several periods of a long run.
///
/// An entry of several periods has the greatest of their figures, and ends where the last of them does. It goes as far
/// as [`Coarseness`] says, so the number of entries grows with the bends of a path and not with its time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trace {
    /// How many periods have passed at the end of each entry.
    pub end: Vec<u64>,
    /// The commanded point at the end of the entry, in mm, in the part's coordinates.
    pub point_mm: Vec<[f64; 3]>,
    /// The wanted chord of a period, in mm.
    pub wanted_mm: Vec<f64>,
    /// Feedrate fluctuation δ, a ratio: that of the greatest magnitude.
    pub fluctuation: Vec<f64>,
    /// Largest distance of the curve from the chord, in mm.
    pub chord_error_mm: Vec<f64>,
    /// How many periods took 0, 1, 2, … evaluations of the curve.
    pub evaluations: Vec<u64>,
    /// The range of each named signal over the whole run.
    pub signals: BTreeMap<&'static str, SignalRange>,
    /// A histogram of the magnitudes of each named signal.
    pub histograms: BTreeMap<&'static str, Histogram>,
}

/// How much of a run an entry of its trace may hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coarseness {
    /// The most periods.
    pub periods: u64,
    /// By how much the way may be longer than the straight line between its ends, in mm.
    pub bend_mm: f64,
}

impl Coarseness {
    /// Entries of a whole trace, at most, where the path does not bend.
    const ENTRIES: u64 = 1 << 17;
    /// A part's length over the bend that an entry may have.
    const PER_BEND: f64 = 65_536.0;

    /// That of a run of so many periods along so many mm: a period for each entry unless the run is long.
    #[must_use]
    pub fn of(periods: u64, length_mm: f64) -> Self {
        Self { periods: periods.div_ceil(Self::ENTRIES).max(1), bend_mm: length_mm / Self::PER_BEND }
    }
}

impl Trace {
    /// Periods of the run.
    #[must_use]
    pub fn periods(&self) -> u64 {
        self.end.last().copied().unwrap_or(0)
    }

    /// Number of entries.
    #[must_use]
    pub fn entries(&self) -> usize {
        self.end.len()
    }

    /// Adds the part of the run that follows.
    fn join(&mut self, other: Self) {
        let before = self.periods();
        self.end.extend(other.end.iter().map(|end| before + end));
        self.point_mm.extend(other.point_mm);
        self.wanted_mm.extend(other.wanted_mm);
        self.fluctuation.extend(other.fluctuation);
        self.chord_error_mm.extend(other.chord_error_mm);
        let most = self.evaluations.len().max(other.evaluations.len());
        self.evaluations.resize(most, 0);
        self.evaluations.iter_mut().zip(&other.evaluations).for_each(|(own, other)| *own += other);
    }
}

/// Makes a trace of steps.
#[derive(Clone, Debug)]
pub(crate) struct TraceRecorder {
    coarseness: Coarseness,
    trace: Trace,
    /// The place before the last entry.
    begin_mm: [f64; 3],
    /// The way since then, in mm.
    way_mm: f64,
}

impl TraceRecorder {
    pub(crate) fn new(coarseness: Coarseness) -> Self {
        Self { coarseness, trace: Trace::default(), begin_mm: [0.0; 3], way_mm: 0.0 }
    }

    /// The trace, with the signals of the run's audit.
    pub(crate) fn finished(self, audit: Option<&Audit>) -> Trace {
        let Audit { signals, histograms, .. } = audit.cloned().unwrap_or_default();
        Trace { signals, histograms, ..self.trace }
    }

    /// Adds the part of the run that follows.
    pub(crate) fn join(&mut self, other: Self) {
        self.trace.join(other.trace);
        (self.begin_mm, self.way_mm) = (other.begin_mm, other.way_mm);
    }

    /// Adds the next step, as the reference judged it.
    pub(crate) fn add(&mut self, step: &RunStep, judged: &JudgedStep) {
        self.count(step.evaluations as usize);
        if self.add_to_last(step, judged) {
            return;
        }
        let trace = &mut self.trace;
        self.begin_mm = trace.point_mm.last().copied().unwrap_or(step.point_mm);
        self.way_mm = distance(&self.begin_mm, &step.point_mm);
        trace.end.push(trace.periods() + 1);
        trace.point_mm.push(step.point_mm);
        trace.wanted_mm.push(judged.wanted_mm);
        trace.fluctuation.push(judged.fluctuation());
        trace.chord_error_mm.push(judged.chord_error_mm);
    }

    /// Counts a period with so many evaluations.
    fn count(&mut self, evaluations: usize) {
        let counts = &mut self.trace.evaluations;
        if evaluations >= counts.len() {
            counts.resize(evaluations + 1, 0);
        }
        counts[evaluations] += 1;
    }
    /// Adds the next step to the last entry, if that may hold it.
    fn add_to_last(&mut self, step: &RunStep, judged: &JudgedStep) -> bool {
        let trace = &mut self.trace;
        let Some(last) = trace.end.len().checked_sub(1) else { return false };
        let begin = last.checked_sub(1).map_or(0, |before| trace.end[before]);
        let way = self.way_mm + distance(&trace.point_mm[last], &step.point_mm);
        let bend = way - distance(&self.begin_mm, &step.point_mm);
        if trace.end[last] - begin >= self.coarseness.periods || bend > self.coarseness.bend_mm {
            return false;
        }
        trace.end[last] += 1;
        (trace.point_mm[last], self.way_mm) = (step.point_mm, way);
        trace.wanted_mm[last] = greater(trace.wanted_mm[last], judged.wanted_mm);
        trace.chord_error_mm[last] = greater(trace.chord_error_mm[last], judged.chord_error_mm);
        if is_less(trace.fluctuation[last].abs(), judged.fluctuation().abs()) {
            trace.fluctuation[last] = judged.fluctuation();
        }
        true
    }
}

fn distance(from: &[f64; 3], to: &[f64; 3]) -> f64 {
    from.iter().zip(to).fold(0.0, |sum: f64, (a, b)| sum.hypot(a - b))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square of 4000 periods in entries of up to 1000: each has the greatest figures of its periods, none goes round
    /// a corner, and it does not matter whether the run comes in one part.
    #[test]
    fn a_long_run_has_few_entries_that_keep_its_shape() {
        let coarseness = Coarseness { periods: 1000, bend_mm: 0.01 };
        let point = |period: u32| {
            let (side, along) = (period / 1000, f64::from(period % 1000));
            [
                [along, 0.0, 0.0],
                [1000.0, along, 0.0],
                [1000.0 - along, 1000.0, 0.0],
                [0.0, 1000.0 - along, 0.0],
            ][side as usize % 4]
        };
        let trace_of = |periods: std::ops::Range<u32>| {
            let mut trace = TraceRecorder::new(coarseness);
            for period in periods {
                let step = RunStep {
                    curve: 0,
                    u: (0.0, 0.0),
                    point_mm: point(period),
                    wanted_mm: (1.0, 0.0),
                    feed_mm_per_s: 1.0,
                    evaluations: 1 + u32::from(period == 7),
                };
                let shortfall_mm = if period == 1500 { -0.5 } else { 1e-9 };
                let judged = JudgedStep {
                    wanted_mm: 1.0,
                    chord_mm: 1.0 - shortfall_mm,
                    arc_mm: 1.0 - shortfall_mm,
                    feed_mm: 1.0,
                    shortfall_mm,
                    commanded_shortfall_mm: 0.0,
                    chord_error_mm: f64::from(period) * 1e-9,
                    passes_corner: false,
                    turn: None,
                    position_error_mm: 0.0,
                };
                trace.add(&step, &judged);
            }
            trace
        };
        let whole = trace_of(1..4001).trace;
        assert_eq!((whole.periods(), whole.evaluations.clone()), (4000, vec![0, 3999, 1]));
        assert!((4..9).contains(&whole.entries()), "{:?}", whole.end);
        for corner in [1000, 2000, 3000] {
            assert!(whole.point_mm.contains(&point(corner)), "{:?}", whole.point_mm);
        }
        let worst = whole.fluctuation.iter().position(|x| *x == -0.5).expect("the worst period");
        assert!(
            whole.end[worst] >= 1501 && worst.checked_sub(1).is_none_or(|before| whole.end[before] < 1501)
        );
        let mut joined = trace_of(1..1200);
        joined.join(trace_of(1200..4001));
        let joined = joined.trace;
        assert_eq!((joined.periods(), joined.evaluations), (4000, whole.evaluations));
    }
}
