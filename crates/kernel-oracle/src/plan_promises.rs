//! What every plan from rest to rest promises, whatever its limit comes from.

use feed_plan::{FeedLimit, KinematicLimits, Schedule};

use crate::violation::{Violation, demand};

/// The limits that a plan has to keep.
pub struct PlanPromises<'a> {
    /// The largest feed at each distance.
    pub limit: &'a FeedLimit<f64>,
    /// Limits, in mm and interpolation periods.
    pub limits: &'a KinematicLimits<f64>,
    /// At so many places of each stage the feed is compared with the limit.
    pub places: u32,
}

/// The rounding that is allowed in a quantity of the plan: 10⁻¹² is promised, over some hundred stages.
const ROUNDING: f64 = 1e-9;

impl PlanPromises<'_> {
    /// Checks that the plan keeps feed, acceleration and jerk at every stage, joins its stages, travels in each as far
    /// as its feed goes, ends at rest at the end, and stays under the limit.
    ///
    /// # Errors
    /// The first promise that is broken.
    pub fn check(&self, plan: &Schedule<'_, f64>) -> Result<(), Violation> {
        let Self { limit, limits, places } = *self;
        let rounded = |bound: f64| bound * (1.0 + ROUNDING);
        let (mut feed, mut distance) = (0.0, 0.0);
        let feed_unit = ROUNDING * limits.feedrate;
        let near = ROUNDING * (1.0 + plan.length());
        for (index, stage) in plan.stages().iter().enumerate() {
            let piece = stage.piece();
            let holds = |what, value, bound| demand(what, "f64", index, value, bound);
            holds("a stage begins with the feed before it", (stage.start_feed - feed).abs(), feed_unit)?;
            holds("a stage begins where the one before ends", (stage.start - distance).abs(), near)?;
            holds(
                "a stage is as long as its feed makes it",
                (stage.distance_at(stage.duration) - stage.length).abs(),
                near,
            )?;
            holds("feed", stage.start_feed.max(stage.end_feed), rounded(limits.feedrate))?;
            holds("no feed is negative", -stage.start_feed.min(stage.end_feed), 0.0)?;
            holds("acceleration", piece.peak_acceleration().abs(), rounded(limits.acceleration))?;
            holds("jerk", piece.peak_jerk().abs(), rounded(limits.jerk))?;
            (feed, distance) = (stage.end_feed, stage.start + stage.length);
            for place in 0..=places {
                let time = stage.duration * f64::from(place) / f64::from(places);
                let at = stage.start + stage.distance_at(time);
                // Where the limit jumps, the values on both sides are allowed: rounding decides on which side a place
                // lies.
                let allowed = limit.at(at).max(limit.at((at - near).max(0.0))).max(limit.at(at + near));
                holds("feed under the limit", stage.feed_at(time), allowed * (1.0 + 1e-6) + feed_unit)?;
            }
        }
        let behind = plan.stages().len();
        demand("the plan ends at rest", "f64", behind, feed, feed_unit)?;
        let length = limit.length();
        demand(
            "the plan ends at the end",
            "f64",
            behind,
            (distance - length).abs(),
            ROUNDING * (1.0 + length),
        )?;
        let periods = plan.periods() as f64;
        let off = (plan.duration() - periods).abs();
        demand("the plan takes whole periods", "f64", 0, off, ROUNDING * (1.0 + periods)).map(|_| ())
    }
}
