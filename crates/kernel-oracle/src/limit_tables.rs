//! Plans under limits that are tables of drawn points, without any geometry; and whether the check of plans sees a plan
//! that is damaged.

use arbitrary::{Arbitrary, Unstructured};
use feed_plan::{
    AxisLimits, EndFeeds, FeedLimit, Junction, KinematicLimits, LimitPoint, ProfileKind, Schedule, Stage,
    plan_with,
};

use crate::plan_promises::PlanPromises;
use crate::violation::{Violation, demand};

/// A table of limits, and the limits of acceleration and jerk.
#[derive(Clone, Debug)]
pub struct LimitTable {
    points: Vec<LimitPoint<f64>>,
    limits: KinematicLimits<f64>,
    profile: ProfileKind,
    damage: Damage,
}

/// What is done to a good plan. Each breaks a promise.
#[derive(Clone, Copy, Debug)]
enum Damage {
    /// A stage goes on at another feed than the one before ended with.
    Feed,
    /// A stage begins further on than the one before ended.
    Gap,
    /// A stage takes half of its time.
    Hurry,
    /// The last stage is left out.
    End,
}

impl<'a> Arbitrary<'a> for LimitTable {
    fn arbitrary(bytes: &mut Unstructured<'a>) -> arbitrary::Result<Self> {
        let mut power = |low: f64, high: f64| -> arbitrary::Result<f64> {
            let share = f64::from(bytes.arbitrary::<u16>()?) / f64::from(u16::MAX);
            Ok(10.0_f64.powf(low + (high - low) * share))
        };
        // In mm and periods: the feed is reached within 3 to 300 periods, and the acceleration within 1 to 100.
        let feedrate = power(-2.0, 0.0)?;
        let acceleration = feedrate * power(-2.5, -0.5)?;
        let jerk = acceleration * power(-2.0, 0.0)?;
        let mut rows = Vec::new();
        for _ in 0..8 {
            rows.push((feedrate * power(-1.0, 2.0)?, feedrate * power(-2.0, 0.0)?));
        }
        let count = bytes.int_in_range(2..=8)?;
        let (mut distance, mut points) = (0.0, Vec::new());
        for (stride, feedrate) in rows.into_iter().take(count) {
            let point = |feedrate| LimitPoint { distance, curve: 0, u: 0.0, feedrate };
            points.push(point(feedrate));
            // A stop is a single point of the limit 0, and a jump are two points of one distance.
            match bytes.int_in_range(0..=7)? {
                0 if points.len() > 1 => points.extend([point(0.0), point(feedrate)]),
                1 => points.push(point(feedrate / 3.0)),
                _ => {}
            }
            distance += stride;
        }
        let last = points.last().map_or(feedrate, |point| point.feedrate);
        points.push(LimitPoint { distance, curve: 0, u: 1.0, feedrate: last });
        let limits = KinematicLimits {
            interpolation_period: 1.0,
            feedrate,
            acceleration,
            jerk,
            chord_error: feedrate,
            centripetal_acceleration: None,
            axes: [AxisLimits::default(); 3],
            junction: Junction::default(),
        };
        let profile = *bytes.choose(&ProfileKind::ALL)?;
        let damage = *bytes.choose(&[Damage::Feed, Damage::Gap, Damage::Hurry, Damage::End])?;
        Ok(Self { points, limits, profile, damage })
    }
}

impl LimitTable {
    /// Plans, and checks the plan and one that is damaged. Returns the number of stages; 0 where the table is refused.
    ///
    /// # Errors
    /// The first promise that the plan breaks, or a damaged plan that broke none.
    pub fn check(&self) -> Result<usize, Violation> {
        let Ok(limit) = FeedLimit::from_points(&self.points) else { return Ok(0) };
        let Ok(plan) = plan_with(&limit, &self.limits, EndFeeds::default(), self.profile) else {
            return Ok(0);
        };
        let promises = PlanPromises { limit: &limit, limits: &self.limits, places: 8 };
        let schedule = plan.as_schedule();
        promises.check(&schedule)?;
        let damaged = self.damaged(schedule.stages());
        let unseen = promises.check(&Schedule::new(&damaged, 1.0, schedule.periods())).is_ok();
        let what = "a damaged plan that breaks no promise";
        demand(what, "f64", self.points.len(), f64::from(u8::from(unseen)), 0.0)?;
        Ok(schedule.stages().len())
    }

    fn damaged(&self, stages: &[Stage<f64>]) -> Vec<Stage<f64>> {
        let mut stages = stages.to_vec();
        let middle = stages.len() / 2;
        match self.damage {
            Damage::Feed => stages[middle].start_feed += self.limits.feedrate / 64.0,
            Damage::Gap => stages[middle].start += self.limits.feedrate / 64.0,
            Damage::Hurry => stages[middle].duration /= 2.0,
            Damage::End => drop(stages.pop()),
        }
        stages
    }
}
