//! A run on one curve with a global parameter: the textbook way, raw in every format.

use std::ops::Range;

use feed_plan::Schedule;
use nurbs_core::{Evaluate, NurbsCurve};
use real::{Audit, Backend, DoubleDouble, Recorded};
use secant_interp::{CurvePart, Interpolator, Method, Tolerance};

use crate::plan::exact_plan::ExactPlan;
use crate::plan::in_format::{in_format, nearest};
use crate::problem::problem::Problem;
use crate::refusal::Refusal;
use crate::run::options::Options;
use crate::run::recorded_run::RecordedRun;
use crate::run::run::{Run, RunStep, cruise_mm, most_periods, resolution_at, unit_in_last_place};

/// What steps from one rest to the next.
type RestToRest<'a, R, const D: usize> = Interpolator<'a, R, CurvePart<R, NurbsCurve<'a, R, D>>>;

/// Converts curve, plan and limits to `R` and runs.
pub(crate) fn run<R: Backend, const D: usize>(
    problem: &Problem<D>,
    plan: &ExactPlan,
    options: &Options,
    method: Method,
) -> Result<Run, Refusal> {
    prepared::<R, D, _>(problem, plan, options, method, |legs| drive(legs, plan, problem))
}

/// The operations of each of the first `most` steps of the run that [`run`] makes.
pub(crate) fn record<R: Backend, const D: usize>(
    problem: &Problem<D>,
    plan: &ExactPlan,
    options: &Options,
    method: Method,
    most: usize,
) -> Result<RecordedRun, Refusal> {
    prepared::<Recorded<R>, D, _>(problem, plan, options, method, |legs| {
        let runs = legs.iter().map(|leg| (leg.start(), leg));
        RecordedRun::of(most.min(most_periods(plan.periods())), runs, |leg, state| leg.step(state).is_some())
    })
}

/// Hands what the run needs, in `R`, to `work`: the path and its plan from stop to stop, so that each is landed on.
fn prepared<R: Backend, const D: usize, T>(
    problem: &Problem<D>,
    plan: &ExactPlan,
    options: &Options,
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
        // Below the format's resolution a tolerance is 0, and the solver goes on to the last digit.
        parameter: R::from_f64(machine.parameter_tolerance).unwrap_or_else(R::zero),
        fluctuation: R::from_f64(fluctuation).unwrap_or_else(R::zero),
        max_iterations: machine.max_iterations,
    };
    let legs = from_rest_to_rest::<R>(plan, curve.as_curve().domain()).into_iter().filter_map(|between| {
        let own = stages.get(between.stages)?;
        Some(Interpolator {
            curve: CurvePart::new(curve.as_curve(), between.begin, between.end),
            schedule: Schedule::new(own, R::one(), between.periods),
            method,
            tolerance,
            landing_step,
        })
    });
    Ok(work(&legs.collect::<Vec<_>>()))
}

/// Part of a curve and of its plan between two rests.
struct Between<R> {
    begin: R,
    end: R,
    stages: Range<usize>,
    periods: u32,
}

/// The sections of a plan with their parts of the curve. Rests that are one parameter in a coarse format divide nothing.
fn from_rest_to_rest<R: Backend>(plan: &ExactPlan, (mut begin, end): (R, R)) -> Vec<Between<R>> {
    let (mut found, mut first, mut periods) = (Vec::new(), 0, 0_u32);
    for section in plan.schedule().sections() {
        let behind = section.first() + section.stages().len();
        let units = section.durations().fold(0, u64::saturating_add);
        periods = periods.saturating_add(u32::try_from(units.div_ceil(1 << 32)).unwrap_or(u32::MAX));
        let rest = section.rest().and_then(|(_, u)| nearest::<R>(u));
        let rest = rest.filter(|rest| begin < *rest && *rest < end);
        let is_last = behind == plan.schedule().stages().len();
        if let Some(rest) = if is_last { Some(end) } else { rest } {
            found.push(Between { begin, end: rest, stages: first..behind, periods });
            (begin, first, periods) = (rest, behind, 0);
        }
    }
    found
}

fn drive<R: Backend, const D: usize>(
    legs: &[RestToRest<'_, R, D>],
    plan: &ExactPlan,
    problem: &Problem<D>,
) -> Run {
    let mut planned = plan.lengths();
    let mut steps = Vec::with_capacity(plan.periods() as usize + 1);
    let mut finished = !legs.is_empty();
    for leg in legs {
        let own: Vec<_> = planned.by_ref().take(leg.schedule.periods() as usize).collect();
        finished =
            finished && follow(leg, own, most_periods(plan.periods()), 1.0 / problem.period_s(), &mut steps);
    }
    let start = problem.curves.first().map_or(0.0, |curve| curve.as_curve().domain().0);
    let points = problem.curves.iter().flat_map(|curve| curve.control_points().iter().flatten());
    Run {
        fluctuation_resolution: fluctuation_resolution::<R, D>(start, &steps, problem),
        steps,
        finished,
        planned_periods: plan.periods(),
        filament_step_mm: None,
        resolution_mm: resolution_at::<R>(points.fold(0.0, |largest: f64, x| largest.max(x.abs()))),
        audit: Audit::default(),
    }
}

/// Steps to the next stop, beside the distance that each period wants and the feed at its end; whether it is reached in no more than
/// so many steps of the run.
fn follow<R: Backend, const D: usize>(
    leg: &RestToRest<'_, R, D>,
    planned: Vec<(DoubleDouble, f64)>,
    most: usize,
    per_second: f64,
    steps: &mut Vec<RunStep>,
) -> bool {
    let mut planned = planned.into_iter();
    let mut state = leg.start();
    while steps.len() < most {
        let Some(setpoint) = leg.step(&mut state) else { break };
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

/// `½ ulp(u)/(u_{i+1} - u_i)`, the largest over the steps that a fluctuation at cruise is judged by.
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
