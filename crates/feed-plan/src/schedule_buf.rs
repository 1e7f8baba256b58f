//! A plan that owns its stages.

use alloc::vec::Vec;

use real::Real;

use crate::{Schedule, Stage};

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
    /// The chords are shorter than their arcs, in each stage by what `shortfalls` says
    /// ([`FeedLimit::shortfalls`]): an interpolator that makes each chord as long as the plan says would be
    /// ahead of the plan by that much, and pass the next bend where the feed is still, or again, that of the
    /// straight. Here the distances and feeds of each stage are scaled by `1 - shortfall/length`; durations
    /// stay. Acceleration and jerk within a stage only fall. From one stage to the next the planned chord steps
    /// with the curvature, by some thousandths at most: the acceleration may change there by more than J T in a period, on a spline
    /// of degree 2 by up to 2.3 J T. What is more than half of a stage is taken
    /// off the next ones, up to the next stop, which is landed on.
    ///
    /// [`FeedLimit::shortfalls`]: crate::FeedLimit::shortfalls
    #[must_use]
    pub fn shortened(mut self, shortfalls: &[R]) -> Self {
        shorten(&mut self.stages, shortfalls);
        self
    }
}

/// Scales stages as [`ScheduleBuf::shortened`] says.
fn shorten<R: Real>(stages: &mut [Stage<R>], shortfalls: &[R]) {
    let (mut due, mut taken) = (R::zero(), R::zero());
    for (stage, shortfall) in stages.iter_mut().zip(shortfalls) {
        due = due + *shortfall;
        stage.start = stage.start - taken;
        let off = due.min(stage.length.half());
        if off > R::zero() {
            *stage = stage.shortened_by(off);
            (due, taken) = (due - off, taken + off);
        }
        if stage.end_feed.is_zero() {
            due = R::zero(); // Landed on.
        }
    }
}

impl<R: Real> Stage<R> {
    /// The stage with its distances and feeds scaled so that it is shorter by `off`, in the same time.
    pub(crate) fn shortened_by(&self, off: R) -> Self {
        if !(off > R::zero()) {
            return *self;
        }
        let share = off / self.length;
        let scaled = |quantity: R| quantity - quantity * share;
        let (length, start_feed, end_feed) =
            (scaled(self.length), scaled(self.start_feed), scaled(self.end_feed));
        Self { length, start_feed, end_feed, ..*self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schedule::examples::stages;

    #[test]
    fn shortening_scales_each_stage_and_keeps_times() {
        let plan = ScheduleBuf { stages: stages().to_vec(), interpolation_period: 1.0, periods: 4 };
        let lengths = plan.stages.iter().map(|stage| stage.length);
        let short = plan.clone().shortened(&[0.01, 0.0, 0.02]);
        assert_eq!(short.as_schedule().duration(), plan.as_schedule().duration());
        let mut start = 0.0;
        for ((stage, length), shortfall) in short.stages().iter().zip(lengths).zip([0.01, 0.0, 0.02]) {
            assert!(
                (stage.length - (length - shortfall)).abs() < 1e-15 && (stage.start - start).abs() < 1e-15
            );
            let mean = f64::midpoint(stage.start_feed, stage.end_feed);
            assert!((mean * stage.duration - stage.length).abs() < 1e-15);
            start += stage.length;
        }
        // What a stage cannot give is taken off the next; less than nothing is nothing.
        let short = plan.clone().shortened(&[0.0, 0.3, 0.0]);
        assert!((short.stages()[1].length - 0.2).abs() < 1e-15);
        assert!((short.as_schedule().length() - (plan.as_schedule().length() - 0.3)).abs() < 1e-15);
        assert_eq!(plan.clone().shortened(&[-1.0, 0.5, 0.0]), plan);
        // A stop is landed on: what was left before it is not made up for behind it.
        let mut stopped = plan.clone();
        stopped.stages[0].end_feed = 0.0;
        let short = stopped.shortened(&[-1.0, 0.02, 0.0]);
        assert!((short.stages()[1].length - (plan.stages()[1].length - 0.02)).abs() < 1e-15);
        assert_eq!(plan.clone().shortened(&[]), plan);
    }
}
