//! A run on one curve with a global parameter: the textbook's form, raw in every format.

use std::iter::Take;
use std::ops::ControlFlow;

use feed_plan::Schedule;
use nurbs_core::{Evaluate, NurbsCurve};
use real::{Audited, Backend, Recorded};
use secant_interp::{CurvePart, Interpolator, Method, State, Tolerance};
use target_cost::RecordedRun;

use crate::plan::in_format::{in_format, nearest};
use crate::plan::lengths::Lengths;
use crate::refusal::Refusal;
use crate::run::at_cruise::GreatestAtCruise;
use crate::run::auditor::Auditor;
use crate::run::job::{Job, most_of_section};
use crate::run::observer::{Observer, Stretch, in_stretches, threads_for};
use crate::run::recorded_run::recorded;
use crate::run::run::{AboutRun, RunStep, resolution_at, unit_in_last_place};

/// The interpolator from one rest to the next.
type RestToRest<'a, R, const D: usize> = Interpolator<'a, R, CurvePart<R, NurbsCurve<'a, R, D>>>;

/// Converts curve, plan and limits to `R` and runs; `observer` looks at the steps.
pub(crate) fn run<R: Backend, const D: usize>(
    job: &Job<'_, D>,
    method: Method,
    observer: &dyn Observer,
) -> Result<AboutRun, Refusal> {
    prepared::<R, D, _>(job, method, |parts| drive(parts, job, observer))
}

/// Makes the same steps as [`run`] and keeps what the arithmetic met.
pub(crate) fn audit<R: Backend, A: Auditor, const D: usize>(
    job: &Job<'_, D>,
    method: Method,
) -> Result<A, Refusal> {
    let (run, audit) = A::of(|| follow_audited::<R, D>(job, method));
    run.map(|()| audit)
}

/// Makes the steps of [`run`] in audited numbers.
fn follow_audited<R: Backend, const D: usize>(job: &Job<'_, D>, method: Method) -> Result<(), Refusal> {
    prepared::<Audited<R>, D, _>(job, method, |parts| {
        let _ = parts.iter().all(|part| {
            let mut state = part.start();
            let most = most_of_section(part.schedule.periods());
            (0..most).any(|_| part.step(&mut state).is_none() || job.options.is_interrupted())
        });
    })
}

/// The operations of each of the first `most` steps of the run that [`run`] makes.
pub(crate) fn record<R: Backend, const D: usize>(
    job: &Job<'_, D>,
    method: Method,
    most: usize,
) -> Result<RecordedRun, Refusal> {
    prepared::<Recorded<R>, D, _>(job, method, |parts| {
        let runs = parts.iter().map(|part| (part.start(), part));
        recorded((most as u64).min(job.most_periods()), runs, |part, state| part.step(state).is_some())
    })
}

