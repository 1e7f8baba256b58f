//! A run on one curve with a global parameter: the textbook way, raw in every format.

use feed_plan::Schedule;
use nurbs_core::{Differentiate, Evaluate, NurbsCurve};
use real::{Audit, Backend, Recorded};
use secant_interp::{Interpolator, Method, Tolerance};

use crate::exact_plan::{ExactPlan, in_format};
use crate::metrics::cruise_mm;
use crate::problem::Problem;
use crate::recorded::RecordedRun;
use crate::run::{Options, Refusal, Run, RunStep, most_periods, resolution_at, unit_in_last_place};

/// Converts curve, plan and limits to `R` and runs.
pub(crate) fn run<R: Backend, const D: usize>(
    problem: &Problem<D>,
    plan: &ExactPlan,
    options: &Options,
    method: Method,
) -> Result<Run, Refusal> {
    prepared::<R, D, _>(problem, plan, options, method, |interpolator| drive(interpolator, plan, problem))
}

/// The operations of each of the first `most` steps of the same run.
pub(crate) fn record<R: Backend, const D: usize>(
    problem: &Problem<D>,
    plan: &ExactPlan,
    options: &Options,
    method: Method,
    most: usize,
) -> Result<RecordedRun, Refusal> {
    prepared::<Recorded<R>, D, _>(problem, plan, options, method, |interpolator| {
        let mut state = interpolator.start();
        RecordedRun::of(most.min(most_periods(plan.periods())), || interpolator.step(&mut state).is_some())
    })
}

/// Hands what the run needs, in `R`, to `work`.
fn prepared<R: Backend, const D: usize, T>(
    problem: &Problem<D>,
    plan: &ExactPlan,
    options: &Options,
    method: Method,
    work: impl FnOnce(&Interpolator<'_, R, NurbsCurve<'_, R, D>>) -> T,
) -> Result<T, Refusal> {
    let [curve] = problem.curves.as_slice() else {
        return Err(Refusal::ManyCurves(problem.curves.len()));
    };
    let limits = problem.limits_per_period()?;
    let machine = &problem.machine;
    let fluctuation = options.fluctuation.unwrap_or(machine.fluctuation_limit);
    let curve = curve.convert::<R>()?;
    let stages = plan.stages_in::<R>()?;
    let interpolator = Interpolator {
        curve: curve.as_curve(),
        schedule: Schedule::new(&stages, R::one(), plan.periods()),
        method,
        tolerance: Tolerance {
            // Below the format's resolution a tolerance is 0, and the solver goes on to the last digit.
            parameter: R::from_f64(machine.parameter_tolerance).unwrap_or_else(R::zero),
            fluctuation: R::from_f64(fluctuation).unwrap_or_else(R::zero),
            max_iterations: machine.max_iterations,
        },
        landing_step: in_format("acceleration", limits.acceleration)?,
    };
    Ok(work(&interpolator))
}

fn drive<R: Backend, C: Differentiate<R, D>, const D: usize>(
    interpolator: &Interpolator<'_, R, C>,
    plan: &ExactPlan,
    problem: &Problem<D>,
) -> Run {
    let per_second = 1.0 / problem.period_s();
    let mut planned = plan.lengths();
    let mut state = interpolator.start();
    let mut steps = Vec::with_capacity(plan.periods() as usize + 1);
    while steps.len() < most_periods(plan.periods()) {
        let Some(setpoint) = interpolator.step(&mut state) else { break };
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
    let start = problem.curves.first().map_or(0.0, |curve| curve.as_curve().domain().0);
    let points = problem.curves.iter().flat_map(|curve| curve.control_points().iter().flatten());
    Run {
        fluctuation_resolution: fluctuation_resolution::<R, D>(start, &steps, problem),
        steps,
        finished: state.is_finished(),
        planned_periods: plan.periods(),
        resolution_mm: resolution_at::<R>(points.fold(0.0, |largest: f64, x| largest.max(x.abs()))),
        audit: Audit::default(),
    }
}

/// `½ ulp(u)/(u_{i+1} - u_i)`, the largest over the steps that a fluctuation at cruise is judged by.
fn fluctuation_resolution<R: Backend, const D: usize>(
    start: f64,
    steps: &[RunStep],
    problem: &Problem<D>,
) -> f64 {
    let full_step = problem.machine.feedrate_mm_per_s * problem.period_s();
    let cruise = cruise_mm(steps.iter().map(|step| step.wanted_mm.0), full_step);
    let from = std::iter::once(start).chain(steps.iter().map(|step| step.u.0));
    let at_cruise = from.zip(steps).filter(|(_, step)| step.wanted_mm.0 >= cruise);
    let share = at_cruise.map(|(from, step)| 0.5 * unit_in_last_place::<R>(step.u.0) / (step.u.0 - from));
    share.filter(|share| share.is_finite()).fold(0.0, f64::max)
}
