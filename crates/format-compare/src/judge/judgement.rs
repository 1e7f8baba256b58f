//! The judge at work while a run is made.

use crate::judge::reference::{Reached, Reference};
use crate::judge::stated_limits::StatedLimit;
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
}

/// A stretch of a run as it was judged. Its first step begins where the stretch before ends, so it is judged last.
struct JudgedStretch<const D: usize> {
    first: Option<RunStep>,
    others: Tally,
    end: Option<Reached<D>>,
    trace: Option<TraceRecorder>,
}

impl<const D: usize> Judge<'_, D> {
    /// Judges the run that `run` makes in front of the observer.
    pub(crate) fn judge(
        &self,
        run: impl FnOnce(&dyn Observer) -> Result<AboutRun, Refusal>,
    ) -> Result<(AboutRun, Judgement<D>), Refusal> {
        let start = (self.tally(), self.reference.start(), self.traced.map(TraceRecorder::new));
        let observer =
            Collected::new(start, |steps| self.stretch(steps), |sum, stretch| self.add(sum, stretch))
                .with_signals(self.traced.is_some());
        let run = run(&observer)?;
        let (tally, end, trace) = observer.sum();
        let trace = trace.map(|trace| trace.finished(run.audit.as_ref()));
        let end_error_mm = self.reference.end_error_mm(&end);
        Ok((run, Judgement { tally, end_error_mm, trace }))
    }

    fn tally(&self) -> Tally {
        Tally::new(self.full_step_mm, self.limits)
    }

    /// Judges the steps of a stretch, all but the first.
    fn stretch(&self, steps: &mut dyn Iterator<Item = RunStep>) -> JudgedStretch<D> {
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
        for step in steps {
            let figures = judged.others.judge_next(self.reference, &mut at, &step, true);
            if let Some(trace) = &mut judged.trace {
                trace.add(&step, &figures);
            }
        }
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
