//! The velocity, acceleration and jerk that a plan asks of each axis, period by period, as the axis's drive gets it.
//!
//! With the unit tangent e an axis has the velocity `e V`. Its mean over a period T is the step to the next setpoint
//! over T. Its acceleration is the difference of two such means over T, and its jerk that of two accelerations over T.
//! These figures include the demands of breaks of the tangent and of steps of the curvature. A peak shorter than a
//! period counts as the drive gets it: by its mean over the period. Where nothing changes no period is looked at.

use std::cell::Cell;
use std::iter::Peekable;
use std::ops::Range;

use feed_plan::FeedLimit;
use nurbs_core::{Differentiate, FastCurve};
use part_program::AxisLimits;
use real::Real;
use serde::Serialize;

use crate::plan::calm::{SURE, calm, on_ways, others};
use crate::plan::exact_plan::ExactPlan;
use crate::plan::samples::Walk;
use crate::problem::problem::Problem;

/// Samples in each period. The trapezoidal rule then has an error of at most `1/(12·4²)` of a step of the jerk.
const PER_PERIOD: u64 = 4;

/// The largest one-period means of one axis over a plan, with the machine's limits.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct AxisPeak {
    /// `x`, `y` or `z`.
    pub axis: char,
    /// Largest velocity, in mm/s.
    pub velocity_max_mm_per_s: f64,
    /// Largest acceleration, in mm/s².
    pub acceleration_max_mm_per_s2: f64,
    /// Largest jerk, in mm/s³.
    pub jerk_max_mm_per_s3: f64,
    /// The machine's limits of this axis.
    pub limits: AxisLimits,
}

/// The peaks of each axis of the path, whose straight ways are `straight`. Before the plan and behind it, each axis keeps the velocity that it has at that
/// end.
pub(crate) fn axis_peaks<const D: usize>(
    plan: &ExactPlan,
    problem: &Problem<D>,
    curves: &[FastCurve<'_, D>],
    limit: &FeedLimit<f64>,
    straight: &[Range<f64>],
) -> Vec<AxisPeak> {
    let axes = &problem.machine.axes;
    let named = [('x', axes.x), ('y', axes.y), ('z', axes.z)];
    let mut peaks: Vec<_> = named
        .into_iter()
        .take(D)
        .map(|(axis, limits)| AxisPeak {
            axis,
            velocity_max_mm_per_s: 0.0,
            acceleration_max_mm_per_s2: 0.0,
            jerk_max_mm_per_s3: 0.0,
            limits,
        })
        .collect();
    let t = problem.period_s();
    let (last, step) = (plan.periods() * PER_PERIOD, 1.0 / PER_PERIOD as f64);
    let steady = || on_ways(plan.arcs().stages(), straight);
    let mut velocities = Velocities {
        curves,
        limit,
        walk: Walk::new(plan),
        place: Cell::default(),
        steady: steady().peekable(),
        known: None,
    };
    let mut at = |sample: u64| velocities.at(sample.min(last) as f64 * step);
    let mut end = at(0);
    let mut before = [end; 2];
    for (period, is_behind_calm) in others(steady().filter_map(|way| calm(&way)), plan.periods() + 2) {
        if is_behind_calm {
            end = at(period * PER_PERIOD);
            before = [end; 2];
        }
        let mut sum = end.map(|x| x / 2.0);
        for sample in 1..=PER_PERIOD {
            end = at(period * PER_PERIOD + sample);
            sum = std::array::from_fn(|d| sum[d] + end[d]);
        }
        let mean: [f64; D] = std::array::from_fn(|d| (sum[d] - end[d] / 2.0) / PER_PERIOD as f64);
        for (d, peak) in peaks.iter_mut().enumerate() {
            let most = |slot: &mut f64, value: f64| *slot = slot.max(value.abs());
            let [second, first] = before.map(|mean| mean[d]);
            most(&mut peak.velocity_max_mm_per_s, mean[d] / t);
            most(&mut peak.acceleration_max_mm_per_s2, (mean[d] - first) / t.powi(2));
            most(&mut peak.jerk_max_mm_per_s3, (mean[d] - 2.0 * first + second) / t.powi(3));
        }
        before = [before[1], mean];
    }
    peaks
}

/// The velocities of the axes along a plan, in mm per period; 0 where a curve stands still.
struct Velocities<'a, I: Iterator<Item = Range<f64>>, const D: usize> {
    curves: &'a [FastCurve<'a, D>],
    limit: &'a FeedLimit<f64>,
    walk: Walk<'a>,
    /// The point of the limit at which the last search ended.
    place: Cell<usize>,
    /// The times in which nothing changes, and the velocities in the first of them, once they are known.
    steady: Peekable<I>,
    known: Option<[f64; D]>,
}

