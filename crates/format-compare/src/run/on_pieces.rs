//! A run on compiled pieces.

use std::ops::{ControlFlow, Range};

use feed_plan::Schedule;
use nurbs_core::PiecesBuf;
use real::{Audit, Audited, Backend, DoubleDouble, Real, Recorded};
use secant_interp::{ChordTolerance, CompiledPath, CompiledPathError, Section};
use target_cost::RecordedRun;

use crate::plan::in_format::in_format;
use crate::refusal::Refusal;
use crate::run::auditor::Auditor;
use crate::run::in_order::{Threads, in_order};
use crate::run::job::{Job, most_of_section};
use crate::run::observer::{Observer, Stretch, in_stretches, stretches};
use crate::run::recorded_run::recorded;
use crate::run::run::{AboutRun, resolution_at, unit_in_last_place};
use crate::run::steps_on_pieces::{Outcome, OverriddenSteps, Steps};

/// Compiles path and plan for `R` and runs, landing on each stop on the way. `observer` looks at the steps.
pub(crate) fn run<R: Backend, const D: usize>(
    job: &Job<'_, D>,
    threads: Threads,
    observer: &dyn Observer,
) -> Result<AboutRun, Refusal> {
    let path = compiled::<R, D>(job)?;
    let outcome = match &job.options.overrides {
        Some(commands) => {
            let mut steps = OverriddenSteps::new(job, &path, commands);
            observer.look(0, &mut steps);
            steps.by_ref().take_while(|_| !observer.is_over()).for_each(drop);
            observer.take(0);
            steps.outcome
        }
        None => run_stretches(job, &path, threads, observer),
    };
    Ok(about(job, &path, &outcome))
}

/// A section of the path and the plan, whatever the format.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PlannedSection {
    /// Its pieces.
    pub(crate) pieces: Range<usize>,
    /// Its periods, counted from the begin of the plan.
    pub(crate) periods: Range<u64>,
}

/// The sections of a run, in order. They are those of every format: f64 is taken.
pub(crate) fn planned_sections<const D: usize>(job: &Job<'_, D>) -> Result<Vec<PlannedSection>, Refusal> {
    let path = compiled::<f64, D>(job)?;
    let periods = section_periods(&path).scan(0, |end, periods| {
        let begin = *end;
        *end += periods;
        Some(begin..*end)
    });
    let planned =
        |(section, periods): (&Section, _)| PlannedSection { pieces: section.pieces.clone(), periods };
    Ok(path.sections().iter().zip(periods).map(planned).collect())
}

/// Runs one section as [`run`] does on its way, compiling nothing else.
pub(crate) fn run_section<R: Backend, const D: usize>(
    job: &Job<'_, D>,
    section: &PlannedSection,
    observer: &dyn Observer,
) -> Result<AboutRun, Refusal> {
    let table = job.cut()?.rounded_part(section.pieces.clone());
    let table = table.map_err(|error| job.problem.refusal(error))?;
    let path = with_plan::<R, D>(job, table, &job.plan.schedule_within(&section.periods))?;
    let whole = Stretch { sections: 0..path.sections().len(), first_period: section.periods.start };
    let mut steps = Steps::new(job, &path, &whole);
    observer.look(0, &mut steps);
    observer.take(0);
    Ok(about(job, &path, &steps.outcome))
}

/// The resolution of the positions of a run in `R`, a fixed-point format, in mm.
pub(crate) fn resolution_mm<R: Backend, const D: usize>(job: &Job<'_, D>) -> Result<f64, Refusal> {
    Ok(R::resolution().to_f64().ldexp(job.cut()?.coordinate_exponent::<R>()))
}

