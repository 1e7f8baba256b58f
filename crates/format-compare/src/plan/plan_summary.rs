//! A plan for people to read: a summary, and the stages in mm and s.

use std::cell::Cell;
use std::ops::Range;

use feed_plan::{
    AxisLimits, EndFeeds, FeedLimit, KinematicLimits, ProfileKind, Stage, StageKind, StageShape,
    jerk_free_duration, least_duration,
};
use nurbs_core::{Evaluate, FastCurve};
use part_program::{Junction, Machine};
use real::{DoubleDouble, Real};
use serde::Serialize;

use crate::plan::axis_peaks::{AxisPeak, axis_peaks};
use crate::plan::calm::{calm, on_ways, others, straight_ways};
use crate::plan::exact_plan::ExactPlan;
use crate::plan::samples::Walk;
use crate::problem::problem::Problem;
use crate::refusal::Refusal;

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
    /// Parameter on that curve at the start.
    pub u_start: f64,
    /// Number of the curve that the stage ends on.
    pub curve_end: usize,
    /// Parameter on that curve at the end.
    pub u_end: f64,
    /// Feed at the start, in mm/s.
    pub start_feed_mm_per_s: f64,
    /// Feed at the end, in mm/s.
    pub end_feed_mm_per_s: f64,
    /// Length, in mm.
    pub length_mm: f64,
    /// Time, in s.
    pub time_s: f64,
    /// a_0 to a_3 of the feed as a polynomial of the time in s; `None` for a cosine.
    pub coefficients: Option<[f64; 4]>,
}

/// A plan in figures.
#[derive(Clone, Debug, Serialize)]
pub struct PlanSummary {
    /// The transitions that the plan is made of: `cubic`, `s-curve`, `trigonometric`, `flexible`, `fastest` or `none`.
    pub profile: &'static str,
    /// Number of curves.
    pub curves: usize,
    /// Arc length, in mm.
    pub length_mm: f64,
    /// Total time, in s.
    pub time_s: f64,
    /// Whole number of interpolation periods.
    pub periods: u64,
    /// The least time that a plan without a jerk limit needs, in s.
    pub jerk_free_time_s: f64,
    /// The additional time of the plan, as a share of that least time.
    pub over_jerk_free: f64,
    /// A time, in s, that no plan with the jerk limited is below.
    pub least_time_s: f64,
    /// By which part of that time the plan takes longer: it is that far from the fastest plan at most.
    pub over_least: f64,
    /// Largest acceleration along the path, in mm/s². Where the feed steps from one stage to the next, the step over a period counts.
    pub acceleration_max_mm_per_s2: f64,
    /// Its limit.
    pub acceleration_limit_mm_per_s2: f64,
    /// Largest acceleration of the setpoints in any direction, in mm/s²: the second difference of the points at which
    /// periods end, over T². In bends and at corners that are passed it is more than the acceleration along the path.
    pub total_acceleration_max_mm_per_s2: f64,
    /// Whether nothing limits the acceleration across the path in bends.
    pub is_free_across: bool,
    /// Largest jerk along the path, in mm/s³. Steps of the feed count too, by their mean over periods.
    pub jerk_max_mm_per_s3: f64,
    /// Its limit.
    pub jerk_limit_mm_per_s3: f64,
    /// Share of the path that is travelled at the commanded feed, or less than 0.5 % below it.
    pub share_at_commanded_feed: f64,
    /// The mean feed on that part of the path, over the commanded feed. It is less than 1, since the time is stretched
    /// to whole periods and since chords in bends are shorter than their arcs. `None` if no part is travelled at the
    /// commanded feed.
    pub feed_over_commanded: Option<f64>,
    /// The velocity, acceleration and jerk that the plan asks of each axis.
    pub axes: Vec<AxisPeak>,
    /// How far a plan without look-ahead is above the limits; `None` for all others, which keep them.
    #[serde(skip)]
    pub without_look_ahead: Option<OverLimits>,
    /// Number of stages.
    pub stage_count: usize,
    /// The stages.
    pub stages: Vec<StageRow>,
}

