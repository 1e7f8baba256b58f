//! The judge at work while a run is made.

use std::sync::atomic::{AtomicBool, Ordering};

use limit_judge::StatedLimit;

use crate::judge::reference::{Reached, Reference};
use crate::judge::tally::Tally;
use crate::judge::trace::{Coarseness, Trace, TraceRecorder};
use crate::refusal::Refusal;
use crate::run::observer::{Collected, Observer};
use crate::run::run::{AboutRun, RunStep};

/// A run as it was judged.
pub(crate) struct Judgement<const D: usize> {
    pub(crate) tally: Tally,
    /// Distance of the last commanded point from the end of the path, in mm; from the path's start if the run has no
    /// step.
    pub(crate) end_error_mm: f64,
    /// The trace, if one was asked for.
    pub(crate) trace: Option<Trace>,
}

/// How runs are judged.
pub(crate) struct Judge<'a, const D: usize> {
    pub(crate) reference: &'a Reference<'a, D>,
    pub(crate) full_step_mm: f64,
    /// The limits that the machine states.
    pub(crate) limits: &'a [StatedLimit],
    /// Whether the run begins at rest.
    pub(crate) starts_at_rest: bool,
    /// How coarse the trace is; `None` if none is wanted.
    pub(crate) traced: Option<Coarseness>,
    /// Called with the periods that have been judged since the call before.
    pub(crate) progress: &'a (dyn Fn(u64) + Sync),
    /// Told a stretch's number and its figures so far, whether they are enough: then the run ends.
    pub(crate) is_enough: Option<&'a IsEnough<'a>>,
}

/// Whether the figures of the stretch of this number are enough.
pub(crate) type IsEnough<'a> = dyn Fn(usize, &Tally) -> bool + Sync + 'a;

/// Periods of a stretch after which it is first asked whether its figures are enough. It is asked again after twice as many, and so on,
/// and at the stretch's end.
const FIRST_ASKED: u64 = 16;

/// A stretch of a run as it was judged. Its first step begins where the stretch before ends, so it is judged last.
struct JudgedStretch<const D: usize> {
    first: Option<RunStep>,
    others: Tally,
    end: Option<Reached<D>>,
    trace: Option<TraceRecorder>,
}

/// The end of a run whose figures are enough.
struct OverOnce<'a> {
    is_over: &'a AtomicBool,
    is_enough: Option<&'a IsEnough<'a>>,
}

impl OverOnce<'_> {
    fn ask(&self, number: usize, figures: &Tally) {
        if self.is_enough.is_some_and(|is_enough| is_enough(number, figures)) {
            self.is_over.store(true, Ordering::Relaxed);
        }
    }

    fn holds(&self) -> bool {
        self.is_over.load(Ordering::Relaxed)
    }
}

impl<const D: usize> Judge<'_, D> {
    /// Judges the run that `run` makes in front of the observer.
    pub(crate) fn judge(
        &self,
        run: impl FnOnce(&dyn Observer) -> Result<AboutRun, Refusal>,
    ) -> Result<(AboutRun, Judgement<D>), Refusal> {
        let start = (self.tally(), self.reference.start(), self.traced.map(TraceRecorder::new));
        let is_over = AtomicBool::new(false);
        let look =
            |number: usize, steps: &mut dyn Iterator<Item = RunStep>| self.stretch(number, steps, &is_over);
        let observer = Collected::new(start, look, |sum, stretch| self.add(sum, stretch))
            .with_signals(self.traced.is_some())
            .until(&is_over);
        let run = run(&observer)?;
        let (tally, end, trace) = observer.sum();
        let trace = trace.map(|trace| trace.finished(run.audit.as_ref()));
        let end_error_mm = self.reference.end_error_mm(&end);
        Ok((run, Judgement { tally, end_error_mm, trace }))
    }

    /// Judges the steps of a section that `run` makes, all but the first, which begins where the section before has ended: its figures are
    /// among those of a run of the whole path.
    pub(crate) fn judge_section(
        &self,
        run: impl FnOnce(&dyn Observer) -> Result<AboutRun, Refusal>,
    ) -> Result<(AboutRun, Tally), Refusal> {
        let is_over = AtomicBool::new(false);
        let look =
            |number: usize, steps: &mut dyn Iterator<Item = RunStep>| self.stretch(number, steps, &is_over);
        let observer =
            Collected::new(self.tally(), look, |sum, stretch| *sum = stretch.others).until(&is_over);
        let run = run(&observer)?;
        Ok((run, observer.sum()))
    }

    fn tally(&self) -> Tally {
        Tally::new(self.full_step_mm, self.limits)
    }

    /// Judges the steps of a stretch, all but the first, until the run is over.
    fn stretch(
        &self,
        number: usize,
        steps: &mut dyn Iterator<Item = RunStep>,
        is_over: &AtomicBool,
    ) -> JudgedStretch<D> {
        let mut judged = JudgedStretch {
            first: None,
            others: self.tally(),
            end: None,
            trace: self.traced.map(TraceRecorder::new),
        };
        judged.first = steps.next();
        let Some(first) = &judged.first else { return judged };
        let mut at = self.reference.reached_by(first);
        judged.others.begin_part(first);
        let (mut asked_after, is_over) = (FIRST_ASKED, OverOnce { is_over, is_enough: self.is_enough });
        for step in steps {
            let figures = judged.others.judge_next(self.reference, &mut at, &step, true);
            if let Some(trace) = &mut judged.trace {
                trace.add(&step, &figures);
            }
            if judged.others.steps >= asked_after {
                asked_after *= 2;
                is_over.ask(number, &judged.others);
            }
            if is_over.holds() {
                break;
            }
        }
        is_over.ask(number, &judged.others);
        judged.end = Some(at);
        (self.progress)(judged.others.steps + 1);
        judged
    }

    fn add(
        &self,
        (tally, at, trace): &mut (Tally, Reached<D>, Option<TraceRecorder>),
        stretch: JudgedStretch<D>,
    ) {
        let JudgedStretch { first: Some(first), others, end, trace: of_others } = stretch else { return };
        let standing = (tally.steps > 0 || self.starts_at_rest).then(|| self.reference.start_of(at, &first));
        let judged = self.reference.judge_next(at, &first);
        tally.join(standing, (&first, &judged), others);
        *at = end.unwrap_or(*at);
        if let Some((trace, of_others)) = trace.as_mut().zip(of_others) {
            trace.add(&first, &judged);
            trace.join(of_others);
        }
    }
}
