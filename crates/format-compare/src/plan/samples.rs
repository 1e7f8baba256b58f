//! A plan sampled at instants.

use feed_plan::Stage;
use real::DoubleDouble;
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

/// An instant of a plan along the path, in mm and periods.
pub(crate) struct Instant<'a> {
    /// Periods from the start of the plan.
    time: f64,
    stage: &'a Stage<DoubleDouble>,
    /// Periods from the start of the stage.
    since: DoubleDouble,
}

impl Instant<'_> {
    /// Distance along the path, in mm.
    pub(crate) fn distance(&self) -> f64 {
        (self.stage.start + self.stage.distance_at(self.since)).value()
    }

    /// Feed, in mm per period.
    pub(crate) fn feed(&self) -> f64 {
        self.stage.feed_at(self.since).value()
    }
}

/// `per_period` instants of each period, and the end of the plan.
fn instants(plan: &ExactPlan, per_period: u32) -> impl Iterator<Item = Instant<'_>> {
    let step = 1.0 / f64::from(per_period);
    let mut walk = Walk::new(plan);
    (0..=plan.periods() * u64::from(per_period)).map(move |sample| walk.to(sample as f64 * step))
}

/// A walk along a plan.
pub(crate) struct Walk<'a> {
    stages: &'a [Stage<DoubleDouble>],
    stage: usize,
    /// Periods before the stage.
    before: f64,
}

impl<'a> Walk<'a> {
    pub(crate) fn new(plan: &'a ExactPlan) -> Self {
        Self { stages: plan.arcs().stages(), stage: 0, before: 0.0 }
    }

    /// Goes on to a time, in periods, which is no earlier than the one before.
    pub(crate) fn to(&mut self, time: f64) -> Instant<'a> {
        let Self { stages, stage, before } = self;
        while *stage + 1 < stages.len() && time >= *before + stages[*stage].duration.value() {
            *before += stages[*stage].duration.value();
            *stage += 1;
        }
        let stage = &stages[*stage];
        Instant { time, stage, since: DoubleDouble::from((time - *before).min(stage.duration.value())) }
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
        let t = problem.period_s();
        let feed_limit = self.limit(problem)?;
        let sample = |at: Instant<'_>| {
            let distance_mm = at.distance();
            let (curve, u) = feed_limit.parameter_at(distance_mm);
            FeedSample {
                time_s: at.time * t,
                distance_mm,
                curve,
                u,
                feed_mm_per_s: at.feed() / t,
                acceleration_mm_per_s2: at.stage.acceleration_at(at.since).value() / t.powi(2),
                jerk_mm_per_s3: at.stage.jerk_at(at.since).value() / t.powi(3),
                limit_mm_per_s: feed_limit.at(distance_mm) / t,
            }
        };
        Ok(instants(self, per_period).map(sample).collect())
    }
}

#[cfg(test)]
mod tests {
    use nurbs_core::arc_length;

    use super::*;
    use crate::examples::{EXAMPLE, on_example_machine};

    /// Sums of chords were once taken for arc lengths. The last row was short of the end, and feeds stood beside the
    /// limit of another place.
    #[test]
    fn the_places_of_samples_are_those_of_the_plan() {
        let mut problem = on_example_machine::<2>(EXAMPLE, "");
        problem.machine.chord_error_mm = 0.1;
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
}