impl PlanSummary {
    /// The figures of a plan of `problem`.
    ///
    /// # Errors
    /// [`Refusal::Plan`] when the limit curve cannot be made.
    pub fn of<const D: usize>(plan: &ExactPlan, problem: &Problem<D>) -> Result<Self, Refusal> {
        let t = problem.period_s();
        let feed_limit = plan.limit(problem)?;
        let curves = problem.fast_curves();
        // Before the rows, since the bounds take much memory for a while.
        let [jerk_free_time_s, least_time_s] = bounds_s(plan, problem, &curves, feed_limit)?;
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
        let (acceleration, jerk) = peaks_along(plan);
        let straight = straight_ways(&curves, feed_limit);
        let is_without = plan.profile() == ProfileKind::WithoutLookAhead;
        let time_s = plan.periods() as f64 * t;
        let length_mm: f64 = stages.iter().map(|s| s.length_mm).sum();
        let [mut full_mm, mut commanded_mm] = [0.0; 2];
        for row in &stages {
            let feeds = (row.curve_start..=row.curve_end).map(|curve| problem.feed_mm_per_s(curve));
            let commanded = feeds.fold(f64::INFINITY, f64::min);
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
            least_time_s,
            over_least: time_s / least_time_s - 1.0,
            acceleration_max_mm_per_s2: acceleration / t.powi(2),
            acceleration_limit_mm_per_s2: problem.machine.acceleration_mm_per_s2,
            total_acceleration_max_mm_per_s2: total_acceleration(plan, problem, feed_limit, &straight)
                / t.powi(2),
            is_free_across: problem.machine.centripetal_acceleration_mm_per_s2.is_none(),
            jerk_max_mm_per_s3: jerk / t.powi(3),
            jerk_limit_mm_per_s3: problem.machine.jerk_mm_per_s3,
            share_at_commanded_feed: full_mm / length_mm,
            feed_over_commanded: (full_mm > 0.0).then(|| full_mm / commanded_mm),
            axes: axis_peaks(plan, problem, &curves, feed_limit, &straight),
            without_look_ahead: is_without.then(|| OverLimits::new((acceleration, jerk), problem)),
            stage_count: stages.len(),
            stages,
        })
    }
}

impl PlanSummary {
    /// The limits of the machine that the plan breaks by more than its last digits, each with how many times it is taken. What axes take at
    /// corners that are passed counts for nothing here, for the machine rounds them or lets the velocity jump.
    #[must_use]
    pub fn broken(&self, machine: &Machine) -> Vec<String> {
        let along = [
            (
                "acceleration along the path".to_string(),
                self.acceleration_max_mm_per_s2,
                Some(self.acceleration_limit_mm_per_s2),
            ),
            ("jerk along the path".to_string(), self.jerk_max_mm_per_s3, Some(self.jerk_limit_mm_per_s3)),
        ];
        let of_axis = |peak: &AxisPeak| {
            let (name, limits) = (peak.axis.to_uppercase(), peak.limits);
            [
                ("velocity", peak.velocity_max_mm_per_s, limits.velocity_mm_per_s),
                ("acceleration", peak.acceleration_max_mm_per_s2, limits.acceleration_mm_per_s2),
                ("jerk", peak.jerk_max_mm_per_s3, limits.jerk_mm_per_s3),
            ]
            .map(|(what, found, most)| (format!("{what} of {name}"), found, most))
        };
        let axes = self.axes.iter().filter(|_| machine.junction == Junction::Stop).flat_map(of_axis);
        let over = |(what, found, most): (String, f64, Option<f64>)| {
            let share = found / most?;
            let is_kept = share <= 1.0 + SLACK;
            (!is_kept).then(|| format!("{what} {share:.3} times its limit"))
        };
        along.into_iter().chain(axes).filter_map(over).collect()
    }
}

