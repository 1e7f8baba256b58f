//! A run by the chosen engine: audited, or recorded.

use real::{Audit, Backend, FormatName, RuntimeFixed, RuntimeFormat};

use crate::refusal::Refusal;
use crate::run::job::Job;
use crate::run::recorded_run::RecordedRun;
use crate::run::run::{Run, own_step_mm};
use crate::run::{on_global_parameter, on_pieces};

/// Runs `problem` in the format `R`, and once more in the auditing form `A` of the same format.
pub(crate) fn audited<R: Backend, A: Backend, const D: usize>(job: &Job<'_, D>) -> Result<Run, Refusal> {
    let mut run = once::<R, D>(job)?;
    run.filament_step_mm = job.problem.filament_mm.filter(|farthest| *farthest > 0.0).map(own_step_mm::<R>);
    let (again, audit) = Audit::of(|| once::<A, D>(job));
    debug_assert!(again.is_ok_and(|again| again.steps == run.steps), "an audit changes no value");
    run.audit = audit;
    Ok(run)
}

fn once<R: Backend, const D: usize>(job: &Job<'_, D>) -> Result<Run, Refusal> {
    match job.options.engine.method() {
        Some(method) => on_global_parameter::run::<R, D>(job, method),
        None => on_pieces::run::<R, D>(job),
    }
}

/// Records the first `most` steps of a run in the format of this name. Fixed point of every kind is recorded in the
/// run-time format, whose run equals the compared run bit for bit. So this code is compiled for f32, f64 and the
/// run-time format only.
pub(crate) fn recorded<const D: usize>(
    format: FormatName,
    job: &Job<'_, D>,
    most: usize,
) -> Result<RecordedRun, Refusal> {
    let at_run_time = match format {
        FormatName::Float { bits: 32 } => return in_backend::<f32, D>(job, most),
        FormatName::Fixed { .. } => RuntimeFormat::named(&format.to_string()),
        _ => None,
    };
    match at_run_time {
        Some(format) => format.run::<1, _>(|| in_backend::<RuntimeFixed<1>, D>(job, most)),
        None => in_backend::<f64, D>(job, most),
    }
}

fn in_backend<R: Backend, const D: usize>(job: &Job<'_, D>, most: usize) -> Result<RecordedRun, Refusal> {
    match job.options.engine.method() {
        Some(method) => on_global_parameter::record::<R, D>(job, method, most),
        None => on_pieces::record::<R, D>(job, most),
    }
}
