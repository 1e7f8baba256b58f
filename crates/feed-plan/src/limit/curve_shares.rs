//! What single curves leave for the path, beside the feed that [`FeedLimit::capped`] caps: acceleration and jerk along a
//! curve, and the feed at the joint before one.

use alloc::vec::Vec;

use real::Real;

use crate::FeedLimit;
use crate::limit::axis_budget::Allowance;
use crate::limit::sample::{LimitPoint, LimitSample};

impl<R: Real> FeedLimit<R> {
    /// Leaves at most this acceleration and this jerk for the path along a curve, which is given by its index; `None` leaves
    /// what there is. An axis that moves evenly with the way, by q' a mm, takes q' times the feed, acceleration and jerk of
    /// the path: its limits are those of the path over q'.
    #[must_use]
    pub fn allowing(mut self, most_of: impl Fn(usize) -> Option<(R, R)>) -> Self {
        for sample in &mut self.samples {
            if let Some((acceleration, jerk)) = most_of(sample.point.curve) {
                sample.allowance = sample.allowance.min(Allowance { acceleration, jerk });
            }
        }
        self
    }

    /// Passes the joint before a curve at no more than this feed, above 0; `None` changes nothing. The limit holds at the joint
    /// alone: beside it the curves have theirs.
    #[must_use]
    pub fn passing_joints(mut self, feed_before: impl Fn(usize) -> Option<R>) -> Self {
        let mut samples = Vec::with_capacity(self.samples.len());
        for mut begin in self.samples.drain(..) {
            let before: Option<&LimitSample<R>> = samples.last();
            let joint = before.filter(|before| before.point.curve != begin.point.curve);
            if let Some((before, feed)) = joint.zip(feed_before(begin.point.curve)) {
                if begin.is_single {
                    begin.lower_corner_to(feed);
                } else if feed < before.lower.min(begin.lower) {
                    let point = LimitPoint { feedrate: feed, ..begin.point };
                    let (lower_before, lower_after) = (before.lower, begin.lower);
                    let allowance = Allowance::unlimited();
                    samples.push(LimitSample {
                        point,
                        is_single: true,
                        bends: false,
                        allowance,
                        lower: feed,
                        lower_before,
                        lower_after,
                        ..begin
                    });
                }
            }
            samples.push(begin);
        }
        Self { samples, ..self }
    }
}

#[cfg(test)]
mod tests {
    use crate::test_paths::{limit_along, paper_limits, polyline};
    use crate::{EndFeeds, FeedLimit, KinematicLimits, PlanError, ProfileKind, Stage, plan_with};

    /// Three lines of 60 mm on one straight line, in mm and periods of 3 ms; F is 0.6 mm a period.
    fn straight() -> FeedLimit<f64> {
        limit_along(&polyline(&[[0.0, 0.0], [60.0, 0.0], [120.0, 0.0], [180.0, 0.0]]), &paper_limits())
    }

    fn peaks(stages: &[Stage<f64>], from: f64, to: f64) -> [f64; 3] {
        let mut peaks = [0.0_f64; 3];
        for (stage, share) in
            stages.iter().flat_map(|stage| (0..=200).map(move |i| (stage, f64::from(i) / 200.0)))
        {
            let time = share * stage.duration;
            if (from..=to).contains(&(stage.start + stage.distance_at(time))) {
                let taken =
                    [stage.feed_at(time), stage.acceleration_at(time).abs(), stage.jerk_at(time).abs()];
                peaks = core::array::from_fn(|one| peaks[one].max(taken[one]));
            }
        }
        peaks
    }

    fn planned(limit: &FeedLimit<f64>, kind: ProfileKind) -> Result<Vec<Stage<f64>>, PlanError> {
        Ok(plan_with(limit, &paper_limits(), EndFeeds::default(), kind)?.stages().to_vec())
    }

    /// The last line has a tenth of the acceleration and a hundredth of the jerk.
    #[test]
    fn a_curve_with_less_takes_no_more_and_the_others_keep_theirs() {
        let KinematicLimits { acceleration, jerk, .. } = paper_limits();
        let less = (0.1 * acceleration, 0.01 * jerk);
        let limit = straight().capped(|curve| if curve == 1 { 0.1 } else { 0.6 }).unwrap();
        let limit = limit.allowing(|curve| (curve == 2).then_some(less));
        for kind in [ProfileKind::Cubic, ProfileKind::SCurve, ProfileKind::Fastest] {
            let stages = planned(&limit, kind).unwrap();
            let [_, a, j] = peaks(&stages, 120.0 + 1e-9, 180.0);
            assert!(a <= less.0 * (1.0 + 1e-9) && j <= less.1 * (1.0 + 1e-9), "{kind:?}: {a} {j}");
            let [_, a, j] = peaks(&stages, 0.0, 60.0);
            assert!(a > 0.5 * acceleration && j > 0.5 * jerk, "{kind:?}: {a} {j}");
        }
    }

    #[test]
    fn a_joint_is_passed_at_its_feed_and_the_curves_beside_it_at_theirs() {
        let limit = straight().passing_joints(|curve| (curve == 1).then_some(0.05));
        let around = |at: f64| limit.minimum_over(at - 1e-9, at + 1e-9);
        assert_eq!([59.9, 60.0, 60.1, 120.0].map(around), [0.6, 0.05, 0.6, 0.6]);
        for kind in [ProfileKind::Cubic, ProfileKind::SCurve, ProfileKind::Fastest] {
            let stages = planned(&limit, kind).unwrap();
            let [at_joint, ..] = peaks(&stages, 60.0 - 1e-6, 60.0 + 1e-6);
            let [beside, ..] = peaks(&stages, 70.0, 110.0);
            assert!(at_joint > 0.04 && at_joint < 0.051 && beside > 0.59, "{kind:?}: {at_joint} {beside}");
        }
        assert_eq!(straight().passing_joints(|_| Some(0.6)), straight());
    }
}