impl<I: Iterator<Item = Range<f64>>, const D: usize> Velocities<'_, I, D> {
    /// At a time, in periods, which is no earlier than the one before.
    fn at(&mut self, time: f64) -> [f64; D] {
        while self.steady.next_if(|steady| steady.end - SURE < time).is_some() {
            self.known = None;
        }
        let is_steady = self.steady.peek().is_some_and(|steady| steady.start + SURE <= time);
        if let Some(known) = self.known.filter(|_| is_steady) {
            return known;
        }
        let (distance, feed) = self.walk.to(time).distance_and_feed();
        let (curve, u) = self.limit.parameter_near(distance, &self.place);
        let along = self.curves.get(curve).map_or([0.0; D], |curve| curve.derivatives(u).first);
        let speed = f64::norm(&along);
        let found = along.map(|x| if speed > 0.0 { x / speed * feed } else { 0.0 });
        self.known = is_steady.then_some(found);
        found
    }
}

#[cfg(test)]
mod tests {
    use part_program::{read_machine, read_part};

    use super::*;
    use crate::plan::calm::straight_ways;
    use crate::plan::plan_summary::total_acceleration;

    /// Slow moves, with corners that are passed and one that is not, and an arc: what is left out is most of the time.
    #[test]
    fn what_is_left_out_has_no_peak() {
        let part = "G21 G90\nG0 X0 Y0\nG1 X10 F60\nG1 X20 Y0.2\nG2 X30 Y-9.8 I0 J-10\nG1 Y-20\nG1 X0\nG0 X5 Y5\nG1 X9 Y9\n";
        let example = include_str!("../../../../data/seed-000.toml");
        let machine = example[example.find("[machine]").unwrap()..].split("[[").next().unwrap();
        let machine = read_machine("m", machine).unwrap();
        let problem = Problem::<3>::new(&read_part("p.nc", part).unwrap(), &machine).unwrap();
        let plan = ExactPlan::in_format::<f64, 3>(&problem, [0.0; 2]).unwrap();
        let limit = plan.limit(&problem).unwrap();
        let curves = problem.fast_curves();
        let straight = straight_ways(&curves, limit);
        let calm = on_ways(plan.arcs().stages(), &straight).filter_map(|way| calm(&way));
        let left_out: u64 = calm.map(|calm| calm.end - calm.start).sum();
        assert!(left_out > plan.periods() / 2, "{left_out} of {}", plan.periods());
        let [all, these] =
            [&[][..], &straight].map(|straight| axis_peaks(&plan, &problem, &curves, limit, straight));
        for (all, these) in all.iter().zip(&these) {
            for (all, these) in [
                (all.velocity_max_mm_per_s, these.velocity_max_mm_per_s),
                (all.acceleration_max_mm_per_s2, these.acceleration_max_mm_per_s2),
                (all.jerk_max_mm_per_s3, these.jerk_max_mm_per_s3),
            ] {
                assert!((all - these).abs() <= 1e-9 * all, "{all} {these}");
            }
        }
        let [all, these] =
            [&[][..], &straight].map(|straight| total_acceleration(&plan, &problem, limit, straight));
        assert!((all - these).abs() <= 1e-9 * all, "{all} {these}");
    }
}