/// Converts the path and its plan to `R`, divides them at rests so that a run lands on each, and passes the parts to
/// `work`. Rests whose parameters are equal in a coarse format divide nothing.
fn prepared<R: Backend, const D: usize, T>(
    Job { problem, plan, options, .. }: &Job<'_, D>,
    method: Method,
    work: impl FnOnce(&[RestToRest<'_, R, D>]) -> T,
) -> Result<T, Refusal> {
    let [curve] = problem.curves.as_slice() else {
        return Err(Refusal::ManyCurves(problem.curves.len()));
    };
    let limits = problem.limits_per_period()?;
    let machine = &problem.machine;
    let fluctuation = options.fluctuation.unwrap_or(machine.fluctuation_limit);
    let curve = curve.convert::<R>()?;
    let stages = plan.stages_in::<R>()?;
    let landing_step = in_format("acceleration", limits.acceleration)?;
    let tolerance = Tolerance {
        // A tolerance below the format's resolution becomes 0, and the solver goes on to the last digit.
        parameter: R::from_f64(machine.parameter_tolerance).unwrap_or_else(R::zero),
        fluctuation: R::from_f64(fluctuation).unwrap_or_else(R::zero),
        max_iterations: machine.max_iterations,
    };
    let (mut begin, end) = curve.as_curve().domain();
    let (mut parts, mut first, mut periods) = (Vec::new(), 0, 0_u64);
    for section in plan.schedule().sections() {
        let behind = section.first() + section.stages().len();
        let units = section.durations().fold(0, u64::saturating_add);
        periods = periods.saturating_add(units.div_ceil(1 << 32));
        let rest = section.rest().and_then(|(_, u)| nearest::<R>(u));
        let rest = rest.filter(|rest| begin < *rest && *rest < end);
        let rest = if behind == stages.len() { Some(end) } else { rest };
        let (Some(rest), Some(own)) = (rest, stages.get(first..behind)) else { continue };
        let schedule = Schedule::new(own, R::one(), periods);
        let curve = CurvePart::new(curve.as_curve(), begin, rest);
        parts.push(Interpolator { curve, schedule, method, tolerance, landing_step });
        (begin, first, periods) = (rest, behind, 0);
    }
    Ok(work(&parts))
}

fn drive<R: Backend, const D: usize>(
    parts: &[RestToRest<'_, R, D>],
    job: &Job<'_, D>,
    observer: &dyn Observer,
) -> AboutRun {
    let Job { problem, plan, .. } = job;
    let mut finished = !parts.is_empty();
    let (mut periods, mut resolution) = (0, GreatestAtCruise::new(problem.full_step_mm()));
    let planned = parts.iter().map(|part| part.schedule.periods());
    let steps = |stretch: &Stretch| Steps::new(parts, stretch, job);
    in_stretches(threads_for(observer), planned, observer, steps, |steps| {
        periods += steps.periods;
        resolution.join(steps.resolution, |place| place);
        finished &= steps.finished && periods <= job.most_periods();
        if finished { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    });
    let points = problem.curves.iter().flat_map(|curve| curve.control_points().iter().flatten());
    AboutRun {
        fluctuation_resolution: resolution.greatest().map_or(0.0, |(share, ())| share),
        finished,
        planned_periods: plan.periods(),
        resolution_mm: resolution_at::<R>(points.fold(0.0, |largest: f64, x| largest.max(x.abs()))),
        lead: job.lead(),
        ..AboutRun::default()
    }
}

/// The steps from rest to rest, one part after the other.
struct Steps<'a, R, const D: usize> {
    job: &'a Job<'a, D>,
    /// The parts that are left, and the period of the plan with which the first of them begins.
    parts: std::slice::Iter<'a, RestToRest<'a, R, D>>,
    period: u64,
    current: Option<OnPart<'a, R, D>>,
    periods: u64,
    finished: bool,
    /// `½ ulp(u)/(u_{i+1} - u_i)`, the largest over the steps at cruise, by which fluctuation is judged.
    resolution: GreatestAtCruise<()>,
}

/// The run of one part.
struct OnPart<'a, R, const D: usize> {
    part: &'a RestToRest<'a, R, D>,
    state: State<R, D>,
    /// The parameter before the step.
    from: f64,
    planned: Take<Lengths<'a>>,
    /// Periods after which the run is given up.
    most: u64,
}

impl<'a, R: Backend, const D: usize> Steps<'a, R, D> {
    fn new(parts: &'a [RestToRest<'a, R, D>], stretch: &Stretch, job: &'a Job<'a, D>) -> Self {
        Self {
            job,
            parts: parts.get(stretch.sections.clone()).unwrap_or_default().iter(),
            period: stretch.first_period,
            current: None,
            periods: 0,
            finished: true,
            resolution: GreatestAtCruise::new(job.problem.full_step_mm()),
        }
    }

    fn begin(&mut self) -> Option<()> {
        let part = self.parts.next()?;
        let (from, periods) = (part.curve.domain().0.to_f64(), part.schedule.periods());
        let planned = self.job.plan.lengths_from(self.period);
        let planned = planned.take(usize::try_from(periods).unwrap_or(usize::MAX));
        self.period += periods;
        self.current =
            Some(OnPart { part, state: part.start(), from, planned, most: most_of_section(periods) });
        Some(())
    }
}

impl<R: Backend, const D: usize> Iterator for Steps<'_, R, D> {
    type Item = RunStep;

    fn next(&mut self) -> Option<RunStep> {
        while self.finished {
            let Some(on) = &mut self.current else {
                self.begin()?;
                continue;
            };
            let setpoint = if on.most > 0 { on.part.step(&mut on.state) } else { None };
            let Some(setpoint) = setpoint else {
                self.finished = on.state.is_finished();
                self.current = None;
                continue;
            };
            on.most = if self.job.options.is_interrupted() { 0 } else { on.most - 1 };
            let (wanted_mm, feed) = match on.planned.next() {
                Some((length, feed)) => (length.to_f64_pair(), feed.value()),
                None => (setpoint.length.to_f64_pair(), setpoint.length.to_f64()),
            };
            let mut point_mm = [0.0; 3];
            for (slot, x) in point_mm.iter_mut().zip(setpoint.point) {
                *slot = x.to_f64();
            }
            let u = setpoint.u.to_f64_pair();
            let share = 0.5 * unit_in_last_place::<R>(u.0) / (u.0 - std::mem::replace(&mut on.from, u.0));
            self.resolution.add(wanted_mm.0, if share.is_finite() { share } else { 0.0 }, ());
            self.periods += 1;
            return Some(RunStep {
                curve: 0,
                u,
                point_mm,
                wanted_mm,
                feed_mm_per_s: feed * (1.0 / self.job.problem.period_s()),
                evaluations: setpoint.evaluations,
            });
        }
        None
    }
}