/// The largest second difference of the points at which periods end, in mm. The tool stands still before and behind the
/// plan where that begins or ends at rest, and wherever the machine makes another move in between.
pub(crate) fn total_acceleration<const D: usize>(
    plan: &ExactPlan,
    problem: &Problem<D>,
    limit: &FeedLimit<f64>,
    straight: &[Range<f64>],
) -> f64 {
    let on = |curve: usize, at: fn((f64, f64)) -> f64| {
        let curve = problem.curves.get(curve)?.as_curve();
        Some(curve.point(at(curve.domain())))
    };
    let standing = |point: Option<[f64; D]>| point.into_iter().flat_map(|point| [point; 2]);
    let stages = plan.arcs().stages();
    let is_rest = |feed: Option<DoubleDouble>| feed.is_some_and(|feed| feed.value() == 0.0);
    let starts_at_rest = is_rest(stages.first().map(|stage| stage.start_feed));
    let ends_at_rest = is_rest(stages.last().map(|stage| stage.end_feed));
    let calm = on_ways(plan.arcs().stages(), straight).filter_map(|way| calm(&way));
    let mut walk = Walk::new(plan);
    let last = Cell::default();
    let mut places = others(calm, plan.periods() + 1)
        .map(|(period, is_behind_calm)| {
            (limit.parameter_near(walk.to(period as f64).distance_and_feed().0, &last), is_behind_calm)
        })
        .peekable();
    let ends = problem.breaks.iter().copied().chain([problem.curves.len()]);
    let (mut begin, mut differences) = (0, SecondDifferences::default());
    for end in ends {
        let before = on(begin, |domain| domain.0).filter(|_| begin > 0 || starts_at_rest);
        let behind = on(end - 1, |domain| domain.1).filter(|_| end < problem.curves.len() || ends_at_rest);
        differences.begin();
        standing(before).for_each(|point| differences.add(point));
        while let Some(((curve, u), is_behind_calm)) = places.next_if(|((curve, _), _)| *curve < end) {
            if is_behind_calm {
                differences.begin();
            }
            if let Some(curve) = problem.curves.get(curve) {
                differences.add(curve.as_curve().point(u));
            }
        }
        standing(behind).for_each(|point| differences.add(point));
        begin = end;
    }
    differences.most
}

/// The largest second difference of series of points.
struct SecondDifferences<const D: usize> {
    last: [Option<[f64; D]>; 2],
    most: f64,
}

impl<const D: usize> Default for SecondDifferences<D> {
    fn default() -> Self {
        Self { last: [None; 2], most: 0.0 }
    }
}

impl<const D: usize> SecondDifferences<D> {
    /// Begins a series.
    fn begin(&mut self) {
        self.last = [None; 2];
    }

    fn add(&mut self, point: [f64; D]) {
        if let [Some(a), Some(b)] = self.last {
            let difference: [f64; D] = std::array::from_fn(|d| (point[d] - b[d]) - (b[d] - a[d]));
            self.most = self.most.max(f64::norm(&difference));
        }
        self.last = [self.last[1], Some(point)];
    }
}

/// The largest second difference of a series of points. For points a period T apart, it is T² times the largest
/// acceleration in any direction.
pub fn largest_second_difference<const D: usize>(points: impl IntoIterator<Item = [f64; D]>) -> f64 {
    let mut differences = SecondDifferences::default();
    points.into_iter().for_each(|point| differences.add(point));
    differences.most
}

/// The largest acceleration and jerk along the path, in mm and periods.
fn peaks_along(plan: &ExactPlan) -> (f64, f64) {
    let pieces = || plan.schedule().stages().iter().map(Stage::piece);
    let (by_periods, jerk_by_periods) = differences_over_periods(plan);
    let acceleration = pieces().map(|piece| piece.peak_acceleration().value()).fold(by_periods, f64::max);
    // In a shorter stage, the rounding of its feeds would look like a large jerk, but it changes nothing in so
    // short a time.
    let lasting = pieces().filter(|piece| piece.duration.value() > SHORT);
    (acceleration, lasting.map(|piece| piece.peak_jerk().value()).fold(jerk_by_periods, f64::max))
}

/// How far a plan is above limits of the machine.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct OverLimits {
    /// Largest acceleration along the path, over its limit.
    pub acceleration: f64,
    /// Largest jerk along the path, over its limit.
    pub jerk: f64,
}

