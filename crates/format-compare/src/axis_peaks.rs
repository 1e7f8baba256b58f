//! What a plan asks of each axis.
//!
//! With the unit tangent e, the curvature vector `k = de/ds` and `c = dk/ds`, an axis has the velocity `e V`, the
//! acceleration `e a + k V²` and the jerk `e j + 3 k V a + c V³`. They are sampled, c by central differences.

use feed_plan::FeedLimit;
use nurbs_core::{Differentiate, Evaluate, NurbsBuf, curvature_vector};
use part_program::AxisLimits;
use real::Real;
use serde::Serialize;

use crate::exact_plan::ExactPlan;
use crate::plan_table::{Place, place_at, samples};
use crate::problem::Problem;

/// Samples a period.
const PER_PERIOD: u32 = 4;
/// Distance of a central difference, as a part of the way between two points of the limit.
const DIFFERENCE: f64 = 1e-2;

/// The largest values of one axis over a plan, and the machine's limits.
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

/// The peaks of each axis that the path has.
pub(crate) fn axis_peaks<const D: usize>(
    plan: &ExactPlan,
    problem: &Problem<D>,
    limit: &FeedLimit<f64>,
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
    for sample in samples(plan, PER_PERIOD) {
        let place = sample
            .rest
            .map_or_else(|| place_at(limit, problem, sample.distance), |rest| behind_rest(problem, rest));
        let found = problem.curves.get(place.curve).and_then(|curve| turning(curve, &place));
        let Some((e, k, c)) = found else { continue };
        let (v, a, j) = (sample.feed / t, sample.acceleration / t.powi(2), sample.jerk / t.powi(3));
        for (d, peak) in peaks.iter_mut().enumerate() {
            let most = |slot: &mut f64, value: f64| *slot = slot.max(value.abs());
            most(&mut peak.velocity_max_mm_per_s, e[d] * v);
            most(&mut peak.acceleration_max_mm_per_s2, e[d] * a + k[d] * v * v);
            most(&mut peak.jerk_max_mm_per_s3, e[d] * j + 3.0 * k[d] * v * a + c[d] * v.powi(3));
        }
    }
    peaks
}

/// The place from which a plan sets off behind a rest: the begin of the next curve, where the one that it rests on ends there.
fn behind_rest<const D: usize>(problem: &Problem<D>, (curve, u): (usize, f64)) -> Place {
    let is_at_end = problem.curves.get(curve).is_some_and(|curve| u >= curve.as_curve().domain().1);
    let next = problem.curves.get(curve + 1).filter(|_| is_at_end);
    let (curve, u) = next.map_or((curve, u), |next| (curve + 1, next.as_curve().domain().0));
    Place { curve, u, around: (u, u) }
}

