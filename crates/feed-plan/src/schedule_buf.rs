//! A plan that owns its stages.

use alloc::vec::Vec;

use real::Real;

use crate::{FeedLimit, Schedule, Stage, chord_feeds, sections};

/// A plan that owns its stages, as [`plan`](crate::plan) makes it.
#[derive(Clone, Debug, PartialEq)]
pub struct ScheduleBuf<R> {
    pub(crate) stages: Vec<Stage<R>>,
    pub(crate) interpolation_period: R,
    pub(crate) periods: u32,
}

impl<R: Real> ScheduleBuf<R> {
    /// The plan, borrowed: everything else is asked of that.
    #[must_use]
    pub fn as_schedule(&self) -> Schedule<'_, R> {
        Schedule::new(&self.stages, self.interpolation_period, self.periods)
    }

    /// The stages, in order.
    #[must_use]
    pub fn stages(&self) -> &[Stage<R>] {
        &self.stages
    }

    /// The same plan for setpoints whose chords, not arcs, have the planned lengths.
    ///
    /// The chords are shorter than their arcs, in each stage by what `shortfalls` says ([`FeedLimit::shortfalls`]): an
    /// interpolator that makes each chord as long as the plan says would be ahead of the plan by that much, and pass the next bend
    /// where the feed is still, or again, that of the straight. Here the feed is lowered by that, in the same time: from stop to
    /// stop the lengths are less by the sum of the shortfalls. Feed and acceleration stay continuous wherever they were;
    /// acceleration and jerk rise by no more than the stretch to whole periods left of their limits. For that the run is led off
    /// its plan near a joint at which the shortfall changes, by a part of what it changes by over a transition: over a tight bend
    /// by half of the bend's shortfall. A stage of constant feed may become three, of which the outer ones lead to other feeds.
    ///
    /// `limit` is the one that the plan was made under: it says where on the path such a stage is divided. Transitions are taken
    /// to be symmetric, as all of a plan are.
    #[must_use]
    pub fn shortened(self, limit: &FeedLimit<R>, shortfalls: &[R]) -> Self {
        let period = self.interpolation_period;
        self.by_sections(shortfalls, |stages, these| {
            chord_feeds::shortened(limit, stages, (these, R::zero()), period)
        })
    }

    /// The plan with other stages in place of those from each stop to the next, which it is given with their part of a list; where
    /// they start follows from their lengths.
    pub(crate) fn by_sections(
        self,
        list: &[R],
        mut other: impl FnMut(&[Stage<R>], &[R]) -> Vec<Stage<R>>,
    ) -> Self {
        let mut stages: Vec<Stage<R>> = Vec::with_capacity(self.stages.len());
        let (mut rest, mut start) = (list, R::zero());
        for section in sections(&self.stages) {
            let (these, others) = rest.split_at(section.stages().len().min(rest.len()));
            rest = others;
            for stage in other(section.stages(), these) {
                stages.push(Stage { start, ..stage });
                start = start + stage.length;
            }
        }
        Self { stages, ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::LimitPoint;
    use crate::schedule::examples::stages;

    #[test]
    fn a_shortened_plan_keeps_its_times_and_its_feeds_meet() {
        let plan = ScheduleBuf { stages: stages().to_vec(), interpolation_period: 1.0, periods: 4 };
        let point = |distance, feedrate| LimitPoint { distance, curve: 0, u: distance, feedrate };
        let limit = FeedLimit::from_points(&[point(0.0, 1.0), point(2.475, 1.0)]).unwrap();
        let shortened = |shortfalls: &[f64]| {
            let short = plan.clone().shortened(&limit, shortfalls);
            assert!((short.as_schedule().duration() - plan.as_schedule().duration()).abs() < 1e-15);
            let (mut start, mut feed) = (0.0, 0.0);
            for stage in short.stages() {
                assert!((stage.start - start).abs() < 1e-15, "{stage:?}");
                assert_eq!(stage.start_feed, feed);
                let mean = f64::midpoint(stage.start_feed, stage.end_feed);
                assert!((mean * stage.duration - stage.length).abs() < 1e-15, "{stage:?}");
                (start, feed) = (start + stage.length, stage.end_feed);
            }
            plan.as_schedule().length() - short.as_schedule().length()
        };
        // 0.3 is more than the second stage has.
        for shortfalls in [[0.01, 0.0, 0.02], [0.0, 0.3, 0.0], [0.2, 0.0, 0.0]] {
            let sum: f64 = shortfalls.iter().sum();
            let less = shortened(&shortfalls);
            assert!((less - sum).abs() < 1e-15, "{shortfalls:?}: {less}");
        }
        // Less than nothing is nothing, and so is what is not there.
        assert!((shortened(&[-1.0, 0.02, 0.0]) - 0.02).abs() < 1e-15);
        assert_eq!(plan.clone().shortened(&limit, &[]), plan);
        // What is more than half of the path is left.
        assert!((shortened(&[2.0, 2.0, 2.0]) - 2.475 / 2.0).abs() < 1e-15);
    }

    /// Each stop is landed on: what lies before it takes nothing from what lies behind.
    #[test]
    fn a_stop_divides_what_is_shortened() {
        let [up, cruise, down] = stages();
        let land = Stage { start_feed: 1.0, end_feed: 0.0, length: 0.55, ..down };
        let stages = vec![up, cruise, land, Stage { start: 2.2, ..up }, Stage { start: 3.45, ..land }];
        let plan = ScheduleBuf { stages, interpolation_period: 1.0, periods: 8 };
        let limit = FeedLimit::from_points(&[0.0, 4.0].map(|distance| LimitPoint {
            distance,
            curve: 0,
            u: distance,
            feedrate: 1.0,
        }));
        let short = plan.clone().shortened(&limit.unwrap(), &[0.1, 0.0, 0.0, 0.0, 0.02]);
        let length = |stages: &[Stage<f64>]| stages.iter().map(|stage| stage.length).sum::<f64>();
        for (range, less) in [(0..3, 0.1), (3..5, 0.02)] {
            let [whole, less_long] = [&plan, &short].map(|plan| length(&plan.stages()[range.clone()]));
            assert!((whole - less_long - less).abs() < 1e-15, "{range:?}: {whole} {less_long}");
        }
        assert_eq!((short.stages()[2].end_feed, short.stages()[3].start_feed), (0.0, 0.0));
    }
}
