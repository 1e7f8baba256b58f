//! A run by the chosen engine: audited, or recorded.

use std::marker::PhantomData;

use real::{Audit, Backend, Extremes, Work, in_few_backends};
use secant_interp::Method;
use target_cost::RecordedRun;

use crate::refusal::Refusal;
use crate::run::auditor::Auditor;
use crate::run::job::{FEW, Job};
use crate::run::observer::{Observer, threads_for};
use crate::run::on_pieces::PlannedSection;
use crate::run::run::{AboutRun, own_step_mm};
use crate::run::{on_global_parameter, on_pieces};

/// Runs `problem` in the format `R`, and once more in the auditing form of the same format. Only the run on pieces is
/// compiled for each format: it is what a controller runs, and most of the time that a comparison takes.
pub(crate) fn audited<R: Backend, const D: usize>(
    job: &Job<'_, D>,
    observer: &dyn Observer,
) -> Result<AboutRun, Refusal> {
    let mut run = match job.options.engine.method() {
        Some(method) => in_few_backends::<FEW, _>(R::name(), OnGlobalParameter { job, method, observer }),
        None => on_pieces::run::<R, D>(job, threads_for(observer), observer),
    }?;
    run.filament_step_mm = filament_step_mm::<R, D>(job);
    if observer.is_over() {
        return Ok(run);
    }
    if observer.wants_signals() {
        let audit = in_few_backends::<FEW, _>(R::name(), Auditing::<Audit, D>::of(job))?;
        (run.extremes, run.audit) = (Extremes::from(&audit), Some(audit));
    } else {
        run.extremes = in_few_backends::<FEW, _>(R::name(), Auditing::<Extremes, D>::of(job))?;
    }
    Ok(run)
}

/// Runs one section on pieces, without an audit.
pub(crate) fn section<R: Backend, const D: usize>(
    job: &Job<'_, D>,
    section: &PlannedSection,
    observer: &dyn Observer,
) -> Result<AboutRun, Refusal> {
    let run = on_pieces::run_section::<R, D>(job, section, observer)?;
    Ok(AboutRun { filament_step_mm: filament_step_mm::<R, D>(job), ..run })
}

fn filament_step_mm<R: Backend, const D: usize>(job: &Job<'_, D>) -> Option<f64> {
    job.problem.filament_mm.filter(|farthest| *farthest > 0.0).map(own_step_mm::<R>)
}

/// A run on one curve's own parameter.
struct OnGlobalParameter<'a, const D: usize> {
    job: &'a Job<'a, D>,
    method: Method,
    observer: &'a dyn Observer,
}

impl<const D: usize> Work for OnGlobalParameter<'_, D> {
    type Output = Result<AboutRun, Refusal>;

    fn in_backend<R: Backend>(self) -> Self::Output {
        on_global_parameter::run::<R, D>(self.job, self.method, self.observer)
    }
}

/// A run whose overflows and ranges are kept in an `A`, and nothing else of it.
struct Auditing<'a, A, const D: usize> {
    job: &'a Job<'a, D>,
    into: PhantomData<fn() -> A>,
}

impl<'a, A, const D: usize> Auditing<'a, A, D> {
    fn of(job: &'a Job<'a, D>) -> Self {
        Self { job, into: PhantomData }
    }
}

impl<A: Auditor, const D: usize> Work for Auditing<'_, A, D> {
    type Output = Result<A, Refusal>;

    fn in_backend<R: Backend>(self) -> Self::Output {
        match self.job.options.engine.method() {
            Some(method) => on_global_parameter::audit::<R, A, D>(self.job, method),
            None => on_pieces::audit::<R, A, D>(self.job),
        }
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
