//! A plan as people read it: the stage table in mm and s, a summary, and samples.

use feed_plan::{EndFeeds, FeedLimit, ProfileKind, Stage, StageKind, StageShape, jerk_free_duration};
use nurbs_core::Evaluate;
use real::{DoubleDouble, Real};
use serde::Serialize;

use crate::axis_peaks::{AxisPeak, axis_peaks};
use crate::exact_plan::ExactPlan;
use crate::problem::Problem;
use crate::run::Refusal;

/// One stage: paper A's {u_s, u_e, v_s, v_e, flag, a_0..a_3}, with length and time.
#[derive(Clone, Debug, Serialize)]
pub struct StageRow {
    /// `accelerate`, `decelerate` or `constant`.
    pub kind: &'static str,
    /// How the feed changes: `cubic`, `onset` (constant jerk from no acceleration), `steady` (constant acceleration or
    /// feed), `easing` (constant jerk to no acceleration) or `cosine`.
    pub shape: &'static str,
    /// Number of the curve that the stage starts on, from 0.
    pub curve_start: usize,
    /// Parameter of that curve where it starts.
    pub u_start: f64,
    /// Number of the curve that it ends on.
    pub curve_end: usize,
    /// Parameter of that curve where it ends.
    pub u_end: f64,
    /// Feed at the start, in mm/s.
    pub start_feed_mm_per_s: f64,
    /// Feed at the end, in mm/s.
    pub end_feed_mm_per_s: f64,
    /// Length, in mm.
    pub length_mm: f64,
    /// Time, in s.
    pub time_s: f64,
    /// a_0 to a_3 of the feed as a polynomial of the time in s; none for a cosine.
    pub coefficients: Option<[f64; 4]>,
}

/// A plan in figures.
#[derive(Clone, Debug, Serialize)]
pub struct PlanSummary {
    /// The transitions that the plan is made of: `cubic`, `s-curve`, `trigonometric` or `flexible`.
    pub profile: &'static str,
    /// Number of curves.
    pub curves: usize,
    /// Arc length, in mm.
    pub length_mm: f64,
    /// Total time, in s.
    pub time_s: f64,
    /// Whole number of interpolation periods.
    pub periods: u32,
    /// The least time that a plan without a jerk limit needs, in s.
    pub jerk_free_time_s: f64,
    /// By which part of that time the plan takes longer.
    pub over_jerk_free: f64,
    /// Largest acceleration along the path, in mm/s², a step of feed between stages counted as its mean over a period.
    pub acceleration_max_mm_per_s2: f64,
    /// Its limit.
    pub acceleration_limit_mm_per_s2: f64,
    /// Largest acceleration in any direction, in mm/s², of the setpoints: the second difference of the points that periods end at,
    /// over T². In bends and at corners that are passed it is more than that along the path.
    pub total_acceleration_max_mm_per_s2: f64,
    /// Whether nothing limits the acceleration across the path in bends.
    pub is_free_across: bool,
    /// Largest jerk along the path, in mm/s³, with such steps in the same way.
    pub jerk_max_mm_per_s3: f64,
    /// Its limit.
    pub jerk_limit_mm_per_s3: f64,
    /// Share of the path that is travelled at the commanded feed, or less than 0.5 % below it.
    pub share_at_commanded_feed: f64,
    /// The feed that is run there, over the commanded one: less than 1, for a whole number of periods from rest to rest, and in
    /// bends for what chords fall short. `None` where no part is travelled at it.
    pub feed_over_commanded: Option<f64>,
    /// What the plan asks of each axis.
    pub axes: Vec<AxisPeak>,
    /// Number of stages.
    pub stage_count: usize,
    /// The stages.
    pub stages: Vec<StageRow>,
}

/// The plan at one instant.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct FeedSample {
    /// Time, in s.
    pub time_s: f64,
    /// Distance along the path, in mm.
    pub distance_mm: f64,
    /// Number of the curve there, from 0.
    pub curve: usize,
    /// Its parameter there.
    pub u: f64,
    /// Feed, in mm/s.
    pub feed_mm_per_s: f64,
    /// Acceleration along the path, in mm/s².
    pub acceleration_mm_per_s2: f64,
    /// Jerk along the path, in mm/s³.
    pub jerk_mm_per_s3: f64,
    /// The feed limit there, in mm/s.
    pub limit_mm_per_s: f64,
}

