//! A run by the chosen engine: audited, or recorded.

use real::{Audit, Audited, Backend};

use crate::refusal::Refusal;
use crate::run::few_backends::{Work, in_format_named};
use crate::run::job::Job;
use crate::run::recorded_run::RecordedRun;
use crate::run::run::{Run, own_step_mm};
use crate::run::{on_global_parameter, on_pieces};

/// Runs `problem` in the format `R`, and once more in the auditing form of the same format.
pub(crate) fn audited<R: Backend, const D: usize>(job: &Job<'_, D>) -> Result<Run, Refusal> {
    let mut run = once::<R, D>(job)?;
    run.filament_step_mm = job.problem.filament_mm.filter(|farthest| *farthest > 0.0).map(own_step_mm::<R>);
    let (again, audit) = in_format_named(R::name(), Auditing { job });
    debug_assert!(again.is_ok_and(|again| again.steps == run.steps), "an audit changes no value");
    run.audit = audit;
    Ok(run)
}

/// A run whose overflows and ranges are recorded.
struct Auditing<'a, const D: usize> {
    job: &'a Job<'a, D>,
}

impl<const D: usize> Work for Auditing<'_, D> {
    type Output = (Result<Run, Refusal>, Audit);

    fn in_backend<R: Backend>(self) -> Self::Output {
        Audit::of(|| once::<Audited<R>, D>(self.job))
    }
}

fn once<R: Backend, const D: usize>(job: &Job<'_, D>) -> Result<Run, Refusal> {
    match job.options.engine.method() {
        Some(method) => on_global_parameter::run::<R, D>(job, method),
        None => on_pieces::run::<R, D>(job),
    }
}

/// The first `most` steps of a run, recorded.
pub(crate) struct Recording<'a, const D: usize> {
    pub(crate) job: Job<'a, D>,
    pub(crate) most: usize,
}

impl<const D: usize> Work for Recording<'_, D> {
    type Output = Result<RecordedRun, Refusal>;

    fn in_backend<R: Backend>(self) -> Self::Output {
        match self.job.options.engine.method() {
            Some(method) => on_global_parameter::record::<R, D>(&self.job, method, self.most),
            None => on_pieces::record::<R, D>(&self.job, self.most),
        }
    }
}
