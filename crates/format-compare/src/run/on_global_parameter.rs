//! A run on one curve with a global parameter: the textbook's form, raw in every format.

use feed_plan::Schedule;
use nurbs_core::{Evaluate, NurbsCurve};
use real::{Backend, DoubleDouble, Recorded};
use secant_interp::{CurvePart, Interpolator, Method, Tolerance};

use crate::plan::in_format::{in_format, nearest};
use crate::problem::problem::Problem;
use crate::refusal::Refusal;
use crate::run::job::Job;
use crate::run::recorded_run::RecordedRun;
use crate::run::run::{Run, RunStep, cruise_mm, resolution_at, unit_in_last_place};

/// The interpolator from one rest to the next.
type RestToRest<'a, R, const D: usize> = Interpolator<'a, R, CurvePart<R, NurbsCurve<'a, R, D>>>;

/// Converts curve, plan and limits to `R` and runs.
pub(crate) fn run<R: Backend, const D: usize>(job: &Job<'_, D>, method: Method) -> Result<Run, Refusal> {
    prepared::<R, D, _>(job, method, |parts| drive(parts, job))
}

/// The operations of each of the first `most` steps of the run that [`run`] makes.
pub(crate) fn record<R: Backend, const D: usize>(
    job: &Job<'_, D>,
    method: Method,
    most: usize,
) -> Result<RecordedRun, Refusal> {
    prepared::<Recorded<R>, D, _>(job, method, |parts| {
        let runs = parts.iter().map(|part| (part.start(), part));
        RecordedRun::of(most.min(job.most_periods()), runs, |part, state| part.step(state).is_some())
    })
}

/// Converts the path and its plan to `R`, divides them at rests so that a run lands on each, and passes the parts to
/// `work`. Rests whose parameters are equal in a coarse format divide nothing.
fn prepared<R: Backend, const D: usize, T>(
    Job { problem, plan, options }: &Job<'_, D>,
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
    let (mut parts, mut first, mut periods) = (Vec::new(), 0, 0_u32);
    for section in plan.schedule().sections() {
        let behind = section.first() + section.stages().len();
        let units = section.durations().fold(0, u64::saturating_add);
        periods = periods.saturating_add(u32::try_from(units.div_ceil(1 << 32)).unwrap_or(u32::MAX));
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

fn drive<R: Backend, const D: usize>(parts: &[RestToRest<'_, R, D>], job: &Job<'_, D>) -> Run {
    let Job { problem, plan, .. } = job;
    let mut planned = plan.lengths();
    let mut steps = Vec::with_capacity(plan.periods() as usize + 1);
    let mut finished = !parts.is_empty();
    for part in parts {
        let own: Vec<_> = planned.by_ref().take(part.schedule.periods() as usize).collect();
        finished = finished && follow(part, own, job.most_periods(), 1.0 / problem.period_s(), &mut steps);
    }
    let start = problem.curves.first().map_or(0.0, |curve| curve.as_curve().domain().0);
    let points = problem.curves.iter().flat_map(|curve| curve.control_points().iter().flatten());
    Run {
        fluctuation_resolution: fluctuation_resolution::<R, D>(start, &steps, problem),
        steps,
        finished,
        planned_periods: plan.periods(),
        resolution_mm: resolution_at::<R>(points.fold(0.0, |largest: f64, x| largest.max(x.abs()))),
        ..Run::default()
    }
}

/// Makes steps to the next rest; `planned` has the wanted distance of each period and the feed at its end. Returns
/// whether the run reaches the rest within its first `most` steps.
fn follow<R: Backend, const D: usize>(
    part: &RestToRest<'_, R, D>,
    planned: Vec<(DoubleDouble, f64)>,
    most: usize,
    per_second: f64,
    steps: &mut Vec<RunStep>,
) -> bool {
    let mut planned = planned.into_iter();
    let mut state = part.start();
    while steps.len() < most {
        let Some(setpoint) = part.step(&mut state) else { break };
        let (wanted_mm, feed) = match planned.next() {
            Some((length, feed)) => (length.to_f64_pair(), feed),
            None => (setpoint.length.to_f64_pair(), setpoint.length.to_f64()),
        };
        let mut point_mm = [0.0; 3];
        for (slot, x) in point_mm.iter_mut().zip(setpoint.point) {
            *slot = x.to_f64();
        }
        steps.push(RunStep {
            curve: 0,
            u: setpoint.u.to_f64_pair(),
            point_mm,
            wanted_mm,
            feed_mm_per_s: feed * per_second,
            evaluations: setpoint.evaluations,
        });
    }
    state.is_finished()
}

/// `½ ulp(u)/(u_{i+1} - u_i)`, the largest over the steps at cruise, by which fluctuation is judged.
fn fluctuation_resolution<R: Backend, const D: usize>(
    start: f64,
    steps: &[RunStep],
    problem: &Problem<D>,
) -> f64 {
    let cruise = cruise_mm(steps.iter().map(|step| step.wanted_mm.0), problem.full_step_mm());
    let from = std::iter::once(start).chain(steps.iter().map(|step| step.u.0));
    let at_cruise = from.zip(steps).filter(|(_, step)| step.wanted_mm.0 >= cruise);
    let share = at_cruise.map(|(from, step)| 0.5 * unit_in_last_place::<R>(step.u.0) / (step.u.0 - from));
    share.filter(|share| share.is_finite()).fold(0.0, f64::max)
}