impl PlanSummary {
    /// The figures of a plan of `problem`.
    ///
    /// # Errors
    /// [`Refusal::Plan`] when the limit curve cannot be made.
    pub fn of<const D: usize>(plan: &ExactPlan, problem: &Problem<D>) -> Result<Self, Refusal> {
        let t = problem.period_s();
        let feed_limit = plan.limit(problem)?;
        let stages: Vec<StageRow> = plan
            .arcs()
            .stages()
            .iter()
            .map(|stage| StageRow {
                kind: match stage.kind() {
                    StageKind::Accelerate => "accelerate",
                    StageKind::Decelerate => "decelerate",
                    StageKind::Constant => "constant",
                },
                shape: shape_name(stage.shape),
                curve_start: stage.curve_start,
                u_start: stage.u_start.value(),
                curve_end: stage.curve_end,
                u_end: stage.u_end.value(),
                start_feed_mm_per_s: stage.start_feed.value() / t,
                end_feed_mm_per_s: stage.end_feed.value() / t,
                length_mm: stage.length.value(),
                time_s: stage.duration.value() * t,
                coefficients: stage.piece().coefficients().map(|a| {
                    let [a0, a1, a2, a3] = a.map(DoubleDouble::value);
                    [a0 / t, a1 / t.powi(2), a2 / t.powi(3), a3 / t.powi(4)]
                }),
            })
            .collect();
        let pieces = || plan.schedule().stages().iter().map(Stage::piece);
        let (by_periods, jerk_by_periods) = differences_over_periods(plan);
        let acceleration = pieces().map(|piece| piece.peak_acceleration().value()).fold(by_periods, f64::max);
        // What the feed of a shorter stage is rounded by would be much of a jerk over so little time, and comes to nothing.
        let lasting = pieces().filter(|piece| piece.duration.value() > SHORT);
        let jerk = lasting.map(|piece| piece.peak_jerk().value()).fold(jerk_by_periods, f64::max);
        let time_s = f64::from(plan.periods()) * t;
        let jerk_free_time_s = jerk_free_time_s(plan, problem, feed_limit)?;
        let length_mm: f64 = stages.iter().map(|s| s.length_mm).sum();
        let [mut full_mm, mut commanded_mm] = [0.0; 2];
        for row in &stages {
            let shares = (row.curve_start..=row.curve_end).map(|curve| problem.feed_share(curve));
            let commanded = shares.fold(1.0, f64::min) * problem.machine.feedrate_mm_per_s;
            if row.start_feed_mm_per_s.min(row.end_feed_mm_per_s) >= commanded * (1.0 - AT_FEED) {
                full_mm += row.length_mm;
                commanded_mm += row.time_s * commanded;
            }
        }
        Ok(Self {
            curves: problem.curves.len(),
            length_mm: feed_limit.length(),
            profile: profile_name(plan.profile()),
            time_s,
            periods: plan.periods(),
            jerk_free_time_s,
            over_jerk_free: time_s / jerk_free_time_s - 1.0,
            acceleration_max_mm_per_s2: acceleration / t.powi(2),
            acceleration_limit_mm_per_s2: problem.machine.acceleration_mm_per_s2,
            total_acceleration_max_mm_per_s2: total_acceleration(plan, problem, feed_limit) / t.powi(2),
            is_free_across: problem.machine.centripetal_acceleration_mm_per_s2.is_none(),
            jerk_max_mm_per_s3: jerk / t.powi(3),
            jerk_limit_mm_per_s3: problem.machine.jerk_mm_per_s3,
            share_at_commanded_feed: full_mm / length_mm,
            feed_over_commanded: (full_mm > 0.0).then(|| full_mm / commanded_mm),
            axes: axis_peaks(plan, problem, feed_limit),
            stage_count: stages.len(),
            stages,
        })
    }
}

