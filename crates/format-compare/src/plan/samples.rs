//! A plan sampled at instants.

use feed_plan::{FeedLimit, Stage, StageKind};
use nurbs_core::{FastCurve, parameter_at};
use real::{DoubleDouble, Real};
use serde::Serialize;

use crate::plan::exact_plan::ExactPlan;
use crate::problem::problem::Problem;
use crate::refusal::Refusal;

/// The plan at one instant.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct FeedSample {
    /// Time, in s.
    pub time_s: f64,
    /// Distance along the path, in mm.
    pub distance_mm: f64,
    /// Number of the curve there, from 0.
    pub curve: usize,
    /// Its parameter there: the arc length up to it is the distance within 1e-9 mm, as far as u tells such places apart.
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

/// An instant of a plan along the path, in mm and periods.
pub(crate) struct Instant<'a> {
    /// Periods from the start of the plan.
    time: f64,
    stage: &'a Stage<DoubleDouble>,
    /// Periods from the start of the stage.
    since: DoubleDouble,
    /// The share of the stage's time.
    share: DoubleDouble,
}

impl Instant<'_> {
    /// Distance along the path, in mm, and feed, in mm per period.
    pub(crate) fn distance_and_feed(&self) -> (f64, f64) {
        let stage = self.stage;
        let (travelled, feed) = match stage.kind() {
            StageKind::Constant => (stage.start_feed * self.since, stage.start_feed),
            _ => stage.piece().distance_and_feed_at(self.share),
        };
        ((stage.start + travelled).value(), feed.value())
    }
}

/// The numbers of the periods at which a plan is sampled for a picture: so many at most of even distance, and those
/// before and behind the end of each stage.
fn for_a_picture(plan: &ExactPlan, most: u64) -> Vec<u64> {
    let distance = plan.periods().div_ceil(most).max(1);
    let even = (0..=plan.periods() / distance).map(|number| number * distance);
    let mut time = 0.0;
    let ends = plan.arcs().stages().iter().flat_map(|stage| {
        time += stage.duration.value();
        [time.floor(), time.ceil()].map(|time| time.to_phase(-64).min(plan.periods()))
    });
    let mut periods: Vec<u64> = even.chain(ends).chain([plan.periods()]).collect();
    periods.sort_unstable();
    periods.dedup();
    periods
}

/// The arc length up to a parameter is the distance within this, in mm.
const ARC_TOLERANCE_MM: f64 = 1e-11;

/// Curve and parameter at `distance` along the path: by the arc length from the limit's point before, where the limit itself has a cubic
/// between two points.
fn exact_parameter<const D: usize>(
    limit: &FeedLimit<f64>,
    curves: &[FastCurve<'_, D>],
    distance: f64,
) -> (usize, f64) {
    let (number, near) = limit.parameter_at(distance);
    let from = limit.point_before(distance).filter(|point| point.curve == number);
    match (curves.get(number), from) {
        (Some(curve @ (FastCurve::Polynomials(_) | FastCurve::Basis(_))), Some(from)) => {
            let way = distance - from.distance;
            (number, parameter_at(curve, from.u, way, ARC_TOLERANCE_MM).parameter())
        }
        _ => (number, near),
    }
}

/// One over a stage's duration; 0 if it has none.
fn reciprocal(stage: &Stage<DoubleDouble>) -> DoubleDouble {
    let [zero, one] = [0.0, 1.0].map(DoubleDouble::from);
    if stage.duration > zero { one / stage.duration } else { zero }
}

/// A walk along a plan.
pub(crate) struct Walk<'a> {
    stages: &'a [Stage<DoubleDouble>],
    stage: usize,
    /// Periods before the stage.
    before: f64,
    /// The reciprocal of the stage's duration: a quotient of double-doubles takes longer than all else.
    reciprocal: DoubleDouble,
}

impl<'a> Walk<'a> {
    pub(crate) fn new(plan: &'a ExactPlan) -> Self {
        let stages = plan.arcs().stages();
        Self {
            stages,
            stage: 0,
            before: 0.0,
            reciprocal: stages.first().map_or_else(|| DoubleDouble::from(0.0), reciprocal),
        }
    }

    /// Goes on to a time, in periods, which is no earlier than the one before.
    pub(crate) fn to(&mut self, time: f64) -> Instant<'a> {
        let Self { stages, stage, before, .. } = self;
        let first = *stage;
        while *stage + 1 < stages.len() && time >= *before + stages[*stage].duration.value() {
            *before += stages[*stage].duration.value();
            *stage += 1;
        }
        let is_another = *stage > first;
        let stage = &stages[*stage];
        if is_another {
            self.reciprocal = reciprocal(stage);
        }
        let since = DoubleDouble::from((time - self.before).min(stage.duration.value()));
        Instant { time, stage, since, share: since * self.reciprocal }
    }
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
        Ok(self.samples(problem, per_period)?.collect())
    }

    /// The same samples, one after the other.
    ///
    /// # Errors
    /// As [`sampled`](Self::sampled).
    pub fn samples<'a, const D: usize>(
        &'a self,
        problem: &'a Problem<D>,
        per_period: u32,
    ) -> Result<impl Iterator<Item = FeedSample> + use<'a, D>, Refusal> {
        let step = 1.0 / f64::from(per_period);
        let count = self.periods() * u64::from(per_period);
        self.sampled_at(problem, (0..=count).map(move |sample| sample as f64 * step))
    }

    /// The plan sampled once a period, or less often if it takes more than `most` periods: then at so many even
    /// distances, and at both ends of each stage.
    ///
    /// # Errors
    /// As [`sampled`](Self::sampled).
    pub fn sampled_for_a_picture<const D: usize>(
        &self,
        problem: &Problem<D>,
        most: u64,
    ) -> Result<Vec<FeedSample>, Refusal> {
        let periods = for_a_picture(self, most);
        Ok(self.sampled_at(problem, periods.into_iter().map(|period| period as f64))?.collect())
    }

    /// Samples at rising times, in periods.
    fn sampled_at<'a, const D: usize, T: Iterator<Item = f64>>(
        &'a self,
        problem: &'a Problem<D>,
        times: T,
    ) -> Result<impl Iterator<Item = FeedSample> + use<'a, D, T>, Refusal> {
        let t = problem.period_s();
        let feed_limit = self.limit(problem)?;
        let curves = problem.fast_curves();
        let sample = move |at: Instant<'_>| {
            let (distance_mm, feed) = at.distance_and_feed();
            let (curve, u) = exact_parameter(feed_limit, &curves, distance_mm);
            FeedSample {
                time_s: at.time * t,
                distance_mm,
                curve,
                u,
                feed_mm_per_s: feed / t,
                acceleration_mm_per_s2: at.stage.acceleration_at(at.since).value() / t.powi(2),
                jerk_mm_per_s3: at.stage.jerk_at(at.since).value() / t.powi(3),
                limit_mm_per_s: feed_limit.at(distance_mm) / t,
            }
        };
        let mut walk = Walk::new(self);
        Ok(times.map(move |time| sample(walk.to(time))))
    }
}