/// Runs the stretches of a path without overrides.
fn run_stretches<R: Backend, const D: usize>(
    job: &Job<'_, D>,
    path: &CompiledPath<R, D>,
    threads: Threads,
    observer: &dyn Observer,
) -> Outcome {
    let mut whole = Outcome::default();
    let steps = |stretch: &Stretch| Steps::new(job, path, stretch);
    in_stretches(threads, section_periods(path), observer, steps, |steps| {
        whole.join(steps.outcome);
        whole.finished &= whole.periods <= job.most_periods();
        if whole.finished { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    });
    whole
}

/// The periods that each section is planned to take.
fn section_periods<R: Backend, const D: usize>(path: &CompiledPath<R, D>) -> impl Iterator<Item = u64> {
    path.runs().map(|run| run.lengths.periods() as u64)
}

/// Makes the same steps as [`run`] in the auditing form of `R`, and keeps what the arithmetic met.
pub(crate) fn audit<R: Backend, A: Auditor, const D: usize>(job: &Job<'_, D>) -> Result<A, Refusal> {
    let (path, mut audit) = A::of(|| compiled::<Audited<R>, D>(job));
    let path = path?;
    if let Some(commands) = &job.options.overrides {
        let ((), of_run) = A::of(|| OverriddenSteps::new(job, &path, commands).for_each(drop));
        audit.join(of_run);
        return Ok(audit);
    }
    let work = |_: usize, stretch: &Stretch| {
        let sections = path.sections().get(stretch.sections.clone()).unwrap_or_default();
        A::of(|| sections.iter().all(|section| ends_audited(job, &path, section, A::LEAVES_OUT)))
    };
    in_order(Threads::All, &stretches(section_periods(&path)), work, |_, (finished, of_stretch)| {
        audit.join(of_stretch);
        if finished { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    });
    Ok(audit)
}

/// Makes the steps of a section in audited numbers; with `leaves_out`, without those that
/// [`skip_alike`](secant_interp::PieceInterpolator::skip_alike) passes behind a step that lost nothing. False if the section does not end
/// within its periods.
fn ends_audited<R: Backend, const D: usize>(
    job: &Job<'_, D>,
    path: &CompiledPath<Audited<R>, D>,
    section: &Section,
    leaves_out: bool,
) -> bool {
    let run = path.interpolator().on(section);
    let mut left = most_of_section(run.lengths.periods() as u64);
    let (mut state, mut lost) = (run.start(), Audit::lost_so_far());
    while left > 0 {
        let before = state.course();
        let Some(setpoint) = run.step(&mut state) else { return true };
        if job.options.is_interrupted() {
            return true;
        }
        left -= 1;
        if leaves_out {
            let lost_before = std::mem::replace(&mut lost, Audit::lost_so_far());
            if lost == lost_before {
                left -= run.skip_alike(&mut state, &before, &setpoint, left);
            }
        }
    }
    false
}

/// The operations of each of the first `most` steps of the run that [`run`] makes without overrides. The state at the
/// begin of a section is computed before the section's first period.
pub(crate) fn record<R: Backend, const D: usize>(
    job: &Job<'_, D>,
    most: usize,
) -> Result<RecordedRun, Refusal> {
    let path = compiled::<Recorded<R>, D>(job)?;
    let runs = path.runs().map(|run| (run.start(), run));
    let most = (most as u64).min(job.most_periods());
    Ok(recorded(most, runs, |run, state| run.step(state).is_some()))
}

/// Path and plan in `R`, as they lie in a controller's flash.
pub(crate) fn compiled<R: Backend, const D: usize>(job: &Job<'_, D>) -> Result<CompiledPath<R, D>, Refusal> {
    let table = job.cut()?.rounded().map_err(|error| job.problem.refusal(error))?;
    with_plan(job, table, &job.plan.schedule())
}

/// Pieces and their plan in `R`.
fn with_plan<R: Backend, const D: usize>(
    job: &Job<'_, D>,
    table: PiecesBuf<R, D>,
    plan: &Schedule<'_, DoubleDouble>,
) -> Result<CompiledPath<R, D>, Refusal> {
    let landing_step_mm = job.problem.limits_per_period()?.acceleration;
    in_format::<R>("acceleration", landing_step_mm.ldexp(table.as_pieces().chord_exponent))?;
    let most = job.problem.machine.max_iterations;
    let tolerance = ChordTolerance::for_fluctuation(job.options.fluctuation, most);
    CompiledPath::new(table, plan, tolerance, landing_step_mm).map_err(|error| {
        let (what, value) = match error {
            CompiledPathError::FeedTooHigh { feed, .. } => ("stage feed", feed),
            CompiledPathError::LandingStepTooLong { step } => ("acceleration", step),
            _ => ("plan", f64::NAN),
        };
        Refusal::Limit { what, value, format: R::name() }
    })
}

/// The figures of a run beside its steps.
fn about<R: Backend, const D: usize>(
    job: &Job<'_, D>,
    path: &CompiledPath<R, D>,
    outcome: &Outcome,
) -> AboutRun {
    let pieces = path.table().as_pieces();
    let unit = 1.0.ldexp(pieces.coordinate_exponent);
    let full_step = job.problem.full_step_mm() * 1.0.ldexp(pieces.chord_exponent);
    AboutRun {
        finished: outcome.finished,
        planned_periods: job
            .options
            .overrides
            .as_ref()
            .map_or(job.plan.periods(), |commands| commands.periods),
        resolution_mm: unit * resolution_at::<R>(outcome.farthest),
        fluctuation_resolution: 0.5 * unit_in_last_place::<R>(full_step) / full_step,
        lead: job.lead(),
        ..AboutRun::default()
    }
}