/// The largest second difference of the points that periods end at, in mm. Where the plan begins or ends at rest, and where the machine
/// makes another move in between, the tool stays where it is.
fn total_acceleration<const D: usize>(plan: &ExactPlan, problem: &Problem<D>, limit: &FeedLimit<f64>) -> f64 {
    let point =
        |curve: usize, u: f64| problem.curves.get(curve).map_or([0.0; D], |curve| curve.as_curve().point(u));
    let ends_of = |curve: usize| {
        let domain = problem.curves.get(curve).map(|curve| curve.as_curve().domain());
        domain.map(|(begin, end)| [point(curve, begin), point(curve, end)])
    };
    let stages = plan.arcs().stages();
    let rests = [
        stages.first().is_some_and(|stage| stage.start_feed.value() == 0.0),
        stages.last().is_some_and(|stage| stage.end_feed.value() == 0.0),
    ];
    let mut places = samples(plan, 1).map(|sample| limit.parameter_at(sample.distance)).peekable();
    let ends = problem.breaks.iter().copied().chain([problem.curves.len()]);
    let (mut begin, mut most) = (0, 0.0_f64);
    for end in ends {
        let own = std::iter::from_fn(|| places.next_if(|(curve, _)| *curve < end))
            .map(|(curve, u)| point(curve, u));
        let before = ends_of(begin).filter(|_| begin > 0 || rests[0]).map(|[start, _]| [start; 2]);
        let behind =
            ends_of(end - 1).filter(|_| end < problem.curves.len() || rests[1]).map(|[_, last]| [last; 2]);
        most = most.max(largest_second_difference(
            before.into_iter().flatten().chain(own).chain(behind.into_iter().flatten()),
        ));
        begin = end;
    }
    most
}

/// The largest second difference of a series of points; over T² of points a period apart the largest acceleration in any direction.
pub fn largest_second_difference<const D: usize>(points: impl IntoIterator<Item = [f64; D]>) -> f64 {
    let (mut last, mut most) = ([None::<[f64; D]>; 2], 0.0_f64);
    for point in points {
        if let [Some(a), Some(b)] = last {
            let difference: [f64; D] = std::array::from_fn(|d| (point[d] - b[d]) - (b[d] - a[d]));
            most = most.max(f64::norm(&difference));
        }
        last = [last[1], Some(point)];
    }
    most
}

/// The largest acceleration and jerk, in mm and periods, as means over a period: second and third differences of the distance. They
/// exceed those of every stage where the feed steps from one stage to the next.
fn differences_over_periods(plan: &ExactPlan) -> (f64, f64) {
    let (mut acceleration, mut jerk) = (0.0_f64, 0.0_f64);
    let mut before = [DoubleDouble::from(0.0); 2];
    for (period, (length, _)) in plan.lengths().enumerate() {
        let [second, first] = before;
        if period > 0 {
            acceleration = acceleration.max((length - first).value().abs());
        }
        if period > 1 {
            jerk = jerk.max((length - first - first + second).value().abs());
        }
        before = [first, length];
    }
    (acceleration, jerk)
}

/// The least time between the plan's end feeds without a limit of jerk. Limits of the axes' accelerations and jerks are left out
/// too: how a plan shares them out between turning and the feed is its own choice.
fn jerk_free_time_s<const D: usize>(
    plan: &ExactPlan,
    problem: &Problem<D>,
    feed_limit: &FeedLimit<f64>,
) -> Result<f64, Refusal> {
    let stages = plan.schedule().stages();
    let ends = EndFeeds {
        start: stages.first().map_or(0.0, |stage| stage.start_feed.value()),
        end: stages.last().map_or(0.0, |stage| stage.end_feed.value()),
    };
    let mut free = problem.clone();
    let mut is_limited = false;
    for axis in [&mut free.machine.axes.x, &mut free.machine.axes.y, &mut free.machine.axes.z] {
        let limits = [axis.acceleration_mm_per_s2.take(), axis.jerk_mm_per_s3.take()];
        is_limited |= limits.iter().any(Option::is_some);
    }
    let limits = problem.limits_per_period()?;
    let duration = if is_limited {
        jerk_free_duration(&free.feed_limit()?, &limits, ends)
    } else {
        jerk_free_duration(feed_limit, &limits, ends)
    };
    Ok(duration * problem.period_s())
}

/// A kind of transition by its name on the command line.
fn profile_name(kind: ProfileKind) -> &'static str {
    match kind {
        ProfileKind::Cubic => "cubic",
        ProfileKind::SCurve => "s-curve",
        ProfileKind::Trigonometric => "trigonometric",
        ProfileKind::Flexible => "flexible",
    }
}

fn shape_name<R>(shape: StageShape<R>) -> &'static str {
    match shape {
        StageShape::Cubic => "cubic",
        StageShape::Onset => "onset",
        StageShape::Steady => "steady",
        StageShape::Easing => "easing",
        StageShape::Cosine => "cosine",
        StageShape::Bent(_) => "bent",
    }
}

/// A stage this close to the commanded feed counts as at it: stretching the time to a whole number of periods
/// lowers every feed by a part in a thousand or so, which [`PlanSummary::feed_over_commanded`] tells.
const AT_FEED: f64 = 0.005;
/// Stages of less than 2⁻²⁰ of a period say nothing of the jerk.
const SHORT: f64 = 1.0 / 1_048_576.0;

