//! A run by the engine that is asked for: audited, or recorded.

use real::{Audit, Backend, FormatName, RuntimeFixed, RuntimeFormat};

use crate::plan::exact_plan::ExactPlan;
use crate::problem::problem::Problem;
use crate::refusal::Refusal;
use crate::run::options::Options;
use crate::run::recorded_run::RecordedRun;
use crate::run::run::{Run, own_step_mm};
use crate::run::{on_global_parameter, on_pieces};

/// Runs `problem` in the format `R`, and once more in the auditing form `A` of the same format.
pub(crate) fn audited<R: Backend, A: Backend, const D: usize>(
    problem: &Problem<D>,
    plan: &ExactPlan,
    options: &Options,
) -> Result<Run, Refusal> {
    let mut run = once::<R, D>(problem, plan, options)?;
    run.filament_step_mm = problem.filament_mm.filter(|farthest| *farthest > 0.0).map(own_step_mm::<R>);
    let (again, audit) = Audit::of(|| once::<A, D>(problem, plan, options));
    debug_assert!(again.is_ok_and(|again| again.steps == run.steps), "an audit changes no value");
    run.audit = audit;
    Ok(run)
}

fn once<R: Backend, const D: usize>(
    problem: &Problem<D>,
    plan: &ExactPlan,
    options: &Options,
) -> Result<Run, Refusal> {
    match options.engine.method() {
        Some(method) => on_global_parameter::run::<R, D>(problem, plan, options, method),
        None => on_pieces::run::<R, D>(problem, plan, options),
    }
}

/// Records the first `most` steps of a run in the format of this name, in which it is bit for bit the compared one: fixed-point formats of every
/// kind by the run-time format, so that three instances serve all.
pub(crate) fn recorded<const D: usize>(
    format: FormatName,
    problem: &Problem<D>,
    plan: &ExactPlan,
    options: &Options,
    most: usize,
) -> Result<RecordedRun, Refusal> {
    let at_run_time = match format {
        FormatName::Float { bits: 32 } => return in_backend::<f32, D>(problem, plan, options, most),
        FormatName::Fixed { .. } => RuntimeFormat::named(&format.to_string()),
        _ => None,
    };
    match at_run_time {
        Some(format) => format.run::<1, _>(|| in_backend::<RuntimeFixed<1>, D>(problem, plan, options, most)),
        None => in_backend::<f64, D>(problem, plan, options, most),
    }
}

fn in_backend<R: Backend, const D: usize>(
    problem: &Problem<D>,
    plan: &ExactPlan,
    options: &Options,
    most: usize,
) -> Result<RecordedRun, Refusal> {
    match options.engine.method() {
        Some(method) => on_global_parameter::record::<R, D>(problem, plan, options, method, most),
        None => on_pieces::record::<R, D>(problem, plan, options, most),
    }
}