/// e, k and c at a place; `None` where the curve stands still.
fn turning<const D: usize>(
    curve: &NurbsBuf<f64, D>,
    place: &Place,
) -> Option<([f64; D], [f64; D], [f64; D])> {
    let curve = curve.as_curve();
    let at = curve.derivatives(place.u);
    let (k, speed) = (curvature_vector(&at)?, f64::norm(&at.first));
    let (begin, end) = place.around;
    let h = (end - begin) * DIFFERENCE;
    // Within the span on both sides: at its end the derivatives are those of the next one.
    let middle = place.u.clamp(begin + 2.0 * h, end - 2.0 * h);
    let bend = |u: f64| curvature_vector(&curve.derivatives(u));
    let c = if h > 0.0 {
        let (before, after) = (bend(middle - h)?, bend(middle + h)?);
        core::array::from_fn(|d| (after[d] - before[d]) / (2.0 * h * speed))
    } else {
        [0.0; D] // At a joint or an end; the samples on both sides have it.
    };
    Some((at.first.map(|x| x / speed), k, c))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{PlanSummary, ProfileKind};
    use part_program::{read_machine, read_part};

    fn summary(part: &str, axes: &str) -> PlanSummary {
        let machine = include_str!("../../../data/seed-000.toml");
        let machine =
            machine[machine.find("[machine]").unwrap()..].split("[[").next().unwrap().to_string() + axes;
        let machine = read_machine("m", &machine).unwrap();
        let problem = Problem::<2>::new(&read_part("p.nc", part).unwrap(), &machine).unwrap();
        let plan = ExactPlan::in_format_with::<f64, 2>(&problem, [0.0; 2], ProfileKind::SCurve).unwrap();
        PlanSummary::of(&plan, &problem).unwrap()
    }

    #[test]
    fn along_an_axis_the_path_s_values_are_the_axis_s() {
        let summary = summary("G0 X0 Y0\nG1 X100 F6000\n", "");
        let [x, y] = summary.axes.as_slice() else { panic!("two axes") };
        assert!((99.5..=100.0).contains(&x.velocity_max_mm_per_s), "{x:?}");
        assert!(
            (x.acceleration_max_mm_per_s2 / summary.acceleration_max_mm_per_s2 - 1.0).abs() < 0.01,
            "{x:?}"
        );
        assert!((x.jerk_max_mm_per_s3 / summary.jerk_max_mm_per_s3 - 1.0).abs() < 1e-9, "{x:?}");
        assert_eq!((y.velocity_max_mm_per_s, y.jerk_max_mm_per_s3), (0.0, 0.0));
    }

    #[test]
    fn on_a_circle_an_axis_turns_and_keeps_its_limits() {
        let circle = "G0 X0 Y0\nG2 I30 J0 F6000\n";
        let free = summary(circle, "");
        // At F on radius 30: V²/r across, as the x axis sees it where the path runs along y; near the start and the end,
        // where the feed changes along y, it sees a little of that too.
        let (x, turning) = (free.axes[0], 100.0_f64.powi(2) / 30.0);
        let used = x.acceleration_max_mm_per_s2 / turning;
        assert!((0.98..2.0).contains(&used), "{x:?}");
        let limits = "\n[machine.axes.x]\nvelocity_mm_per_s = 60\nacceleration_mm_per_s2 = 200\njerk_mm_per_s3 = 5000\n";
        let x = summary(circle, limits).axes[0];
        assert!(x.velocity_max_mm_per_s <= 60.0 * (1.0 + 1e-9) && x.velocity_max_mm_per_s > 30.0, "{x:?}");
        assert!(x.acceleration_max_mm_per_s2 <= 200.0 * (1.0 + 1e-9), "{x:?}");
        assert!(x.jerk_max_mm_per_s3 <= 5000.0 * (1.0 + 1e-6), "{x:?}");
    }

    /// At an inner knot of degree 2 the curvature steps, which is no jerk of the span on either side. The plan keeps the jerk of
    /// the axes, and so do its samples.
    #[test]
    fn a_step_of_curvature_is_no_jerk() {
        let spline = "[curve]\ndegree = 2\ncontrol_points_mm = [[0, 0], [30, 40], [60, -20], [90, 30]]\nknots = [0, 0, 0, 1, 2, 2, 2]\n";
        let limits =
            "\n[machine.axes.x]\njerk_mm_per_s3 = 100000\n[machine.axes.y]\njerk_mm_per_s3 = 100000\n";
        for axis in &summary(spline, limits).axes[..2] {
            assert!(axis.jerk_max_mm_per_s3 <= 1e5 * 1.05, "{axis:?}");
        }
    }

    /// The jerk with which the next move begins was that of the axis along which the last one had come to the stop.
    #[test]
    fn a_stop_begins_in_the_direction_of_the_next_move() {
        let limits = "\n[machine.axes.x]\njerk_mm_per_s3 = 10000\n";
        let summary = summary("G21 G90\nG0 X0 Y0\nG1 Y20 F6000\nG1 X5\nG1 Y30\n", limits);
        let [x, y] = summary.axes.as_slice() else { panic!("two axes") };
        assert!(x.jerk_max_mm_per_s3 <= 1e4 && x.jerk_max_mm_per_s3 > 9e3, "{x:?}");
        assert!((y.jerk_max_mm_per_s3 / summary.jerk_max_mm_per_s3 - 1.0).abs() < 1e-9, "{y:?}");
    }
}