/// The plan at one instant, in mm and periods.
pub(crate) struct Sample {
    time: f64,
    pub(crate) distance: f64,
    pub(crate) feed: f64,
    pub(crate) acceleration: f64,
    pub(crate) jerk: f64,
}

/// The plan `per_period` times a period, both ends included.
pub(crate) fn samples(plan: &ExactPlan, per_period: u32) -> impl Iterator<Item = Sample> {
    let stages = plan.arcs().stages();
    let step = 1.0 / f64::from(per_period);
    let (mut stage, mut before) = (0, 0.0);
    (0..=plan.periods() * per_period).map(move |sample| {
        let time = f64::from(sample) * step;
        while stage + 1 < stages.len() && time >= before + stages[stage].duration.value() {
            before += stages[stage].duration.value();
            stage += 1;
        }
        let here = &stages[stage];
        let local = DoubleDouble::from((time - before).min(here.duration.value()));
        Sample {
            time,
            distance: (here.start + here.distance_at(local)).value(),
            feed: here.feed_at(local).value(),
            acceleration: here.acceleration_at(local).value(),
            jerk: here.jerk_at(local).value(),
        }
    })
}

impl ExactPlan {
    /// The plan sampled `per_period` times a period, both ends included.
    ///
    /// # Errors
    /// [`Refusal::Plan`] when the limit curve cannot be made.
    pub fn sampled<const D: usize>(
        &self,
        problem: &Problem<D>,
        per_period: u32,
    ) -> Result<Vec<FeedSample>, Refusal> {
        let t = problem.period_s();
        let feed_limit = self.limit(problem)?;
        let rows = samples(self, per_period).map(|sample| {
            let (curve, u) = feed_limit.parameter_at(sample.distance);
            FeedSample {
                time_s: sample.time * t,
                distance_mm: sample.distance,
                curve,
                u,
                feed_mm_per_s: sample.feed / t,
                acceleration_mm_per_s2: sample.acceleration / t.powi(2),
                jerk_mm_per_s3: sample.jerk / t.powi(3),
                limit_mm_per_s: feed_limit.at(sample.distance) / t,
            }
        });
        Ok(rows.collect())
    }
}

#[cfg(test)]
mod tests {
    use nurbs_core::arc_length;
    use part_program::{read_machine, read_part};

    use super::*;

    fn problem(chord_error_mm: &str) -> Problem<2> {
        let text = include_str!("../../../data/seed-000.toml").replace("0.0005", chord_error_mm);
        Problem::new(&read_part("p.toml", &text).unwrap(), &read_machine("p.toml", &text).unwrap()).unwrap()
    }

    /// Sums of chords were taken for arc lengths: the last row was short of the end, and feeds stood beside the limit of another place.
    #[test]
    fn the_places_of_samples_are_those_of_the_plan() {
        let problem = problem("0.1");
        let plan = ExactPlan::in_format::<f64, 2>(&problem, [0.0; 2]).unwrap();
        let limit = plan.limit(&problem).unwrap();
        let chords: f64 = plan.lengths().map(|(length, _)| length.value()).sum();
        assert!(limit.length() - chords > 1e-3, "chords fall short: {chords} of {}", limit.length());
        let samples = plan.sampled(&problem, 2).unwrap();
        let last = samples.last().unwrap();
        assert!((last.distance_mm - limit.length()).abs() < 1e-9 && last.u > 1.0 - 1e-9, "{last:?}");
        for sample in &samples {
            assert!(sample.feed_mm_per_s <= sample.limit_mm_per_s * (1.0 + 1e-9), "{sample:?}");
            let length = arc_length(&problem.curves[0].as_curve(), 0.0, sample.u, 1e-9).length;
            assert!((length - sample.distance_mm).abs() < 1e-3, "{length} {sample:?}");
        }
    }

    #[test]
    fn the_limit_is_that_of_the_problem_and_made_once() {
        let problem = problem("0.0005");
        let expected = problem.feed_limit().unwrap();
        for plan in [
            ExactPlan::in_format::<f64, 2>(&problem, [0.0; 2]),
            ExactPlan::in_format::<f32, 2>(&problem, [0.0; 2]),
            ExactPlan::through_window(&problem, 50.0, ProfileKind::Cubic),
        ] {
            let plan = plan.unwrap();
            let limit = plan.limit(&problem).unwrap();
            assert_eq!(*limit, expected);
            assert!(std::ptr::eq(limit, plan.limit(&problem).unwrap()), "made twice");
        }
    }
}