impl OverLimits {
    /// The figures of a plan without look-ahead; `None` for all others, which keep both limits.
    pub(crate) fn of<const D: usize>(plan: &ExactPlan, problem: &Problem<D>) -> Option<Self> {
        let is_without = plan.profile() == ProfileKind::WithoutLookAhead;
        is_without.then(|| Self::new(peaks_along(plan), problem))
    }

    /// `peaks` are in mm and periods.
    fn new<const D: usize>(peaks: (f64, f64), problem: &Problem<D>) -> Self {
        let (t, machine, (acceleration, jerk)) = (problem.period_s(), &problem.machine, peaks);
        Self {
            acceleration: acceleration / t.powi(2) / machine.acceleration_mm_per_s2,
            jerk: jerk / t.powi(3) / machine.jerk_mm_per_s3,
        }
    }
}

/// The largest acceleration and jerk, in mm and periods, as means over a period: the second and third differences of
/// the distance. Where the feed steps from one stage to the next, they exceed those of every stage.
fn differences_over_periods(plan: &ExactPlan) -> (f64, f64) {
    let (mut acceleration, mut jerk) = (0.0_f64, 0.0_f64);
    let schedule = plan.schedule();
    let mut cursor = schedule.start();
    let mut before = [None; 2];
    while let Some(length) = schedule.advance(&mut cursor) {
        if let [_, Some(first)] = before {
            acceleration = acceleration.max((length - first).value().abs());
        }
        if let [Some(second), Some(first)] = before {
            jerk = jerk.max((length - first - first + second).value().abs());
        }
        // Behind three of them all periods of a constant feed are the same.
        let is_calm = before == [Some(length); 2] && schedule.pass_constant(&mut cursor) > 0;
        before = if is_calm { [Some(length); 2] } else { [before[1], Some(length)] };
    }
    (acceleration, jerk)
}

/// The least times between the plan's end feeds, in s: without a limit of jerk, and with one. Limits of the axes' accelerations and
/// jerks are left out of both: how a plan shares them out between turning and the feed is its own choice.
fn bounds_s<const D: usize>(
    plan: &ExactPlan,
    problem: &Problem<D>,
    curves: &[FastCurve<'_, D>],
    feed_limit: &FeedLimit<f64>,
) -> Result<[f64; 2], Refusal> {
    let stages = plan.schedule().stages();
    let ends = EndFeeds {
        start: stages.first().map_or(0.0, |stage| stage.start_feed.value()),
        end: stages.last().map_or(0.0, |stage| stage.end_feed.value()),
    };
    let limits = problem.limits_per_period()?;
    let freed = if limits.limit_accelerations_of_axes(D) {
        let of_velocities = |axis: AxisLimits<f64>| AxisLimits { acceleration: None, jerk: None, ..axis };
        let free = KinematicLimits { axes: limits.axes.map(of_velocities), ..limits };
        Some(problem.feed_limit_under(curves, &free)?)
    } else {
        None
    };
    let limit = freed.as_ref().unwrap_or(feed_limit);
    let bounds = [jerk_free_duration(limit, &limits, ends), least_duration(limit, &limits, ends)];
    Ok(bounds.map(|duration| duration * problem.period_s()))
}

/// A kind of transition by its name on the command line.
fn profile_name(kind: ProfileKind) -> &'static str {
    match kind {
        ProfileKind::Cubic => "cubic",
        ProfileKind::SCurve => "s-curve",
        ProfileKind::Trigonometric => "trigonometric",
        ProfileKind::Flexible => "flexible",
        ProfileKind::Fastest => "fastest",
        ProfileKind::WithoutLookAhead => "none",
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

/// Peaks are found by sampling, to a ten-thousandth or so.
const SLACK: f64 = 1e-3;

/// A stage counts as travelled at the commanded feed if its feed is lower by at most this share. The time is stretched
/// to whole periods, which lowers every feed by a thousandth or so: see [`PlanSummary::feed_over_commanded`].
const AT_FEED: f64 = 0.005;
/// Stages shorter than 2⁻²⁰ of a period are not used for the jerk.
const SHORT: f64 = 1.0 / 1_048_576.0;
